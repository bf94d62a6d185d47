"""A simulation's pace, its moments to go back to and its end, of a network that is made up."""

from types import SimpleNamespace

import pytest

from innervate.sim.driver import InvariantBroken
from innervate.web import messages, simulated
from innervate.web.engine import Mark
from innervate.web.errors import Refused
from innervate.web.history import BACK, LOG, SERIES, Logbook
from innervate.web.messages import Go, Pause, Save, Seek, Speed, Step
from innervate.web.simulated import BEAT_S, BUDGET, SLICE_S, Simulated

END_US = 2_000_000
SLOW = 0.05


class MadeUp:
    """An engine in which nothing happens but at times, and the simulation that it is running.

    `costs` are the seconds of every call.
    """

    now_us, next_at, size, complete, breaks_us = 0, None, 1, False, None
    is_before_fault = False

    def __init__(self):
        self.calls, self.costs, self.spent, self.short, self.back = [], [], 0.0, 0, []
        self.edges, self.running = [], self

    @property
    def edge_us(self):
        return min([at for at in self.edges if at > self.now_us], default=END_US)

    @property
    def earliest_us(self):
        return max(self.now_us, 1)

    def prepare(self):
        self.now_us = 0

    def is_complete(self):
        return self.complete

    def next_us(self):
        return self.next_at

    def advance(self, until_us, budget):
        self.calls.append((until_us, budget))
        self.spent += self.costs.pop(0) if self.costs else 0.0
        if self.breaks_us is not None and until_us > self.breaks_us:
            raise InvariantBroken("two gateways")
        if self.short:
            self.short -= 1
            self.now_us += 1
        else:
            self.now_us = until_us

    def take(self):
        return {}

    def mark(self):
        return Mark(self.now_us, None, self.size)

    def back_to(self, mark):
        self.back.append(mark.now_us)
        self.now_us = mark.now_us


class Seen:
    """A view that keeps what is asked of it."""

    speed, slow, saves, can, check_us, is_open, is_still = (
        0.5,
        SLOW,
        False,
        ("cut",),
        0,
        False,
        None,
    )

    def has_absent(self):
        return True

    def __init__(self, engine, history):
        self.engine, self.history, self.log = engine, history, Logbook(history)
        self.checks, self.done, self.forgot = [], [], []

    def note(self, rows):
        assert rows == {}

    def check(self):
        self.checks.append(self.engine.now_us)

    def sample(self):
        self.history.add(SERIES, self.engine.now_us, {})

    def fields(self, flights):
        return {"flights": flights, "still": self.is_still}

    def scene(self):
        return {"nodes": 3}

    def remember(self):
        return self.engine.now_us

    def forget(self, memory):
        self.forgot.append(memory)

    def apply(self, command):
        self.done.append((self.engine.now_us, command))


@pytest.fixture
def made(monkeypatch):
    engine = MadeUp()
    monkeypatch.setattr(simulated, "engine_of", lambda plan: engine)
    monkeypatch.setattr(simulated, "networks", lambda: {"skin": SimpleNamespace(view=Seen)})
    clock = SimpleNamespace(thread_time=lambda: engine.spent, perf_counter=lambda: engine.spent)
    monkeypatch.setattr(simulated, "time", clock)
    plan = SimpleNamespace(kind="skin", duration_us=END_US, scenario=SimpleNamespace(name="x"))
    one = Simulated(plan)
    one.playback._clock = lambda: one.clock_s
    one.clock_s = 0.0
    one.playback.start_from(0)
    one.prepare()
    return one


def kept(made):
    return [mark.engine.now_us for mark in made._marks]


def arrive(made):
    while made._target_us is not None:
        assert made.work() == 0.0


def test_what_it_is_and_can(made):
    assert made.can == ("pause", "step", "speed", "seek", "cut")
    assert (made.playback.speed, made.broken, kept(made)) == (0.5, "", [0])
    scene = made.scene()
    assert (scene["duration_s"], scene["t_s"], scene["nodes"]) == (2.0, 0.0, 3)
    assert (scene["kind"], scene["name"], scene["source"]) == ("skin", "x", "simulation")
    assert scene["absent"] is True
    with pytest.raises(Refused, match="how a skin writes its events is not known"):
        made.do(Save())


