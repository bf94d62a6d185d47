"""A mesh's counterexample as pictures: tables and frames after each event."""

from __future__ import annotations

import math
from pathlib import Path
from typing import TYPE_CHECKING

from innervate.plot import panels
from innervate.plot.panels import PANEL, RADIUS
from innervate.plot.svg import Drawing, Point

if TYPE_CHECKING:
    from innervate.networks.mesh.verify.story import MeshStory

SPREAD = (70.0, 52.0)
CENTRE = (PANEL[0] / 2, PANEL[1] / 2 + 8)
SHIFT = 4.0  # arrows of tables and of frames run beside each other
_MORE = """
.gone{fill:none;stroke:var(--link);stroke-dasharray:3 3}
.sent{stroke:var(--accent);stroke-width:1.6;fill:none;stroke-linecap:round}
.lost{stroke:var(--alarm);stroke-width:1.6;fill:none;stroke-dasharray:4 4;stroke-linecap:round}
"""


def draw(story: MeshStory) -> Drawing:
    """A panel for every event; the sentences below."""
    drawn = [_panel(story, index) for index in range(len(story.scenes))]
    return panels.page(story.title, drawn, story.sentences)


def save(story: MeshStory, path: Path) -> None:
    """Write the drawing to a file of its own."""
    panels.save(draw(story), path, _MORE)


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
    panel = panels.panel(index)
    for a, b in model.links:
        panel.line(places[a], places[b], "cable")
    is_last = index == len(story.scenes) - 1
    for node, hop in enumerate(scene.hops):
        if hop >= 0:
            kind = "ring" if is_last and node in story.ring else "way"
            panels.arrow(panel, *_beside(places[node], places[hop], SHIFT), kind)
    for pair, kind in ((scene.sent, "sent"), (scene.lost, "lost")):
        if pair:
            panels.arrow(panel, *_beside(places[pair[0]], places[pair[1]], 3 * SHIFT), kind)
    for node, place in enumerate(places):
        gone = node in scene.dead
        label = "x" if gone else str(node)
        panels.disc(panel, place, label, node == story.dest and not gone, node == scene.actor)
        if gone:
            panel.circle(place, RADIUS, "gone")
    return panel


def _beside(start: Point, end: Point, shift: float) -> tuple[Point, Point]:
    """Two points moved to the right of the way from one to the other."""
    angle = math.atan2(end[1] - start[1], end[0] - start[0]) + math.pi / 2
    x, y = shift * math.cos(angle), shift * math.sin(angle)
    return (start[0] + x, start[1] + y), (end[0] + x, end[1] + y)
