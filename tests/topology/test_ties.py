"""Cells between two interface ports, by hand."""

from innervate.topology import free_graph
from innervate.topology.ties import tied_at


def test_cells_that_are_as_far_from_two_ports_are_counted_by_their_distance():
    ring = [("pc.0", "a"), ("a", "b"), ("b", "c"), ("c", "pc.1")]
    assert tied_at(free_graph(ring)) == {2: 1}
    assert tied_at(free_graph([*ring, ("b", "d")])) == {2: 1, 3: 1}
    assert tied_at(free_graph([("pc.0", "a"), ("a", "b"), ("b", "pc.1")])) == {}


def test_a_port_that_nothing_is_on_is_no_way():
    graph = free_graph([("pc.0", "a"), ("a", "b"), ("b", "pc.1")])
    graph.peer[4 * graph.cells + 1] = -1
    assert tied_at(graph) == {}


def test_what_no_cable_leads_to_is_tied_to_nobody():
    graph = free_graph([("pc.0", "a"), ("a", "pc.1"), ("b", "c")])
    assert tied_at(graph) == {1: 1}


def test_the_two_nearest_of_three_ports_tie():
    star = [("pc.0", "a"), ("pc.1", "b"), ("a", "m"), ("b", "m"), ("m", "c"), ("c", "pc.2")]
    assert tied_at(free_graph(star)) == {2: 1}  # to m all three
    longer = [*star[:4], ("m", "d"), ("d", "c"), ("c", "pc.2")]
    assert tied_at(free_graph(longer)) == {2: 1}  # to m the first two
