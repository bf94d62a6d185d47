"""How far a walk leads out of a fence, and when it crosses; floats, cm and us of true time."""

from collections.abc import Sequence
from heapq import heappop, heappush
from itertools import pairwise
from math import hypot
from typing import Any, NamedTuple

from innervate.networks.mesh.rings import of_table
from innervate.networks.mesh.scenario.plan import Point
from innervate.scenario.robots import Walk, position_cm

Edge = tuple[Point, Point]
CLOSE_CM = 1e-3  # overruns are right to this


class Crossing(NamedTuple):
    """A walk changes sides of a fence."""

    time_us: float  # when
    outward: bool  # True = it leaves, False = it comes back


def rings_of(plan: Any) -> list[list[Point]]:
    """The rings of a mesh plan's fence, cm in the world; none without a fence."""
    unit, (x0, y0) = plan.params["unit_cm"], plan.origin_cm
    return [[(x0 + unit * x, y0 + unit * y) for x, y in ring] for ring in of_table(plan.params)]


def edges_of(plan: Any) -> list[Edge]:
    """The edges of all its rings; empty without a fence."""
    return [edge for ring in rings_of(plan) for edge in pairwise([*ring, ring[0]])]


def margin_cm(edges: Sequence[Edge], place: Point) -> float:
    """Distance to the nearest edge, cm: > 0 inside (even-odd rule over all rings), < 0 outside.

    Raises:
        ValueError: there are no edges.
    """
    nearest = min(_distance(edge, place) for edge in edges)
    return nearest if _is_inside(edges, place) else -nearest


def crossings(edges: Sequence[Edge], walk: Walk, until_us: float) -> list[Crossing]:
    """The moments at which a walk leaves the fence or comes back, until a time.

    To touch the fence from either side is not to cross it, and to walk along it changes no side.
    """
    found: list[Crossing] = []
    inside = _is_inside(edges, position_cm(walk, _start(walk)))
    for begin, _end, now_inside in _pieces(edges, walk, _start(walk), until_us):
        if now_inside != inside:
            inside = now_inside
            found.append(Crossing(begin, outward=not inside))
    return found


def overrun_cm(edges: Sequence[Edge], walk: Walk, since_us: float, until_us: float) -> float:
    """The greatest distance outside the fence between two times, cm; 0 if it never is outside."""
    worst = 0.0
    for begin, end, inside in _pieces(edges, walk, since_us, until_us):
        if not inside:
            reached = _farthest(edges, position_cm(walk, begin), position_cm(walk, end), worst)
            worst = max(worst, reached)
    return worst


def _start(walk: Walk) -> float:
    return float(walk.points[0][0]) if walk.points else 0.0


def _pieces(
    edges: Sequence[Edge], walk: Walk, since_us: float, until_us: float
) -> list[tuple[float, float, bool]]:
    """(begin, end, inside) of what lies between a walk's corners and its meetings with edges."""
    if until_us <= since_us:
        return []
    corners = [float(t) for t, _, _ in walk.points if since_us < t < until_us]
    pieces = []
    for begin, end in pairwise([since_us, *corners, until_us]):
        a, b = position_cm(walk, begin), position_cm(walk, end)
        shares = sorted({0.0, 1.0, *(s for edge in edges for s in _meetings(edge, a, b))})
        for low, high in pairwise(shares):
            middle = _between(a, b, (low + high) / 2)
            # From the world's own times, so that neighbours share their moment exactly.
            times = [begin + share * (end - begin) for share in (low, high)]
            pieces.append((times[0], times[1], _is_inside(edges, middle)))
    return pieces


def _meetings(edge: Edge, a: Point, b: Point) -> list[float]:
    """Shares of the way from a to b, in (0, 1), at which it meets the line of an edge."""
    (px, py), (qx, qy) = edge
    ex, ey = qx - px, qy - py
    before = ex * (a[1] - py) - ey * (a[0] - px)
    after = ex * (b[1] - py) - ey * (b[0] - px)
    if before == after:
        return []
    share = before / (before - after)
    return [share] if 0 < share < 1 else []


def _between(a: Point, b: Point, share: float) -> Point:
    return (a[0] + share * (b[0] - a[0]), a[1] + share * (b[1] - a[1]))


def _distance(edge: Edge, place: Point) -> float:
    (px, py), (qx, qy) = edge
    ex, ey = qx - px, qy - py
    square = ex * ex + ey * ey
    along = ((place[0] - px) * ex + (place[1] - py) * ey) / square if square else 0.0
    share = min(1.0, max(0.0, along))
    return hypot(place[0] - px - share * ex, place[1] - py - share * ey)


def _is_inside(edges: Sequence[Edge], place: Point) -> bool:
    """True inside, and on an edge: margin 0 is not yet outside."""
    x, y = place
    inside = False
    for (px, py), (qx, qy) in edges:
        if (py > y) != (qy > y):
            inside ^= x < px + (y - py) / (qy - py) * (qx - px)
    return inside or any(_distance(edge, place) < 1e-9 for edge in edges)


def _farthest(edges: Sequence[Edge], a: Point, b: Point, known: float) -> float:
    """The greatest distance to the nearest edge on the way from a to b, if more than `known`.

    Branch and bound: on a straight way the distance to one edge is convex, so its larger end
    bounds it, and the smallest of these bounds that to the nearest edge.
    """
    near_a = [_distance(edge, a) for edge in edges]
    near_b = [_distance(edge, b) for edge in edges]
    best = max(known, min(near_a), min(near_b))
    ways = [(-min(map(max, near_a, near_b)), a, b, near_a, near_b)]
    while ways:
        bound, a, b, near_a, near_b = heappop(ways)
        if -bound <= best + CLOSE_CM:
            break
        middle = _between(a, b, 0.5)
        near = [_distance(edge, middle) for edge in edges]
        best = max(best, min(near))
        heappush(ways, (-min(map(max, near_a, near)), a, middle, near_a, near))
        heappush(ways, (-min(map(max, near, near_b)), middle, b, near, near_b))
    return best
