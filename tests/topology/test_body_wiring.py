"""Which cables a body's cells get, and which of them the PC: worked out again with graphs."""

import math
import random
import re

import networkx as nx
import pytest

from innervate.topology import TopologyError, body_graph
from innervate.topology.body import joining_reach, propose

SEEDS = range(12)


def spots(seed, count_max=18):
    rng = random.Random(seed)
    grid = [(x, y, z) for x in range(6) for y in range(6) for z in range(3)]
    return [tuple(17.0 * v for v in spot) for spot in rng.sample(grid, rng.randint(4, count_max))]


def body(places, reach_mm, interfaces):
    return body_graph([f"c{i}" for i in range(len(places))], places, reach_mm, interfaces)


def all_pairs(places):
    """The complete graph, a cable's length in mm at each edge."""
    full = nx.Graph()
    full.add_nodes_from(range(len(places)))
    for a in range(len(places)):
        for b in range(a):
            full.add_edge(a, b, weight=math.dist(places[a], places[b]))
    return full


def cables(graph):
    """Between cells, as a graph."""
    found = nx.Graph()
    found.add_nodes_from(range(graph.cells))
    found.add_edges_from((a // 4, b // 4) for a, b in graph.links() if b < 4 * graph.cells)
    return found


@pytest.mark.parametrize("seed", SEEDS)
def test_the_longest_cable_that_is_needed_is_that_of_the_least_tree(seed):
    places = spots(seed)
    tree = nx.minimum_spanning_tree(all_pairs(places))
    needed = max(length for *_, length in tree.edges.data("weight"))
    assert joining_reach(places) == pytest.approx(needed)


@pytest.mark.parametrize(
    ("places", "reach"), [([], 0), ([(1, 2, 3)], 0), ([(0, 0, 0), (3, 4, 0)], 5)]
)
def test_the_reach_of_few_cells(places, reach):
    assert joining_reach(places) == reach


def test_the_reach_counts_with_the_four_ports_of_a_cell():
    """Six cells about one: two of them are joined by way of others, which is farther."""
    about = [
        tuple(10 * way * (axis == a) for a in range(3)) for axis in range(3) for way in (1, -1)
    ]
    places = [(0, 0, 0), *about]
    reach = joining_reach(places)
    assert reach == pytest.approx(math.sqrt(200))
    assert nx.is_connected(cables(body(places, reach, 1)))
    with pytest.raises(TopologyError, match=r"reach_mm = 14\.2 would join them"):
        body(places, 10.0, 1)


@pytest.mark.parametrize("seed", SEEDS)
def test_the_reach_that_is_named_joins_all_and_is_no_longer_than_it_has_to_be(seed):
    places = spots(seed)
    with pytest.raises(TopologyError) as caught:
        body(places, 1.0, 1)
    named = float(re.search(r"reach_mm = ([\d.]+)", str(caught.value))[1])
    assert nx.is_connected(cables(body(places, named, 1)))
    with pytest.raises(TopologyError, match="would join them"):
        body(places, named - 0.2, 1)


@pytest.mark.parametrize("count", [1, 4, 5, 9])
def test_of_those_left_out_four_are_named_and_the_largest_group_is_not(count):
    places = [(10.0 * i, 0.0, 0.0) for i in range(12)]
    places += [(500.0 + 100.0 * i, 0.0, 0.0) for i in range(count)]
    with pytest.raises(TopologyError) as caught:
        body(places, 10.0, 1)
    some = ", ".join(f"c{12 + i}" for i in range(min(4, count)))
    more = f" and {count - 4} more" if count > 4 else ""
    assert f"cables of 10 mm leave out {some}{more}; reach_mm = 390 would" in str(caught.value)


@pytest.mark.parametrize("interfaces", [1, 3])
@pytest.mark.parametrize("seed", SEEDS)
def test_a_cable_that_is_left_out_lacks_a_port_or_would_take_an_interfaces(seed, interfaces):
    places = spots(seed)
    reach = joining_reach(places) + 10.0
    graph = body(places, reach, interfaces)
    drawn, ports = cables(graph), 4 * graph.cells
    spare = ports - 2 * drawn.number_of_edges() - interfaces
    assert spare >= 0
    assert min(graph.depths()) >= 1
    with_interface = {graph.peer[ports + i] // 4 for i in range(interfaces)}
    assert len(with_interface) == interfaces
    for a, b, length in all_pairs(places).edges.data("weight"):
        if length <= reach and not drawn.has_edge(a, b):
            full = [c for c in (a, b) if drawn.degree[c] == 4]
            left = [c for c in drawn if drawn.degree[c] + (c in (a, b)) < 4]
            assert full or spare < 2 or len(left) < interfaces
        assert length <= reach or not drawn.has_edge(a, b)


@pytest.mark.parametrize(("cells", "chosen"), [(1, [0]), (2, [0, 1]), (3, [0, 2]), (4, [0, 2]),
                                               (5, [0, 4]), (6, [0, 4]), (9, [0, 8])])  # fmt: skip
def test_of_a_row_two_cells_an_even_number_of_hops_apart_get_the_pc(cells, chosen):
    """Ties between two ports exist only then [skin E15]; else the ends would be taken."""
    graph = body([(20.0 * i, 0.0, 0.0) for i in range(cells)], 20.0, 0)
    assert propose(graph, min(2, cells)) == chosen


@pytest.mark.parametrize("seed", SEEDS)
def test_each_further_interface_is_as_many_hops_from_the_others_as_one_can_be(seed):
    places = spots(seed)
    graph = body(places, joining_reach(places) + 5.0, 0)
    far = dict(nx.all_pairs_shortest_path_length(cables(graph)))
    free = [cell for cell in range(graph.cells) if graph.free_ports(cell)]
    count = min(4, len(free))
    chosen = propose(graph, count)
    assert len(set(chosen)) == count
    assert set(chosen) <= set(free)
    first = chosen[0]
    for i in range(1, count):

        def score(cell, before=chosen[:i]):
            return min(far[cell][one] for one in before) - 1.5 * (far[first][cell] % 2)

        left = [cell for cell in free if cell not in chosen[:i]]
        assert score(chosen[i]) == max(map(score, left))


def test_the_first_interface_is_at_the_border():
    places = [(20.0 * x, 20.0 * y, 0.0) for x in range(5) for y in range(5)]
    corners = {0, 4, 20, 24}
    graph = body(places, 20.0, 0)
    assert propose(graph, 1)[0] in corners
    assert set(propose(graph, 4)) == corners
    assert propose(graph, 0) == []
    graph.add_interface(0)
    assert set(propose(graph, 4)) == corners  # the PC is no way from cell to cell
    with pytest.raises(TopologyError, match=r"only \d+ cells have a free port for 25"):
        propose(graph, 25)
