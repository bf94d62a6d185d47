"""Where the nodes of a mesh lie on a drawing, and where there is room for their names."""

from collections.abc import Iterable
from itertools import pairwise
from typing import Any

import numpy as np

from innervate.analysis.spread import scaled
from innervate.networks.mesh.analysis.fence import edges_of
from innervate.plot.svg import Point
from innervate.topology.placement import UNREACHABLE, distances, neighbours

WIDTH, HEIGHT_MAX, MARGIN = 760.0, 660.0, 34.0
LONELY_CM = 500.0, 100.0  # around a node that is alone
SCALE_PX = 16.0  # below the map, for the bar that says how long metres are
DOT_PX = 5.0
STEP_PX = 7.0  # between the places on a line that keep names away
NAME_PX, STRONG_PX, LINE_PX = 6.6, 7.6, 12.0  # letters at 11 px, on the safe side

Floats = np.ndarray[Any, np.dtype[np.float64]]
Box = tuple[float, float, float, float]


class Sheet:
    """Places of a plan's nodes on a drawing, in px."""

    def __init__(self, plan: Any, width: float = WIDTH, height_max: float = HEIGHT_MAX) -> None:
        # Places are true ones, or only show who hears whom, as nobody knows them or they lie on
        # top of each other.
        self.metres = is_to_scale(plan, width)
        places = np.array(plan.positions_cm if self.metres else laid_out(plan), np.float64)
        around = [places]
        if self.metres:
            around += [np.array([p[1:] for p in walk.points], np.float64) for walk in plan.walks]
            corners = [corner for edge in edges_of(plan) for corner in edge]
            around += [np.array(corners, np.float64)] if corners else []
        everything = np.concatenate([part.reshape(-1, 2) for part in around])
        self._low, self._high = everything.min(axis=0), everything.max(axis=0)
        if not (self._high - self._low).any():
            self._low, self._high = self._low - LONELY_CM, self._high + LONELY_CM
        wide, high = (float(value) for value in np.maximum(self._high - self._low, 1.0))
        self.scale = min((width - 2 * MARGIN) / wide, (height_max - 2 * MARGIN) / high)  # px per cm
        self.width = width
        self._left = (width - wide * self.scale) / 2
        self.height = high * self.scale + 2 * MARGIN + (SCALE_PX if self.metres else 0)
        # (nodes, 2), where they are at the start.
        self.points: Floats = np.array([self.of_cm((x, y)) for x, y in places.tolist()])
        self.dot = DOT_PX if plan.nodes <= 100 else 3.5  # radius of a node, px

    def of_cm(self, place: Point) -> Point:
        """A place of the world on the drawing; north is up."""
        x = self._left + (place[0] - float(self._low[0])) * self.scale
        y = MARGIN + (float(self._high[1]) - place[1]) * self.scale
        return x, y

    def node(self, node: int) -> Point:
        """Where a node's centre is, in the sheet's units."""
        x, y = self.points[node]
        return float(x), float(y)

    def between(self, a: int, b: int) -> tuple[Point, Point]:
        """The ends of a line from a node to another, outside their dots."""
        return shortened(self.node(a), self.node(b), self.dot + 2)


def is_to_scale(plan: Any, width: float) -> bool:
    """True if nodes can be drawn where they are: most of them apart, or among robots and fences."""
    if len(plan.positions_cm) != plan.nodes:
        return False
    if plan.walks or plan.params["points"] or plan.nodes < 2:
        return True
    places = np.array(plan.positions_cm, np.float64)
    extent = max(float((places.max(axis=0) - places.min(axis=0)).max()), 1.0)
    apart = np.hypot(*(places[:, None, :] - places[None, :, :]).transpose(2, 0, 1))
    np.fill_diagonal(apart, np.inf)
    return float(np.median(apart.min(axis=1))) * width / extent > 1.5 * DOT_PX


def shortened(start: Point, end: Point, gap: float) -> tuple[Point, Point]:
    """A line with so much taken off either end."""
    dx, dy = end[0] - start[0], end[1] - start[1]
    length = max((dx * dx + dy * dy) ** 0.5, 1e-9)
    gap = min(gap, 0.4 * length)
    ux, uy = gap * dx / length, gap * dy / length
    return (start[0] + ux, start[1] + uy), (end[0] - ux, end[1] - uy)


def laid_out(plan: Any) -> Floats:
    """Places for nodes that have none: far apart as they are in hops (classical scaling)."""
    near = neighbours(plan.nodes, plan.good)
    far = np.array([distances(near, node) for node in range(plan.nodes)], np.float64)
    far[far == UNREACHABLE] = far.max() + 2
    if plan.nodes < 3:
        return np.array([[100.0 * i, 0.0] for i in range(plan.nodes)])
    return _spread(100.0 * scaled(far), near)


