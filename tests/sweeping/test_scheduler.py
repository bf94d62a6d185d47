"""What is handed out, in which batches, and when a point is done, by an engine that notes it."""

import json
from concurrent.futures import FIRST_COMPLETED, BrokenExecutor, Future
from contextlib import nullcontext
from dataclasses import replace

import pytest

from innervate.kernel import cache, compilation
from innervate.sweeping import SweepError, make_plan, scheduler
from innervate.sweeping.engines import Engine
from innervate.sweeping.jobs import Jobs
from innervate.sweeping.planfile import PlotTable
from innervate.sweeping.scheduler import DEATHS_MAX, Scheduler, Seen
from innervate.sweeping.work import Done, Job, Outcome
from innervate.trace.sources import stamp
from tests.sweeping.test_plan import SKIN

PLACE = json.dumps({"host": "here"})


class Noting(Engine):
    """Every run takes as long and comes to what a function of its repeat says."""

    ahead = 4

    def __init__(self, value=lambda repeat: 1.0, wall_s=0.01, sources=None):
        self.batches = []
        self.value, self.wall_s = value, wall_s
        self.sources = sources or stamp("running")

    def submit(self, work, base, jobs):
        self.batches.append([(job.point, job.repeat) for job in jobs])
        future = Future()
        future.set_result(Done([self.outcome(job) for job in jobs], PLACE, self.sources))
        return future

    def outcome(self, job):
        value = self.value(job.repeat)
        row = None if value is None else json.dumps({"x": value, "word": "a", "list": "[]"})
        return Outcome(job.point, job.repeat, job.seed, row, "" if row else "broke", self.wall_s, 1)

    def sizes(self):
        return [len(batch) for batch in self.batches]


@pytest.fixture
def conducted(tmp_path, monkeypatch):
    """A sweep of so many points under way, on a machine that has compiled something."""
    monkeypatch.setenv("INNERVATE_CACHE", str(tmp_path / "cache"))
    folder = cache.cache_root() / compilation.source_hash()
    folder.mkdir(parents=True)
    (folder / "skin.compiled").touch()

    def begun(engine, points=1, there=(), show=(), **options):
        plan = make_plan(SKIN, vary={"protocol.k": list(range(2, 2 + points))}, **options)
        jobs = Jobs(None)
        digest = plan.points[0].digest
        jobs.add([Outcome(digest, r, r, json.dumps({"x": v}), "", 1.0, 1) for r, v in there], PLACE)
        return Scheduler(plan, jobs, engine, Seen(show))

    return begun


@pytest.mark.parametrize(("name", "value", "goal"), [("x", 1.0, 4), ("list.x", 1.0, 12),
                                                    ("list.x", None, 40)])  # fmt: skip
def test_what_never_happens_is_not_waited_for_beyond_three_batches(conducted, name, value, goal):
    """Of runs that failed nobody knows whether it would have."""
    made = conducted(Noting(lambda repeat: value), repeat=40, batch=4, until=f"{name}.ci=5%")
    made.run()
    assert (made.done, made.states[0].goal, made.states[0].finished) == (goal, goal, True)


def test_what_is_there_is_not_run_again(conducted):
    engine = Noting()
    made = conducted(engine, repeat=5, there=[(0, 1.0), (3, 1.0)])
    made.run()
    assert [repeat for batch in engine.batches for _, repeat in batch] == [1, 2, 4]
    assert (made.ran, made.done, made.total, made.failed) == (3, 5, 5, 0)
    assert made.states[0].finished
    again = Noting()
    done = conducted(again, repeat=2, there=[(0, 1.0), (1, 1.0)])
    done.run()
    assert again.batches == []
    assert done.states[0].finished


@pytest.mark.parametrize(("values", "goal"), [
    ([1.0] * 6, 6), ([0.0, 2.0] * 3, 12), ([0.0, 9.0] * 6, 24), ([1.0] * 12, 6),
])  # fmt: skip
def test_a_point_that_is_known_well_enough_is_done(conducted, values, goal):
    engine = Noting()  # all the rest comes to 1.0
    made = conducted(engine, repeat=24, batch=6, until="x.ci=50%", there=list(enumerate(values)))
    made.run()
    assert made.states[0].goal == goal
    assert made.states[0].finished
    ran = [repeat for batch in engine.batches for _, repeat in batch]
    assert ran == list(range(len(values), goal))


def test_a_point_is_never_repeated_more_often_than_said(conducted):
    engine = Noting(lambda repeat: float(repeat % 2))
    made = conducted(engine, repeat=20, batch=6, until="x.ci=0.01")
    made.run()
    assert (made.states[0].goal, made.done, made.total) == (20, 20, 20)


