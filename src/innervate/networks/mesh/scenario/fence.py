"""The fence of a mesh: a polygon with holes, as whole numbers in its own coordinates [mesh 6]."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from itertools import combinations
from typing import Any

from innervate.networks.mesh.protocol.fields import POINTS
from innervate.networks.mesh.scenario.model import FenceTable
from innervate.scenario.lines import Key
from innervate.scenario.source import Source
from innervate.topology.placement import Point

EXTENT_MAX = 23_000  # units: squares stay below 2^29
UNITS_CM = (1, 10, 100)
FLOODS = {"never": 0, "crossings": 1, "all": 2}
Ring = list[Point]


def rings_cm(fence: FenceTable) -> list[Ring]:
    """The polygon and its holes, corners in cm; a last corner that repeats the first is dropped."""
    found = []
    for polygon in (fence.polygon, *fence.holes):
        ring = [(round(100 * x), round(100 * y)) for x, y in polygon]
        found.append(ring[:-1] if len(ring) > 1 and ring[0] == ring[-1] else ring)
    return found


def ring_key(index: int) -> Key:
    """The key of ring `index`: the polygon is 0, holes follow."""
    return ("fence", "polygon") if index == 0 else ("fence", "holes", index - 1)


def check(source: Source, fence: FenceTable) -> None:
    """Raise ScenarioError if no area is inside, or nobody could say which."""
    rings = rings_cm(fence)
    corners = sum(len(ring) for ring in rings)
    if corners > POINTS:
        message = f"the fence has {corners} corners, more than {POINTS}; leave some out"
        raise source.error(("fence", "polygon"), message)
    _check_rings(source, rings)


def _check_rings(source: Source, rings: list[Ring]) -> None:
    for index, ring in enumerate(rings):
        key = ring_key(index)
        name = ".".join(str(part) for part in key)
        if len(ring) < 3:
            raise source.error(key, f"{name} must have 3 corners or more, not {len(ring)}")
        wrong = _fault(ring)
        if wrong:
            raise source.error(key, f"{name} {wrong}")
        if index and not (_inside(ring[0], rings[0]) and not _meet(ring, rings[0])):
            raise source.error(key, f"{name} is not wholly inside fence.polygon; move it there")
    for i, j in combinations(range(1, len(rings)), 2):
        a, b = rings[i], rings[j]
        if _meet(a, b) or _inside(a[0], b) or _inside(b[0], a):
            message = f"fence.holes.{i - 1} and {j - 1} overlap or touch; make them one, or apart"
            raise source.error(ring_key(j), message)


def _fault(ring: Ring) -> str:
    """What is wrong with a ring; "" if its edges meet at its corners only."""
    count = len(ring)
    for i in range(count):
        if ring[i] == ring[(i + 1) % count]:
            return f"has corner {i} twice in a row; leave one out"
    for i, j in combinations(range(count), 2):
        first, second = _edge(ring, i), _edge(ring, j)
        if j == i + 1:
            spike = _side(*first, second[1]) == 0 and _ahead(*first, second[1]) < 0
        elif i == 0 and j == count - 1:
            spike = _side(*second, first[1]) == 0 and _ahead(*second, first[1]) < 0
        else:
            if _touch(first, second):
                crosses = _sides(first, second) < 0 and _sides(second, first) < 0
                verb = "crosses" if crosses else "touches"
                both = f"edge {i} (from corner {i}) and edge {j}"
                return f"{verb} itself: {both} meet; put the corners in order around the area"
            continue
        if spike:
            return f"touches itself: edges {i} and {j} lie on each other; leave a corner out"
    return ""


def _edge(ring: Ring, i: int) -> tuple[Point, Point]:
    return ring[i], ring[(i + 1) % len(ring)]


def _side(a: Point, b: Point, c: Point) -> int:
    """> 0 if c is to the left of the line from a to b, < 0 to the right, 0 on it."""
    cross = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
    return (cross > 0) - (cross < 0)


def _ahead(a: Point, b: Point, c: Point) -> int:
    """< 0 if from b on to c goes back in the direction of a."""
    return (b[0] - a[0]) * (c[0] - b[0]) + (b[1] - a[1]) * (c[1] - b[1])


def _sides(edge: tuple[Point, Point], other: tuple[Point, Point]) -> int:
    """< 0 if the ends of `other` lie on different sides of `edge`."""
    return _side(*edge, other[0]) * _side(*edge, other[1])


def _touch(first: tuple[Point, Point], second: tuple[Point, Point]) -> bool:
    """True if two edges have a point in common."""
    if _sides(first, second) < 0 and _sides(second, first) < 0:
        return True
    return any(
        _side(*edge, point) == 0 and _within(edge, point)
        for edge, other in ((first, second), (second, first))
        for point in other
    )


def _within(edge: tuple[Point, Point], point: Point) -> bool:
    (ax, ay), (bx, by) = edge
    return min(ax, bx) <= point[0] <= max(ax, bx) and min(ay, by) <= point[1] <= max(ay, by)


def _meet(a: Ring, b: Ring) -> bool:
    return any(_touch(_edge(a, i), _edge(b, j)) for i in range(len(a)) for j in range(len(b)))


def _inside(point: Point, ring: Ring) -> bool:
    """Even-odd rule; a point on an edge counts as either."""
    found = False
    for i in range(len(ring)):
        a, b = _edge(ring, i)
        if (a[1] > point[1]) != (b[1] > point[1]):
            low, high = (a, b) if a[1] < b[1] else (b, a)
            if _side(low, high, point) > 0:
                found = not found
    return found


def is_outside(fence: FenceTable, point: Point) -> bool:
    """True if a point, cm, is beyond the polygon or in a hole; an edge is inside."""
    rings = rings_cm(fence)
    edges = [_edge(ring, i) for ring in rings for i in range(len(ring))]
    if any(_side(*edge, point) == 0 and _within(edge, point) for edge in edges):
        return False
    return sum(_inside(point, ring) for ring in rings) % 2 == 0


def origin_of(rings: Sequence[Ring]) -> Point:
    """The fence's corner: least x and least y, cm."""
    return min(x for x, _ in rings[0]), min(y for _, y in rings[0])


