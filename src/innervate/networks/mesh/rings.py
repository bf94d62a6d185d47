"""Areas that are bounded by rings of corners, in whole numbers: an outer one, with holes."""

from collections.abc import Mapping, Sequence
from itertools import combinations
from typing import Any

Point = tuple[int, int]
Ring = Sequence[Point]


def opened(ring: Ring) -> list[Point]:
    """A ring without a last corner that repeats its first."""
    return list(ring[:-1] if len(ring) > 1 and ring[0] == ring[-1] else ring)


def table(rings: Sequence[Ring], room: int) -> dict[str, Any]:
    """All rings' corners in one table of so much room, each with the place of the next one."""
    px, py, after = ([0] * room for _ in range(3))
    at = 0
    for ring in rings:
        for i, (x, y) in enumerate(ring):
            px[at + i], py[at + i], after[at + i] = x, y, at + (i + 1) % len(ring)
        at += len(ring)
    return {"points": at, "px": px, "py": py, "after": after}


def of_table(found: Mapping[str, Any]) -> list[list[Point]]:
    """The rings that `table` made one of; none if there is no fence."""
    rings: list[list[Point]] = []
    start = 0
    for i in range(found["points"]):
        if found["after"][i] != i + 1:  # the last corner of a ring leads back to its first
            ends = slice(start, i + 1)
            rings.append(list(zip(found["px"][ends], found["py"][ends], strict=True)))
            start = i + 1
    return rings


def mistake(rings: Sequence[Ring], names: Sequence[str]) -> tuple[int, str] | None:
    """Why no area is inside, or nobody could say which: at which ring, and in words.

    The outer ring is the first, then its holes.
    """
    for index, (ring, name) in enumerate(zip(rings, names, strict=True)):
        if len(ring) < 3:
            return index, f"{name} must have 3 corners or more, not {len(ring)}"
        wrong = _fault(ring)
        if wrong:
            return index, f"{name} {wrong}"
        if index and not (_inside(ring[0], rings[0]) and not _meet(ring, rings[0])):
            return index, f"{name} is not wholly inside {names[0]}; move it there"
    for i, j in combinations(range(1, len(rings)), 2):
        a, b = rings[i], rings[j]
        if _meet(a, b) or _inside(a[0], b) or _inside(b[0], a):
            both = f"{names[i]} and {names[j].rpartition('.')[2]}"
            return j, f"{both} overlap or touch; make them one, or apart"
    return None


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


def is_outside(point: Point, rings: Sequence[Ring]) -> bool:
    """True if a point is beyond the outer ring or in a hole; an edge is inside."""
    edges = [_edge(ring, i) for ring in rings for i in range(len(ring))]
    if any(_side(*edge, point) == 0 and _within(edge, point) for edge in edges):
        return False
    return sum(_inside(point, ring) for ring in rings) % 2 == 0
