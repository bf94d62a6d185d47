"""A counterexample as a page of panels: the network after each event, the sentences below."""

import math
from collections.abc import Sequence
from pathlib import Path
from textwrap import wrap

from innervate.plot.svg import Drawing, Point
from innervate.plot.theme import drawing_style

PANEL = (210.0, 190.0)
COLUMNS = 4
RADIUS = 15.0
TOP = 34.0
LINE = 15.0
LETTERS = 119
DISC_LETTERS, WORD = 4, 9.0  # of a node's disc: letters that fit side by side, a row of a word
STYLE = "\n" + Path(__file__).with_name("panels.css").read_text(encoding="utf-8")


def page(title: str, panels: Sequence[Drawing], sentences: Sequence[str]) -> Drawing:
    """Panels in rows of four, then what happened, numbered."""
    rows = -(-len(panels) // COLUMNS)
    texts = [part for i, s in enumerate(sentences, 1) for part in wrapped(f"{i}. {s}")]
    high = TOP + rows * PANEL[1] + LINE * (len(texts) + 2)
    drawing = Drawing(PANEL[0] * COLUMNS, high, f"Counterexample: {title}")
    drawing.text((12, 22), title, "strong alarm")
    for index, panel in enumerate(panels):
        corner = (PANEL[0] * (index % COLUMNS), TOP + PANEL[1] * (index // COLUMNS))
        drawing.place(panel, corner)
    for i, text in enumerate(texts):
        drawing.text((12, TOP + rows * PANEL[1] + LINE * (i + 1)), text)
    return drawing


def panel(index: int) -> Drawing:
    """An empty panel, of what was after the event with this index."""
    made = Drawing(PANEL[0], PANEL[1], f"after event {index + 1}")
    made.text((12, 18), f"after {index + 1}", "small")
    return made


def save(drawing: Drawing, path: Path, more: str = "") -> None:
    """Write a page to a file of its own; `more` are further rules of its style."""
    drawing.save(path, drawing_style() + STYLE + more)


def wrapped(text: str) -> list[str]:
    """A sentence as lines of at most LETTERS letters, all but the first indented."""
    return wrap(" ".join(text.split()), LETTERS, subsequent_indent="    ", break_long_words=False,
                break_on_hyphens=False)  # fmt: skip


def disc(panel: Drawing, place: Point, label: str, is_end: bool, is_actor: bool) -> None:
    """A node, the words of a long name in rows; `is_end` where ways lead to it."""
    panel.circle(place, RADIUS, "pc" if is_end else f"node{' actor' if is_actor else ''}")
    lines = label.split() if len(label) > DISC_LETTERS else [label]
    for i, line in enumerate(lines):
        y = place[1] + 4 + WORD * (i - (len(lines) - 1) / 2)
        panel.text((place[0], y), line, "portname" if is_end else "small", "middle")


def arrow(panel: Drawing, start: Point, end: Point, kind: str) -> None:
    """From the rim of one node to the rim of the other."""
    angle = math.atan2(end[1] - start[1], end[0] - start[0])
    x, y = math.cos(angle), math.sin(angle)
    tail = (start[0] + x * RADIUS, start[1] + y * RADIUS)
    tip = (end[0] - x * (RADIUS + 2), end[1] - y * (RADIUS + 2))
    panel.line(tail, tip, kind)
    for side in (2.6, -2.6):
        barb = (tip[0] + 9 * math.cos(angle + side), tip[1] + 9 * math.sin(angle + side))
        panel.line(tip, barb, kind)