def parameters(
    source: Source, fence: FenceTable, visited: Iterable[Point], robots: int
) -> dict[str, Any]:
    """The fence's part of the protocol's parameters.

    Args:
        source: for error messages.
        fence: the table, already checked.
        visited: where robots come, cm: their coordinates must fit too.
        robots: how many there are.

    Raises:
        ScenarioError: the unit is too small for the extent, or too large for the corners.
    """
    rings = rings_cm(fence)
    x0, y0 = origin_of(rings)
    unit = _unit_cm(source, fence, [*rings[0], *visited])
    scaled = [[(round((x - x0) / unit), round((y - y0) / unit)) for x, y in ring]
              for ring in rings]  # fmt: skip
    if unit > 1:
        _check_rings(source, scaled)
    return {
        "watch": int(fence.watch and robots > 0),
        "lost": fence.lost_beacons,
        "flood": FLOODS[fence.flood],
        "instances": fence.floods,
        "clear_margin": round(100 * fence.clear_m / unit),
        "predict_ms": round(1000 * fence.predict_s),
        "unit_cm": unit,
        **_corners(scaled),
        "fence": fence.number,
    }


def _corners(rings: list[list[tuple[int, int]]]) -> dict[str, Any]:
    """All rings' corners in one table, each with the place of the next one."""
    px, py, after = ([0] * POINTS for _ in range(3))
    at = 0
    for ring in rings:
        for i, (x, y) in enumerate(ring):
            px[at + i], py[at + i], after[at + i] = x, y, at + (i + 1) % len(ring)
        at += len(ring)
    return {"points": at, "px": px, "py": py, "after": after}


def _unit_cm(source: Source, fence: FenceTable, points: list[Point]) -> int:
    """The unit asked for, or the smallest in which all points can be told."""
    extent = max(max(p[i] for p in points) - min(p[i] for p in points) for i in (0, 1))
    fitting = [unit for unit in UNITS_CM if extent <= EXTENT_MAX * unit]
    if not fitting:
        message = f"the fence and its robots spread over {extent / 100:g} m; 23 km is the most"
        raise source.error(("fence", "polygon"), message)
    unit = fence.unit_cm or fitting[0]
    if unit < fitting[0]:
        message = (
            f"fence.unit_cm = {unit} reaches {EXTENT_MAX * unit // 100} m, but the fence and its "
            f"robots spread over {extent / 100:g} m; make it {fitting[0]}"
        )
        raise source.error(("fence", "unit_cm"), message)
    return unit
