"""sweep(scenario, vary=...) -> Sweep: plan, run what is missing, write the tables."""

import json
import os
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import replace
from hashlib import sha256
from numbers import Integral
from pathlib import Path
from typing import Any, Literal, TypedDict, Unpack

from msgspec import Struct

from innervate import scenario as scenarios
from innervate.running.options import refuse_others, takes
from innervate.running.showing import Bar
from innervate.scenario import Scenario, ScenarioError
from innervate.sweeping import planfile, tables
from innervate.sweeping.base import PLAN_FILE, Source, base_of, leaves, of_vary
from innervate.sweeping.derive import Formula
from innervate.sweeping.engines import engine
from innervate.sweeping.errors import DamagedError, SweepError
from innervate.sweeping.jobs import FILE, Jobs, rescue
from innervate.sweeping.plan import REPEAT_MAX, SweepPlan
from innervate.sweeping.result import Sweep
from innervate.sweeping.scheduler import Scheduler, Seen
from innervate.sweeping.sources import files_named
from innervate.sweeping.until import parse as parse_until
from innervate.sweeping.vary import Axis, axis, check_key, parse, plain
from innervate.trace.provenance import checkout

REPEAT_UNTIL = 1000  # repeats at most, with `until`, if nobody says
BATCH = 10
PAGE = "report.html"
CHECKED_MAX = 20  # points looked at before the first run, for one that is valid
Vary = Iterable[str] | Mapping[str | tuple[str, ...], Any]
Progress = Callable[[Scheduler], None]


class Planned(TypedDict, total=False):
    """What is varied, and how often it runs.

    Attributes:
        vary: what is varied: {"protocol.k": [2, 3], ("a", "b"): [(1, 10), (2, 20)]}, values also
            as "2..8"; or texts like those of --vary. The last one changes fastest.
        overrides: scenario keys that are other than in the file, for every run.
        derive: keys that follow from others, {"duration_s": "2 + 100 / protocol.beacon_hz"}.
        repeat: runs of every point, each with a seed of its own; 1, or at most 1,000 with `until`.
        seed: root seed in place of the scenario's.
        until: "recoveries.routed_ms.ci=5%": a point ends when the 95 % interval of its mean is
            that narrow to either side; several must all be met.
        batch: repeats between two decisions of `until`; 10.
        paired: keys whose variants are compared on the same seeds; "all" = every point has them.
    """

    vary: Vary
    overrides: Iterable[str] | Mapping[str, Any]
    derive: Mapping[str, str] | None
    repeat: int | None
    seed: int | None
    until: str | Iterable[str]
    batch: int | None
    paired: str | Iterable[str]


class Crew(TypedDict, total=False):
    """Who runs it.

    Attributes:
        workers: how many at the same time; None = one for every core; 1 = here, without processes.
        kind: "processes", "threads" or "here".
        dask: address of a Dask scheduler to use instead of this machine.
    """

    workers: int | None
    kind: str
    dask: str


class Asked(Planned, Crew, total=False):
    """What a sweep is asked for besides its scenario and its folder."""


AS_WRITTEN: Planned = {"vary": (), "overrides": (), "derive": None, "repeat": None, "seed": None,
                       "until": (), "batch": None, "paired": ()}  # fmt: skip
ALL_CORES: Crew = {"workers": None, "kind": "processes", "dask": ""}