@pytest.mark.parametrize(
    ("speed", "paused", "flights"),
    [(SLOW, False, True), (SLOW * 1.01, False, False), (0, False, False), (0.01, False, True),
     (100, True, True), (0, True, True)],
)  # fmt: skip
def test_frames_on_their_way_are_drawn_where_it_is_slow_enough(made, speed, paused, flights):
    made.do(Speed(speed))
    if paused:
        made.do(Pause())
    fields = made.fields()
    assert (fields["flights"], fields["still"], fields["paused"]) == (flights, paused, paused)
    made.do(Seek(1.5))
    assert not made.fields()["flights"]  # on its way


def test_it_goes_on_as_its_clock_does_and_beats(made):
    assert made.work() == BEAT_S
    assert made.engine.now_us == 0
    made.clock_s = 0.125
    assert made.work() == BEAT_S
    assert made.engine.now_us == 62_500
    made.do(Pause())
    made.clock_s = 0.25
    assert made.work() == 1.0
    assert made.engine.now_us == 62_500
    made.do(Go())
    made.clock_s = 0.375
    assert made.work() == BEAT_S
    assert made.engine.now_us == 125_000
    made.clock_s = 99.0
    while not made.at_end:
        made.work()
    assert made.engine.now_us == END_US
    assert made.work() == 1.0
    assert made.fields()["at_end"]
    assert made.fields()["still"]


def test_who_has_not_come_so_far_in_a_slice_goes_on_at_once(made):
    made.clock_s = 0.2  # due: 100 ms
    made.engine.costs = [SLICE_S * 1.1] * 3
    assert made.work() == 0.0
    assert 0 < made.engine.now_us < 100_000
    assert len(made.engine.calls) == 1
    made.engine.costs = []
    assert made.work() == BEAT_S
    assert made.engine.now_us == 100_000


