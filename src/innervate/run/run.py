"""run(scenario) -> Run: simulate a scenario, sum it up, write its folder."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field
from functools import cached_property
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Any

from innervate import scenario as scenarios
from innervate.analysis import frames, skin
from innervate.analysis.touch import WINDOW_S, Image, received_image
from innervate.run import folder as folders
from innervate.run.columns import columns
from innervate.scenario import Plan, Scenario
from innervate.sim.simulate import Result, simulate
from innervate.trace import tables
from innervate.trace.provenance import provenance

if TYPE_CHECKING:
    import polars

# Received samples are kept by default as long as they fit easily: some 60 MB.
RECEIVED_MAX = 1_000_000

Progress = Callable[[int, int], None]
Source = str | os.PathLike[str] | Scenario | dict[str, Any]


@dataclass(eq=False)
class Run:
    """A scenario that was run.

    Attributes:
        scenario: as resolved.
        plan: its graph and whole numbers.
        result: the simulation's rows and its world at the end.
        summary: what a person wants to know, by the names of docs/summary.
        received_kept: the table `received` holds all samples, rather than none.
        checks: the invariant checkers were on.
    """

    scenario: Scenario
    plan: Plan
    result: Result
    summary: dict[str, Any]
    received_kept: bool
    checks: bool = True
    written: Path | None = field(default=None)

    @cached_property
    def tables(self) -> dict[str, polars.LazyFrame]:
        """The run's tables by name: routes, links, outages, loops, received."""
        return {
            table.name: tables.frame(table, columns(table, self.result)).lazy()
            for table in tables.TABLES
        }

    @cached_property
    def provenance(self) -> dict[str, Any]:
        """Version, commit, seeds, package versions, fingerprint."""
        return provenance(
            scenario_toml=scenarios.dump(self.scenario),
            seeds=[self.plan.seed],
            fingerprint=self.result.fingerprint,
            wall_s=self.summary["wall_s"],
            checks=self.checks,
            interrupted=self.result.interrupted,
        )

    @property
    def interrupted(self) -> bool:
        """True if it was ended early; all it holds is then of the time until there."""
        return self.result.interrupted

    def received_image(self, time_s: float, window_s: float = WINDOW_S) -> Image:
        """Force and proximity per cell as the PC had them at a time (see analysis/touch.py)."""
        return received_image(self.result, time_s, window_s)

    def plot(self, figure: str = "recovery", **options: Any) -> Any:
        """A matplotlib figure of the run; `innervate.plot.figures` says which there are."""
        return import_module("innervate.plot.figures").draw(self, figure, **options)

    def report(self) -> str:
        """The run's report, one page of HTML."""
        page: str = import_module("innervate.plot.report").render(self)
        return page

    def write(self, folder: str | os.PathLike[str] | None = None, report: bool = True) -> Path:
        """Write the run folder, whole or not at all; the default is runs/<name>-<seed>.

        Raises:
            RunError: the folder holds something else or cannot be written.
        """
        if folder is None:
            folder = folders.default_folder(self.scenario.name, self.plan.seed)
        with folders.replacing(folder) as fresh:
            text = scenarios.dump(self.scenario)
            (fresh / folders.SCENARIO).write_text(text, encoding="utf-8")
            for table in tables.TABLES:
                if table is not tables.RECEIVED or self.received_kept:
                    tables.write(table, columns(table, self.result), fresh)
            if report:
                (fresh / folders.REPORT).write_text(self.report(), encoding="utf-8")
            folders.write_json(fresh / folders.SUMMARY, self.summary)
            origin = self.provenance | {"tables_sha256": folders.digests(fresh)}
            folders.write_json(fresh / folders.PROVENANCE, origin)
        self.written = Path(folder)
        return self.written


def run(
    scenario: Source,
    *,
    seed: int | None = None,
    overrides: Iterable[str] | Mapping[str, Any] = (),
    out: str | os.PathLike[str] | None = None,
    progress: Progress | None = None,
    checks: bool = True,
    received: bool | None = None,
    plain: bool = False,
) -> Run:
    """Run a scenario.

    Args:
        scenario: a file, a bundled name ("setup-1"), a Scenario, or tables as in a file.
        seed: in place of the scenario's.
        overrides: "a.b=c" texts, or a mapping from dotted keys to values.
        out: folder to write; nothing is written without one (see Run.write).
        progress: called now and then with (time_us, duration_us).
        checks: invariant checkers on.
        received: keep every sample the PC received; None = unless there are very many.
        plain: run uncompiled, slow; for comparison.

    Raises:
        ScenarioError: the scenario is not valid.
        RunError: `out` cannot be written; found out before the simulation.
        InvariantBroken: a checker found what must not happen.
        FramesLost: frames are not accounted for.
    """
    made = resolve(scenario, seed, overrides)
    plan = scenarios.plan(made)
    if out is not None:
        folders.check_target(out)
    if received is None:
        received = 0 < _samples(plan) <= RECEIVED_MAX
    result = simulate(plan, plain=plain, checks=checks, deliveries=received, progress=progress)
    if checks:
        frames.check_conserved(result)
    done = Run(made, plan, result, skin.summarize(result), received, checks)
    if out is not None:
        done.write(out)
    return done


def resolve(
    scenario: Source, seed: int | None = None, overrides: Iterable[str] | Mapping[str, Any] = ()
) -> Scenario:
    """The scenario meant by a file, a bundled name, tables or a Scenario, with overrides.

    Raises:
        ScenarioError: it is not valid.
    """
    changes: list[str | tuple[str, Any]] = (
        list(overrides.items()) if isinstance(overrides, Mapping) else list(overrides)
    )
    if isinstance(scenario, dict):
        return scenarios.from_dict(scenario, changes, seed)
    if not isinstance(scenario, Scenario):
        return scenarios.load(scenario, changes, seed)
    if seed is None and not changes:
        return scenario
    text, source = scenarios.dump(scenario), scenario.source
    return scenarios.loads(text, changes, seed, source.path, source.folder)


def _samples(plan: Plan) -> int:
    """About how many samples all cells take."""
    if plan.data_period_us == 0:
        return 0
    return plan.graph.cells * (plan.duration_us // plan.data_period_us + 1)