@takes(Asked, {**AS_WRITTEN, **ALL_CORES})
def sweep(
    scenario: Source | SweepPlan,
    *,
    out: str | os.PathLike[str] | None = None,
    retry: bool = False,
    show: Iterable[str] = (),
    follow: Iterable[str] = (),
    progress: Progress | None = None,
    **asked: Unpack[Asked],
) -> Sweep:
    """Run a scenario for every combination of some settings, each many times.

    Args:
        scenario: a plan file, or what `innervate.run` takes, or a SweepPlan,
            which says all that Planned does.
        out: folder to write, or to go on in; without one everything stays in memory.
        retry: run again what failed.
        show: measures that somebody wants to see; the first run shows whether there are such.
        follow: measures that `progress` wants to see the values of, if there are such.
        progress: called now and then with the Scheduler; None = a bar in a notebook.
        asked: `vary`, `overrides`, `derive`, `repeat`, `seed`, `until`, `batch`, `paired`: what is
            varied (see Planned); `workers`, `kind`, `dask`: who runs it (see Crew).

    Raises:
        TypeError: no argument of that name.
        SweepError: the plan cannot be kept, or the folder not used; one line.
        ScenarioError: no point of it is a valid scenario.
        KeyboardInterrupt: Ctrl-C; with `out` what was done is kept, and the same call goes on.
    """
    refuse_others("a sweep", asked, Asked.__annotations__)
    workers, dask = asked.pop("workers", ALL_CORES["workers"]), asked.pop("dask", ALL_CORES["dask"])
    crew = engine(asked.pop("kind", ALL_CORES["kind"]), workers, dask)
    planned: Planned = asked
    plan = scenario if isinstance(scenario, SweepPlan) else make_plan(scenario, **planned)
    plan, made = _checked(plan)
    folder, seen = None if out is None else Path(out), Seen(tuple(show), tuple(follow))
    with crew as running:  # one that cannot be leaves no folder behind
        if folder is not None:
            _prepare(folder)
        files = _files(plan, made)

        def go_on(jobs: Jobs) -> Sweep:
            jobs.claim(plan.identity(), files)
            if folder is not None:
                _describe(plan, folder)
            if retry:
                jobs.forget_failed()
            with Bar("preparing the runs") as bar:
                scheduler = Scheduler(plan, jobs, running, seen, progress or bar.swept)
                return _run_plan(scheduler, jobs, folder)

        return _with_table(folder, plan, go_on)


def _with_table(folder: Path | None, plan: SweepPlan, go_on: Callable[[Jobs], Sweep]) -> Sweep:
    """Go on with the job table, or, where a page of it is damaged, with what is left of it."""
    try:
        with Jobs(folder) as jobs:
            return go_on(jobs)
    except DamagedError:
        if folder is None:
            raise
        kept, aside = rescue(folder, {point.digest: plan.repeat for point in plan.points})
    with Jobs(folder) as jobs:
        done = go_on(jobs)
    said = f"whole pages: {kept:,} runs could be read and are kept, {done.ran:,} were run now"
    done.torn = (f"{said} ({aside} is the file as it was)", *done.torn)
    return done


def _run_plan(scheduler: Scheduler, jobs: Jobs, folder: Path | None) -> Sweep:
    """Run it; the tables are written in any case, with what there is."""
    try:
        scheduler.run()
    finally:
        done = _result(scheduler.plan, jobs, scheduler)
        if folder is not None:
            _write(done, folder, scheduler.wanted)
    return done


@takes(Planned, AS_WRITTEN)
def make_plan(scenario: Source, **planned: Unpack[Planned]) -> SweepPlan:
    """The plan that these describe, as in sweep(); what they say goes before a plan file's."""
    refuse_others("a sweep", planned, Planned.__annotations__)
    file, source = _plan_file(scenario)
    base = base_of(source, planned.get("overrides", ()))
    axes, derived = _axes(planned.get("vary", ())), dict(planned.get("derive") or {})
    rules, pairs = _texts(planned.get("until", ())), _texts(planned.get("paired", ()))
    if file is not None:
        given = {key for one in axes for key in one.keys} | {key for key, _ in base.settings}
        label = str(scenario)
        axes = tuple(
            one for one in planfile.axes_of(file, label) if given.isdisjoint(one.keys)
        ) + axes  # fmt: skip
        kept = tuple((k, v) for k, v in leaves(file.set, into=dict) if k not in given)
        base = replace(base, settings=(*kept, *base.settings))
        derived = {k: str(v) for k, v in leaves(file.derive, into=dict) if k not in given} | derived
        rules = rules or _texts(file.until)
        pairs = pairs or _texts(file.paired)
    for key in derived:
        check_key(key, f"derive {key}")
    return SweepPlan(
        base=base,
        axes=axes,
        derived=tuple((k, Formula(text, f"derive {k}")) for k, text in derived.items()),
        until=tuple(parse_until(rule) for rule in rules),
        root=_first(planned.get("seed"), file.seed if file else None, -1),
        paired=pairs,
        name=(file.name if file is not None else "") or base.name or Path(base.file).stem,
        plots=planfile.plots_of(file, str(scenario)) if file is not None else (),
        repeat=_count("repeat", planned, file, REPEAT_UNTIL if rules else 1),
        batch=_count("batch", planned, file, BATCH),
    )


