"""A sweep's page: one HTML file with its headline, means as pictures and as a table, its runs."""

from collections import Counter
from collections.abc import Mapping, Sequence
from html import escape
from typing import Any, NamedTuple

import polars

from innervate.analysis.headline import DEGRADED, DOWN, NO_DATA, OK, part_of
from innervate.analysis.intervals import mean_interval
from innervate.kernel.words import number_of, without_middle
from innervate.plot import charts, means, notebook, page, report
from innervate.plot.svg import clean
from innervate.plot.words import averages, label
from innervate.sweeping import tables
from innervate.sweeping.planfile import dump
from innervate.sweeping.result import LEVEL, Sweep
from innervate.sweeping.vary import shown
from innervate.sweeping.words import headline, mean_words, never_lines

VALUES_MAX = 12  # of a key that are named
STYLE = "h3:not(figure h3){margin-top:1.4em}pre.command{margin:.4em 0;white-space:pre-wrap}"
FAILED = "failed"
WORST = (FAILED, DOWN, NO_DATA, DEGRADED)
GROUPS_OPEN, GROUPS_MAX = 5, 40  # of runs that are not well, by their points
NAME_LETTERS = 30
PLAN_LETTERS = 40_000


class Axes(NamedTuple):
    """What goes to the right in a sweep's pictures ("" = nothing), and what tells lines apart."""

    x: str
    by: tuple[str, ...]


def render(done: Sweep, wanted: Sequence[str] = ()) -> str:
    """The page of a sweep, as HTML; pictures are of what was asked for, or of a few figures."""
    measures = _shown(done, wanted)
    body = page.joined(
        f"<style>{means.STYLE}{STYLE}</style>",
        _top(done),
        page.section("Figures", _pictures(done, measures)),
        page.section("Every point", _points(done, measures)),
        page.section("Runs that are not well", _not_well(done)),
        page.section("What was run", _varied(done)),
        page.section("Run it again", _again(done)),
    )
    return page.page(f"{done.plan.name} · innervate", body)


def in_cell(done: Sweep) -> str:
    """A sweep in a cell of a notebook: its headline, its pictures, its points."""
    measures = _shown(done, ())
    inside = page.joined(_top(done), _pictures(done, measures), _points(done, measures))
    return notebook.framed(inside, means.STYLE)


def _shown(done: Sweep, wanted: Sequence[str]) -> list[str]:
    return [one for one in done.to_show(wanted) if one in done.measures]


def _top(done: Sweep) -> str:
    plan = done.plan
    counted = f"{number_of(len(plan.points), 'point')}, {number_of(done.results.height, 'run')}"
    over = f"Sweep {plan.name}: {counted}, root seed {plan.root}"
    notes = page.paragraphs(never_lines(done), "note")
    return page.top(over, {"headline": headline(done)}, notes)


def axes(done: Sweep) -> Axes:
    """The number with the most values goes to the right; of other keys lines are told apart by
    those, from the first on, that make few enough lines. Over the rest means are taken.
    """
    many = {key: len(_values(done, (key,))) for key in done.plan.keys}
    numbers = [key for key in done.plan.keys if many[key] > 1 and _is_number(done, key)]
    x = max(numbers, key=lambda key: many[key], default="")
    by: tuple[str, ...] = ()
    for key in done.averaged(x) if x else ():
        if len(_values(done, (*by, key))) <= means.LINES_MAX or not by:
            by = (*by, key)
    return Axes(x, by)


def _values(done: Sweep, keys: tuple[str, ...]) -> list[tuple[Any, ...]]:
    """What points have of some keys, each once, in the order of the plan."""
    return list(dict.fromkeys(tuple(p.columns[key] for key in keys) for p in done.plan.points))


def _is_number(done: Sweep, key: str) -> bool:
    kinds = {type(point.columns[key]) for point in done.plan.points}
    return kinds <= {int, float}


def _varied(done: Sweep) -> str:
    """What was varied and how, and what was the same for all."""
    plan = done.plan
    rows = []
    for key in plan.keys:
        values = list(dict.fromkeys(shown(point.columns[key]) for point in plan.points))
        more = f" and {len(values) - VALUES_MAX:,} more" if len(values) > VALUES_MAX else ""
        rows.append((escape(key), clean(", ".join(map(_short, values[:VALUES_MAX])) + more)))
    rows += [(escape(key), f"{clean(_short(shown(value)))} in every run")
             for key, value in plan.base.settings]  # fmt: skip
    often = f"{plan.repeat:,}" if not plan.until else (
        f"until {', '.join(map(str, plan.until))}, at most {plan.repeat:,}")  # fmt: skip
    rows.append(("runs of a point", clean(often)))
    if plan.paired:
        rows.append(("on the same seeds", clean(", ".join(plan.paired))))
    return page.table(("key", "values"), rows, "summary")


