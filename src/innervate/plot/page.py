"""The HTML of a report: skeleton, style sheet and small parts."""

import re
from collections.abc import Callable, Iterable, Mapping, Sequence
from html import escape
from operator import itemgetter
from pathlib import Path
from typing import Any

from innervate.analysis.headline import DEGRADED, DOWN, NO_DATA, OK
from innervate.plot import theme
from innervate.plot.charts import Bars, Panel, Steps
from innervate.plot.svg import Drawing, clean, verbatim
from innervate.plot.words import count_words, figure_words
from innervate.scenario.declared.shared import own_events

ROWS_MAX = 200
FIGURE = re.compile(r"[-\d.,]+ \S{1,5}")  # a number with its unit
INTERVAL = re.compile(r"\(([-\d.,]+) to ([-\d.,]+)\)")
LEVEL_CLASSES = {OK: "status", DEGRADED: "status warn", DOWN: "status bad", NO_DATA: "status none"}

# Parts of a page, wherever they stand.
PARTS = "\n" + Path(__file__).with_name("parts.css").read_text(encoding="utf-8")
_PAGE = "\n" + Path(__file__).with_name("page.css").read_text(encoding="utf-8")


def page(title: str, body: str) -> str:
    """A whole HTML document; `body` is HTML."""
    return (
        '<!DOCTYPE html>\n<html lang="en">\n<head>\n<meta charset="utf-8">\n'
        '<meta name="viewport" content="width=device-width, initial-scale=1">\n'
        f"<title>{escape(title)}</title>\n<style>{theme.drawing_style()}{PARTS}{_PAGE}</style>\n"
        f"</head>\n<body>\n<main>\n{body}\n</main>\n</body>\n</html>\n"
    )


def element(tag: str, text: str, kind: str = "") -> str:
    """An element with text, which is escaped."""
    opening = f'<{tag} class="{kind}">' if kind else f"<{tag}>"
    inside = verbatim(text) if tag == "pre" else clean(text)
    return f"{opening}{inside}</{tag}>\n"


def headline(found: Mapping[str, str]) -> str:
    """A summary's headline: its sentence, and below it its level, in the level's colour."""
    level = found["level"]
    return element("h1", found["text"]) + element("p", level, LEVEL_CLASSES[level])


def joined(*parts: str) -> str:
    """Those parts of a page that have something to say."""
    return "\n".join(part for part in parts if part)


def top(over: str, summary: Mapping[str, Any], *parts: str) -> str:
    """What a report begins with: what it is about, what came of it, parts as HTML."""
    begin = element("p", over, "over") + headline(summary["headline"])
    return f"<header>\n{begin}{''.join(parts)}</header>"


def paragraphs(sentences: Iterable[str], kind: str = "") -> str:
    """A paragraph for each sentence."""
    return "".join(element("p", sentence, kind) for sentence in sentences)


def ended_early(summary: Mapping[str, Any]) -> str:
    """A word on a run that was interrupted."""
    if "interrupted_at_s" not in summary:
        return ""
    early = f"Ended early, at {summary['interrupted_at_s']:.3f} s of simulated time."
    return element("p", early, "status bad")


def took(summary: Mapping[str, Any], simulated_s: float) -> tuple[str, str]:
    """The figure on how long the simulation took."""
    wall = f"{figure_words(summary['wall_s'], 2)} s" if summary["wall_s"] >= 0.01 else "< 0.01 s"
    events = f"{count_words(summary['events'])} events"
    return wall, f"to simulate {figure_words(simulated_s, 4)} s, {events}"


def beginning(head: Sequence[str], rows: Sequence[Sequence[str]], rest: str = "") -> str:
    """The first rows of a table, and how many more there are; `rest` says where."""
    more = len(rows) - ROWS_MAX
    note = element("p", f"And {more:,} more{rest}.", "note") if more > 0 else ""
    return table(head, rows[:ROWS_MAX]) + note


def events(result: Any, words: Callable[[Any], str]) -> str:
    """The section on what the scenario has brought about; "" if that is nothing."""
    told = [(fault.at_us, words(fault)) for fault in result.plan.faults] + own_events(result.plan)
    told = sorted((one for one in told if one[0] <= result.ended_us), key=itemgetter(0))
    rows = [(f"{at_us / 1e6:.3f} s", clean(what)) for at_us, what in told]
    return section("Events", beginning(("at", "what"), rows) if rows else "")


def section(head: str, inside: str) -> str:
    """A section with a heading; nothing if there is nothing inside."""
    return f"<section>\n{element('h2', head)}{inside}</section>" if inside else ""


def figure(drawing: Drawing, head: str, text: str = "") -> str:
    """A drawing with its caption."""
    words = element("figcaption", text) if text else ""
    title = element("h3", head) if head else ""
    return f"<figure>\n{title}{drawing.render()}\n{words}</figure>\n"


def panel(one: Panel | Steps | Bars) -> str:
    """A figure that has its caption with it."""
    return figure(one.drawing, one.head, one.text)


def pictures(figures: Iterable[str], columns: str) -> str:
    """Figures side by side as far as there is room; `columns` is "two", "three" or "four"."""
    inside = "".join(figures)
    return f'<div class="pictures {columns}">\n{inside}</div>\n' if inside else ""


def keys(entries: Sequence[tuple[Drawing, str]]) -> str:
    """A legend: small drawings with words."""
    items = "".join(f"<li>{icon.render()}{clean(words)}</li>" for icon, words in entries)
    return f'<ul class="keys">{items}</ul>\n' if entries else ""


def tiles(entries: Sequence[tuple[str, str]]) -> str:
    """Numbers with a line each: (number, meaning)."""
    inside = "".join(f"<div><b>{clean(n)}</b><span>{clean(m)}</span></div>" for n, m in entries)
    return f'<div class="tiles">{inside}</div>\n'


def table(head: Sequence[str], rows: Iterable[Sequence[str]], kind: str = "") -> str:
    """A table; cells are HTML. Each column has a head, for who listens to the page."""
    assert all(head), head
    opening = f'<table class="{kind}">' if kind else "<table>"
    top = "".join(f"<th>{cell}</th>" for cell in head)
    body = "".join(
        f"<tr>{''.join(f'<td>{_on_one_line(cell)}</td>' for cell in row)}</tr>\n" for row in rows
    )
    return f'<div class="scroll" tabindex="0">{opening}<tr>{top}</tr>\n{body}</table></div>\n'


def _on_one_line(cell: str) -> str:
    """A cell whose numbers stay with their units, and intervals whole, however narrow it is."""
    space = "\N{NO-BREAK SPACE}"
    whole = cell.replace(" ", space) if FIGURE.fullmatch(cell) else cell
    return INTERVAL.sub(rf"(\1{space}to{space}\2)", whole)


def details(head: str, inside: str) -> str:
    """Something to unfold; `inside` is HTML."""
    return f"<details><summary>{clean(head)}</summary>\n{inside}</details>\n"


def film_controls(cycle_s: float) -> str:
    """A pause button and a slider for the film in the same `.film`; it plays without them, too."""
    return (
        '<div class="controls"><button type="button">Pause</button>'
        '<input type="range" min="0" max="1000" value="0" aria-label="Time"></div>\n'
        f"<script>(cycle=>{{{_FILM}}})({cycle_s:g})</script>\n"
    )


# Who asked for less motion gets the film's end, at rest.
_FILM = "\n" + Path(__file__).with_name("film.js").read_text(encoding="utf-8")
