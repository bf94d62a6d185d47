"""The loop of a field by hand: what a command does to a node in each state, timers, what is due."""

from types import SimpleNamespace as Of

import pytest

from innervate.scenario.actions.field import CUT, JAM, KILL, QUIET, RESTART, RESTORE, REVIVE
from innervate.sim.channel.world import Heap
from innervate.sim.field import calls, loop, medium, powers, queue
from innervate.sim.field.loop import COLD, MEMORY_LOST, NEVER
from innervate.sim.field.states import ALIVE, DEAD, OFF
from innervate.sim.status import BUDGET, DONE, ON_START, ON_TIMER, ROWS_FULL

TIMERS = 3  # of a node; the last is below the router
NODES = 2


class Do:
    """Functions of a network that note how they are called."""

    def __init__(self):
        self.said, self.soon, self.full = [], queue.LAST, DONE

    def __getattr__(self, name):
        return lambda _world, *what: self.said.append((name, *what_of(what)))

    def pressing(self, _world):
        return self.full

    def short(self, _world):
        return DONE

    def due(self, _world):
        return self.soon


def what_of(what):
    return [one for one in what if not isinstance(one, Do)]


@pytest.fixture
def do(monkeypatch):
    made = Do()
    for room, names in ((calls, ["finish"]), (medium, ["die", "set_cut", "set_noise"])):
        for name in names:
            monkeypatch.setattr(room, name, getattr(made, name))
    monkeypatch.setattr(powers, "strength", lambda _table, value: 1000 + value)
    return made


def world_of(state=ALIVE):
    return Of(
        run=[Of(timers=TIMERS, own_timers=TIMERS - 1, next_command=0, commands=2, next_offer=0,
                offers=2, now=0, status=DONE)],
        radios=[Of(state=state, offset=500, boots=1) for _ in range(NODES)],
        due=[40, 50, 60, 70, 80, 90], strengths=None, heap=Heap([0] * 16, [0]),
        commands=[Of(action=KILL, node=1, other=0, value=0, time=30),
                  Of(action=QUIET, node=0, other=0, value=0, time=35)],
        offers=[Of(time=30), Of(time=36)],
    )  # fmt: skip


BEGINS = [("power_on", 1, 9), ("on_start", 1, 509), ("finish", 1, 9, ON_START)]


def begins(cause):
    first = [("wipe", 1)] if cause == MEMORY_LOST else []
    return [*first, *((*what, cause) for what in BEGINS)]


ENDS = [("power_off", 1, 9), ("die", 1)]
OBEYED = {
    (loop.BOOT, OFF): begins(COLD), (loop.BOOT, ALIVE): [], (loop.BOOT, DEAD): [],
    (KILL, OFF): [], (KILL, ALIVE): ENDS, (KILL, DEAD): [],
    (REVIVE, OFF): begins(MEMORY_LOST), (REVIVE, ALIVE): [], (REVIVE, DEAD): begins(MEMORY_LOST),
    (RESTART, OFF): begins(MEMORY_LOST), (RESTART, ALIVE): ENDS + begins(MEMORY_LOST),
    (RESTART, DEAD): begins(MEMORY_LOST),
    (CUT, ALIVE): [("set_cut", 1, 0, True)], (RESTORE, DEAD): [("set_cut", 1, 0, False)],
    (JAM, ALIVE): [("set_noise", 1, 1000 - 40)], (QUIET, ALIVE): [("set_noise", 1, 0)],
}  # fmt: skip


@pytest.mark.parametrize(("action", "state"), OBEYED)
def test_what_is_done_to_a_node_depends_on_whether_it_is_on(do, action, state):
    world = world_of(state)
    world.commands[0] = Of(action=action, node=1, other=0, value=-40)
    loop.obey(world, do, 0, 9)
    assert do.said == OBEYED[action, state]
    has_begun = any(what[0] == "on_start" for what in do.said)
    assert [radio.boots for radio in world.radios] == [1, 1 + has_begun]
    assert world.due == [40, 50, 60, *([NEVER] * 3 if has_begun else [70, 80, 90])]
    if has_begun:
        assert world.radios[1].state == ALIVE
    elif (action, state) == (KILL, OFF):
        assert world.radios[1].state == DEAD  # it is not switched on when its time comes


