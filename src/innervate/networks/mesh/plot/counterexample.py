"""A mesh's counterexample as pictures: tables and frames after each event."""

from __future__ import annotations

import math
from pathlib import Path
from typing import TYPE_CHECKING

from innervate.networks.skin.plot.counterexample import (
    COLUMNS,
    LINE,
    PANEL,
    TOP,
    arrow,
    disc,
    wrapped,
)
from innervate.plot.svg import Drawing, Point
from innervate.plot.theme import drawing_style

if TYPE_CHECKING:
    from innervate.networks.mesh.verify.story import MeshStory

SPREAD = (70.0, 52.0)
CENTRE = (PANEL[0] / 2, PANEL[1] / 2 + 8)
SHIFT = 4.0  # arrows of tables and of frames run beside each other
_STYLE = """
.node{fill:var(--panel);stroke:var(--link);stroke-width:1.4}
.actor{stroke:var(--accent);stroke-width:2.6}
.gone{fill:none;stroke:var(--link);stroke-dasharray:3 3}
.pc{fill:var(--ink)}
.way{stroke:var(--link);stroke-width:2.4;fill:none;stroke-linecap:round}
.sent{stroke:var(--accent);stroke-width:1.6;fill:none;stroke-linecap:round}
.lost{stroke:var(--alarm);stroke-width:1.6;fill:none;stroke-dasharray:4 4;stroke-linecap:round}
.ring{stroke:var(--alarm);stroke-width:3.2;fill:none;stroke-linecap:round}
"""


def draw(story: MeshStory) -> Drawing:
    """A panel for every event; the sentences below."""
    rows = -(-len(story.scenes) // COLUMNS)
    texts = [part for i, s in enumerate(story.sentences, 1) for part in wrapped(f"{i}. {s}")]
    high = TOP + rows * PANEL[1] + LINE * (len(texts) + 2)
    drawing = Drawing(PANEL[0] * COLUMNS, high, f"Counterexample: {story.title}")
    drawing.text((12, 22), story.title, "strong alarm")
    for index in range(len(story.scenes)):
        corner = (PANEL[0] * (index % COLUMNS), TOP + PANEL[1] * (index // COLUMNS))
        drawing.place(_panel(story, index), corner)
    for i, text in enumerate(texts):
        drawing.text((12, TOP + rows * PANEL[1] + LINE * (i + 1)), text)
    return drawing


def save(story: MeshStory, path: Path) -> None:
    """Write the drawing to a file of its own."""
    draw(story).save(path, drawing_style() + _STYLE)


def _places(nodes: int) -> list[Point]:
    """Nodes on an ellipse, 0 on top."""
    turns = [2 * math.pi * node / nodes - math.pi / 2 for node in range(nodes)]
    return [
        (CENTRE[0] + SPREAD[0] * math.cos(t), CENTRE[1] + SPREAD[1] * math.sin(t)) for t in turns
    ]


def _panel(story: MeshStory, index: int) -> Drawing:
    """The network after one event: links, next hops to the recipient, the frame that went out."""
    scene, model = story.scenes[index], story.found.model
    places = _places(model.nodes)
    panel = Drawing(PANEL[0], PANEL[1], f"after event {index + 1}")
    for a, b in model.links:
        panel.line(places[a], places[b], "cable")
    is_last = index == len(story.scenes) - 1
    for node, hop in enumerate(scene.hops):
        if hop >= 0:
            kind = "ring" if is_last and node in story.ring else "way"
            arrow(panel, *_beside(places[node], places[hop], SHIFT), kind)
    for pair, kind in ((scene.sent, "sent"), (scene.lost, "lost")):
        if pair:
            arrow(panel, *_beside(places[pair[0]], places[pair[1]], 3 * SHIFT), kind)
    for node, place in enumerate(places):
        gone = node in scene.dead
        label = "x" if gone else str(node)
        disc(panel, place, label, node == story.dest and not gone, node == scene.actor)
        if gone:
            panel.circle(place, 15.0, "gone")
    panel.text((12, 18), f"after {index + 1}", "small")
    return panel


def _beside(start: Point, end: Point, shift: float) -> tuple[Point, Point]:
    """Two points moved to the right of the way from one to the other."""
    angle = math.atan2(end[1] - start[1], end[0] - start[0]) + math.pi / 2
    x, y = shift * math.cos(angle), shift * math.sin(angle)
    return (start[0] + x, start[1] + y), (end[0] + x, end[1] + y)
