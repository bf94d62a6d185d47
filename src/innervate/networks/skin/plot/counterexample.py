"""A counterexample as pictures: the network after each event that matters."""

from __future__ import annotations

import math
from pathlib import Path
from typing import TYPE_CHECKING

from innervate.networks.skin.protocol.constants import NONE
from innervate.plot.svg import Drawing, Point
from innervate.plot.theme import drawing_style

if TYPE_CHECKING:
    from innervate.networks.skin.verify.story import Story

PANEL = (210.0, 190.0)
COLUMNS = 4
RADIUS = 15.0
TOP = 34.0
LINE = 15.0
LETTERS = 118
_STYLE = """
.node{fill:var(--panel);stroke:var(--link);stroke-width:1.4}
.actor{stroke:var(--accent);stroke-width:2.6}
.pc{fill:var(--ink)}
.way{stroke:var(--link);stroke-width:2.4;fill:none;stroke-linecap:round}
.ring{stroke:var(--alarm);stroke-width:3.2;fill:none;stroke-linecap:round}
"""


def draw(story: Story) -> Drawing:
    """A panel for every event that changed a parent or a cable; the sentences below."""
    shown = _shown(story)
    rows = -(-len(shown) // COLUMNS)
    wide = PANEL[0] * min(COLUMNS, len(shown)) if len(shown) > 2 else PANEL[0] * 4
    texts = [part for i, s in enumerate(story.sentences, 1) for part in wrapped(f"{i}. {s}")]
    high = TOP + rows * PANEL[1] + LINE * (len(texts) + 2)
    drawing = Drawing(max(wide, PANEL[0] * 4), high, f"Counterexample: {story.title}")
    drawing.text((12, 22), story.title, "strong alarm")
    places = _places(story)
    for place, index in enumerate(shown):
        corner = (PANEL[0] * (place % COLUMNS), TOP + PANEL[1] * (place // COLUMNS))
        drawing.place(_panel(story, index, places), corner)
    for i, text in enumerate(texts):
        drawing.text((12, TOP + rows * PANEL[1] + LINE * (i + 1)), text)
    return drawing


def save(story: Story, path: Path) -> None:
    """Write the drawing to a file of its own."""
    draw(story).save(path, drawing_style() + _STYLE)


def _shown(story: Story) -> list[int]:
    """Events after which the picture is another one, and the last."""
    found, before = [], None
    for i, scene in enumerate(story.scenes):
        if before is None or (scene.parents, scene.cut) != before:
            found.append(i)
        before = (scene.parents, scene.cut)
    last = len(story.scenes) - 1
    return [*found, last] if found[-1] != last else found


def wrapped(text: str) -> list[str]:
    """A sentence as lines of at most LETTERS letters, all but the first indented."""
    lines, line = [], ""
    for word in text.split():
        if len(line) + len(word) > LETTERS:
            lines.append(line)
            line = "    " + word
        else:
            line = f"{line} {word}".strip() if not line.startswith("    ") else f"{line} {word}"
    return [*lines, line]


def _places(story: Story) -> list[Point]:
    """The PC on top, cells in rows by their hops to it."""
    graph = story.graph
    depths = list(graph.depths())
    rows = max(depths) + 1
    places: list[Point] = []
    for cell in range(graph.cells):
        same = [c for c in range(graph.cells) if depths[c] == depths[cell]]
        # Off the straight line, so that no cable runs through a cell.
        shift = 14.0 * (depths[cell] % 2) if len(same) == 1 and rows > 2 else 0.0
        x = PANEL[0] * (same.index(cell) + 1) / (len(same) + 1) + shift
        low = 6.0 * (same.index(cell) % 2) * (len(same) > 2)
        places.append((x, 40 + (PANEL[1] - 70) * depths[cell] / max(rows - 1, 1) + low * 3))
    return [*places, (PANEL[0] / 2, 40.0)]


def _panel(story: Story, index: int, places: list[Point]) -> Drawing:
    """The network after one event."""
    scene, graph = story.scenes[index], story.graph
    panel = Drawing(PANEL[0], PANEL[1], f"after event {index + 1}")
    whole: list[tuple[Point, Point]] = []
    cut: list[tuple[Point, Point]] = []
    for a, b in graph.links():
        ends = graph.node_of(a), graph.node_of(b)
        is_cut = ends in scene.cut or ends[::-1] in scene.cut
        (cut if is_cut else whole).append((places[ends[0]], places[ends[1]]))
    for start, end in whole:
        panel.line(start, end, "cable")
    is_last = index == len(story.scenes) - 1
    for cell, parent in enumerate(scene.parents):
        if parent != NONE:
            closed = is_last and cell in story.ring
            arrow(panel, places[cell], places[parent], "ring" if closed else "way")
    for start, end in cut:  # over the arrow of a cell that has not noticed yet
        panel.line(start, end, "cut")
    for node, place in enumerate(places):
        label = "PC" if node == graph.sink else graph.label(node)
        disc(panel, place, label, node == graph.sink, node == scene.actor)
    panel.text((12, 18), f"after {index + 1}", "small")
    return panel


def disc(panel: Drawing, place: Point, label: str, is_end: bool, is_actor: bool) -> None:
    """A node; `is_end` where ways lead to it."""
    panel.circle(place, RADIUS, "pc" if is_end else f"node{' actor' if is_actor else ''}")
    panel.text((place[0], place[1] + 4), label, "portname" if is_end else "small", "middle")


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
