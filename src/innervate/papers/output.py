"""A paper's outputs besides its figures: the table as CSV and Markdown, one page with all of it."""

from __future__ import annotations

import base64
import csv
import io
import platform
from collections.abc import Mapping, Sequence
from dataclasses import astuple, dataclass, fields
from importlib import metadata
from pathlib import Path

import innervate
from innervate.papers.experiment import FAILS, HOLDS, Claim, Experiment
from innervate.plot import page
from innervate.plot.svg import clean
from innervate.trace.provenance import checkout

PACKAGES = ("numba", "numpy", "matplotlib")
_LAYOUT = (
    "<style>figure img{display:block;max-width:100%;height:auto;background:#fff;border-radius:6px;"
    "padding:8px;margin:.5em 0}figure{margin:1.6em 0}.claims td{min-width:14em;white-space:normal}"
    ".claims td:nth-child(3){min-width:7em}"
    ".good{color:var(--good)}.bad{color:var(--alarm)}</style>"
)


@dataclass(frozen=True, slots=True)
class Heading:
    """What the outputs are of.

    Attributes:
        stamp: hash of the sources the results depend on.
        redraw: results of other sources were allowed.
        command: the line that does it again.
    """

    system: str
    title: str
    authors: str
    quick: bool
    stamp: str
    redraw: bool
    command: str


def write(
    folder: Path,
    heading: Heading,
    experiments: Sequence[Experiment],
    claims: Mapping[str, Sequence[Claim]],
    wall_s: float,
) -> Path:
    """Write papers-<system>.csv, .md and .html; the path of the page."""
    name = f"papers-{heading.system}"
    rows = [claim for experiment in experiments for claim in claims[experiment.name]]
    origin = provenance(heading, wall_s)
    _put(folder / f"{name}.csv", as_csv(rows))
    _put(folder / f"{name}.md", as_markdown(heading, rows, origin))
    path = folder / f"{name}.html"
    _put(path, as_page(folder, heading, experiments, claims, origin))
    return path


def provenance(heading: Heading, wall_s: float) -> dict[str, str]:
    """Where the numbers come from."""
    commit, modified = checkout()
    if commit is not None:
        commit += " with changes" if modified else ""
    versions = [f"{name} {metadata.version(name)}" for name in PACKAGES]
    return {
        "innervate": innervate.__version__,
        "commit": commit or "unknown",
        "sources": heading.stamp + (" or others (redrawn)" if heading.redraw else ""),
        "seeds": "1 and following; each claim names how many runs",
        "settings": "quick: few seeds" if heading.quick else "full",
        "with": ", ".join([f"Python {platform.python_version()}", *versions]),
        "time": f"{wall_s:.0f} s",
    }


def as_csv(rows: Sequence[Claim]) -> str:
    """The table for other programs."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow([field.name for field in fields(Claim)])
    writer.writerows(astuple(row) for row in rows)
    return text.getvalue()


def as_markdown(heading: Heading, rows: Sequence[Claim], origin: Mapping[str, str]) -> str:
    """The table for people, with where it comes from."""
    names = [field.name for field in fields(Claim)]
    lines = [
        f"# {heading.title}",
        "",
        summary(rows),
        "",
        "| " + " | ".join(names) + " |",
        "|" + "---|" * len(names),
        *("| " + " | ".join(_cell(value) for value in astuple(row)) + " |" for row in rows),
        "",
        f"    {heading.command}",
        "",
        *(f"- {key}: {value}" for key, value in origin.items()),
    ]
    return "\n".join(lines) + "\n"


def _cell(text: str) -> str:
    return text.replace("|", "\\|").replace("*", "\\*").replace("\n", " ")


def summary(rows: Sequence[Claim]) -> str:
    """How many claims came out how."""
    plain = sum(row.verdict == HOLDS for row in rows)
    fails = sum(row.verdict == FAILS for row in rows)
    read = len(rows) - plain - fails
    return (
        f"{len(rows)} claims: {plain} hold, {read} hold with a reading of ours, "
        f"{fails} do not hold."
    )


def as_page(
    folder: Path,
    heading: Heading,
    experiments: Sequence[Experiment],
    claims: Mapping[str, Sequence[Claim]],
    origin: Mapping[str, str],
) -> str:
    """One self-contained page: every figure with its claims, all of it in one file."""
    rows = [claim for experiment in experiments for claim in claims[experiment.name]]
    parts = [
        _LAYOUT,
        page.element("p", f"{heading.authors}, redrawn by innervate", "over"),
        page.element("h1", heading.title),
        page.element("p", summary(rows)),
    ]
    for experiment in experiments:
        image = (folder / f"{experiment.name}.svg").read_bytes()
        coded = base64.b64encode(image).decode()
        inside = (
            f'<figure><img alt="{clean(experiment.title)}" '
            f'src="data:image/svg+xml;base64,{coded}">\n'
            + page.element("figcaption", experiment.caption)
            + "</figure>\n"
            + _table(claims[experiment.name])
            + _simulated(experiment, heading.quick)
        )
        parts.append(page.section(experiment.title, inside))
    origin_rows = [[clean(key), clean(value)] for key, value in origin.items()]
    again = page.element("pre", heading.command, "command")
    parts.append(page.section("Run it again", again + page.table(("", ""), origin_rows)))
    return page.page(f"innervate: papers {heading.system}", "\n".join(parts))


def _simulated(experiment: Experiment, quick: bool) -> str:
    """The scenarios of a figure: what each set of runs differs by, and its seeds."""
    keys = [point.key for point in experiment.points(quick)]
    head = f"What was simulated: {len(keys)} sets of runs, by their settings"
    return page.details(head, page.element("pre", "\n".join(keys)))


def _table(rows: Sequence[Claim]) -> str:
    cells = [
        [
            clean(row.claim),
            clean(row.measurement),
            f'<b class="{"bad" if row.verdict == FAILS else "good"}">{clean(row.verdict)}</b>',
            clean(row.reason),
        ]
        for row in rows
    ]
    return page.table(("claim", "measured", "verdict", "why"), cells, "claims")


def _put(path: Path, text: str) -> None:
    """Whole or not at all."""
    fresh = path.with_name(path.name + ".part")
    fresh.write_text(text, encoding="utf-8")
    fresh.replace(path)
