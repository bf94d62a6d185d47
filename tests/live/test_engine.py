"""What an engine does with what a protocol puts out: timers at their times, each action once."""

import asyncio
import time
from types import SimpleNamespace

import pytest

from innervate.dialect.arith import HALF30, MASK30
from innervate.dialect.outbox import DELIVER, REPORT, SEND, SET_TIMER
from innervate.live.engine import Engine, clock_us
from innervate.live.machine import machine
from tests.live import time_by_hand


class Box:
    """An outbox as protocols fill it."""

    def __init__(self):
        self.count, self.overflow = [0], [0]
        self.action, self.frame = [], []

    def put(self, kind, a=0, b=0, c=0, frame=None):
        del self.action[self.count[0] :], self.frame[self.count[0] :]
        self.action.append(type("Action", (), {"kind": kind, "a": a, "b": b, "c": c}))
        self.frame.append(frame)
        self.count[0] += 1


class Stack:
    """A protocol of a few timers that does as it is told; `fired` is what fired, us since began."""

    timers, reasons = 3, ("read", "too short")

    def __init__(self):
        self.out, self.fired, self.heard, self.began = Box(), [], [], clock_us()
        self.then, self.why, self.last = (lambda timer: None), "", ()

    def arm(self, timer, wait_us):
        self.out.put(SET_TIMER, timer, (clock_us() + wait_us) & MASK30)

    def on_start(self, now, cause):
        self.heard.append(("start", now, cause))

    def on_timer(self, now, timer):
        assert now == clock_us() & MASK30
        self.fired.append((clock_us() - self.began, timer))
        self.then(timer)

    def on_frame(self, now, port):
        self.heard.append((now, port))

    def on_input(self, now, kind, item):
        self.heard.append((now, kind, item))

    def decode(self, data):
        return int(not data)

    def objection(self, sender):
        return self.why

    def behind(self, count):
        return self.last


def run(what, on=lambda *_: None):
    """Have a stack put out what `what(stack, engine)` says, then give it ten minutes."""

    async def main():
        stack = Stack()
        engine = Engine(stack, lambda *one: on("send", *one), lambda *one: on("deliver", *one),
                        lambda *one: on("report", *one), lambda: on("settled"))  # fmt: skip
        done = what(stack, engine)
        if done is not None:
            await done
        await asyncio.sleep(600.0)
        return stack, engine

    return time_by_hand.run(main())


@pytest.mark.parametrize(
    ("wait_us", "fires_us"),
    [(5_000, 5_000), (0, 0), (-1, 0), (-400_000_000, 0), (HALF30 - 1, HALF30 - 1), (HALF30, 0)],
)
def test_a_timer_fires_at_its_time_and_one_that_is_late_at_once(wait_us, fires_us):
    """Within the clock's 30 bits the nearer half lies ahead."""

    async def all_of_it(stack, engine):
        stack.arm(1, wait_us)
        engine.call(lambda _: None, clock_us())
        await asyncio.sleep(HALF30 / 1e6)

    stack, engine = run(all_of_it)
    assert [(pytest.approx(fires_us, abs=2), 1)] == stack.fired
    assert engine.counters["timers"] == 1


def test_a_timer_that_is_set_anew_fires_once_at_its_new_time_sooner_or_later():
    async def twice(stack, engine):
        for timer, first_us, second_us in ((0, 9_000, 4_000), (1, 3_000, 8_000)):
            for wait_us in (first_us, second_us):
                stack.arm(timer, wait_us)
                engine.call(lambda _: None, clock_us())

    stack, engine = run(twice)
    assert stack.fired == [(pytest.approx(4_000, abs=2), 0), (pytest.approx(8_000, abs=2), 1)]
    assert engine.counters["timers"] == 2


def test_a_timer_may_set_itself_and_others_while_it_fires():
    def again(stack, engine):
        def then(timer):
            if len(stack.fired) < 4:
                stack.arm(timer, 1_000)
            elif timer == 0:
                stack.arm(2, 0)

        stack.then = then
        stack.arm(0, 1_000)
        engine.call(lambda _: None, clock_us())

    stack, _ = run(again)
    assert stack.fired == [
        *((pytest.approx(k * 1_000, abs=4), 0) for k in (1, 2, 3, 4)),
        (pytest.approx(4_000, abs=8), 2),
    ]


def test_what_is_due_at_once_when_an_engine_stops_never_fires():
    async def stopped(stack, engine):
        stack.arm(0, 0)
        stack.out.put(SET_TIMER, 1, (clock_us() + 50) & MASK30)
        engine.call(lambda _: None, clock_us())
        engine.stop()

    stack, _ = run(stopped)
    assert stack.fired == []


