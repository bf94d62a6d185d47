"""A counterexample as pictures: the network after each event that matters."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from innervate.networks.skin.protocol.constants import NONE
from innervate.plot import panels
from innervate.plot.panels import PANEL
from innervate.plot.svg import Drawing, Point

if TYPE_CHECKING:
    from innervate.networks.skin.verify.story import Story


def draw(story: Story) -> Drawing:
    """A panel for every event that changed a parent or a cable; the sentences below."""
    places = _places(story)
    drawn = [_panel(story, index, places) for index in _shown(story)]
    return panels.page(story.title, drawn, story.sentences)


def save(story: Story, path: Path) -> None:
    """Write the drawing to a file of its own."""
    panels.save(draw(story), path)


def _shown(story: Story) -> list[int]:
    """Events after which the picture is another one, and the last."""
    found, before = [], None
    for i, scene in enumerate(story.scenes):
        if before is None or (scene.parents, scene.cut) != before:
            found.append(i)
        before = (scene.parents, scene.cut)
    last = len(story.scenes) - 1
    return [*found, last] if found[-1] != last else found


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
    panel = panels.panel(index)
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
            panels.arrow(panel, places[cell], places[parent], "ring" if closed else "way")
    for start, end in cut:  # over the arrow of a cell that has not noticed yet
        panel.line(start, end, "cut")
    for node, place in enumerate(places):
        label = "PC" if node == graph.sink else graph.label(node)
        panels.disc(panel, place, label, node == graph.sink, node == scene.actor)
    return panel
