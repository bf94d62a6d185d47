"""What is done to a network over cables from outside: every command by hand, on every state."""

from types import SimpleNamespace as Of

import pytest

from innervate.dialect.arith import MASK30
from innervate.scenario.actions.cables import CUT, KILL, LOOSE, LOSE, RESTART, RESTORE, REVIVE
from innervate.sim import clocks, wheel
from innervate.sim.cables import commands
from innervate.sim.cables.wires import LOSSY
from innervate.sim.cables.world import ALIVE, DEAD, OFF, TIMER_SLOTS
from innervate.sim.status import MEMORY_LOST, ON_INPUT
from tests.networks.skin.runs import free
from tests.sim.cables.small import END, PEER, SINK, Do, small_world, timers

NOW = 5_000


@pytest.fixture
def do():
    return Do(small_world(trail=True))


def obey(do, action, *, end=-1, node=-1, value=0, index=6):
    command = Of(action=action, at=NOW, end=end, node=node, value=value, index=index)
    commands.obey(do.world, do, command)
    return [what for what in do.said if what[0] not in ("check", "before_change", "on_change")]


def begins(node):
    return ("on_start", node, NOW + 100 * (node + 1), MEMORY_LOST)


def test_a_cell_has_four_ends_and_the_pc_those_behind_all_cells(do):
    found = [commands.ends_of(do.world, node) for node in (0, 1, SINK)]
    assert found == [(0, 4), (4, 8), (8, len(do.world.ends))]


STOPS = ("on_stop", NOW, 1)
ON_OR_OFF = {
    (KILL, ALIVE): ([STOPS], DEAD), (KILL, DEAD): ([], DEAD), (KILL, OFF): ([STOPS], DEAD),
    (REVIVE, ALIVE): ([], ALIVE), (REVIVE, DEAD): ([begins(1)], ALIVE), (REVIVE, OFF): ([], OFF),
    (RESTART, ALIVE): ([STOPS, begins(1)], ALIVE), (RESTART, DEAD): ([], DEAD),
    (RESTART, OFF): ([], OFF),
}  # fmt: skip


@pytest.mark.parametrize(("action", "state"), ON_OR_OFF)
def test_what_is_done_to_a_node_depends_on_whether_it_is_on(do, action, state):
    do.world.alive[1] = state
    said, after = ON_OR_OFF[action, state]
    assert obey(do, action, node=1) == said
    assert do.world.alive == [ALIVE, after, ALIVE]


@pytest.mark.parametrize(("action", "where", "node"), [
    (CUT, {"end": END}, 0), (CUT, {"end": PEER}, 1), (RESTORE, {"end": END}, 0),
    (LOOSE, {"end": END}, 0), (LOSE, {"end": PEER}, 1), (CUT, {"end": 9}, SINK),
    (KILL, {"node": 1}, 1), (KILL, {"node": SINK}, SINK), (RESTART, {"node": 0}, 0),
])  # fmt: skip
def test_who_watches_is_told_before_and_after_and_where(do, action, where, node):
    obey(do, action, **where)
    around = [what for what in do.said if what[0] in ("before_change", "on_change")]
    assert around == [("before_change",), ("on_change", NOW, node, 6)]
    assert do.said[0] == around[0]
    assert do.said[-1] == around[1]


def test_a_cable_of_the_last_of_many_interfaces_is_the_sinks():
    do = Do(small_world(free([("pc", f"n{i}") for i in range(7)])))
    obey(do, CUT, end=len(do.world.ends) - 1)
    assert do.said[-1] == ("on_change", NOW, 7, 6)
    assert do.world.epoch[4 * 6] == 1


def test_who_does_not_watch_is_told_nothing(do):
    do.world.run[0].observe = 0
    obey(do, CUT, end=END)
    assert do.said == []
    assert do.world.epoch[END] == 1


def test_at_the_beginning_every_node_is_due_at_its_moment(do):
    for node in range(3):
        do.world.starts[node].phase = 70 + node
    assert obey(do, commands.BEGIN) == []
    assert timers(do.world) == {(node, 0): 70 + node for node in range(3)}


@pytest.mark.parametrize("node", [0, SINK])
def test_who_dies_takes_its_timers_along_and_all_its_cables(do, node):
    world = do.world
    for other in range(3):
        for timer in range(TIMER_SLOTS):
            wheel.insert(world.wheel, clocks.timer_slot(world, other, timer), 90)
    obey(do, KILL, node=node)
    assert set(timers(world)) == {(o, t) for o in range(3) if o != node for t in range(4)}
    ends = world.ends
    mine = range(4) if node == 0 else range(8, len(ends))
    down = {e for e in mine if ends[e].peer >= 0} | {ends[e].peer for e in mine} - {-1}
    assert {e for e in range(len(ends)) if world.epoch[e] & 1} == down
    assert len(down) == 4
    obey(do, REVIVE, node=node)
    assert {world.epoch[e] for e in down} == {2}  # what was under way does not come any more


def test_a_cable_that_is_down_stays_lossy(do):
    obey(do, LOSE, end=END, value=3)
    obey(do, CUT, end=END)
    obey(do, RESTORE, end=END)
    assert [do.world.ends[end].impaired for end in (END, PEER)] == [LOSSY, LOSSY]
    obey(do, LOSE, end=END, value=0)
    assert [do.world.ends[end].impaired for end in (END, PEER)] == [0, 0]


def test_an_end_never_counts_fewer_reasons_than_none(do):
    commands.shift_end(do.world, END, -1)
    commands.shift_end(do.world, END, 1)
    assert (do.world.ends[END].impaired, do.world.epoch[END]) == (5, 1)


@pytest.mark.parametrize("kind", [0, 5])
def test_what_a_user_gives_is_handed_in_if_the_network_has_it(do, kind):
    command = Of(action=0, at=NOW, end=-1, node=1, value=0, index=3)
    do.take_input = lambda _world, given: kind if given is command else None
    do.world.clocks[1].offset = MASK30
    do.world.run[0].trail = 0
    commands.hand_in(do.world, do, command)
    called = [what for what in do.said if what[0] == "on_input"]
    assert called == ([("on_input", 1, NOW - 1, 5)] if kind else [])
    steps = [(row.time, row.node, row.handler) for row in do.world.trail[: do.world.run[0].trail]]
    assert steps == ([(NOW, 1, ON_INPUT)] if kind else [])
