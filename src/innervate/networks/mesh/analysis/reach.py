"""Whose messages would reach the gateway of a mesh now, and who is physically cut off from it.

A node *has a way* if a packet that it sends to its gateway now would get there by what the protocol
does: over links that carry frames and nodes that are on, next hops that do not answer passed by as
`protocol/route.py` passes them by. It is *cut off* if no chain of such links and nodes joins
it to any gateway, whatever a protocol did. What makes the difference between the two is mended by
the protocol; what cuts off, by people.

What nodes know comes from the tables of a simulation (`choices`), or from what running nodes say;
`ways` is the same for both.
"""

from typing import Any, NamedTuple

import numpy as np

from innervate.analysis.ways import NOWHERE, Flags, Numbers, follow, reach
from innervate.networks.mesh.protocol import constants as const
from innervate.networks.mesh.protocol.neighbours import FREE, UNHEARD
from innervate.networks.mesh.scenario.params import sent_at_most
from innervate.networks.mesh.scenario.plan import ONE
from innervate.sim.field.powers import CAPTURE_ONE
from innervate.sim.field.states import ALIVE, DEAD
from innervate.sim.tables import column
from innervate.topology.placement import distances

FAR = 1 << 30
HALF = 0.5

HAS_WAY, ASTRAY, CUT_OFF = range(3)


class Choices(NamedTuple):
    """Whom nodes would hand a packet for the gateway, as far as they know; n nodes."""

    gateway: Numbers  # per node whom it follows, NOWHERE nobody
    # (n, k), k at least 1, in order: the gateway if it is a strong neighbour, the table's
    # next hop and alternate, the uplinks; NOWHERE where there is none, or it is silent
    named: Numbers
    neighbours: Flags  # (n, n) flags: neighbours that are tried after those
    goes_back: bool  # a packet that got stuck is given back, and tried another way from there


class Ways(NamedTuple):
    """Who reaches a gateway; one entry per node."""

    # by whom its packets get there: the first choice that carries frames, or a neighbour of the
    # search; of who has no way, whom it would try first; NOWHERE nobody
    hop: Numbers
    # hops of the way over first choices that carry frames; NOWHERE where that leads nowhere
    # and a packet has to search
    depth: Numbers
    on: Flags  # it is on
    off: Flags  # it was on and is not any more
    leads: Flags  # it is a gateway now
    joined: Flags  # it follows a gateway, or is one
    cut_off: Flags  # it is on, and no links that carry frames join it to a gateway
    astray: Flags  # it is on and not cut off, and its packets do not get to its gateway

    @property
    def without(self) -> Flags:
        """Who is on and has no way, for whatever reason."""
        found: Flags = self.cut_off | self.astray
        return found

    @property
    def served(self) -> Flags:
        """Who is on and not cut off, and no gateway: with a way, or astray."""
        found: Flags = self.on & ~self.cut_off & ~self.leads
        return found

    @property
    def lacks(self) -> Numbers:
        """Per node HAS_WAY (or it is off), ASTRAY or CUT_OFF."""
        return np.where(self.cut_off, CUT_OFF, np.where(self.astray, ASTRAY, HAS_WAY))


def ways(known: Choices, carries: Flags, on: Flags, off: Flags, leads: Flags) -> Ways:
    """Who reaches a gateway now; `carries`, (n, n) flags: from whom to whom messages get over."""
    count = len(on)
    nodes = np.arange(count)
    live = carries & on[:, None] & on[None, :]
    leads = leads & on
    named = known.named
    over = (named != NOWHERE) & live[nodes[:, None], np.maximum(named, 0)]
    first = np.where(over.any(axis=1), named[nodes, over.argmax(axis=1)], NOWHERE)
    root, depth = follow(first, leads)
    there = leads | ((root != NOWHERE) & (root == known.gateway) & (depth <= const.PATH_MAX))
    rest = np.flatnonzero(on & ~there & (known.gateway != NOWHERE))
    hop = first.copy()
    if len(rest):
        hop[rest] = _searched(known, live, leads, over, rest)
        there[rest] = hop[rest] != NOWHERE
    joined = on & (leads | (known.gateway != NOWHERE))
    cut_off = on & ~reach(live & live.T, leads) if leads.any() else np.zeros(count, np.bool_)
    return Ways(
        hop=np.where(leads | ~on, NOWHERE, np.where(there, hop, named[:, 0])),
        depth=np.where(there, depth, NOWHERE),
        on=on,
        off=off,
        leads=leads,
        joined=joined,
        cut_off=cut_off,
        astray=on & ~there & ~cut_off,
    )


def _searched(known: Choices, live: Flags, leads: Flags, over: Flags, rest: Numbers) -> Numbers:
    """Per node of `rest`, by whom its packets arrive although its first choices lead nowhere.

    NOWHERE where they do not arrive.
    """
    if known.goes_back:
        # It comes to everybody whom anybody there can hand it to, if need be.
        count = len(leads)
        hands = known.neighbours.copy()
        to = known.named[over]
        hands[np.repeat(np.arange(count), over.sum(axis=1)), to] = True
        hands &= live
        back = [np.flatnonzero(row).tolist() for row in hands.T]
        gateways = np.unique(known.gateway[rest[leads[known.gateway[rest]]]]).tolist()
        far = {gateway: np.array(distances(back, gateway)) for gateway in gateways}
        found = [_nearer(hands[node], far.get(known.gateway[node]), node) for node in rest]
    else:
        found = [_walked(known, live, leads, node) for node in rest.tolist()]
    return np.array(found, np.int64)


