"""`innervate sweep`: many runs of a scenario with settings varied."""

from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

from cyclopts import Parameter

from innervate.cli import errors
from innervate.cli.live_table import LiveTable
from innervate.cli.options import SweepOptions
from innervate.kernel.words import number_of, without_middle

if TYPE_CHECKING:
    from innervate.sweeping import Sweep, SweepPlan

POINTS_MAX = 40
CELL_MAX = 40  # letters of a setting
TORN_MAX = 5


def sweep(
    file: str, /, *, options: Annotated[SweepOptions, Parameter(name="*")] = SweepOptions()
) -> int:
    """Run a sweep behind a live table; say what came of it.

    Args:
        file: A scenario file, the name of a bundled one, or a plan file (see: innervate docs
            sweeps).
        options: What is varied, how often it runs, and where.
    """
    from innervate import sweeping as room
    from innervate.running.folder import plain_name
    from innervate.sweeping.result import SHOWN

    plan: SweepPlan = room.make_plan(file, **options.planned)
    folder = options.out or Path("sweeps") / (plain_name(plan.name) or "sweep")
    wanted = tuple(dict.fromkeys([*options.shown, *(rule.measure for rule in plan.until)]))
    follow = wanted or SHOWN
    with LiveTable(plan.name, follow, folder, options.json) as table:
        done = room.sweep(plan, out=folder, **options.how, show=options.shown, follow=follow,
                          progress=table)  # fmt: skip
    _say_torn(done, folder)
    drawn = draw_plots(done, folder)
    if options.json:
        told = {"folder": str(folder), "drawn": [str(path) for path in drawn]}
        told |= record(done, wanted)
        print(json.dumps(told, indent=2, ensure_ascii=False, allow_nan=False))
    else:
        for line in result_lines(done, wanted):
            print(line)
        for path in drawn:
            print(f"Drawn: {path}")
        print(f"Written: {folder / 'report.html'}")
    if done.others:
        kept = number_of(done.others, "other run")
        errors.say(f"{folder} keeps {kept}, too, which these tables do not show; whoever asks for "
                   "them again has them at once (--out: another folder)")  # fmt: skip
    undrawn = len(drawn) < len(done.plan.plots)
    return int(undrawn or done.failed.height == done.results.height > 0)


def _say_torn(done: Sweep, folder: Path) -> None:
    """What the job table had lost; of much, the first of it."""
    if done.torn:
        more = f"; ... and {len(done.torn) - TORN_MAX} more" if len(done.torn) > TORN_MAX else ""
        errors.say(f"{folder / 'jobs.sqlite'} had damaged rows: "
                   f"{'; '.join(done.torn[:TORN_MAX])}{more}")  # fmt: skip


def draw_plots(done: Sweep, folder: Path) -> list[Path]:
    """Draw the figures that the plan asks for, into its folder; the PNGs' paths."""
    if not done.plan.plots:
        return []
    from innervate.plot import style
    from innervate.sweeping import SweepError

    paths = []
    for plot in done.plan.plots:
        with style.house():
            try:
                drawn = done.plot(plot.x, plot.y, plot.by, plot.kind, plot.title)
            except SweepError as error:  # no run has what it shows; all else is there
                errors.say(f"{plot.name} is not drawn: {error}")
                continue
            over = done.averaged(plot.x, plot.by) if plot.x in done.plan.keys else {}
            if over:
                keys = ", ".join(over)
                errors.say(f"{plot.name}: means over all values of {keys}; to tell them apart, "
                           "name one as by, or fix the others with --set")  # fmt: skip
            paths.append(style.save(drawn, folder, plot.name)[0])
    return paths


def result_lines(done: Sweep, wanted: tuple[str, ...] = ()) -> list[str]:
    """The means of every point in columns, and what failed."""
    from innervate.sweeping import words

    shown = done.to_show(wanted)
    heads = [*done.plan.keys, "runs", *shown]
    rows = [heads]
    there = [name for name in shown if name in done.results.columns]  # others never happened
    table = done.points(there).iter_rows(named=True) if there else ()
    figures = {(row["point"], row["measure"]): row for row in table}
    counts = dict(done.results.group_by("point").len().iter_rows())
    for point in done.plan.points[:POINTS_MAX]:
        cells = [_cell(value) for value in point.columns.values()]
        count = counts.get(point.index, 0)
        means = [words.mean_words(figures.get((point.index, name)), count) for name in shown]
        rows.append([*cells, str(count), *means])
    widths = [max(len(row[i]) for row in rows) for i in range(len(heads))]
    lines = ["  ".join(f"{c:>{w}}" for c, w in zip(row, widths, strict=True)) for row in rows]
    more = len(done.plan.points) - POINTS_MAX
    if more > 0:
        lines.append(f"... and {more} more points")
    return lines + words.never_lines(done) + words.headline_lines(done) + words.failed_lines(done)


def record(done: Sweep, wanted: tuple[str, ...] = ()) -> dict[str, Any]:
    """What a sweep came to, for programs: of every point its settings, runs, and figures.

    Figures are those wanted, or all; each with its mean, the interval's ends, and of how many runs.
    """
    from innervate.sweeping import words
    from innervate.sweeping.tables import reasons

    points: list[dict[str, Any]] = [
        {"point": one.index, "settings": one.columns, "runs": 0, "figures": {}}
        for one in done.plan.points
    ]
    for index, runs in done.results.group_by("point").len().iter_rows():
        points[index]["runs"] = runs
    there = [name for name in wanted or done.measures if name in done.measures]
    for row in done.points(there).iter_rows(named=True) if there else ():
        figures = {key: row[key] for key in ("runs", "mean", "low", "high")}
        points[row["point"]]["figures"][row["measure"]] = figures
    return {
        "name": done.plan.name, "complete": done.complete, "runs": done.results.height,
        "failed": reasons(done.failed),
        "headlines": words.levels(done), "points": points,
    }  # fmt: skip


def _cell(value: Any) -> str:
    """A setting as in a file; a long one without its middle."""
    from innervate.sweeping.vary import shown

    return without_middle(shown(value), CELL_MAX)
