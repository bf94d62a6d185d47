"""Where to draw cells: honeycombs side by side, unrolled bodies, layers of a free graph.

All lengths in mm, x to the right, y down. The pitch of 14 mm is that of the published cell.
"""

from __future__ import annotations

import math
from array import array
from collections import Counter

from innervate.topology.graph import Graph
from innervate.topology.patch import PORTS, Patch

PITCH_MM = 14.0
ROW_MM = PITCH_MM * math.sqrt(3) / 2
GAP_MM = 2 * PITCH_MM
CABLED_PATCHES_MAX = 64
# One cell's step towards W, E, up, down.
_STEP = ((-PITCH_MM, 0.0), (PITCH_MM, 0.0), (0.0, -ROW_MM), (0.0, ROW_MM))

Point = tuple[float, float]


def cell_places(graph: Graph) -> list[Point]:
    """(x_mm, y_mm) of every cell; the smallest x and y are 0."""
    if graph.patches:
        return _patched(graph)
    if len(graph.positions) == 3 * graph.cells > 0:
        return _unrolled(graph.positions)
    return _layered(graph)


def _size(patch: Patch) -> Point:
    shift = 0.5 if patch.rows > 1 else 0.0
    return PITCH_MM * (patch.columns - 1 + shift), ROW_MM * (patch.rows - 1)


def _in_patch(patch: Patch, cell: int) -> Point:
    row, column = patch.row_column(cell)
    return PITCH_MM * (column + 0.5 * (row & 1)), ROW_MM * row


def _patched(graph: Graph) -> list[Point]:
    patches = graph.patches
    corners = _by_cables(graph) if len(patches) <= CABLED_PATCHES_MAX else _in_grid(patches)
    points = []
    for patch, (x, y) in zip(patches, corners, strict=True):
        across = [[PITCH_MM * (c + s) for c in range(patch.columns)] for s in (0.0, 0.5)]
        for row in range(patch.rows):
            y_mm = y + ROW_MM * row
            points.extend([(x + dx, y_mm) for dx in across[row & 1]])
    return points


