"""run(scenario) -> Run: simulate a scenario, sum it up, write its folder."""

from __future__ import annotations

import os
from collections.abc import Callable
from dataclasses import dataclass, field
from functools import cached_property
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypedDict, Unpack

from innervate import scenario as scenarios
from innervate.folders import for_plain
from innervate.network import networks
from innervate.running import folder as folders
from innervate.running.errors import RunError
from innervate.running.options import refuse_others, takes
from innervate.running.showing import Bar
from innervate.scenario import Scenario
from innervate.scenario.given import Changes, Given, load
from innervate.trace import tables
from innervate.trace.provenance import provenance

if TYPE_CHECKING:
    import polars

    from innervate.networks.typed import Summaries, Summary
else:
    Summaries = object

Progress = Callable[[int, int], None]


class How(TypedDict, total=False):
    """How a plan is simulated, and what is kept of it.

    Attributes:
        checks: invariant checkers on, as they are if nothing is said.
        received: keep every sample that a skin's PC received; None = unless there are very many.
        plain: run uncompiled, slow; a protocol may call `print` and `breakpoint`.
    """

    checks: bool
    received: bool | None
    plain: bool


USUAL: How = {"checks": True, "received": None, "plain": False}


@dataclass(eq=False, repr=False)
class Run(Summaries):
    """A scenario that was run; `run.skin`, `run.radio`, ... are its summary, with known keys.

    Attributes:
        scenario: as resolved.
        plan: its whole numbers.
        result: the simulation's rows and its world at the end.
        summary: what a person wants to know.
        checks: the invariant checkers were on.
    """

    scenario: Scenario
    plan: Any
    result: Any
    summary: Summary
    checks: bool = True
    written: Path | None = field(default=None)

    def __repr__(self) -> str:
        """Short: what ran, and its fingerprint."""
        return f"Run({self.scenario.name!r}, seed={self.plan.seed}, {self.result.fingerprint})"

    if not TYPE_CHECKING:  # or every name would do, misspelt ones too

        def __getattr__(self, name: str) -> Any:
            """The summary by its network's name, so that type checkers know its keys."""
            if name.startswith("_") or name in type(self).__dict__ or "summary" not in vars(self):
                raise AttributeError(name)
            own = networks()[self.summary["kind"]].summary_name(self.summary)
            if name == own:
                return self.summary
            raise AttributeError(f"this run has no summary {name!r}; run.{own} is its summary")

    @cached_property
    def tables(self) -> dict[str, polars.LazyFrame]:
        """The run's tables by name; the network's `tables` says what stands in them."""
        room = networks()[self.plan.kind].run
        return {
            table.name: tables.frame(table, room.columns(table, self.result)).lazy()
            for table in room.tables_of(self.result)
        }

    @property
    def nodes(self) -> Any:
        """The nodes' states at the end, from node 0 on: their fields are attributes.

        Raises:
            RunError: a network of the toolkit's own that keeps them otherwise: see `result.world`.
        """
        if not hasattr(self.result, "counts"):
            raise RunError(f"a run of {self.plan.kind} has no nodes; see run.result.world")
        from innervate.analysis.summary import nodes_of  # who runs nothing needs no NumPy

        return nodes_of(self.result)

    def numpy(self, table: str) -> dict[str, Any]:
        """A table as NumPy arrays by the names of its columns.

        Raises:
            RunError: no table of that name.
        """
        return tables.arrays(self._table(table).collect())

    def pandas(self, table: str) -> Any:
        """A table as a pandas data frame; needs pandas.

        Raises:
            RunError: no table of that name.
        """
        return tables.to_pandas(self._table(table).collect())

    def _table(self, name: str) -> polars.LazyFrame:
        if name not in self.tables:
            raise RunError(f"there is no table {name[:40]!r}; there are {', '.join(self.tables)}")
        return self.tables[name]

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
        return bool(self.result.interrupted)

    def received_image(self, time_s: float, **window: float) -> Any:
        """Where nodes feel: force and proximity per node as they were received at a time, s."""
        return networks()[self.plan.kind].received_image(self.result, time_s, **window)

    def _repr_html_(self) -> str:
        """In a notebook: the headline, the figures to know, and a picture."""
        shown: str = import_module("innervate.plot.notebook").render(self.result, self.summary)
        return shown

    def plot(self, figure: str = "", **options: Any) -> Any:
        """A matplotlib figure of the run; the error of one that is none says which there are."""
        return import_module("innervate.plot.figures").draw(self, figure, **options)

    def report(self) -> str:
        """The run's report, one page of HTML."""
        page: str = import_module("innervate.plot.report").render(self)
        return page

    def write(self, folder: str | os.PathLike[str] | None = None, report: bool = True) -> Path:
        """Write the run folder, whole or not at all; the default is `runs/NAME-SEED`,
        or `runs/NAME-SEED-2`, ... where a run of other settings is.

        Raises:
            RunError: the folder holds something else or cannot be written.
        """
        if folder is None:
            folder = folders.free_folder(self.scenario)
        with folders.replacing(folder) as fresh:
            text = scenarios.dump(self.scenario)
            (fresh / folders.SCENARIO).write_text(text, encoding="utf-8")
            room = networks()[self.plan.kind].run
            for table in room.written_of(self.result):
                tables.write(table, room.columns(table, self.result), fresh)
            if report:
                (fresh / folders.REPORT).write_text(self.report(), encoding="utf-8")
            folders.write_json(fresh / folders.SUMMARY, self.summary)
            origin = self.provenance | {"tables_sha256": folders.digests(fresh)}
            folders.write_json(fresh / folders.PROVENANCE, origin)
        self.written = Path(folder)
        return self.written


@takes(How, USUAL)
def run(
    scenario: Given,
    *,
    seed: int | None = None,
    overrides: Changes = (),
    out: str | os.PathLike[str] | None = None,
    progress: Progress | None = None,
    **how: Unpack[How],
) -> Run:
    """Run a scenario.

    Args:
        scenario: a file, a bundled name, a Skin, Radio, Mesh ..., tables as in a file, a Scenario.
        seed: in place of the scenario's.
        overrides: "a.b=c" texts, or a mapping from dotted keys to values.
        out: folder to write; nothing is written without one (see Run.write).
        progress: called now and then with (time_us, duration_us); None = a bar in a notebook.
        how: `checks`, `received`, `plain`: how it is simulated, and what is kept (see How).

    Raises:
        TypeError: no argument of that name.
        ScenarioError: the scenario is not valid.
        RunError: `out` cannot be written; found out before the simulation.
        InvariantBroken: a checker found what must not happen, as frames that went nowhere.
    """
    refuse_others("run", how, How.__annotations__)
    usual: How = {**USUAL, **how}
    with for_plain(usual["plain"]):
        plan = scenarios.plan(made := load(scenario, seed=seed, overrides=overrides))
    if out is not None:
        folders.check_target(out)
    room = networks()[plan.kind].run
    with Bar() as bar:
        result = room.simulate(plan, **usual, progress=progress or bar.simulated)
    done = Run(made, plan, result, room.summarize(result), usual["checks"])
    if out is not None:
        done.write(out)
    return done
