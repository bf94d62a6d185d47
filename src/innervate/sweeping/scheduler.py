"""Conducts a sweep: hands out what is missing, keeps what comes back, decides `until`."""

from __future__ import annotations

import json
import time
from collections import deque
from collections.abc import Callable, Iterable
from concurrent.futures import FIRST_COMPLETED, CancelledError, Future, wait
from dataclasses import dataclass, field
from typing import Any, NamedTuple

from innervate.analysis.summary import COUNTED
from innervate.kernel import cache, compilation
from innervate.scenario.explain import nearest
from innervate.sweeping.engines import Engine
from innervate.sweeping.errors import SweepError
from innervate.sweeping.jobs import Jobs
from innervate.sweeping.plan import Point, SweepPlan, blocks
from innervate.sweeping.sources import sources_of
from innervate.sweeping.work import Done, Job, Outcome, run_batch

BATCH_S = 0.25  # about how long a batch takes: what a kill may cost, and often enough for a display
BATCH_MAX = 500
DEATHS_MAX = 3
NEVER_BATCHES = 3  # repeats after which what `until` names is taken for what never happens
NAMED_MAX = 8  # figures that an error names


@dataclass(slots=True)
class State:
    """How far a point is."""

    point: Point  # which
    goal: int = 0  # repeats that it gets as far as is decided
    # done, failed: how many of these there are, and failed ones among them
    done: int = 0
    failed: int = 0
    # for each measure followed, its value by repeat; None where it has none
    values: dict[str, dict[int, float]] = field(default_factory=dict)
    finished: bool = False  # nothing more will be run

    def series(self, measure: str) -> list[float]:
        """A measure's values in order of repeat."""
        found = self.values.get(measure, {})
        return [found[repeat] for repeat in sorted(found)]


class Seen(NamedTuple):
    """Measures that somebody looks at.

    Attributes:
        show: runs have to have these.
        follow: their values are kept at hand for a display, besides those of `until`.
    """

    show: tuple[str, ...] = ()
    follow: tuple[str, ...] = ()


NOTHING = Seen()


