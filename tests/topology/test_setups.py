"""The paper's setups have the sizes, depths and ties that the specification lists [skin 1a]."""

from __future__ import annotations

from collections import Counter

import pytest

from innervate.topology import Graph, from_patches

# columns, rows, roots, h (0 = not given), deepest, degrees 2/3/4, tie cells
SETUPS = {
    1: (9, 11, ((0, 3), (10, 5)), 13, 10, (4, 32, 63), 9),
    2: (11, 9, ((0, 5), (8, 5)), 9, 10, (4, 32, 63), 11),
    3: (5, 7, ((0, 2), (6, 2)), 7, 6, (4, 16, 15), 5),
    4: (7, 5, ((0, 3), (4, 3)), 5, 6, (4, 16, 15), 7),
    5: (12, 12, ((0, 2), (2, 0)), 0, 21, (4, 40, 100), 102),
    6: (10, 15, ((0, 4), (4, 0)), 0, 20, (4, 42, 104), 70),
    7: (12, 17, ((1, 0), (9, 0), (16, 7)), 0, 16, (4, 50, 150), 39),
    8: (12, 17, ((0, 4), (16, 7)), 20, 14, (4, 50, 150), 0),
}


def hops(graph: Graph, start: int) -> list[int]:
    """Hops from a cell to every cell over cables between cells."""
    far = {start: 0}
    queue = [start]
    for cell in queue:
        for other in graph.neighbours(cell):
            if other != graph.sink and other not in far:
                far[other] = far[cell] + 1
                queue.append(other)
    return [far[cell] for cell in range(graph.cells)]


@pytest.mark.parametrize("number", SETUPS)
def test_setup_is_as_listed(number: int) -> None:
    columns, rows, roots, h, deepest, degrees, ties = SETUPS[number]
    graph = from_patches([(columns, rows, "Z")])
    assert graph.cells == columns * rows
    counts = Counter(4 - len(graph.free_ports(cell)) for cell in range(graph.cells))
    assert (counts[2], counts[3], counts[4]) == degrees
    cells = [graph.patches[0].cell(*root) for root in roots]
    for cell in cells:
        graph.add_interface(cell)
    assert graph.interfaces == len(roots)
    depths = graph.depths()
    assert max(depths) == deepest
    if h:
        assert hops(graph, cells[0])[cells[1]] + 1 == h
    # A tie cell is as near to one root as to another: it can choose between interface ports.
    tied = 0
    from_roots = [hops(graph, cell) for cell in cells]
    for cell in range(graph.cells):
        shortest = sorted(far[cell] for far in from_roots)
        tied += shortest[0] == shortest[1]
    assert tied == ties


def test_rule_s_with_opposite_corners_has_13_hops() -> None:
    graph = from_patches([(9, 11, "S")])
    patch = graph.patches[0]
    assert hops(graph, patch.cell(0, 8))[patch.cell(10, 0)] == 13
