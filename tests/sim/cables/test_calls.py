"""Calls of nodes over cables, by hand: when one is due, and what becomes of all it asks for."""

import pytest

from innervate.dialect.access import SAMPLE
from innervate.dialect.arith import MASK30
from innervate.dialect.outbox import DELIVER, FLUSH, REPORT, SEND, SET_TIMER, URGENT
from innervate.sim import clocks, wheel
from innervate.sim.cables import calls
from innervate.sim.cables.wires import ARRIVED, DELAYED, OFFERED, URGENT_BLOCK
from innervate.sim.cables.world import ALIVE, BROKEN_OUTBOX, DEAD, OFF, SOURCE
from innervate.sim.status import COLD, MEMORY_LOST, ON_FRAME, ON_INPUT, ON_START, ON_TIMER
from tests.sim.cables.small import END, PEER, SINK, Do, small_world, timers

NOW = 5_000


@pytest.fixture
def do():
    world = small_world(trail=True)
    world.run[0].watchful = 0
    return Do(world)


def put(world, *actions):
    """What a handler has put into the outbox, each with a frame of its own."""
    world.out.count[0] = len(actions)
    for i, action in enumerate(actions):
        act = world.out.action[i]
        act.kind, act.a, act.b, act.c = action
        world.out.frame[i].seq = 50 + i


def flights(world):
    events, first = world.wheel.events, world.run[0].pool_slots
    return [(events[slot].time, events[slot].kind, events[slot].target, events[slot].epoch,
             world.frames[slot - first].seq)
            for slot in range(first, world.wheel.pool[wheel.FRESH])]  # fmt: skip


def drained(do, *actions, node=0):
    put(do.world, *actions)
    calls.drain(do.world, do, node, NOW, NOW + do.world.clocks[node].offset, 3)
    assert do.world.out.count[0] == 0
    return do.world


def test_frames_go_out_at_once_or_later_with_their_flags(do):
    do.world.ends[END].latency = 75
    world = drained(do, (SEND, 1, 0, URGENT), (SEND, 1, 40, URGENT | FLUSH))
    assert flights(world) == [
        (NOW + 75, URGENT_BLOCK, PEER, 0, 50), (NOW + 40, DELAYED, END, URGENT | FLUSH, 51),
    ]  # fmt: skip


def test_a_timer_fires_by_its_nodes_clock_and_is_set_once(do):
    at = NOW + 300 + 25  # by the sink's clock, 300 us ahead
    world = drained(do, (SET_TIMER, 1, at, 0), node=SINK)
    assert timers(world) == {(SINK, 1): NOW + 25}
    drained(do, (SET_TIMER, 1, at + 10, 0), (SET_TIMER, 2, at - 60, 0), node=SINK)
    assert timers(world) == {(SINK, 1): NOW + 35, (SINK, 2): NOW}  # one that is overdue fires now
    assert wheel.pop(world.wheel, 1 << 30) == clocks.timer_slot(world, SINK, 2)
    assert wheel.pop(world.wheel, 1 << 30) == clocks.timer_slot(world, SINK, 1)
    assert wheel.pop(world.wheel, 1 << 30) == wheel.NIL


def test_reports_and_deliveries_are_handed_on(do):
    world = drained(do, (REPORT, 7, 8, 9), (DELIVER, 4, 0, 0), node=1)
    assert do.said == [
        ("on_report", NOW, 1, 7, 8, 9),
        ("on_deliver", NOW, 1, 3, world.out.frame[1]),
    ]


MARKED = [
    (SEND, 1, 0, 0), (SEND, 1, 9, 0), (SEND, 2, 9, 0), (SEND, 1, 9, 1), (SET_TIMER, 1, NOW, 0),
    (SET_TIMER, 2, NOW, 0), (REPORT, 1, 2, 3), (REPORT, 2, 1, 3), (REPORT, 1, 2, 4),
    (DELIVER, 1, 0, 0), (DELIVER, 2, 0, 0),
]  # fmt: skip


def test_whatever_was_asked_for_marks_the_run(do):
    marks = set()
    for action in MARKED:
        for seq in (50, 51):
            do.world.run[0].fingerprint = 0
            put(do.world, action)
            do.world.out.frame[0].seq = seq
            calls.drain(do.world, do, 0, NOW, NOW, 3)
            marks.add(do.world.run[0].fingerprint)
    assert len(marks) == len(MARKED) + 6  # of two frames each: four that are sent, two delivered


@pytest.mark.parametrize(("broken", "found"), [(0, (BROKEN_OUTBOX, 1)), (9, (9, -1))])
def test_an_outbox_that_was_too_small_breaks_the_run_unless_it_is_broken(do, broken, found):
    run = do.world.run[0]
    run.broken, run.broken_node, do.world.out.overflow[0] = broken, -1, 1
    drained(do, node=1)
    assert (run.broken, run.broken_node) == found


@pytest.mark.parametrize("checks", [0, 1])
def test_after_a_call_it_is_counted_checked_and_kept(do, checks):
    run = do.world.run[0]
    run.watchful, run.checks = 1, checks
    for k, (time, broken) in enumerate([(70, 0), (80, 3), (90, 3)]):
        do.check = lambda _world, node, broken=broken: setattr(run, "broken", broken)
        calls.finish(do.world, do, 1, time, ON_TIMER, 2)
        assert (run.handled, run.trail) == (k + 1, k + 1)
    assert run.broken_at == (80 if checks else -1)  # when it broke, whatever came then
    steps = [(row.time, row.node, row.handler, row.port) for row in do.world.trail[:3]]
    assert steps == [(time, 1, ON_TIMER, 2) for time in (70, 80, 90)]