def _in_grid(patches: tuple[Patch, ...]) -> list[Point]:
    """Patches in rows of a square, in the order of their numbers."""
    wide = max(_size(p)[0] for p in patches) + GAP_MM
    high = max(_size(p)[1] for p in patches) + GAP_MM
    across = math.ceil(math.sqrt(len(patches) * high / wide))
    return [(wide * (i % across), high * (i // across)) for i in range(len(patches))]


def _by_cables(graph: Graph) -> list[Point]:
    """Each patch beside one it is cabled to, where there is room; else to the right of all."""
    patches = graph.patches
    corner: dict[int, Point] = {}
    joints: list[list[tuple[int, int]]] = [[] for _ in patches]
    for a, b in graph.links():
        if b < PORTS * graph.cells:
            here, there = graph.patch_of(a // PORTS), graph.patch_of(b // PORTS)
            if here != there:
                joints[here].append((a, b))
                joints[there].append((b, a))
    for start in range(len(patches)):
        if start in corner:
            continue
        right = max((corner[i][0] + _size(patches[i])[0] + GAP_MM for i in corner), default=0.0)
        corner[start] = (right, 0.0)
        queue = [start]
        for index in queue:
            for mine, theirs in joints[index]:
                other = graph.patch_of(theirs // PORTS)
                if other not in corner:
                    corner[other] = _beside(graph, corner, index, mine, theirs)
                    queue.append(other)
    left = min(x for x, _ in corner.values())
    top = min(y for _, y in corner.values())
    return [(corner[i][0] - left, corner[i][1] - top) for i in range(len(patches))]


def _beside(graph: Graph, corner: dict[int, Point], index: int, mine: int, theirs: int) -> Point:
    """Corner of the patch of end `theirs`, a few cells away from end `mine` if that is free."""
    patch = graph.patches[graph.patch_of(theirs // PORTS)]
    here = _in_patch(graph.patches[index], mine // PORTS)
    there = _in_patch(patch, theirs // PORTS)
    x, y = corner[index][0] + here[0] - there[0], corner[index][1] + here[1] - there[1]
    towards = [_STEP[mine % PORTS], _STEP[(theirs % PORTS) ^ 1], *_STEP]
    for cells in (1, 2, 3, 5, 8, 12):
        for dx, dy in towards:
            place = (x + cells * dx, y + cells * dy)
            if all(_apart(patch, place, graph.patches[i], at) for i, at in corner.items()):
                return place
    right = max(at[0] + _size(graph.patches[i])[0] for i, at in corner.items())
    return right + GAP_MM, 0.0


def _apart(a: Patch, at_a: Point, b: Patch, at_b: Point) -> bool:
    (wide_a, high_a), (wide_b, high_b) = _size(a), _size(b)
    room_x, room_y = 0.99 * PITCH_MM, 0.99 * ROW_MM
    return (
        at_a[0] + wide_a + room_x < at_b[0]
        or at_b[0] + wide_b + room_x < at_a[0]
        or at_a[1] + high_a + room_y < at_b[1]
        or at_b[1] + high_b + room_y < at_a[1]
    )


def _layered(graph: Graph) -> list[Point]:
    """One row per hop count, in order of cell number; unconnected cells at the bottom."""
    depth = graph.depths()
    bottom = max(depth, default=0) + 1
    filled: dict[int, int] = {}
    counts = Counter(depth)
    widest = max(counts.values(), default=0)
    points = []
    for hops in depth:
        level = hops if hops > 0 else bottom
        column = filled.get(level, 0)
        filled[level] = column + 1
        margin = (widest - counts[hops]) / 2
        points.append((2 * PITCH_MM * (column + margin), 2 * PITCH_MM * (level - 1)))
    return points


def _unrolled(positions: array[float]) -> list[Point]:
    """A skin round a limb, unrolled: y along its longest axis, x the angle round it.

    The cut is where the widest gap between two angles is.
    """
    count = len(positions) // 3
    points = [tuple(positions[3 * i : 3 * i + 3]) for i in range(count)]
    centre = tuple(math.fsum(p[a] for p in points) / count for a in range(3))
    moved = [tuple(p[a] - centre[a] for a in range(3)) for p in points]
    axis = _longest_axis(moved)
    least = min(range(3), key=lambda a: abs(axis[a]))
    side = _cross(axis, tuple(1.0 if a == least else 0.0 for a in range(3)))
    norm = math.sqrt(_dot(side, side))
    side = tuple(v / norm for v in side)
    third = _cross(axis, side)
    flat = [(_dot(p, side), _dot(p, third), _dot(p, axis)) for p in moved]
    radius = math.fsum(math.hypot(u, v) for u, v, _ in flat) / count
    angles = [math.atan2(v, u) for u, v, _ in flat]
    order = sorted(angles)
    gaps = [(order[i] - order[i - 1]) % math.tau for i in range(count)]
    start = order[gaps.index(max(gaps))] if count > 1 else 0.0
    top = min(w for _, _, w in flat)
    return [
        (radius * ((angle - start) % math.tau), w - top)
        for angle, (_, _, w) in zip(angles, flat, strict=True)
    ]


def _longest_axis(points: list[tuple[float, ...]]) -> tuple[float, ...]:
    """Direction of greatest variance, by power iteration on the 3 x 3 covariance.

    From several starts: one alone may stand square to it, and would never turn there.
    """
    spread = [[math.fsum(p[a] * p[b] for p in points) for b in range(3)] for a in range(3)]
    starts = (
        tuple(1.0 + spread[a][a] for a in range(3)),
        *(tuple(float(a == b) for b in range(3)) for a in range(3)),
    )
    found = [_grown(spread, start) for start in starts]
    most = max(norm for norm, _ in found)
    return next(axis for norm, axis in found if norm >= (1 - 1e-9) * most)


def _grown(spread: list[list[float]], axis: tuple[float, ...]) -> tuple[float, tuple[float, ...]]:
    """How much a direction grows that was turned towards the greatest variance, and itself."""
    norm = 0.0
    for _ in range(60):
        grown = tuple(_dot(tuple(row), axis) for row in spread)
        norm = math.sqrt(_dot(grown, grown))
        if norm < 1e-9:
            return 0.0, (1.0, 0.0, 0.0)
        axis = tuple(v / norm for v in grown)
    return norm, axis


def _dot(a: tuple[float, ...], b: tuple[float, ...]) -> float:
    return math.fsum(x * y for x, y in zip(a, b, strict=True))


def _cross(a: tuple[float, ...], b: tuple[float, ...]) -> tuple[float, ...]:
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])
