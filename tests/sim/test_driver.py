"""The driver of loops by hand: slices, rows moved out, taps, how a run ends, what stops it."""

import signal
from typing import ClassVar, NamedTuple

import pytest

from innervate.kernel import compilation
from innervate.sim import driver
from innervate.sim.counts import Counts
from innervate.sim.driver import InvariantBroken, Simulation
from innervate.sim.status import BROKEN, BUDGET, DONE, POOL_FULL
from innervate.sim.tables import TAP, Tables, get, put

RUN = ("status", "checks", "broken", "broken_node", "fingerprint", "rows", "taps", "now", "next")
TIMES = (5, 10, 20, 30, 40, 50, 60)
DURATION = 100


class World(NamedTuple):
    run: object
    rows: object
    taps: object
    tapped: object


class Plan(NamedTuple):
    duration_us: int = DURATION


class Small(Simulation):
    """A row and a tapped frame at each of seven moments, two of them a slice."""

    tables: ClassVar = {"rows": ("time", "node")}
    slice_events = 2
    complete = False
    between = None

    def __init__(self, plain, name=""):
        tables = Tables(plain)
        run = tables.records(RUN, 1, wide=RUN)
        rows, taps = tables.records(("time", "node"), 4), tables.records(TAP, len(TIMES))
        put(run, 0, checks=1)
        world = World(run, rows, taps, tables.records(("seq",), len(TIMES)))
        self.asked, self.grown, self.full_at = [], [], None
        super().__init__(Plan(), world, self.loop, name)

    def loop(self, world, until_us, budget):
        self.asked.append((until_us, budget))
        numbers = {name: int(get(world.run, 0, name)) for name in RUN}
        for _ in range(budget):
            at = TIMES[numbers["next"]] if numbers["next"] < len(TIMES) else DURATION
            if at >= until_us:
                put(world.run, 0, status=DONE)
                return
            put(world.rows, numbers["rows"], time=at, node=numbers["next"])
            put(world.taps, numbers["taps"], time=at)
            put(world.tapped, numbers["taps"], seq=7 * at)
            for one in ("rows", "taps", "next"):
                numbers[one] += 1
            put(world.run, 0, now=at, **{one: numbers[one] for one in ("rows", "taps", "next")})
        put(world.run, 0, status=POOL_FULL if self.full_at == numbers["next"] else BUDGET)

    def is_complete(self):
        return self.complete

    def broken_between(self):
        return self.between

    def clock_us(self):
        return int(get(self.world.run, 0, "now"))

    def next_us(self):
        return None

    def grow(self, status):
        self.grown.append(status)

    def schedule(self, fault):
        pass

    def broken_line(self):
        run = self.world.run
        return f"broken {get(run, 0, 'broken')} at {get(run, 0, 'broken_node')}"


@pytest.fixture(params=[True, False], ids=["plain", "arrays"])
def small(request):
    return Small(request.param)


def pairs(rows):
    return list(zip(rows["time"].tolist(), rows["node"].tolist(), strict=True))


ROWS = list(zip(TIMES, range(len(TIMES)), strict=True))


def test_a_run_goes_slice_by_slice_to_the_end_of_its_plan(small, monkeypatch):
    monkeypatch.setattr(driver, "wall_s", iter([100.0, 107.5]).__next__)
    seen = []
    ended = small.finish(lambda *when: seen.append(when))
    assert (ended.ended_us, ended.interrupted, ended.wall_s) == (DURATION, False, 7.5)
    assert pairs(ended.rows["rows"]) == ROWS
    assert seen == [(10, DURATION), (30, DURATION), (50, DURATION), (60, DURATION)]
    assert small.asked == [(0, 1)] + [(DURATION, 2)] * 4
    assert small.grown == [BUDGET] * 3 + [DONE]


@pytest.mark.parametrize("moments", [15, 35])
def test_a_run_whose_time_stands_still_ends_with_words(small, monkeypatch, moments):
    """Ten slices of two events each at one time are too many; nine are not."""
    monkeypatch.setitem(globals(), "TIMES", (5,) * moments + TIMES)
    monkeypatch.setattr(small, "slice_events", 2)
    for name in ("rows", "taps", "tapped"):
        tables = Tables(isinstance(small.world.run, list))
        names = {"rows": ("time", "node"), "taps": TAP, "tapped": ("seq",)}[name]
        small.world = small.world._replace(**{name: tables.records(names, 50)})
    if moments < 20:
        assert small.finish().ended_us == DURATION
        return
    with pytest.raises(InvariantBroken, match=r"time stands still at 0\.000005 s: 20 events"):
        small.finish()