def test_what_was_armed_before_something_sooner_does_not_fire_in_an_engine_that_stopped():
    async def stopped(stack, engine):
        for timer, wait_us in ((0, 9_000), (1, 4_000)):
            stack.arm(timer, wait_us)
            engine.call(lambda _: None, clock_us())
        engine.stop()

    stack, _ = run(stopped)
    assert stack.fired == []


def test_what_is_due_at_once_fires_each_time():
    def again(stack, engine):
        stack.then = lambda timer: stack.arm(1 - timer, 0) if len(stack.fired) < 4 else None
        stack.arm(0, 0)
        engine.call(lambda _: None, clock_us())

    stack, _ = run(again)
    assert [timer for _, timer in stack.fired] == [0, 1, 0, 1]


def test_what_stops_an_engine_while_it_fires_leaves_nothing_armed():
    def stopping(stack, engine):
        def then(timer):
            stack.arm(timer, 1_000)
            engine.stop()

        stack.then = then
        stack.arm(0, 1_000)
        engine.call(lambda _: None, clock_us())

    stack, _ = run(stopping)
    assert [timer for _, timer in stack.fired] == [0]


def test_every_action_goes_where_it_belongs_in_order_and_once():
    seen = []

    def some(stack, engine):
        stack.out.put(SEND, 2, 7, 8, "sent")
        stack.out.put(REPORT, 3, 4, 5)
        stack.out.put(DELIVER, 6, frame="for its user")
        engine.call(lambda _: None, clock_us())
        engine.call(lambda _: None, clock_us())

    run(some, lambda *one: seen.append(one))
    assert seen == [
        ("send", 2, "sent", 7, 8), ("report", 3, 4, 5), ("deliver", 6, "for its user"),
        ("settled",), ("settled",),
    ]  # fmt: skip


def test_what_comes_is_told_with_when_it_came_and_what_is_not_taken_is_counted_by_reason():
    def came(stack, engine):
        engine.start()
        engine.start(1)
        assert engine.read(b"x") == ""
        engine.receive(4)
        engine.receive(5, (1 << 30) + 77)
        assert engine.now == (1 << 30) + 77
        engine.input(3, "item")
        assert engine.read(b"") == "too short"
        stack.why = "for another"
        assert engine.read(b"x", 9) == "for another"

    stack, engine = run(came)
    now = stack.began & MASK30
    began = [("start", now, cause) for cause in (0, 1)]
    assert stack.heard == [*began, (now, 4), (77, 5), (now, 3, "item")]
    assert engine.counters == {"frames": 2, "dropped: too short": 1, "dropped: for another": 1}


@pytest.mark.skipif(not hasattr(time, "CLOCK_BOOTTIME"), reason="this system has no such clock")
def test_the_clock_goes_on_while_the_machine_is_suspended(monkeypatch):
    read = time.clock_gettime_ns
    slept = {time.CLOCK_BOOTTIME: 20_000_000_000}
    before_us = clock_us()
    monkeypatch.setattr(time, "clock_gettime_ns", lambda which: read(which) + slept.get(which, 0))
    assert 20_000_000 <= clock_us() - before_us < 21_000_000


def test_a_timer_that_is_set_after_a_suspension_is_not_late_by_one_that_was_set_before():
    """The loop's clock stands still meanwhile: what it waits for then comes as much later."""

    async def suspended(stack, engine):
        clock = machine()
        stack.arm(0, 20_000_000)
        engine.call(lambda _: None, clock_us())
        await asyncio.sleep(1.0)
        read = clock.monotonic_ns
        clock.monotonic_ns = lambda: read() + 3_600_000_000_000
        stack.began += 3_600_000_000
        stack.arm(1, 250_000)
        engine.call(lambda _: None, clock_us())

    stack, _ = run(suspended)
    assert stack.fired == [
        (pytest.approx(1_000_000, abs=5), 0),
        (pytest.approx(1_250_000, abs=5), 1),
    ]


def test_frames_that_may_wait_leave_behind_the_others_in_order():
    async def main():
        stack, left = Stack(), []
        engine = Engine(
            stack, lambda port, frame, b, c: left.append((port, frame.kind)), *[lambda *_: None] * 3
        )
        stack.last = [0, 3]
        for port, kind in enumerate([16, 8, 9, 16, 8]):
            stack.out.put(SEND, port, frame=SimpleNamespace(kind=kind))
        engine.input(1, None)
        return left

    assert asyncio.run(main()) == [(1, 8), (2, 9), (4, 8), (0, 16), (3, 16)]