def _nearer(hands: Flags, far: Numbers | None, node: int) -> int:
    """Whom a node hands to that is a hop nearer to its gateway; NOWHERE if that is too far."""
    if far is None or not 0 < far[node] <= const.PATH_MAX:
        return NOWHERE
    return int(np.argmax(hands & (far == far[node] - 1)))


def _walked(known: Choices, live: Flags, leads: Flags, node: int) -> int:
    """To whom a packet goes first that is never given back, and meets nobody twice; see above."""
    gateway, path = int(known.gateway[node]), [node]
    if not leads[gateway]:
        return NOWHERE
    while path[-1] != gateway and len(path) <= const.PATH_MAX:
        here = path[-1]
        order = [*known.named[here].tolist(), *np.flatnonzero(known.neighbours[here]).tolist()]
        fits = (to for to in order if to != NOWHERE and to not in path and live[here, to])
        onward = next(fits, NOWHERE)
        if onward == NOWHERE:
            return NOWHERE
        path.append(onward)
    return path[1] if path[-1] == gateway else NOWHERE


def of_simulation(world: Any, plan: Any) -> Ways:
    """Who reaches a gateway in a simulation, as its tables stand; compiled or plain."""
    states = column(world.radios, "state", plan.nodes)
    leading = column(world.nodes, "leading", plan.nodes) == 1
    on = states == ALIVE
    return ways(choices(world, plan), carries(world, plan), on, states == DEAD, leading & on)


def carries(world: Any, plan: Any) -> Flags:
    """Per sender and receiver, whether a message most likely gets over that link in time.

    A hop is sent `transmissions` times, and a message `e2e_tries` times more by its origin; with
    each, frame and acknowledgement have to come through. In every second case at least one of them
    does.
    """
    count, params = plan.nodes, plan.params
    shape = count, count
    chance = np.asarray(world.prob).reshape(shape) / ONE
    heard = chance * (np.asarray(world.cut).reshape(shape) == 0)
    noise = column(world.radios, "noise", count)
    if noise.any() and plan.radio.collisions:
        capture = int(column(world.run, "capture", 1)[0])
        power = np.asarray(world.power).reshape(shape)
        heard = heard * (power * CAPTURE_ONE // capture >= noise[None, :])
    acked = heard * heard.T if params["hop_acks"] else heard
    found: Flags = (1 - acked) ** sent_at_most(params) <= HALF
    return found & ~np.eye(count, dtype=np.bool_)


def choices(world: Any, plan: Any) -> Choices:
    """What the nodes of a simulation know."""
    count, params = plan.nodes, plan.params
    nodes = _Columns(world.nodes, count)
    near, suspect = nodes["neighbour"], nodes["suspect"] & 1 == 1
    gateway = np.where(nodes["known"] == 1, nodes["gateway"], FREE)
    who = np.arange(count)

    def usable(found: Any) -> Any:
        hit = ((near == found[:, None]) & suspect).any(axis=1)
        return np.where((found < count) & (found != who) & ~hit, found, NOWHERE)

    strong = ((near == gateway[:, None]) & (nodes["rssi"] >= 4 * params["min_rssi"])).any(axis=1)
    named = [np.where(strong, usable(gateway), NOWHERE)]
    if params["mode"] == const.TABLES:
        place = nodes["bank"] * params["width"] + np.minimum(gateway, params["width"] - 1)
        tables = ("next", "alt") if params["failover"] >= const.ALTERNATE else ("next",)
        for table in tables:
            way = nodes[table][who, place]
            named.append(np.where(gateway != FREE, usable(way), NOWHERE))
    named.extend(_uplinks(nodes, params, near, suspect))
    goes_back = params["mode"] != const.TABLE_FREE and params["failover"] == const.SEARCH
    # With the document's failover anybody takes the place of a next hop that does not answer.
    others = goes_back or (params["mode"] == const.TABLES and params["failover"] < const.ALTERNATE)
    is_near = np.zeros((count, count + 1), np.bool_)
    if others:
        is_near[who[:, None], np.minimum(near, count)] = True
    return Choices(
        gateway=np.where(gateway < count, gateway, NOWHERE),
        named=_packed(np.stack(named, axis=1)),
        neighbours=is_near[:, :count],
        goes_back=bool(goes_back),
    )


def _uplinks(nodes: Any, params: Any, near: Numbers, suspect: Flags) -> list[Numbers]:
    """Neighbours that are nearer to the gateway, the best first."""
    depth = nodes["round_depth"]
    up = (near != FREE) & (depth != UNHEARD) & (depth < nodes["depth"][:, None]) & ~suspect
    weak = nodes["round_rssi"] < params["min_rssi"]
    cost = np.where(up, weak * 1_000_000 + depth * 1_000 - nodes["round_rssi"], FAR)
    if params["faint"] <= params["min_rssi"]:
        cost = np.where(up & (near == nodes["parent"][:, None]), -FAR, cost)
    order = np.argsort(cost, axis=1, kind="stable")
    sorted_ = np.take_along_axis(np.where(up, near, NOWHERE), order, axis=1)
    found: list[Numbers] = list(sorted_.T)
    return found


def _packed(named: Numbers) -> Numbers:
    """The same choices without gaps, so that the first of a row is the first choice."""
    order = np.argsort(named == NOWHERE, axis=1, kind="stable")
    found: Numbers = np.take_along_axis(named, order, axis=1)
    return found


class _Columns(dict[str, Numbers]):
    """Fields of a table's records by name, read when they are asked for."""

    def __init__(self, table: Any, count: int) -> None:
        super().__init__()
        self._table, self._count = table, count

    def __missing__(self, name: str) -> Numbers:
        found = self[name] = column(self._table, name, self._count)
        return found