def _pictures(done: Sweep, measures: Sequence[str]) -> str:
    """A picture for each measure that some run has a value of."""
    found = {name: done.results.filter(_known(name)) for name in measures}
    found = {name: table for name, table in found.items() if table.height}
    if len(done.plan.points) == 1:
        return page.pictures(map(page.panel, map(_spread, found, found.values())), "two")
    chosen = axes(done)
    drawn = [_picture(done, name, table, chosen) for name, table in found.items()]
    return _legend(done, chosen) + page.pictures(drawn, "two")


def _known(name: str) -> polars.Expr:
    """Whether a run has a value of a measure."""
    return polars.col(name).is_not_null() & polars.col(name).is_finite()


def _spread(name: str, table: polars.DataFrame) -> charts.Steps:
    """Of one point: how a figure is spread over its runs."""
    values = table[name].sort().to_numpy()
    low, high = min(0.0, float(values[0])), float(values[-1])
    x = charts.Axis(low, high + 0.05 * (high - low) or 1.0, label(name))
    text = f"Share of the runs in % with at most so much; of {number_of(len(values), 'run')}."
    return charts.distribution(values, x, label(name), text)


def _picture(done: Sweep, name: str, table: polars.DataFrame, chosen: Axes) -> str:
    notes = []
    if table.height < done.results.height:
        notes.append(f"{part_of(table.height, done.results.height, 'run')} have a value")
    if chosen.x:
        over = done.averaged(chosen.x, *chosen.by)
        notes += [averages(over, done.results["point"].to_list())] if over else []
        drawing = means.over(_lines(done, name, table, chosen), label(chosen.x), label(name))
    else:
        kept = _rows(done, name, table)
        more = len(done.plan.points) - means.ROWS_MAX
        notes += [f"the first {means.ROWS_MAX} of {len(done.plan.points)} points"] * (more > 0)
        drawing = means.rows(kept, label(name))
    notes.append("95 % intervals of the means")
    text = "; ".join(notes)
    return page.figure(drawing, label(name), f"{text[0].upper()}{text[1:]}.")


def _lines(done: Sweep, name: str, table: polars.DataFrame, chosen: Axes) -> list[means.Line]:
    """A line for each of the first values of `by`; one without means where no run has any."""
    runs = _by_point(name, table)
    lines = []
    for values in _values(done, chosen.by)[: means.LINES_MAX]:
        called = _called_line(chosen.by, values)
        groups: dict[float, list[float]] = {}
        for point in done.plan.points:
            if tuple(point.columns[key] for key in chosen.by) == values and point.index in runs:
                groups.setdefault(point.columns[chosen.x], []).extend(runs[point.index])
        lines.append(means.Line(called, [
            _mean(float(at), groups[at], f"{chosen.x} {shown(at)}{called and ', '}{called}")
            for at in sorted(groups)
        ]))  # fmt: skip
    return lines


def _by_point(name: str, table: polars.DataFrame) -> dict[int, list[float]]:
    return dict(table.group_by("point").agg(polars.col(name)).iter_rows())


def _called_line(keys: tuple[str, ...], values: tuple[Any, ...]) -> str:
    pairs = zip(keys, values, strict=True)
    return ", ".join(f"{key} {_short(shown(value))}" for key, value in pairs)


def _rows(done: Sweep, name: str, table: polars.DataFrame) -> list[tuple[str, means.Mean]]:
    """A row for each of the first points with a value."""
    groups = _by_point(name, table)
    return [
        (_called(point.columns), _mean(0.0, groups[point.index], point.label))
        for point in done.plan.points[: means.ROWS_MAX] if point.index in groups
    ]  # fmt: skip


def _mean(at: float, values: Sequence[float], where: str) -> means.Mean:
    found = mean_interval(values)
    row = {"runs": len(values), "mean": found.value, "low": found.low, "high": found.high}
    told = _mean_words(row, 0)
    return means.Mean(at, found, told, f"{where}: {told}, {number_of(len(values), 'run')}")


def _mean_words(row: dict[str, Any] | None, count: int) -> str:
    return mean_words(row, count).replace("+-", "±")


def _legend(done: Sweep, chosen: Axes) -> str:
    if not chosen.by:
        return ""
    values = _values(done, chosen.by)
    drawn = values[: means.LINES_MAX]
    keys = page.keys([(means.swatch(i), _called_line(chosen.by, one))
                      for i, one in enumerate(drawn)])  # fmt: skip
    note = f"The first {len(drawn)} of {len(values)} values of {', '.join(chosen.by)}."
    return keys + (page.element("p", note, "note") if len(values) > len(drawn) else "")


