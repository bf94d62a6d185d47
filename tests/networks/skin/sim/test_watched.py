"""What the observer keeps, worked out anew from cables and parents alone, all along random runs."""

from types import SimpleNamespace

import networkx
import numpy as np
import pytest

from innervate.networks.skin.protocol.constants import (
    NONE,
    PORTS,
    REPORT_BALANCE,
    REPORT_BROKEN,
    REPORT_PARENT,
    RULE_FEASIBLE,
)  # fmt: skip
from innervate.networks.skin.sim import observer, simulate
from innervate.sim.cables.world import DEAD
from innervate.sim.status import DONE
from tests.networks.skin.runs import faulty, plan_of

EVENTS = ["cut", "restore", "kill", "revive", "restart", "cut pc", "restore pc"]
STEP_US = 1500
CHANGES, LOOPS = (REPORT_PARENT, REPORT_BALANCE), (observer.LOOP_OPEN, observer.LOOP_CLOSED)


def hops(world, cells):
    """Per cell the node its data goes to over a live cable; the PC is node `cells`."""
    found = {}
    for cell in range(cells):
        end = PORTS * cell + world.watch.port[cell]
        if world.watch.port[cell] != NONE and world.epoch[end] % 2 == 0:
            found[cell] = min(world.ends[end].peer // PORTS, cells)
    return found


def expected(world, cells):
    """Who is joined, who has a route, how many loops there are, who is cut off."""
    live = networkx.Graph([(min(end // PORTS, cells), min(wire.peer // PORTS, cells))
                           for end, wire in enumerate(world.ends)
                           if wire.peer >= 0 and world.epoch[end] % 2 == 0])  # fmt: skip
    live.add_node(cells)
    joined = networkx.node_connected_component(live, cells) - {cells}
    chains = networkx.DiGraph(hops(world, cells).items())
    chains.add_node(cells)
    routed = networkx.ancestors(chains, cells)
    loops = rings_of(world, cells)
    off = {cell for cell in range(cells) if world.alive[cell] == DEAD}
    return {
        "joined": joined,
        "routed": routed,
        "in loops": set().union(*loops),
        "apart": set(range(cells)) - joined - off,
        "loops_open": len(loops),
        "unrouted": len(joined - routed),
    }


def rings_of(world, cells):
    """The loops that stand, by their cells."""
    return set(map(frozenset, networkx.simple_cycles(networkx.DiGraph(hops(world, cells).items()))))


def kept(world, cells):
    """The same, as the observer has it."""
    watch, run = world.watch, world.run[0]
    return {
        "joined": {cell for cell in range(cells) if watch.joined[cell]},
        "routed": {cell for cell in range(cells) if watch.routed[cell]},
        "in loops": {cell for cell in range(cells) if watch.ring[cell] != NONE},
        "apart": {cell for cell in range(cells) if watch.apart[cell] != NONE},
        "loops_open": run.loops_open,
        "unrouted": run.unrouted,
    }


@pytest.mark.parametrize("seed", range(2))
def test_it_knows_at_any_time_who_has_a_way_and_who_could_have_one(seed):
    keys = faulty(seed, EVENTS, (4, 4, ((0, 1), (3, 2))), count=40, gap_s=0.01, rule="paper")
    running = simulate.simulation(plan_of(keys), plain=True)
    world, cells = running.world, running.plan.graph.cells
    seen, had, loops, rings = set(), set(), 0, set()
    for until in range(280_000, running.plan.duration_us, STEP_US):
        while running.advance(until, 1 << 30) != DONE:
            pass
        now = kept(world, cells)
        assert now == expected(world, cells), until
        had |= now["routed"]
        seen |= {name for name, value in now.items() if value}
        rows = running.take()["rows"]
        loops += int((rows["code"] == observer.LOOP_OPEN).sum())
        assert world.run[0].loops == loops
        before, rings = rings, rings_of(world, cells)
        turned = set(rows["node"][np.isin(rows["code"], CHANGES)].tolist())
        told = set(rows["node"][np.isin(rows["code"], LOOPS)].tolist())
        assert not any(ring & told for ring in before & rings if not ring & turned)
    assert seen == now.keys(), "nothing of that was there to be looked at"
    assert {cell for cell in range(cells) if world.watch.had[cell]} >= had


def test_a_port_without_a_cable_is_not_found_broken():
    run = SimpleNamespace(observe=1, rows=0, row_limit=1)
    world = SimpleNamespace(run=[run], rows=[SimpleNamespace()], ends=[
        SimpleNamespace(peer=peer) for peer in (-1, 5)])  # fmt: skip
    observer.on_report(world, 9, 0, REPORT_BROKEN, 0, 1)
    assert run.rows == 0
    observer.on_report(world, 9, 0, REPORT_BROKEN, 1, 1)
    assert (run.rows, vars(world.rows[0])) == (
        1, {"time": 9, "node": 0, "code": REPORT_BROKEN, "a": 1, "b": 1})  # fmt: skip


def test_the_first_loop_is_the_one_that_is_told():
    keys = faulty(0, EVENTS, (2, 1, ((0, 0),)), count=1)
    world = simulate.simulation(plan_of(keys), plain=True).world
    world.params[0].rule, world.run[0].broken, world.run[0].broken_node = RULE_FEASIBLE, 2, 7
    world.watch.port[0], world.watch.port[1] = (
        next(p for p in range(PORTS) if world.ends[PORTS * cell + p].peer // PORTS == 1 - cell)
        for cell in range(2)
    )
    observer.open_loop(world, 5, 0)
    assert (world.run[0].broken, world.run[0].broken_node, world.run[0].loops) == (2, 7, 1)