def _spread(places: Floats, near: list[list[int]]) -> Floats:
    """Push apart what lies on one spot, a little each time; neighbours hold together."""
    count = len(places)
    angle = 2.4 * np.arange(count)
    places = places + 5.0 * np.stack([np.cos(angle), np.sin(angle)], axis=1)
    pairs = np.array([(a, b) for a in range(count) for b in near[a]], np.int64).reshape(-1, 2)
    for _ in range(120):
        apart = places[:, None, :] - places[None, :, :]
        far = np.maximum(np.hypot(apart[..., 0], apart[..., 1]), 1.0)
        push = np.where(far < 120.0, (120.0 - far) / far, 0.0)[..., None] * apart
        step = 0.06 * push.sum(axis=1)
        pull = places[pairs[:, 1]] - places[pairs[:, 0]]
        long = np.maximum(np.hypot(pull[:, 0], pull[:, 1]), 1.0)
        pull *= (0.02 * np.maximum(long - 140.0, 0.0) / long)[:, None]
        np.add.at(step, pairs[:, 0], pull)
        size = np.maximum(np.hypot(step[:, 0], step[:, 1]), 1e-9)[:, None]
        places = places + step * np.minimum(1.0, 20.0 / size)
    return places


class Labels:
    """Puts names beside their nodes, where nothing lies yet; a name without room is left out."""

    def __init__(self, width: float, height: float) -> None:
        self._limits = (2.0, 2.0, width - 2, height - 2)
        self._taken: list[Box] = []
        self._lines = np.zeros((0, 4))

    def avoid(self, lines: Iterable[tuple[Point, Point]]) -> None:
        """Where there is a choice, names lie on as few of these lines as they can."""
        ends = [(*start, *end) for start, end in lines]
        self._lines = np.array(ends, np.float64).reshape(-1, 4)

    def block(self, centre: Point, radius: float) -> None:
        """Nothing may be written there."""
        x, y = centre
        self._taken.append((x - radius, y - radius, x + radius, y + radius))

    def block_line(self, points: Iterable[Point]) -> None:
        """Nothing may be written on a line."""
        for (ax, ay), (bx, by) in pairwise(points):
            count = max(1, int(max(abs(bx - ax), abs(by - ay)) / STEP_PX))
            for i in range(count + 1):
                share = i / count
                self.block((ax + share * (bx - ax), ay + share * (by - ay)), 2.0)

    def put(
        self, centre: Point, words: str, gap: float, strong: bool = False
    ) -> tuple[Point, str] | None:
        """(place, anchor) of a name beside a point; None if there is no room for it."""
        x, y = centre
        long = (STRONG_PX if strong else NAME_PX) * len(words)
        slant = 0.75 * gap
        places = (
            ((x + gap, y + 4), "start"),
            ((x - gap, y + 4), "end"),
            ((x, y - gap), "middle"),
            ((x, y + gap + 9), "middle"),
            ((x + slant, y - slant), "start"),
            ((x + slant, y + slant + 8), "start"),
            ((x - slant, y - slant), "end"),
            ((x - slant, y + slant + 8), "end"),
        )
        boxes = [_box(place, anchor, long) for place, anchor in places]
        free = [i for i, box in enumerate(boxes) if self._is_free(box)]
        if not free:
            return None
        best = min(free, key=lambda i: self._crossed(boxes[i]))
        self._taken.append(boxes[best])
        return places[best]

    def _crossed(self, box: Box) -> int:
        """How many of the lines that names avoid run through a box."""
        way = self._lines[:, 2:] - self._lines[:, :2]
        way[way == 0] = 1e-9
        parts = [(np.array(corner) - self._lines[:, :2]) / way for corner in (box[:2], box[2:])]
        begin = np.minimum(*parts).max(axis=1, initial=0.0)
        end = np.maximum(*parts).min(axis=1, initial=1.0)
        return int(np.count_nonzero(begin < end))

    def _is_free(self, box: Box) -> bool:
        low_x, low_y, high_x, high_y = self._limits
        if box[0] < low_x or box[1] < low_y or box[2] > high_x or box[3] > high_y:
            return False
        return not any(
            box[0] < t[2] and t[0] < box[2] and box[1] < t[3] and t[1] < box[3] for t in self._taken
        )


def _box(place: Point, anchor: str, long: float) -> Box:
    x = {"start": place[0], "middle": place[0] - long / 2, "end": place[0] - long}[anchor]
    return (x, place[1] - LINE_PX + 2, x + long, place[1] + 2)