def test_batches_take_a_while_and_leave_something_for_everybody(conducted):
    engine = Noting(wall_s=0.01)
    engine.workers = 2
    conducted(engine, repeat=81).run()
    # First alone until somebody knows how long a run takes; then 0.25 s, and a quarter at most.
    assert engine.sizes()[:4] == [1] * 4
    assert engine.sizes()[4] == 20
    assert max(engine.sizes()) == 20
    assert sum(engine.sizes()) == 81
    slow = Noting(wall_s=0.1)
    conducted(slow, repeat=30).run()
    assert max(slow.sizes()) == 2
    quick = Noting(wall_s=1e-6)
    conducted(quick, repeat=2000).run()
    assert max(quick.sizes()) == scheduler.BATCH_MAX == 500


def test_a_batch_is_as_large_as_runs_of_late_took_long(conducted):
    """The mean of a run's time, of which the newest batch is three tenths."""
    engine = Noting()
    engine.ahead = 1
    engine.outcome = lambda job: Noting.outcome(engine, job)._replace(
        wall_s={0: 0.02, 1: 0.01}.get(len(engine.batches) - 1, 0.05)
    )
    conducted(engine, repeat=200).run()
    means = [0.02]
    for took in (0.01, 0.05, 0.05):
        means.append(0.7 * means[-1] + 0.3 * took)
    assert engine.sizes()[:5] == [1, *(int(0.25 / mean) for mean in means)]


@pytest.mark.parametrize("points", [1, 3])
def test_one_run_goes_first_where_nothing_is_compiled(conducted, tmp_path, points):
    (compiled,) = (tmp_path / "cache").rglob("*.compiled")
    compiled.unlink()
    engine, seen = Noting(), []
    made = conducted(engine, points, repeat=3)
    made._progress = lambda scheduler: seen.append(scheduler.ran)
    made.run()
    assert seen[:2] == [0, 1]  # nothing else was handed out until it came back
    assert sum(engine.sizes()) == 3 * points


def test_the_time_left_is_by_what_came_after_the_first_results(conducted, monkeypatch):
    clock = iter(range(0, 10_000, 10))
    monkeypatch.setattr(scheduler.time, "perf_counter", lambda: next(clock))
    made = conducted(Noting(wall_s=1.0), repeat=9)
    left = []
    made._progress = lambda scheduler: left.append(scheduler.left_s)
    made.run()
    assert left[:2] == [None, None]
    assert all(one is not None for one in left[2:])
    assert left[-1] == 0


def test_failures_are_counted_and_no_figures(conducted):
    made = conducted(Noting(lambda repeat: None if repeat % 3 == 0 else 2.0), repeat=7)
    made._measures = ("x", "word")
    made.run()
    assert (made.done, made.failed) == (7, 3)
    assert made.states[0].series("x") == [2.0] * 4
    assert made.states[0].series("word") == []


def test_a_rule_about_no_figure_and_a_worker_of_another_version_are_told(conducted):
    with pytest.raises(SweepError, match='runs have no figure "y"'):
        conducted(Noting(), repeat=4, until="y.ci=5%").run()
    with pytest.raises(SweepError, match='--show: runs have no figure "z"'):
        conducted(Noting(), repeat=4, show=("x", "z")).run()
    with pytest.raises(SweepError, match=r'--until word\.ci=5%: "word" is no number'):
        conducted(Noting(), repeat=4, until="word.ci=5%").run()
    with pytest.raises(SweepError, match="the worker on here has other sources"):
        conducted(Noting(sources="others"), repeat=4).run()


@pytest.mark.parametrize(
    ("plot", "says"),
    [({"x": "protocol.kk", "y": "x"}, 'runs have no figure "protocol.kk"'),
     ({"x": "protocol.k", "y": "word"}, '"word" is no number'),
     ({"x": "protocol.k", "y": "x", "by": "z"}, 'runs have no figure "z"'),
     ({"x": "x", "y": "x", "by": "word"}, ""), ({"x": "protocol.k", "y": "list.routed_ms"}, "")],
)  # fmt: skip
def test_a_plot_of_what_runs_do_not_have_is_refused_by_the_first_run(conducted, plot, says):
    """Hours later is too late; but a list that is empty in one run need not be in others."""
    plan = replace(conducted(Noting(), repeat=4).plan, plots=(PlotTable(**plot),))
    made = Scheduler(plan, Jobs(None), Noting())
    with pytest.raises(SweepError, match=rf"\[\[plot\]\] 0: {says}") if says else nullcontext():
        made.run()
    assert made.ran < 4 if says else made.ran == 4