def _count(
    name: Literal["repeat", "batch"], planned: Planned, file: planfile.PlanFile | None, usual: int
) -> int:
    """How often, as was asked for, or as the plan file says; not never, and not too often."""
    count: Any = _first(planned.get(name), getattr(file, name, None), usual)
    if not isinstance(count, Integral) or not 1 <= int(count) <= REPEAT_MAX:
        raise SweepError(f"{name} must be a whole number from 1 to {REPEAT_MAX}, not {count}")
    return int(count)


def _first(*numbers: int | None) -> int:
    """The first number that was given."""
    return next(number for number in numbers if number is not None)


def _plan_file(scenario: Source) -> tuple[planfile.PlanFile | None, Source]:
    """The plan file, if it is one, and the scenario that it or the caller names."""
    if isinstance(scenario, dict | Struct | Scenario):
        return None, scenario
    text, label, folder = scenarios.read(scenario)
    if not planfile.is_plan(text):
        return None, scenario
    file = planfile.read(text, label)
    return file, planfile.scenario_of(file, folder)


def _axes(vary: Vary) -> tuple[Axis, ...]:
    if isinstance(vary, str):
        return (parse(vary),)
    if not isinstance(vary, Mapping):
        return tuple(parse(text) for text in vary)
    made = []
    for key, values in vary.items():
        if isinstance(key, str):
            steps = [(value,) for value in planfile.listed(values, f"vary {key}")]
            made.append(axis((key,), steps, f"vary {key}"))
        else:
            made.append(axis(tuple(key), [tuple(step) for step in values], f"vary {key}"))
    return tuple(made)


def _texts(given: str | Iterable[str]) -> tuple[str, ...]:
    return (given,) if isinstance(given, str) else tuple(given)


def _files(plan: SweepPlan, made: Scenario) -> dict[str, str]:
    """The files that its runs read: by a scenario of it, or by values of what is varied."""
    varied = {
        key: [plain(step[place]) for step in axis.steps]
        for axis in plan.axes for place, key in enumerate(axis.keys)
    }  # fmt: skip
    return files_named(made, plan.base.folder, varied)


def _checked(plan: SweepPlan) -> tuple[SweepPlan, Scenario]:
    """The plan, if one of its first points at least can be run, and that point's scenario.

    Seed and paths are filled in.

    Points that cannot be run are rows with their reason; if there are no others, something in the
    plan itself is wrong, a key's name for one.
    """
    wrong: ScenarioError | None = None
    for point in plan.points[:CHECKED_MAX]:
        try:
            base = plan.base.anywhere(point.settings)
            made = base.scenario(point.settings)
            scenarios.plan(made)  # what a file says that it names shows only here
        except ScenarioError as error:
            wrong = wrong or of_vary(error, (key for axis in plan.axes for key in axis.keys))
        else:
            root = made.seed if plan.root < 0 else plan.root
            return replace(plan, base=base, root=root), made
    assert wrong is not None
    raise wrong


def _prepare(folder: Path) -> None:
    """Make the folder, unless something else is in it."""
    try:
        folder.mkdir(parents=True, exist_ok=True)
        names = {entry.name for entry in folder.iterdir()}
    except OSError as error:
        why = error.strerror or type(error).__name__
        raise SweepError(f"{folder} cannot be used: {why}; choose another folder") from None
    if names and FILE not in names:
        raise SweepError(f"{folder} is no sweep's folder and not empty; choose another folder")
    if not os.access(folder, os.W_OK | os.X_OK):
        raise SweepError(f"no permission to write in {folder}; choose another folder")


