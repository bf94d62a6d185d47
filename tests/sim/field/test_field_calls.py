"""A node's calls in a field, by hand: what it asks for, what marks the run, when timers fire."""

from types import SimpleNamespace as Of

import pytest

from innervate.dialect.arith import MASK30
from innervate.dialect.outbox import DELIVER, REPORT, SEND, SET_TIMER
from innervate.sim.field import calls, queue
from innervate.sim.field.medium import BROKEN_OUTBOX, set_timer
from innervate.sim.status import ON_FRAME, ON_INPUT, ON_TIMER

NOW, OFFSET = 1_000, 500


class Do:
    def __init__(self):
        self.said, self.mark = [], 77

    def __getattr__(self, name):
        return lambda _world, *what: self.said.append((name, *(w for w in what if w is not self)))

    def hand_down(self, _world, _do, node, frame, act, time):
        self.said.append(("hand_down", node, frame, act.b, time))
        return self.mark

    def digest(self, _frame):
        return self.mark


@pytest.fixture
def do():
    return Do()


def world_of(*actions, **run):
    given = {"timers": 3, "fingerprint": 0, "handled": 0, "rows": 0, "row_limit": 9, "broken": 0,
             "broken_node": -1, "watchful": 0, "checks": 0, "trail": 0,
             "trail_limit": 0}  # fmt: skip
    acts = [Of(kind=kind, a=a, b=b, c=c) for kind, a, b, c in actions]
    return Of(
        run=[Of(**given | run)], radios=[Of(offset=OFFSET)] * 2, due=[-1] * 6,
        out=Of(count=[len(acts)], overflow=[0], action=acts, frame=[Of(kind=4)] * 4),
        heap=Of(keys=[0] * 9, size=[0]), rows=[Of(), Of()], trail=[Of(), Of()],
    )  # fmt: skip


@pytest.mark.parametrize(("at", "when"), [
    (NOW + OFFSET + 40, NOW + 40), (NOW + OFFSET, NOW), (NOW + OFFSET - 1, NOW),
    (NOW + OFFSET + 2**29 - 1, NOW + 2**29 - 1), (NOW + OFFSET + 2**29, NOW), (NOW, NOW),
])  # fmt: skip
def test_a_timer_fires_by_its_nodes_clock_and_never_before_now(at, when):
    world = world_of()
    for _ in range(2):
        set_timer(world, 1, 2, at & MASK30, NOW, NOW + OFFSET)
    assert world.due == [-1] * 5 + [when]
    assert (world.heap.keys[0], world.heap.size) == (queue.key_of(when, queue.TIMER, 1, 2), [1])
    set_timer(world, 1, 2, (at + 7) & MASK30, NOW, NOW + OFFSET)
    assert world.heap.size == [1 + (world.due[5] != when)]


def test_what_a_node_asks_for_is_carried_out_in_order(do):
    world = world_of((SEND, 0, 6, 0), (SET_TIMER, 1, NOW + OFFSET + 3, 0), (REPORT, 7, 8, 9),
                     (DELIVER, 4, 0, 0))  # fmt: skip
    calls.drain(world, do, 1, NOW)
    frame = world.out.frame[0]
    assert do.said == [("hand_down", 1, frame, 6, NOW), ("note_report", 1, NOW, 7),
                       ("record_delivered", 1, frame, NOW)]  # fmt: skip
    assert vars(world.rows[0]) == {"time": NOW, "node": 1, "code": 7, "a": 8, "b": 9}
    assert (world.due[4], world.out.count) == (NOW + 3, [0])


ACTIONS = [(SEND, 0, 6, 0), (SEND, 1, 6, 0), (SEND, 0, 7, 0), (SEND, 0, 6, 1), (DELIVER, 1, 0, 0),
           (DELIVER, 2, 0, 0), (REPORT, 1, 2, 3), (REPORT, 2, 1, 3),
           (SET_TIMER, 1, 9, 0)]  # fmt: skip


def test_whatever_was_asked_for_marks_the_run(do):
    marks = set()
    for action in ACTIONS:
        for do.mark in (77, 78):
            world = world_of(action)
            calls.drain(world, do, 0, NOW)
            marks.add(world.run[0].fingerprint)
    assert len(marks) == len(ACTIONS) + 6  # of two frames each: four that are sent, two delivered


def test_each_call_marks_the_run_by_who_when_and_what(do):
    marks = set()
    for call in ((1, 70, 1, 2), (0, 70, 1, 2), (1, 71, 1, 2), (1, 70, 2, 2), (1, 70, 1, 3)):
        world = world_of()
        calls.finish(world, do, *call)
        marks.add(world.run[0].fingerprint)
        assert world.run[0].handled == 1
    assert len(marks) == 5


@pytest.mark.parametrize(("overflow", "broken", "found"), [
    (0, 0, (0, -1)), (1, 0, (BROKEN_OUTBOX, 1)), (1, 9, (9, -1)),
])  # fmt: skip
def test_an_outbox_that_was_too_small_breaks_the_run(do, overflow, broken, found):
    world = world_of((REPORT, 1, 2, 3), broken=broken)
    world.out.overflow[0] = overflow
    calls.finish(world, do, 1, NOW, ON_TIMER, 0)
    assert (world.run[0].broken, world.run[0].broken_node) == found


@pytest.mark.parametrize(("watchful", "checks", "checked", "kept"), [
    (1, 1, 1, 1), (1, 0, 0, 1), (0, 1, 0, 0),
])  # fmt: skip
def test_after_a_call_it_is_checked_and_kept_if_anybody_looks(do, watchful, checks, checked, kept):
    world = world_of(watchful=watchful, checks=checks, trail_limit=9)
    calls.finish(world, do, 1, NOW, ON_TIMER, 2)
    assert do.said == [("check", 1, NOW)] * checked
    assert world.run[0].trail == kept
    if kept:
        assert (world.trail[0].handler, world.trail[0].port, world.trail[0].node) == (
            ON_TIMER,
            2,
            1,
        )


@pytest.mark.parametrize("time", [NOW, MASK30 - OFFSET + 1])
def test_a_node_is_told_the_time_of_its_clock(do, time):
    world, frame = world_of(watchful=1, trail_limit=9), Of(kind=4)
    calls.give(world, do, 1, time, 6)
    calls.take(world, do, 1, frame, time)
    now = (time + OFFSET) & MASK30
    assert do.said == [("on_input", 1, now, 6), ("on_frame", 1, now, frame)]
    assert [(row.handler, row.port) for row in world.trail] == [(ON_INPUT, 6), (ON_FRAME, 4)]
