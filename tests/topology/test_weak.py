"""Cables and cells whose loss isolates others, against taking each of them away."""

import random

import networkx
import pytest

from innervate.topology import Graph, from_patches, join_chain
from innervate.topology.free import free_graph
from innervate.topology.weak import Weak, weak_points


def by_taking_away(graph):
    """(isolated, end's cable or None, node or None) of every cable and cell, by brute force."""
    whole = networkx.MultiGraph()
    whole.add_nodes_from(range(graph.nodes))
    whole.add_edges_from((graph.node_of(a), graph.node_of(b), (a, b)) for a, b in graph.links())
    joined = networkx.node_connected_component(whole, graph.sink)
    found = set()
    for a, b, key in list(whole.edges(keys=True)):
        left = whole.copy()
        left.remove_edge(a, b, key)
        lost = len(joined - networkx.node_connected_component(left, graph.sink))
        if lost:
            found.add((lost, frozenset(key), None))
    for cell in sorted(joined - {graph.sink}):
        left = whole.copy()
        left.remove_node(cell)
        lost = len(joined - networkx.node_connected_component(left, graph.sink)) - 1
        if lost:
            found.add((lost, None, cell))
    return found


def as_set(graph, weak):
    return {
        (one.isolated, frozenset((one.end, graph.peer[one.end])) if one.end >= 0 else None,
         one.node if one.node >= 0 else None)
        for one in weak
    }  # fmt: skip


@pytest.mark.parametrize("seed", range(40))
def test_the_same_as_taking_each_away(seed):
    draw = random.Random(seed)
    graph = from_patches([(draw.randint(1, 5), draw.randint(1, 4), "Z")])
    for end, other in list(graph.links()):
        if draw.random() < 0.3:
            graph.peer[end] = graph.peer[other] = -1
    for _ in range(draw.randint(1, 3)):
        cells = [cell for cell in range(graph.cells) if graph.free_ports(cell)]
        graph.add_interface(draw.choice(cells))
    assert as_set(graph, weak_points(graph)) == by_taking_away(graph)


def test_two_cables_between_the_same_two_are_no_weak_point():
    links = [("pc.0", "a"), ("a", "b"), ("a", "b"), ("b", "pc.1")]
    assert weak_points(free_graph(links)) == []


def test_a_cable_is_named_by_its_end_towards_the_pc_and_the_worst_comes_first():
    graph = free_graph([("pc.0", "a"), ("a", "b"), ("b", "c")])
    found = weak_points(graph)
    assert [one.isolated for one in found] == [3, 2, 2, 1, 1]
    assert found[0] == Weak(3, 12, -1)
    assert [graph.node_of(one.end) for one in found if one.end >= 0] == [3, 0, 1]


def test_a_hundred_thousand_cells_in_a_row_are_not_too_deep():
    graph = from_patches([(100_000, 1, "Z")])
    graph.add_interface(0)
    assert weak_points(graph)[0].isolated == 100_000


def test_a_skin_of_patches_joined_by_single_cables():
    graph: Graph = from_patches([(4, 4, "Z")] * 3)
    join_chain(graph, 0, 3)
    graph.add_interface(0)
    assert [one.isolated for one in weak_points(graph) if one.end >= 0] == [48, 32, 16]


def test_of_those_that_isolate_as_many_cables_come_before_cells_and_lower_numbers_first():
    graph = free_graph([("pc.0", "a"), ("a", "b"), ("b", "c"), ("pc.1", "x"), ("x", "y")])
    found = weak_points(graph)
    assert found == sorted(found, key=lambda one: (-one.isolated, one.end < 0, one.node, one.end))
    twos = [(one.end >= 0, one.node) for one in found if one.isolated == 2]
    assert twos == [(True, -1), (True, -1), (False, 0)]
