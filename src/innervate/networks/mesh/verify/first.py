"""A mesh's first round: from nodes that are off to tables in force, if nothing fails."""

from typing import NamedTuple

from innervate.networks.mesh.verify import local
from innervate.networks.mesh.verify import net as mesh_net
from innervate.verify.values import with_one

SETTLED_US = 3_000_000  # tables are there; messages are offered from then on
LAST = 12  # events of a round without end that its story tells


class Begun(NamedTuple):
    """Where an exploration begins, or what broke before it could."""

    # switched on; where something is offered, after the first round, its tables in force
    net: mesh_net.Net
    broken: int  # what that broke, a number of local.py; 0 nothing
    start: mesh_net.Net  # the state before `path`; if nothing broke, `net`
    path: list[mesh_net.Successor]  # the events that broke it


def begin(nets: mesh_net.Nets) -> Begun:
    """Switch all nodes of a mesh on, and let their first round pass."""
    model, many = nets.model, (1 << 20,) * nets.n
    start = mesh_net.Net((mesh_net.DEAD,) * nets.n, (0,) * nets.n, (0, 0, 0, 0), many, 1 << 20, 0)
    path: list[mesh_net.Successor] = []
    net = start
    for who in (*range(1, nets.n), 0):
        out = nets.locals.start(who, 0)
        net = net._replace(nodes=with_one(net.nodes, who, out.state))
        path.append((mesh_net.Move(mesh_net.SWITCH_ON, who), net, out.broken))
        if out.broken:
            return Begun(net, out.broken, start, path)
    past = 0
    while past < SETTLED_US and not model.beats:
        wait = nets.soonest(net)[0]
        step = nets.steady(net)
        if step is None:  # nobody does anything any more
            break
        path.append(step)
        net, past = step[1], past + wait
        if step[2]:
            return Begun(net, step[2], start, path)
        if len(path) > mesh_net.EVENTS_MAX:
            return Begun(net, local.BROKEN_FIRST, path[-LAST - 1][1], path[-LAST:])
    first = _ready(nets, net)
    return Begun(first, 0, first, [])


def _ready(nets: mesh_net.Nets, net: mesh_net.Net) -> mesh_net.Net:
    """The state with all that may still happen."""
    model, budget = nets.model, nets.model.budget
    if not model.beats:
        nets.locals.coarsen()
        net = net._replace(nodes=nets.present(net), lags=(0,) * nets.n)
    left = (budget.deaths, budget.revivals, budget.frames, budget.acks)
    most = model.beats + nets.calm_beats() if model.beats else budget.ticks
    return net._replace(left=left, ticks=(most,) * nets.n, offered=0, got=0)