def _describe(plan: SweepPlan, folder: Path) -> None:
    """Put the scenario and the plan beside the job table."""
    with _writing(folder):
        tables.write_bytes(plan.base.text.encode(), folder / plan.base.file)
        tables.write_bytes(planfile.dump(plan).encode(), folder / PLAN_FILE)


def _result(plan: SweepPlan, jobs: Jobs, scheduler: Scheduler) -> Sweep:
    repeats = [state.goal for state in scheduler.states]
    results = tables.results(plan, jobs, repeats)
    return Sweep(
        plan=plan,
        results=results,
        timings=tables.timings(plan, jobs, repeats),
        complete=all(state.finished for state in scheduler.states),
        ran=scheduler.ran,
        others=jobs.count() - results.height,
        torn=_torn(plan, jobs),
    )


def _torn(plan: SweepPlan, jobs: Jobs) -> tuple[str, ...]:
    """What was torn in the job table, in words."""
    index = {point.digest: point.index for point in plan.points}
    runs = sorted((index[point], repeat) for point, repeat in jobs.torn)
    return (
        *(f"point {point}, repeat {repeat}, which was run again" for point, repeat in runs),
        *(f"place {number}, where runs were" for number in sorted(jobs.torn_places)),
    )


def _write(done: Sweep, folder: Path, wanted: tuple[str, ...]) -> None:
    """Write the tables, the page with the measures that are wanted, where all that comes from."""
    commit, modified = checkout()
    written = planfile.dump(done.plan).encode()
    origin = done.provenance | {
        "plan": sha256(written).hexdigest(), "commit": commit, "modified": modified,
    }  # fmt: skip
    with _writing(folder):
        tables.write(done.results, folder / tables.RESULTS)
        tables.write(done.timings, folder / tables.TIMINGS)
        tables.write(done.points(), folder / tables.POINTS)
        text = json.dumps(origin, indent=2, ensure_ascii=False)
        tables.write_bytes(text.encode() + b"\n", folder / "provenance.json")
        tables.write_bytes(done.report(wanted).encode(), folder / PAGE)
    done.written = folder


@contextmanager
def _writing(folder: Path) -> Iterator[None]:
    try:
        yield
    except OSError as error:
        why = error.strerror or type(error).__name__
        raise SweepError(
            f"{folder} cannot be written: {why}; what is done is kept in {FILE}, give the same "
            "command again"
        ) from error


def load_sweep(folder: str | os.PathLike[str]) -> Sweep:
    """A sweep from its folder; nothing is run.

    Raises:
        SweepError: it is no sweep's folder, or damaged.
    """
    import polars

    path = Path(folder)
    try:
        origin = json.loads((path / "provenance.json").read_text(encoding="utf-8"))
        written = (path / PLAN_FILE).read_bytes()
        results, timings = (
            polars.read_parquet(path / name) for name in (tables.RESULTS, tables.TIMINGS)
        )
        complete = bool(origin["complete"])
        planned, scenario = origin.get("plan"), origin["identity"]["the scenario"]
    except FileNotFoundError as error:
        name = Path(str(error.filename or "")).name or tables.RESULTS
        raise SweepError(f"{path} is not a finished sweep's folder: it has no {name}") from None
    except (OSError, ValueError, KeyError, TypeError, polars.exceptions.PolarsError):
        raise SweepError(f"{path} is damaged; give its sweep again") from None
    if planned not in (None, sha256(written).hexdigest()):
        raise SweepError(
            f"the tables in {path} are of another plan than its {PLAN_FILE}: its last sweep was "
            "killed before its end, or the file was changed; give that sweep again"
        )
    plan = make_plan(path / PLAN_FILE)
    if plan.identity()["the scenario"] != scenario:
        raise SweepError(f"{path / plan.base.file} is missing or was changed; give its sweep again")
    return Sweep(plan, results, timings, complete, written=path)
