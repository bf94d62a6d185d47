"""The tables of a sweep: results, timings, figures of every point; same runs, same bytes.

`results` has nothing in it of machines, clocks and order of work; all that is in `timings`.
"""

from __future__ import annotations

import io
import json
import os
from collections import Counter
from collections.abc import Iterable, Iterator, Sequence
from itertools import accumulate
from pathlib import Path
from typing import TYPE_CHECKING, Any

from innervate.analysis.intervals import mean_interval, quantile
from innervate.analysis.summary import COUNTED
from innervate.sweeping.jobs import Jobs
from innervate.sweeping.plan import Point, SweepPlan

if TYPE_CHECKING:
    import polars

RESULTS = "results.parquet"
TIMINGS = "timings.parquet"
POINTS = "points.parquet"
FIRST = ("point", "repeat", "seed")
AFTER = ("status", "reason", "command")
Columns = dict[str, list[Any]]


def results(plan: SweepPlan, jobs: Jobs, repeats: Sequence[int]) -> polars.DataFrame:
    """One row for every run, by point and repeat.

    `repeats`: how many runs of every point belong to it; those that are missing are left out.
    """
    aside = (*FIRST, *plan.keys, *AFTER)
    columns = _columns(_rows(plan, jobs, repeats), aside)
    _count_none(columns)
    never = [name for name, values in columns.items()
             if name not in aside and all(value is None for value in values)]  # fmt: skip
    return _frame(columns, never)


def _rows(plan: SweepPlan, jobs: Jobs, repeats: Sequence[int]) -> Iterator[dict[str, Any]]:
    for point, count in zip(plan.points, repeats, strict=True):
        for repeat, run in jobs.each(point.digest, count):
            head = {"point": point.index, "repeat": repeat, "seed": run.seed} | point.columns
            tail = {
                "status": "failed" if run.figures is None else "done",
                "reason": run.reason,
                "command": plan.base.command(point.settings, run.seed),
            }
            figures = {k: v for k, v in (run.figures or {}).items() if k not in head}
            yield head | tail | figures


def _count_none(columns: Columns) -> None:
    """Put 0 where a run has no count since there was nothing to count, lest means leave it out.

    So it is with an empty list of tables, and with what the summary of any network counts by
    reason: it names only what happened.
    """
    of_any = columns.get("frames.lost", ())
    for name, values in columns.items():
        if name.startswith(tuple(f"{counts}." for counts in COUNTED)):
            known = [lost is not None for lost in of_any]
        elif name.endswith(".count"):
            known = [text == "[]" for text in columns.get(name.removesuffix(".count"), ())]
        else:
            continue
        for i in (i for i, there in enumerate(known) if there and values[i] is None):
            values[i] = 0


def timings(plan: SweepPlan, jobs: Jobs, repeats: Sequence[int]) -> polars.DataFrame:
    """How long every run took, when it began, and where it was."""
    places = jobs.places()
    rows = (
        {"point": point.index, "repeat": repeat, "wall_s": run.wall_s, "began_s": run.began_s}
        | places.get(run.place, {})
        for point, count in zip(plan.points, repeats, strict=True)
        for repeat, run in jobs.each(point.digest, count)
    )
    return frame(rows, ("point", "repeat", "wall_s", "began_s"))


def frame(
    rows: Iterable[dict[str, Any]], first: Iterable[str] = (), numbers: Sequence[str] = ()
) -> polars.DataFrame:
    """A frame of rows that need not have the same keys: null where one is missing.

    Columns stand in the order of `first`, then in the order in which rows bring them. A column of
    whole numbers is Int64, of numbers Float64, of truths Boolean, else String; those of `numbers`
    are Float64 even if there is no value in them.
    """
    return _frame(_columns(rows, first), numbers)


def _columns(rows: Iterable[dict[str, Any]], first: Iterable[str]) -> Columns:
    """Rows by column: a sweep may have millions, whose keys take more room than their values."""
    columns: Columns = {name: [] for name in first}
    count = 0
    for count, row in enumerate(rows, 1):
        for name, value in row.items():
            values = columns.setdefault(name, [])
            values += [None] * (count - 1 - len(values))
            values.append(value)
    for values in columns.values():
        values += [None] * (count - len(values))
    return columns


