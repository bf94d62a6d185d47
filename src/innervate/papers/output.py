"""A paper's outputs besides its figures: the table as CSV and Markdown, one page with all of it."""

import base64
import csv
import io
import platform
import re
from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import astuple, dataclass, field, fields
from importlib import metadata
from pathlib import Path

import innervate
from innervate.papers.errors import PapersError
from innervate.papers.experiment import FAILS, Claim, Experiment, Sheet, summary
from innervate.plot import page
from innervate.plot.svg import clean
from innervate.trace.provenance import checkout

PACKAGES = ("numba", "numpy", "matplotlib")
QUICK = "Of few seeds and settings (--quick): with all of them some verdicts may be others."
_LAYOUT = f"<style>\n{Path(__file__).with_name('output.css').read_text(encoding='utf-8')}</style>"
Sections = Sequence[tuple[Experiment, Sequence[Claim]]]
NARROW_PT = 400  # a figure of one column is not blown up


@dataclass(frozen=True, slots=True)
class Heading:
    """What the outputs are of."""

    system: str
    title: str
    authors: str
    quick: bool
    stamp: str  # hash of the sources the results depend on
    redraw: bool  # results of other sources were allowed
    command: str  # the line that does it again
    # what the labels in claims and reasons mean, a sentence each
    readings: Mapping[str, str] = field(default_factory=dict)


@dataclass(frozen=True, slots=True)
class Made:
    """What came of experiments, by their names."""

    claims: dict[str, list[Claim]] = field(default_factory=dict)
    sheets: dict[str, list[Sheet]] = field(default_factory=dict)

    def tables(self, name: str) -> Sequence[Sheet]:
        """The tables of one experiment."""
        return self.sheets.get(name, ())


def write(
    folder: Path, heading: Heading, experiments: Sequence[Experiment], made: Made, wall_s: float
) -> Path:
    """Write papers-<system>.csv, .md and .html; the path of the page."""
    name = f"papers-{heading.system}"
    rows = [claim for experiment in experiments for claim in made.claims[experiment.name]]
    origin = provenance(heading, wall_s)
    _put(folder / f"{name}.csv", as_csv(rows))
    _put(folder / f"{name}.md", as_markdown(heading, rows, origin))
    for one in experiments:
        if made.tables(one.name):
            _put(folder / f"{heading.system}-{one.name}.md", as_tables(heading, one, made, origin))
    path = page_of(folder, heading.system)
    _put(path, as_page(folder, heading, experiments, made, origin))
    return path


def page_of(folder: Path, system: str) -> Path:
    """Where the page of a book lies."""
    return folder / f"papers-{system}.html"


def shown_on(path: Path, figures: Iterable[str]) -> tuple[bool, list[str]]:
    """Whether a page is a quick one, and which of the figures it has; none if there is no page."""
    text = path.read_text(encoding="utf-8", errors="replace") if path.is_file() else ""
    return QUICK in text, [name for name in figures if f'<section id="{clean(name)}">' in text]


def as_tables(heading: Heading, one: Experiment, made: Made, origin: Mapping[str, str]) -> str:
    """The tables of an experiment and its claims as Markdown, for a page of the documentation."""
    kept = ("seeds", "settings", "with")
    claims = [
        (f"{row.whose}: {row.claim}" if row.source else row.claim, *astuple(row)[2:5])
        for row in made.claims[one.name]
    ]
    sheets = [
        *made.tables(one.name),
        Sheet("What is claimed", ("claim", "measured", "verdict", "why"), claims),
    ]
    quick = " --quick" if heading.quick else ""
    again = f"innervate papers {heading.system}{quick} --only {one.name}"
    said = [f"`{again}`;", *(f"{key}: {origin[key]};" for key in kept)]
    said[-1] = said[-1].removesuffix(";") + "."
    return "\n".join([*said, "", *map(_table_of, sheets)])


def _table_of(sheet: Sheet) -> str:
    lines = [f"**{_cell(sheet.title)}**", "", f"| {' | '.join(sheet.head)} |"]
    lines.append("|" + "---|" * len(sheet.head))
    return "\n".join([*lines, *(f"| {' | '.join(map(_cell, row))} |" for row in sheet.rows), ""])


