"""The networks that are compared: links, and between which nodes probes go."""

from typing import NamedTuple


class Shape(NamedTuple):
    name: str
    count: int
    links: list[tuple[int, int]]
    source: int
    sink: int


def ring(count=8):
    links = [(i, (i + 1) % count) for i in range(count)]
    return Shape(f"ring of {count}", count, [tuple(sorted(pair)) for pair in links], 0, count // 2)


def grid(side=3):
    links = []
    for row in range(side):
        for column in range(side):
            node = row * side + column
            if column + 1 < side:
                links.append((node, node + 1))
            if row + 1 < side:
                links.append((node, node + side))
    return Shape(f"grid {side}x{side}", side * side, links, 0, side * side - 1)


def hexagon(radius=2):
    """Cells at most `radius` steps from the middle one; each has up to six neighbours."""
    cells = [
        (q, r)
        for r in range(-radius, radius + 1)
        for q in range(-radius, radius + 1)
        if abs(q + r) <= radius
    ]
    number = {cell: i for i, cell in enumerate(cells)}
    links = []
    for (q, r), node in number.items():
        for step in ((1, 0), (0, 1), (-1, 1)):
            other = number.get((q + step[0], r + step[1]))
            if other is not None:
                links.append(tuple(sorted((node, other))))
    ends = number[(-radius, 0)], number[(radius, 0)]
    return Shape(f"hexagons {len(cells)}", len(cells), sorted(links), *ends)


SHAPES = {"ring": ring, "grid": grid, "hexagon": hexagon}