def test_the_time_left_is_that_of_a_run_for_each_that_is_missing(conducted, monkeypatch):
    monkeypatch.setattr(scheduler.time, "perf_counter", lambda: 130.0)
    made = conducted(Noting(), repeat=9, points=2)
    for state, done in zip(made.states, (9, 4), strict=True):
        state.goal, state.done = 9, done
    assert (made.done, made.total) == (13, 18)
    made.ran = 5
    assert made.left_s is None
    made._first_ran = (100.0, 5)
    assert made.left_s is None  # nobody knows yet
    made.ran = 11
    assert made.left_s == 30 / 6 * 5


def test_with_a_rule_there_will_be_as_many_runs_as_it_needs(conducted):
    made = conducted(Noting(), repeat=50, until="x.ci=10%")
    (state,) = made.states
    state.goal, state.values = 8, {"x": dict(enumerate([1.0, 1.4] * 4))}
    assert 8 < made.total == made.plan.until[0].needed([1.0, 1.4] * 4) < 50
    state.values = {"x": dict(enumerate([1.0, 1.00001] * 4))}
    assert made.total == 8  # as many as are decided
    state.values = {"x": dict(enumerate([1.0, 9.0] * 4))}
    assert made.total == 50
    state.finished = True
    assert made.total == 8


def job(repeat, point=""):
    return Job(point, {}, repeat, 0)


def test_who_died_with_a_worker_goes_alone_and_is_given_up_after_the_third_time(conducted):
    engine = Noting()
    made, renewed = conducted(engine, repeat=9), []
    engine.renew = lambda: renewed.append(len(made._suspects))
    digest = made.plan.points[0].digest
    one, other = job(0, digest), job(1, digest)
    made.states[0].goal = 9
    made._isolate([[one, other]])  # nobody knows which of them
    made._isolate([[one], [other]])
    assert set(made._deaths.values()) == {0}
    assert (list(made._suspects), renewed) == ([one, other, one, other], [2, 4])
    made._suspects.clear()
    for _ in range(DEATHS_MAX - 1):
        made._isolate([[one]])
    assert (list(made._suspects), made.failed) == ([one] * (DEATHS_MAX - 1), 0)
    made._isolate([[one]])
    assert (len(made._suspects), made.done, made.failed) == (DEATHS_MAX - 1, 1, 1)
    found = made._jobs.runs(digest, 9)
    assert list(found) == [0]
    assert made._deaths[digest, 1] == 0


def test_suspects_run_one_at_a_time_before_all_others(conducted):
    engine = Noting()
    made = conducted(engine, repeat=9)
    for state in made.states:
        made._begin(state)
    digest = made.plan.points[0].digest
    made._suspects.extend([job(0, digest), job(1, digest)])
    assert made._hand_out()
    assert made._hand_out()
    assert engine.batches == [[(digest, 0)]]
    made._running.clear()
    assert made._hand_out()
    assert engine.batches[1:] == [[(digest, 1)]]
    made._running.clear()
    assert made._hand_out()
    assert len(engine.batches) == 2 + len(made._running) > 2


class Dying(Noting):
    """Nothing that is handed out is done: whoever asks is told of one worker's death."""

    died = (BrokenExecutor,)
    renewed = 0

    def submit(self, work, base, jobs):
        super().submit(work, base, jobs)
        return Future()

    def renew(self):
        self.renewed += 1

    def wait(self, running, timeout=None, return_when=None):
        """The first is lost at once, all others while one waits for all."""
        ended = list(running)[: 1 if return_when == FIRST_COMPLETED else None]
        for future in ended:
            future.set_exception(BrokenExecutor())
        return set(ended), set(running) - set(ended)


@pytest.mark.parametrize(("together", "lost"), [(True, 4), (False, 1)])
def test_who_falls_with_a_worker_is_run_again_and_the_clock_is_not_begun(
    conducted, monkeypatch, together, lost
):
    engine = Dying()
    engine.falls_together = together
    monkeypatch.setattr(scheduler, "wait", engine.wait)
    made = conducted(engine, repeat=4)
    made._begin(made.states[0])
    assert made._hand_out()
    assert engine.sizes() == [1] * 4
    made._collect()
    assert sorted(job.repeat for job in made._suspects) == list(range(lost))
    assert (len(made._running), engine.renewed) == (4 - lost, 1)
    assert (made.ran, made._first_ran) == (0, None)