@pytest.mark.parametrize(
    ("timer", "time", "state", "said"),
    [
        (1, 80, ALIVE, [("on_timer", 1, 580, 1), ("finish", 1, 80, ON_TIMER, 1)]),
        (2, 90, ALIVE, [("expire_below", 1, 2, 90)]),
        (1, 79, ALIVE, []),
        (1, 80, DEAD, []),
        (1, 80, OFF, []),
    ],
)
def test_a_timer_goes_off_once_at_the_time_it_was_set_to_last(do, timer, time, state, said):
    world = world_of(state)
    loop.expire(world, do, 1, timer, time)
    assert do.said == said
    loop.expire(world, do, 1, timer, time)
    assert do.said == said
    place = TIMERS + timer
    assert world.due[place] == (NEVER if said else [40, 50, 60, 70, 80, 90][place])


def dispatched(world, do, rank, node=1, what=2, time=80):
    """What one event of the queue does, and what is in the queue then: (time, rank)."""
    queue.push(world.heap, queue.key_of(time, rank, node, what))
    loop.dispatch(world, do, world.heap.keys[0], time)
    keys = sorted(world.heap.keys[: world.heap.size[0]])
    return [(key >> queue.TIME_SHIFT, key >> queue.RANK_SHIFT & 7) for key in keys]


def test_every_event_goes_where_it_belongs(do):
    assert dispatched(world_of(), do, queue.ENDS) == []
    assert dispatched(world_of(), do, queue.SAMPLE) == []
    assert do.said == [("dispatch_below", queue.ENDS, 1, 2, 80), ("sample", 2, 80)]
    do.said.clear()
    world = world_of()
    dispatched(world, do, queue.TIMER, what=1)
    assert do.said[0] == ("on_timer", 1, 580, 1)


def test_offers_and_commands_come_one_after_the_other(do):
    world = world_of()
    assert dispatched(world, do, queue.OFFER, 0, 0, 30) == [(36, queue.OFFER)]
    queue.pop(world.heap)
    assert dispatched(world, do, queue.OFFER, 0, 0, 36) == []
    assert do.said == [("offer", 0, 30), ("offer", 1, 36)]
    do.said.clear()
    assert dispatched(world, do, queue.COMMAND, 0, 0, 30) == [(35, queue.COMMAND)]
    queue.pop(world.heap)
    assert dispatched(world, do, queue.COMMAND, 0, 0, 35) == []
    assert do.said == [("power_off", 1, 30), ("die", 1), ("note_carriers", 30),
                       ("set_noise", 0, 0), ("note_carriers", 35)]  # fmt: skip


def ran(do, until, budget=9, soon=queue.LAST, at=(20, 30)):
    """Times of the samples that were taken, and of the steps between; how it ended, and when."""
    world = world_of()
    for time in at:
        queue.push(world.heap, queue.key_of(time, queue.SAMPLE, 0, 0))
    do.soon = soon
    loop.bind(do)(world, until, budget)
    return [what[-1] for what in do.said], world.run[0].status, world.run[0].now


def test_it_goes_up_to_a_time_and_not_to_it(do):
    assert ran(do, 30) == ([20], DONE, 20)
    do.said.clear()
    assert ran(do, 31) == ([20, 30], DONE, 30)


def test_what_is_due_between_events_comes_before_them_and_after_those_of_its_moment(do):
    dues = iter([20, queue.LAST])

    def step(_world, _do, time):
        do.said.append(("step", -time))
        do.soon = next(dues)

    do.step = step
    assert ran(do, 21, soon=15) == ([-15, 20, -20], DONE, 20)
    do.said.clear()
    assert ran(do, 15, soon=15) == ([], DONE, 0)


def test_it_stops_when_the_budget_is_spent_or_something_presses(do):
    assert ran(do, 99, budget=1) == ([20], BUDGET, 20)
    do.said.clear()
    do.full = ROWS_FULL
    assert ran(do, 99) == ([], ROWS_FULL, 0)
    do.full, do.short = DONE, lambda _world: ROWS_FULL
    assert ran(do, 99) == ([], ROWS_FULL, 0)