def test_a_slice_has_as_many_events_as_there_is_time_for(made):
    budget = 8 * BUDGET
    made.engine.short = 3
    made._advance(3_000)
    assert [calls for _, calls in made.engine.calls] == [BUDGET, 2 * BUDGET, 4 * BUDGET, budget]
    assert made._budget == budget  # it came as far as it was to: no more are needed
    made.engine.calls.clear()
    for cost, then in [(SLICE_S, budget), (1.1 * SLICE_S, budget // 2), (SLICE_S / 4, budget // 2)]:
        made.engine.costs, made.engine.short = [cost], 1
        made._advance(made.engine.now_us + 1)
        assert made._budget == then
    made._budget = BUDGET + 1
    made.engine.costs = [1.0]
    made._advance(made.engine.now_us + 1)
    assert made._budget == BUDGET


def test_it_halts_at_edges_points_and_checks(made):
    made.do(Speed(0))  # points: of the whole time
    made.engine.edges = [2_500]
    made._advance(2_700)
    assert [at for at, _ in made.engine.calls] == [2_500, 2_700]
    made.view.check_us, made.view.is_open = 1_500, True
    made.engine.calls.clear()
    made._advance(9_000)
    at = [at for at, _ in made.engine.calls]
    assert at == made.view.checks == [3_000, 4_000, 4_500, 6_000, 7_500, 8_000, 9_000]
    points = made.history.after(SERIES, 0, made.history.newest, 99)
    assert [point.at_us for point in points] == [4_000, 8_000]
    made.view.is_open = False
    assert made._next_check_us() == END_US


def test_one_goes_back_to_the_last_moment_before(made):
    made.do(Speed(0))
    made.do(Seek(0.1))
    arrive(made)
    assert kept(made) == [0, 20_000, 40_000, 60_000, 80_000, 100_000]
    made.broken = "x"
    made.clock_s = 1.0
    made.back_to(60_000)
    assert (made.engine.back, made.engine.now_us, made.view.forgot) == ([60_000], 60_000, [60_000])
    assert (made.broken, made._next_point_us) == ("", 64_000)
    assert [item.at_us for item in made.history.after(BACK, 0, made.history.newest, 9)] == [60_000]
    made.do(Speed(1.0))
    made.back_to(59_999)
    assert made.engine.back == [60_000, 40_000]
    made.clock_s = 1.5
    assert made.playback.due_us(END_US) == 540_000  # it goes on from there
    made.back_to(19_999)
    assert made.engine.now_us == 0
    assert made.playback.due_us(END_US) == 0


def test_what_was_kept_of_another_time_is_forgotten_when_something_is_done_before_it(made):
    made.do(Speed(0))
    made.do(Seek(0.1))
    arrive(made)
    made.do(Seek(0.05))
    arrive(made)
    assert (made.engine.back, made.engine.now_us) == ([40_000], 50_000)
    assert kept(made)[-1] == 100_000  # as long as nothing else has happened
    made.do(messages.Cut(1))
    assert made.view.done == [(50_000, messages.Cut(1))]
    assert kept(made) == [0, 20_000, 40_000]
    assert made.engine.now_us == 50_001  # it has happened
    made.do(Seek(0.2))
    with pytest.raises(Refused, match=r"on the way to 0.2 s"):
        made.do(messages.Cut(1))
    arrive(made)
    made.do(Seek(0.09))
    assert made.engine.back[-1] == 80_000


def test_one_seeks_within_the_time_there_is(made):
    made.do(Seek(5.0))
    assert made._target_us == END_US
    arrive(made)
    assert made.engine.now_us == END_US
    assert max(at for at, _ in made.engine.calls) == END_US
    made.do(Seek(0.0))
    arrive(made)
    assert made.engine.now_us == 0


def test_having_arrived_it_goes_on_from_there(made):
    made.do(Seek(1.0))
    made.clock_s = 3.0
    arrive(made)
    assert made.playback.due_us(END_US) == 1_000_000
    made.clock_s = 3.1
    assert made.playback.due_us(END_US) == 1_050_000


@pytest.mark.parametrize(
    ("next_us", "goes"), [(None, False), (END_US, False), (END_US - 1, True), (7, True)]
)
def test_a_step_is_to_what_happens_next_before_the_end(made, next_us, goes):
    made.engine.next_at = next_us
    if goes:
        made.do(Step())
        assert made.engine.now_us == next_us + 1
        made.clock_s = 9.0
        assert made.playback.due_us(END_US) == next_us + 1
    else:
        with pytest.raises(Refused, match="nothing more happens"):
            made.do(Step())
        assert made.engine.now_us == 0
    assert made.playback.paused


def test_at_the_end_nothing_is_done_or_stepped(made):
    made.engine.next_at = 5
    made.broken = "x"
    with pytest.raises(Refused, match="nothing more happens"):
        made.do(Step())
    with pytest.raises(Refused, match="this is the end; go back first"):
        made.do(messages.Cut(1))
    made.broken = ""
    made.engine.now_us = END_US - 1
    made.do(messages.Cut(1))
    made.engine.now_us = END_US
    with pytest.raises(Refused, match="this is the end; go back first"):
        made.do(messages.Cut(2))
    assert made.view.done == [(END_US - 1, messages.Cut(1))]


def test_what_must_not_happen_is_said_and_one_can_go_back_from_it(made):
    made.engine.breaks_us = 30_000
    made.run_to_end()
    assert (made.broken, made.at_end) == ("two gateways", True)
    (line,) = made.history.after(LOG, 0, made.history.newest, 9)
    assert (line.what["text"], line.what["level"]) == ("two gateways", "bad")
    assert line.at_us == made.engine.now_us
    made.engine.breaks_us = None
    made.do(Seek(0.01))
    assert made.broken == ""
    assert not made.at_end
    arrive(made)
    assert made.engine.now_us == 10_000


def test_progress_is_told_to_the_end(made):
    told = []
    made.engine.costs = [SLICE_S * 2] * 2
    made.run_to_end(lambda now_us, end_us: told.append((now_us, end_us)))
    assert told == [(4_000, END_US), (8_000, END_US), (END_US, END_US)]


@pytest.mark.parametrize(
    ("size", "most"), [(1, 32), (2**28 // 5, 5), (2**28 // 2, 2), (2**28, 2), (2**30, 2)]
)
def test_of_too_many_moments_every_other_is_kept_further_apart(made, size, most):
    made.engine.size = size
    for number in range(1, most):
        made.engine.now_us = number * 20_000
        made._keep()
    assert kept(made) == [number * 20_000 for number in range(most)]
    made.engine.now_us += 19_999
    made._keep()
    assert len(kept(made)) == most
    made.engine.now_us += 1
    made._keep()
    assert kept(made) == [number * 40_000 for number in range(most // 2 + 1)]
    assert made._apart_us == 40_000