def insert(page: Path, name: str, text: str) -> None:
    """Put a text between a page's marks of this name; see around()."""
    before, after = around(page, name)
    _put(page, f"{before}\n{text}\n{after}")


def around(page: Path, name: str) -> tuple[str, str]:
    """A page up to its first mark of this name, and from its last one on.

    Raises:
        PapersError: there is no such page, or it has no such marks.
    """
    first, last = f"<!-- {name}: made by innervate papers -->", f"<!-- end of {name} -->"
    try:
        old = page.read_text(encoding="utf-8")
    except OSError as error:
        raise PapersError(f"{page}: {error.strerror or error}; name another page") from None
    before, found, rest = old.partition(first)
    _, end, after = rest.partition(last)
    if not found or not end:
        raise PapersError(f"{page} has no place for {name}; add {first} and {last}, "
                          "or leave out --page")  # fmt: skip
    return f"{before}{first}", f"{end}{after}"


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
    writer.writerow(columns(rows))
    writer.writerows(astuple(row)[: len(columns(rows))] for row in rows)
    return text.getvalue()


def columns(rows: Sequence[Claim]) -> list[str]:
    """Names of a table's columns: without whose claims they are in a book that does not say."""
    names = [field.name for field in fields(Claim)]
    return names if any(row.source for row in rows) else names[:-1]


def as_markdown(heading: Heading, rows: Sequence[Claim], origin: Mapping[str, str]) -> str:
    """The table for people, with where it comes from."""
    names = columns(rows)
    lines = [
        *(f"# {heading.title}", "", summary(rows), ""),
        "| " + " | ".join(names) + " |",
        "|" + "---|" * len(names),
        *(f"| {' | '.join(map(_cell, astuple(row)[: len(names)]))} |" for row in rows),
        "",
        f"    {heading.command}",
        "",
        *(f"- {key}: {value}" for key, value in origin.items()),
    ]
    return "\n".join(lines) + "\n"


def _cell(text: str) -> str:
    return text.replace("|", "\\|").replace("*", "\\*").replace("\n", " ")


def as_page(
    folder: Path,
    heading: Heading,
    experiments: Sequence[Experiment],
    made: Made,
    origin: Mapping[str, str],
) -> str:
    """One self-contained page: every figure with its claims, all of it in one file."""
    sections = [(experiment, made.claims[experiment.name]) for experiment in experiments]
    rows = [row for _, some in sections for row in some]
    parts = [
        _LAYOUT,
        page.element("p", f"{heading.authors}, redrawn by innervate", "over"),
        page.element("h1", heading.title),
        page.element("p", summary(rows)),
        page.element("p", QUICK, "note") if heading.quick else "",
        page.section("Does not hold", _failed(sections, heading.readings)),
        page.section("Contents", _contents(sections, heading.readings)),
    ]
    for experiment, some in sections:
        inside = _figure(folder, experiment, heading.readings) + _table(some, heading.readings)
        for sheet in made.tables(experiment.name):
            cells = [[clean(text) for text in row] for row in sheet.rows]
            inside += page.element("h3", sheet.title) + page.table(sheet.head, cells)
        inside += _simulated(experiment, heading.quick)
        section = _anchored(experiment.name, page.section(experiment.title, inside))
        plain, head = (f"<h2>{text}</h2>" for text in (
            clean(experiment.title), linked(experiment.title, heading.readings)
        ))  # fmt: skip
        parts.append(section.replace(plain, head, 1))
    parts.append(_anchored("readings", page.section("Readings", _readings(sections, heading))))
    origin_rows = [[clean(key), clean(value)] for key, value in origin.items()]
    again = page.element("pre", heading.command, "command")
    parts.append(page.section("Run it again", again + page.table(("what", "value"), origin_rows)))
    return page.page(f"innervate: papers {heading.system}", "\n".join(parts))


def _anchored(name: str, section: str) -> str:
    return section.replace("<section>", f'<section id="{clean(name)}">', 1)