def test_each_call_marks_the_run_by_who_when_and_what(do):
    marks = set()
    for call in ((1, 70, 1, 2), (0, 70, 1, 2), (1, 71, 1, 2), (1, 70, 2, 2), (1, 70, 1, 3)):
        do.world.run[0].fingerprint = 0
        calls.finish(do.world, do, *call)
        marks.add(do.world.run[0].fingerprint)
    assert len(marks) == 5


@pytest.mark.parametrize(("node", "source_us", "queued"), [
    (0, 10_000, {(0, SOURCE): NOW + 40}), (1, 10_000, {(1, SOURCE): NOW + 41}), (0, 0, {}),
    (SINK, 10_000, {}),
])  # fmt: skip
def test_who_is_switched_on_starts_and_a_cell_feels_from_then_on(do, node, source_us, queued):
    do.world.run[0].source_us = source_us
    for k in range(3):
        do.world.starts[k].source = 40 + k
    do.world.alive[node] = OFF
    calls.switch_on(do.world, do, node, NOW, MEMORY_LOST)
    assert do.world.alive[node] == ALIVE
    assert do.said == [("on_start", node, NOW + 100 * (node + 1), MEMORY_LOST)]
    assert timers(do.world) == queued


def due(do, node, timer, state):
    do.world.alive[node] = state
    calls.on_event(do.world, do, clocks.timer_slot(do.world, node, timer), NOW)
    return do.said


def test_the_first_that_is_due_switches_a_node_on(do):
    assert due(do, 1, 0, OFF) == [("on_start", 1, NOW + 200, COLD)]
    assert (do.world.alive[1], do.world.run[0].handled) == (ALIVE, 1)


@pytest.mark.parametrize("timer", range(4))
def test_nothing_is_due_at_a_dead_node(do, timer):
    assert due(do, 1, timer, DEAD) == []
    assert (do.world.run[0].handled, do.world.counters[OFFERED]) == (0, 0)


@pytest.mark.parametrize("timer", range(3))
def test_a_timer_is_told_which_it_is(do, timer):
    do.world.clocks[1].offset = MASK30
    assert due(do, 1, timer, ALIVE) == [("on_timer", 1, NOW - 1, timer)]
    assert do.world.run[0].handled == 1


def test_a_sample_is_offered_again_and_again(do):
    do.world.run[0].source_us = 900
    said = due(do, 1, SOURCE, ALIVE)
    assert said == [("sense", 1, NOW), ("on_input", 1, NOW + 200, SAMPLE)]
    assert (timers(do.world), do.world.counters[OFFERED]) == ({(1, SOURCE): NOW + 900}, 1)


@pytest.fixture
def accounted(monkeypatch):
    """What is said of each call when it is accounted for: node, time, handler, port."""
    told = []
    monkeypatch.setattr(calls, "finish", lambda _world, _do, *what: told.append(what))
    return told


@pytest.mark.parametrize(("timer", "handler", "port"), [(1, ON_TIMER, 1), (SOURCE, ON_INPUT, 0)])
def test_what_is_due_is_accounted_for_as_what_it_was(do, accounted, timer, handler, port):
    due(do, 1, timer, ALIVE)
    assert accounted == [(1, NOW, handler, port)]


def test_a_frame_is_accounted_for_at_its_port(do, accounted):
    slot = wheel.take(do.world.wheel)
    event = do.world.wheel.events[slot]
    event.kind, event.target, event.epoch = URGENT_BLOCK, 3, 0
    calls.on_event(do.world, do, slot, NOW)
    assert accounted == [(0, NOW, ON_FRAME, 3)]


@pytest.mark.parametrize(("end", "node", "port"), [(PEER, 1, 0), (3, 0, 3), (8, SINK, 0),
                                                   (9, SINK, 1)])  # fmt: skip
@pytest.mark.parametrize(("alive", "arrives"), [(ALIVE, 1), (DEAD, 0)])
def test_a_frame_comes_to_the_port_at_its_cables_end(do, end, node, port, alive, arrives):
    world = do.world
    world.alive[node] = alive
    slot = wheel.take(world.wheel)
    event, frame = world.wheel.events[slot], world.frames[slot - world.run[0].pool_slots]
    event.kind, event.target, event.epoch = URGENT_BLOCK, end, 0
    calls.on_event(world, do, slot, NOW)
    assert do.said == [("on_frame", node, NOW, port, frame)] * arrives
    assert (world.counters[ARRIVED + URGENT_BLOCK], world.counters[ARRIVED]) == (arrives, 0)
    assert world.wheel.pool[wheel.FREE] == slot  # for another frame


def test_what_a_call_asked_for_is_carried_out_by_its_clock_then(do):
    put(do.world, (SET_TIMER, 0, NOW + 200 + 5, 0))
    calls.finish(do.world, do, 1, NOW, ON_INPUT, 0)
    calls.finish(do.world, do, 1, NOW, ON_FRAME, 0)
    calls.finish(do.world, do, 1, NOW, ON_START, 0)
    assert timers(do.world) == {(1, 0): NOW + 5}