def _frame(columns: Columns, numbers: Sequence[str]) -> polars.DataFrame:
    import polars

    made = polars.DataFrame([_series(name, values) for name, values in columns.items()])
    return made.with_columns(polars.col(*numbers).cast(polars.Float64)) if numbers else made


def _series(name: str, values: list[Any]) -> polars.Series:
    import polars

    kinds = {type(value) for value in values if value is not None}
    if kinds and kinds <= {bool}:
        return polars.Series(name, values, polars.Boolean)
    if kinds and kinds <= {int}:
        return polars.Series(name, values, polars.Int64)
    if kinds and kinds <= {int, float}:
        numbers = [None if value is None else float(value) for value in values]
        return polars.Series(name, numbers, polars.Float64)
    texts = [
        value if value is None or type(value) is str else json.dumps(value) for value in values
    ]
    return polars.Series(name, texts, polars.String)


def measures(table: polars.DataFrame, keys: Iterable[str]) -> list[str]:
    """The columns of the results that hold figures, in order."""
    import polars

    aside = {*FIRST, *AFTER, *keys}
    numbers = (polars.Int64, polars.Float64)
    return [name for name, kind in table.schema.items() if kind in numbers and name not in aside]


def points(
    table: polars.DataFrame, plan_points: Sequence[Point], wanted: Sequence[str], level: float
) -> polars.DataFrame:
    """For every point and measure of the results: runs with a value, mean, interval of a level,
    quantiles, extremes.
    """
    keys = plan_points[0].columns if plan_points else ()
    rows = _of_points(table, plan_points, wanted, level)
    figures = tuple(_figures([], level))
    return frame(rows, ("point", *keys, "measure", "runs", *figures), figures)


def _of_points(
    table: polars.DataFrame, plan_points: Sequence[Point], wanted: Sequence[str], level: float
) -> Iterator[dict[str, Any]]:
    ordered = table.sort("point", maintain_order=True)
    counts = Counter(ordered["point"].to_list())
    behind = dict(zip(counts, accumulate(counts.values()), strict=True))
    for point in plan_points:  # slices: a frame for each point would take more room than the runs
        count = counts[point.index]
        mine = ordered.slice(behind.get(point.index, 0) - count, count).to_dict(as_series=False)
        for name in wanted:
            values = [value for value in mine[name] if value is not None]
            head = {"point": point.index, **point.columns, "measure": name, "runs": len(values)}
            yield head | _figures(values, level)


def _figures(values: list[float], level: float) -> dict[str, float | None]:
    names = ("mean", "low", "high", "min", "p05", "p50", "p95", "max")
    if not values:
        return dict.fromkeys(names)
    found = mean_interval(values, level)
    quantiles = (quantile(values, share) for share in (0.0, 0.05, 0.5, 0.95, 1.0))
    return dict(zip(names, (*map(float, found), *map(float, quantiles)), strict=True))


def reasons(failed: polars.DataFrame) -> dict[str, int]:
    """Why runs failed, and how often, most often first."""
    counts = Counter(failed["reason"].to_list())
    return dict(sorted(counts.items(), key=lambda pair: -pair[1]))


def write(table: polars.DataFrame, path: Path) -> None:
    """Write a table as Parquet, whole or not at all (OSError)."""
    packed = io.BytesIO()  # written by ourselves, a full disk is an OSError that says so
    table.write_parquet(packed, compression="zstd", statistics=True, row_group_size=1 << 16)
    write_bytes(bytes(packed.getbuffer()), path)


def write_bytes(content: bytes, path: Path) -> None:
    """Put a file in the place of an older one, whole or not at all (OSError)."""
    fresh = path.with_name(f".{path.name}.part")
    try:
        fresh.write_bytes(content)
        os.replace(fresh, path)
    finally:
        fresh.unlink(missing_ok=True)