def _figure(folder: Path, experiment: Experiment, readings: Mapping[str, str]) -> str:
    image = (folder / f"{experiment.name}.svg").read_bytes()
    coded = base64.b64encode(image).decode()
    width = re.search(rb'width="([\d.]+)pt"', image)
    narrow = width is not None and float(width[1]) < NARROW_PT
    return (
        f'<figure{" class=narrow" * narrow}><img alt="{clean(experiment.title)}" '
        f'src="data:image/svg+xml;base64,{coded}">\n'
        f"<figcaption>{linked(experiment.caption, readings)}</figcaption>\n</figure>\n"
    )


def failing_first(rows: Sequence[Claim]) -> list[Claim]:
    """Claims that do not hold, then the others, each in the order they came."""
    return sorted(rows, key=lambda row: row.verdict != FAILS)


def _failed(sections: Sections, readings: Mapping[str, str]) -> str:
    """What does not hold, each with a link to its figure."""
    items = [
        f'<li><a href="#{clean(experiment.name)}">{clean(row.whose)}</a>: '
        f"{linked(row.claim, readings)}</li>"
        for experiment, rows in sections
        for row in rows
        if row.verdict == FAILS
    ]
    return f'<ul class="failed">{"".join(items)}</ul>\n' if items else ""


def _contents(sections: Sections, readings: Mapping[str, str]) -> str:
    items = []
    for experiment, rows in sections:
        bad = sum(row.verdict == FAILS for row in rows)
        words = f'<span class="good">{len(rows) - bad} hold</span>'
        words += f', <span class="bad">{bad} not</span>' if bad else ""
        title = clean(experiment.title)
        items.append(f'<li><a href="#{clean(experiment.name)}">{title}</a>: {words}</li>')
    if readings:
        items.append('<li><a href="#readings">Readings</a>: what the labels mean</li>')
    return f'<ul class="contents">{"".join(items)}</ul>\n'


def linked(text: str, readings: Mapping[str, str]) -> str:
    """Text as HTML, in which every label of a reading is a link to its sentence."""

    def link(found: re.Match[str]) -> str:
        label = found[0]
        return f'<a href="#{label}">{label}</a>' if label in readings else label

    return re.sub(r"\b[A-Z]\d+\b", link, clean(text))


def _readings(sections: Sections, heading: Heading) -> str:
    """The sentences of the labels that claims, titles and captions use; nothing if none does."""
    said = [
        f"{experiment.title} {experiment.caption} "
        + " ".join(f"{row.claim} {row.measurement} {row.verdict} {row.reason}" for row in rows)
        for experiment, rows in sections
    ]
    names = set(re.findall(r"\b[A-Z]\d+\b", " ".join(said)))
    used = {label: said for label, said in heading.readings.items() if label in names}
    items = [
        f'<dt id="{label}">{label}</dt><dd>{linked(sentence, used)}</dd>'
        for label, sentence in used.items()
    ]
    note = page.element("p", "All labels: docs/readings.md.", "note")
    return f'<dl class="readings">{"".join(items)}</dl>\n{note}' if items else ""


def _simulated(experiment: Experiment, quick: bool) -> str:
    """The scenarios of a figure: what each set of runs differs by, and its seeds."""
    keys = [point.key for point in experiment.points(quick)]
    head = f"What was simulated: {len(keys)} sets of runs, by their settings"
    of_seeds = [re.sub(r", seed \d+$", ", a run a seed", key) for key in keys]
    times = Counter(of_seeds)
    keys = [both if times[both] > 1 else key for key, both in zip(keys, of_seeds, strict=True)]
    keys = list(dict.fromkeys(keys))
    return page.details(head, page.element("pre", "\n".join(keys)))


def _table(rows: Sequence[Claim], readings: Mapping[str, str]) -> str:
    cells = []
    for row in failing_first(rows):
        said = (row.verdict, row.claim, row.measurement, row.reason)
        verdict, claim, *others = (linked(text, readings) for text in said)
        if row.source:
            claim = page.element("p", row.whose, "over") + claim
        colour = "bad" if row.verdict == FAILS else "good"
        cells.append([f'<b class="{colour}">{verdict}</b>', claim, *others])
    return page.table(("verdict", "claim", "measured", "why"), cells, "claims")


def _put(path: Path, text: str) -> None:
    """Whole or not at all."""
    fresh = path.with_name(path.name + ".part")
    fresh.write_text(text, encoding="utf-8")
    fresh.replace(path)