def _points(done: Sweep, measures: Sequence[str]) -> str:
    """The table of the points, as the command shows it, with what their runs came to."""
    head = [*map(escape, done.plan.keys), "runs", "headlines", *map(escape, map(label, measures))]
    points = done.plan.points[: page.ROWS_MAX]
    table = tables.points(done.results, points, measures, LEVEL)
    figures = {(row["point"], row["measure"]): row for row in table.iter_rows(named=True)}
    came = _came(done)
    rows = []
    for point in points:
        runs = came.get(point.index, Counter())
        told = [_mean_words(figures.get((point.index, name)), runs.total()) for name in measures]
        levels = ", ".join(f"{count:,} {level}" for level, count in runs.most_common())
        cells = [_short(shown(value)) for value in point.columns.values()]
        rows.append([*map(clean, cells), f"{runs.total():,}", levels or "none", *told])
    more = len(done.plan.points) - page.ROWS_MAX
    note = f"And {more:,} more, in points.parquet." if more > 0 else ""
    return page.table(head, rows) + (page.element("p", note, "note") if note else "")


def _came(done: Sweep) -> dict[int, Counter[str]]:
    """How many runs of each point came to which level, or failed."""
    found: dict[int, Counter[str]] = {}
    counts = _levels(done).group_by("point", "level", maintain_order=True).len()
    for point, level, count in counts.iter_rows():
        found.setdefault(point, Counter())[level] = count
    return found


def _levels(done: Sweep) -> polars.DataFrame:
    """The results with what each run came to as `level`: of its headline, or that it failed."""
    table = done.results
    known = polars.col("headline.level") if "headline.level" in table.columns else polars.lit(None)
    return table.with_columns(level=known.fill_null(FAILED))


def _not_well(done: Sweep) -> str:
    """The points at which runs failed or are not ok, worst first: how many, the first of them."""
    table = _levels(done).filter(polars.col("level") != OK)
    groups = table.group_by("point", "level", maintain_order=True)
    first = groups.agg(polars.len().alias("count"), polars.all().first()).to_dicts()
    first.sort(key=lambda row: WORST.index(row["level"]))
    if not first:
        return ""
    parts = [page.element("p", "Each command runs it again, in this folder.", "note")]
    parts += [_group(done, row) for row in first[:GROUPS_OPEN]]
    rest = [_group(done, row) for row in first[GROUPS_OPEN:GROUPS_MAX]]
    more = len(first) - GROUPS_MAX
    rest += [page.element("p", f"And {more:,} more, in results.parquet.", "note")] * (more > 0)
    parts += [page.details(f"{len(first) - GROUPS_OPEN:,} more", "".join(rest))] * bool(rest)
    return "".join(parts)


def _group(done: Sweep, row: Mapping[str, Any]) -> str:
    """Runs of a point that came to the same: `row` is the first of them, with their `count`."""
    point = done.plan.points[row["point"]]
    where = f"Point {point.index}" + (f", {point.label}" if point.label else "")
    said = row["reason"] if row["level"] == FAILED else row["headline.text"]
    return (
        page.element("h3", f"{where}: {row['count']:,} {row['level']}")
        + page.element("p", f"The first: {said}")
        + page.element("pre", row["command"], "command")
    )


def _again(done: Sweep) -> str:
    rows = [(escape(key), escape(str(value))) for key, value in report.flatten(done.provenance)]
    text = dump(done.plan)
    if len(text) > PLAN_LETTERS:
        text = text[:PLAN_LETTERS] + "\n# ... the rest is in sweep.toml\n"
    return "".join([
        page.element("p", "In the folder of this page:"),
        page.element("pre", "innervate sweep sweep.toml --out again", "command"),
        page.element("p", "results.parquet has a row for every run, points.parquet the mean, its "
                     "interval and quantiles of every figure at every point."),
        page.details("The plan", page.element("pre", text)),
        page.details("Versions", page.table(("what", "value"), rows, "summary")),
    ])  # fmt: skip


def _called(columns: Mapping[str, Any]) -> str:
    """A point in a picture: its settings, without their keys where there is only one."""
    if len(columns) == 1:
        return _short(shown(next(iter(columns.values()))))
    return _short(", ".join(f"{key.rsplit('.')[-1]} {shown(v)}" for key, v in columns.items()))


def _short(text: str) -> str:
    return without_middle(text, NAME_LETTERS)