def test_what_ends_before_its_time_ended_when_its_last_event_was(small):
    small.complete = True
    ended = small.finish()
    assert (ended.ended_us, ended.interrupted) == (60, False)


def test_an_interrupt_ends_it_after_the_slice_and_keeps_its_rows(small):
    ended = small.finish(lambda now, _: now == 30 and signal.raise_signal(signal.SIGINT))
    assert (ended.ended_us, ended.interrupted) == (30, True)
    assert pairs(ended.rows["rows"]) == ROWS[:4]
    with pytest.raises(KeyboardInterrupt):
        signal.raise_signal(signal.SIGINT)  # afterwards it is as it was


def test_a_tap_is_handed_every_frame_once_and_up_to_when(small):
    frames, upto = [], []

    def tap(rows, tapped, now):
        frames.extend(zip(rows["time"].tolist(), tapped["seq"].tolist(), strict=True))
        upto.append(now)

    small.finish(tap=tap)
    assert frames == [(at, 7 * at) for at in TIMES]
    assert upto == [10, 30, 50, DURATION]  # nothing more comes before the end


def test_rows_are_taken_once_and_none_are_rows_too(small):
    none = small.take()["rows"]
    assert len(none) == 0
    small.advance(DURATION, 3)
    small.advance(DURATION, 1)
    found = small.take()["rows"]
    assert (pairs(found), found.dtype) == (ROWS[:4], none.dtype)
    assert len(small.take()["rows"]) == 0


def test_rows_of_one_table_come_in_pieces_up_to_a_time(small):
    assert [pairs(piece) for piece in small.pieces("rows", 21)] == [ROWS[:2], ROWS[2:3]]
    assert [pairs(piece) for piece in small.pieces("rows", 31)] == [ROWS[3:4]]


def test_a_table_that_was_full_is_grown(small):
    small.full_at = 2
    assert small.advance(DURATION, 2) == POOL_FULL
    assert small.advance(DURATION, 2) == BUDGET
    assert small.grown == [POOL_FULL, BUDGET]


@pytest.mark.parametrize(("run", "between", "says"), [
    ({"status": BROKEN, "broken": 3, "broken_node": 5}, None, "broken 3 at 5"),
    ({}, (2, 4), "broken 2 at 4"), ({}, None, ""), ({"checks": 0}, (2, 4), ""),
    ({"status": BROKEN, "broken": 3, "broken_node": 5}, (2, 4), "broken 3 at 5"),  # the first
])  # fmt: skip
def test_what_is_broken_is_raised_and_no_rows_are_lost_without_it(small, run, between, says):
    small.between = between
    small._advance = lambda world, *_: put(world.run, 0, rows=1, **run)
    if says:
        with pytest.raises(InvariantBroken, match=says):
            small.advance(DURATION, 1)
        assert int(get(small.world.run, 0, "status")) == BROKEN
    else:
        assert small.advance(DURATION, 1) == DONE
        assert len(small.take()["rows"]) == 1


@pytest.mark.parametrize("name", ["", "small"])
def test_a_loop_with_a_name_is_compiled_from_now_on(monkeypatch, name):
    marked = []
    monkeypatch.setattr(compilation, "mark_compiled", marked.append)
    running = Small(plain=True, name=name)
    running.prepare()
    assert (running.asked, marked) == ([(0, 1)], [name] if name else [])


@pytest.mark.parametrize(("mark", "words"), [
    (5, "0000000000000005"), (-1, "ffffffffffffffff"), (-(1 << 63), "8000000000000000"),
])  # fmt: skip
def test_a_fingerprint_is_sixteen_digits(small, mark, words):
    put(small.world.run, 0, fingerprint=mark)
    assert small.fingerprint == words


def test_what_is_on_its_way_has_neither_arrived_nor_been_lost(small):
    counts = Counts(sent=20, arrived=11, lost_by={"cut": 2, "off": 3}, offered=9, delivered=8)
    assert counts.in_flight == 4
    assert small.counts() == Counts()
    assert small.counts().in_flight == 0
