"""Patches, cables and the graph's table."""

from __future__ import annotations

import math
import time
from array import array

import pytest
from hypothesis import given
from hypothesis import strategies as st

from innervate.topology import Graph, Patch, TopologyError, from_patches, join_chain, port_number
from innervate.topology import graph as graphs
from innervate.topology.layout import cell_places
from innervate.topology.patch import neighbour

shapes = st.tuples(st.integers(1, 7), st.integers(1, 7), st.sampled_from("ZS"))


@given(st.lists(shapes, min_size=1, max_size=4))
def test_every_cable_has_two_ends(patches: list[tuple[int, int, str]]) -> None:
    graph = from_patches(patches)
    assert len(graph.peer) == 4 * graph.cells + graph.interfaces
    for end, other in enumerate(graph.peer):
        if other >= 0:
            assert graph.peer[other] == end
            assert graph.port_of(other) == graph.port_of(end) ^ 1
            assert graph.patch_of(graph.node_of(end)) == graph.patch_of(graph.node_of(other))


@given(shapes)
def test_neighbours_touch_on_the_honeycomb(shape: tuple[int, int, str]) -> None:
    graph = from_patches([shape])
    points = cell_places(graph)
    for a, b in graph.links():
        assert math.dist(points[a // 4], points[b // 4]) == pytest.approx(14.0)


@given(st.integers(1, 9), st.integers(1, 9))
def test_rule_s_wires_as_many_cells_as_rule_z_or_fewer(columns: int, rows: int) -> None:
    counts = [sum(1 for _ in from_patches([(columns, rows, w)]).links()) for w in "ZS"]
    assert counts[0] == rows * (columns - 1) + columns * (rows - 1)
    assert counts[1] <= counts[0]


def test_ends_and_labels() -> None:
    graph = from_patches([(3, 2, "Z"), (2, 2, "Z")])
    assert graph.add_interface(graph.patches[1].cell(0, 1), "E") == 0
    assert graph.label(graph.patches[0].cell(1, 2)) == "p0 r1 c2"
    end = graph.end(graph.patches[1].cell(0, 1), 1)
    assert graph.label_end(end) == "p1 r0 c1 E"
    assert graph.label_end(graph.peer[end]) == "pc.0"
    assert graph.label(graph.sink) == "pc"
    assert graph.node_of(graph.peer[end]) == graph.sink == graph.nodes - 1
    assert graph.neighbours(graph.sink) == [graph.patches[1].cell(0, 1)]
    assert list(graph.depths()) == [-1] * 6 + [2, 1, 3, 2]


def test_connect_names_both_sides() -> None:
    graph = from_patches([(3, 3, "Z"), (2, 2, "Z")])
    with pytest.raises(TopologyError, match="port p0 r0 c0 E is already cabled to p0 r0 c1 W"):
        graph.connect(graph.end(0, 1), graph.end(9, 0))
    with pytest.raises(TopologyError, match="join p0 r0 c0 to itself"):
        graph.connect(graph.end(0, 0), graph.end(0, 2))
    with pytest.raises(TopologyError, match="p0 r1 c1 has no free port; choose a border cell"):
        graph.add_interface(4)
    with pytest.raises(TopologyError, match="already cabled"):
        graph.add_interface(0, "E")
    assert graph.interfaces == 0
    assert len(graph.peer) == 4 * graph.cells


@pytest.mark.parametrize(
    ("port", "number"), [("W", 0), ("e", 1), ("up", 2), ("Down", 3), ("2", 2), (1, 1)]
)
def test_port_names(port: str | int, number: int) -> None:
    assert port_number(port) == number


@pytest.mark.parametrize("port", ["X", "", 4, -1, "10"])
def test_unknown_ports(port: str | int) -> None:
    with pytest.raises(TopologyError, match="no port is called"):
        port_number(port)


def test_cells_out_of_the_patch() -> None:
    patch = Patch(3, 2, "Z", 10)
    assert patch.row_column(patch.cell(1, 2)) == (1, 2)
    with pytest.raises(TopologyError, match="no row 2; rows are 0 to 1"):
        patch.cell(2, 0)
    with pytest.raises(TopologyError, match="no column -1"):
        patch.cell(0, -1)


def test_too_many_cells() -> None:
    with pytest.raises(TopologyError, match="more than 4,000,000"):
        from_patches([(4000, 4000, "Z")])


def joined(count: int) -> Graph:
    graph = from_patches([(6, 10, "Z")] * count)
    join_chain(graph, 0, count)
    for patch in graph.patches:
        graph.add_interface(patch.cell(0, 3))
    return graph


def test_patches_never_overlap() -> None:
    for count in (1, 5, 40, 70):
        points = cell_places(joined(count))
        assert len(points) == 60 * count
        assert len({(round(x), round(y)) for x, y in points}) == 60 * count
        assert min(x for x, _ in points) >= 0
        assert min(y for _, y in points) >= 0


def test_joined_patches_lie_side_by_side() -> None:
    graph = from_patches([(6, 10, "Z")] * 2)
    graph.connect(graph.end(5, 1), graph.end(60, 0))
    points = cell_places(graph)
    assert math.dist(points[5], points[60]) < 45


def test_a_million_cells_are_quick() -> None:
    start = time.perf_counter()
    graph = joined(1667)
    depths = graph.depths()
    assert time.perf_counter() - start < 2.0  # a tenth of a million in a tenth of the time
    assert graph.cells == 100_020
    assert max(depths) == 13
    assert min(depths) == 1


@pytest.mark.parametrize(
    ("wiring", "near"),
    [
        ("Z", {(1, 1): [(1, 0), (1, 2), (0, 1), (2, 1)], (2, 1): [(2, 0), (2, 2), (1, 1), None]}),
        ("S", {(1, 1): [(1, 0), (1, 2), (0, 2), (2, 1)], (2, 1): [(2, 0), (2, 2), (1, 1), None],
               (0, 1): [(0, 0), (0, 2), None, (1, 0)], (0, 0): [None, (0, 1), None, None],
               (1, 2): [(1, 1), None, None, (2, 2)]}),
    ],
)  # fmt: skip
def test_each_rule_wires_its_own_neighbours(
    wiring: str, near: dict[tuple[int, int], list[tuple[int, int] | None]]
) -> None:
    patch = Patch(3, 3, wiring, 40)
    for (row, column), wanted in near.items():
        assert [neighbour(patch, row, column, port) for port in range(4)] == wanted
    graph = from_patches([(3, 3, wiring)])
    for (row, column), wanted in near.items():
        ends = [graph.peer[graph.end(3 * row + column, port)] for port in range(4)]
        cells = [-1 if one is None else 3 * one[0] + one[1] for one in wanted]
        assert [end // 4 if end >= 0 else -1 for end in ends] == cells


@pytest.mark.parametrize(("rows", "joint"), [(1, 0), (2, 1), (3, 1), (10, 5)])
def test_patches_are_joined_in_the_middle_of_their_sides(rows: int, joint: int) -> None:
    graph = from_patches([(3, 2, "Z"), (2, rows, "Z"), (4, 3, "S"), (1, 1, "Z")])
    join_chain(graph, 1, 2)
    across = [(a, b) for a, b in graph.links() if graph.patch_of(a // 4) != graph.patch_of(b // 4)]
    left, right = graph.patches[1], graph.patches[2]
    assert across == [(4 * left.cell(joint, 1) + 1, 4 * right.cell(1, 0))]


def test_what_no_cable_leads_to_is_nowhere() -> None:
    graph = from_patches([(2, 1, "Z"), (1, 1, "Z")])
    assert list(graph.depths()) == [-1, -1, -1]
    assert graph.add_interface(1) == 0
    assert graph.add_interface(1, "up") == 1
    assert list(graph.depths()) == [2, 1, -1]
    assert graph.neighbours(graph.sink) == [1, 1]
    assert (list(graph.ends_of(graph.sink)), list(graph.ends_of(1))) == ([12, 13], [4, 5, 6, 7])
    assert [graph.port_of(end) for end in (7, 11, 12, 13)] == [3, 3, 0, 1]
    assert list(Graph(0, 0, array("i")).depths()) == []


def test_a_port_in_the_way_is_told_with_those_that_are_free() -> None:
    graph = from_patches([(1, 1, "Z")] * 3)
    graph.connect(graph.end(0, 1), graph.end(1, 0))
    with pytest.raises(TopologyError, match="p2 r0 c0 W cannot be joined to it; free on p0 r0"):
        graph.connect(graph.end(0, 1), graph.end(2, 0))
    with pytest.raises(TopologyError, match=r"port p0 r0 c0 E is .* so p2 r0 c0 W cannot"):
        graph.connect(graph.end(2, 0), graph.end(0, 1))
    assert graph.free_ports(2) == [0, 1, 2, 3]
    assert graph.free_end(0) == 0
    assert graph.free_end(0, "down") == 3
    graph.add_interface(2)
    with pytest.raises(TopologyError, match="use another interface port"):
        graph.connect(graph.end(graph.sink, 0), graph.end(1, 3))
    assert Graph(2, 0, array("i", [-1] * 8)).label(1) == "cell 1"
    assert graph.nodes == 4


def test_all_interface_ports_are_the_pcs() -> None:
    graph = from_patches([(2, 1, "Z")])
    for port in ("up", "down", "W"):
        graph.add_interface(0, port)
    for port in ("up", "down", "E"):
        graph.add_interface(1, port)
    assert [graph.node_of(end) for end in range(6, 14)] == [1, 1] + [2] * 6
    assert graph.neighbours(0) == [2, 1, 2, 2]
    assert graph.label_end(13) == "pc.5"


def test_all_patches_together_are_no_larger_than_they_can_be(monkeypatch) -> None:
    monkeypatch.setattr(graphs, "CELLS_MAX", 10)
    assert from_patches([(2, 3, "Z"), (2, 2, "S")]).cells == 10
    with pytest.raises(TopologyError, match="more than 10 cells"):
        from_patches([(2, 3, "Z"), (2, 2, "S"), (1, 1, "Z")])