class Scheduler:
    """Brings a sweep from where it is to its end.

    Args:
        plan, jobs, engine: what is wanted, what is there, who runs the rest.
        seen: measures that somebody looks at.
        progress: called after every batch, with this.
    """

    def __init__(
        self,
        plan: SweepPlan,
        jobs: Jobs,
        engine: Engine,
        seen: Seen = NOTHING,
        progress: Callable[[Scheduler], None] | None = None,
    ) -> None:
        self.plan = plan
        self.states = [State(point) for point in plan.points]
        self.ran = 0  # runs done by this process
        self.lacks = ""  # what nothing goes on without, in words; "" = it goes on
        self._jobs = jobs
        self._engine = engine
        self._progress = progress or (lambda scheduler: None)
        rules = [(f"--until {rule}", rule.measure) for rule in plan.until]
        self._numbers = [*rules, *(("--show", measure) for measure in seen.show)]
        self.wanted = tuple(dict.fromkeys(name for _, name in self._numbers))
        self._measures = tuple(dict.fromkeys([*self.wanted, *seen.follow]))
        drawn = [(f"[[plot]] {number}", plot) for number, plot in enumerate(plan.plots)]
        self._numbers += [(where, plot.y) for where, plot in drawn]
        self._named = [*self._numbers, *((w, n) for w, plot in drawn for n in (plot.x, plot.by))]
        self._by_digest = {state.point.digest: state for state in self.states}
        self._blocks = list(blocks(plan))
        self._ready: deque[tuple[State, int]] = deque()
        self._running: dict[Future[Done], list[Job]] = {}
        self._suspects: deque[Job] = deque()
        self._deaths: dict[tuple[str, int], int] = {}
        self._mean_s = 0.0
        self._known = False
        # When the first results came, and how many: all before was starting and compiling.
        self._first_ran: tuple[float, int] | None = None

    def run(self) -> None:
        """Run what is missing.

        Raises:
            SweepError: the cluster is lost, its workers have other sources, or nothing can be kept.
            KeyboardInterrupt: Ctrl-C; what came back until then is kept.
        """
        for state in self.states:
            self._begin(state)
        self._progress(self)
        lost: tuple[type[BaseException], ...] = (CancelledError, *self._engine.lost)
        try:
            self._first_alone()
            while self._hand_out():
                self._collect()
        except lost as error:
            raise SweepError(
                f"the cluster is gone ({type(error).__name__}); what is done is kept, the same "
                "command goes on"
            ) from error

    def _begin(self, state: State) -> None:
        """Take what the job table has of a point, block by block, until something is missing."""
        there = None
        while not state.finished:
            if there is None:
                there = self._jobs.runs(state.point.digest, self.plan.repeat)
            first, behind = self._blocks[state.goal // self._blocks[0][1]]
            missing = []
            for repeat in range(first, behind):
                found = there.get(repeat)
                if found is None:
                    missing.append(repeat)
                else:
                    self._count(state, repeat, found.figures)
            state.goal = behind
            if missing:
                self._ready.extend((state, repeat) for repeat in missing)
                return
            self._decide(state)

    def _decide(self, state: State) -> None:
        """All repeats up to the goal are there: is that enough?"""
        rules = self.plan.until
        enough = bool(rules) and all(rule.met(state.series(rule.measure)) for rule in rules)
        tried = state.done - state.failed >= NEVER_BATCHES * self.plan.batch
        vain = tried and not all(state.series(rule.measure) for rule in rules)
        state.finished = enough or vain or state.goal >= self.plan.repeat

    def _count(self, state: State, repeat: int, figures: dict[str, Any] | None) -> None:
        state.done += 1
        state.failed += figures is None
        if figures is not None and not self._known:
            self._known = True
            self._check_named(figures)
        for measure in self._measures:
            value = (figures or {}).get(measure)
            if isinstance(value, int | float):
                state.values.setdefault(measure, {})[repeat] = value

    def _check_named(self, figures: dict[str, Any]) -> None:
        """That somebody speaks of figures that runs have; the first one shows which they are."""
        for option, measure in self._named:
            if measure and measure not in self.plan.keys and not _may_have(figures, measure):
                close = nearest(measure, list(figures))
                hint = close if "did you" in close else nearest("", some(figures))
                raise SweepError(f'{option}: runs have no figure "{measure}"{hint}')
        for option, measure in self._numbers:
            if isinstance(figures.get(measure), str | bool):
                raise SweepError(f'{option}: "{measure}" is no number')

    def _first_alone(self) -> None:
        """On a machine that has compiled nothing yet, one run goes first, and compiles for all."""
        folder = cache.cache_root() / compilation.source_hash()
        if self._ready and not any(folder.glob("*.compiled")):
            self._submit(self._next_jobs(1))
            self._collect()

    def _hand_out(self) -> bool:
        """Give the engine as much as it can use; False when there is nothing left to wait for."""
        if self._suspects:  # one at a time: if a worker dies now, it is clear whose fault it is
            if not self._running:
                self._submit([self._suspects.popleft()])
            return True
        ahead = self._engine.ahead
        while self._ready and len(self._running) < ahead:
            self._submit(self._next_jobs(self._batch_size()))
        return bool(self._running)

    def _batch_size(self) -> int:
        if self._mean_s <= 0:
            return 1
        share = -(-len(self._ready) // (2 * self._engine.workers))
        return max(1, min(int(BATCH_S / self._mean_s), share, BATCH_MAX))

    def _next_jobs(self, count: int) -> list[Job]:
        taken = (self._ready.popleft() for _ in range(min(count, len(self._ready))))
        return [
            Job(s.point.digest, s.point.settings, repeat, self.plan.seed(s.point, repeat))
            for s, repeat in taken
        ]

    def _submit(self, jobs: list[Job]) -> None:
        self._running[self._engine.submit(run_batch, self.plan.base, jobs)] = jobs

    def _first_ended(self) -> set[Future[Done]]:
        """Wait for something, and say what that waits for where nothing can come."""
        while True:
            look_s = self._engine.look_s
            ended, _ = wait(self._running, timeout=look_s, return_when=FIRST_COMPLETED)
            lacks = "" if ended else self._engine.lacks()
            if lacks != self.lacks:
                self.lacks = lacks
                self._progress(self)
            if ended:
                return ended

    def _collect(self) -> None:
        """Wait for something, and keep it."""
        ended = self._first_ended()
        suspects = self._take(ended)
        if suspects and self._engine.falls_together:
            others, _ = wait(self._running)
            suspects += self._take(others)
        if suspects:
            self._isolate(suspects)
        if self._first_ran is None and self.ran > 0:
            self._first_ran = (time.perf_counter(), self.ran)
        self._progress(self)

    def _take(self, ended: Iterable[Future[Done]]) -> list[list[Job]]:
        """Keep what these brought; the batches whose worker died come back."""
        suspects = []
        for future in ended:
            jobs = self._running.pop(future)
            try:
                self._keep(future.result())
            except self._engine.died:
                suspects.append(jobs)
        return suspects

    def _keep(self, done: Done) -> None:
        if done.sources != sources_of(self.plan.base.kind):
            host = json.loads(done.place)["host"]
            raise SweepError(
                f"the worker on {host} has other sources of innervate; install the same version "
                "on all machines"
            )
        self._jobs.add(done.outcomes, done.place)
        took = sum(outcome.wall_s for outcome in done.outcomes) / len(done.outcomes)
        self._mean_s = took if self._mean_s == 0 else 0.7 * self._mean_s + 0.3 * took
        for outcome in done.outcomes:
            self.ran += 1
            state = self._by_digest[outcome.point]
            figures = None if outcome.row is None else json.loads(outcome.row)
            self._count(state, outcome.repeat, figures)
            if state.done == state.goal:
                self._decide(state)
                self._begin(state)  # the next block, if there is one

    def _isolate(self, batches: list[list[Job]]) -> None:
        """Workers died with these: each run goes alone from now on, and three times at most."""
        alone = len(batches) == 1 and len(batches[0]) == 1
        for job in (job for jobs in batches for job in jobs):
            key = (job.point, job.repeat)
            self._deaths[key] = self._deaths.get(key, 0) + alone
            if self._deaths[key] < DEATHS_MAX:
                self._suspects.append(job)
            else:
                self._give_up(job)
        self._engine.renew()

    def _give_up(self, job: Job) -> None:
        reason = f"its worker died {DEATHS_MAX} times, killed or out of memory"
        outcome = Outcome(job.point, job.repeat, job.seed, None, reason, 0.0, time.time())
        mine = sources_of(self.plan.base.kind)
        self._keep(Done([outcome], json.dumps({"host": ""}), mine))

    @property
    def done(self) -> int:
        """How many runs are there, of all points."""
        return sum(state.done for state in self.states)

    @property
    def failed(self) -> int:
        """Runs among them that failed."""
        return sum(state.failed for state in self.states)

    @property
    def total(self) -> int:
        """Runs there will be; with `until` an estimate."""
        return sum(self._expected(state) for state in self.states)

    def _expected(self, state: State) -> int:
        if state.finished or not self.plan.until:
            return state.goal
        needed = [rule.needed(state.series(rule.measure)) for rule in self.plan.until]
        return min(max(state.goal, *needed), self.plan.repeat)

    @property
    def left_s(self) -> float | None:
        """About how long it will still take, s; None if nobody knows yet."""
        if self._first_ran is None or self.ran == self._first_ran[1]:
            return None
        took, count = time.perf_counter() - self._first_ran[0], self.ran - self._first_ran[1]
        return took / count * (self.total - self.done)


def some(names: Iterable[str]) -> list[str]:
    """A few names in order, and how many more there are."""
    known = sorted(names)
    more = len(known) - NAMED_MAX
    return known if more <= 0 else [*known[:NAMED_MAX], f"and {more} more"]


def _may_have(figures: dict[str, Any], measure: str) -> bool:
    """True if a run has a figure, or may have it where something happens that did not in this."""
    parts = measure.split(".")
    lists = (".".join(parts[:count]) for count in range(1, len(parts)))
    return measure in figures or any(figures.get(name) == "[]" or name in COUNTED for name in lists)
