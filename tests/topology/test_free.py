"""Free graphs: the paper's small counterexamples and wrong ends."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from innervate.topology import TopologyError, free_graph
from innervate.topology.free import split_end
from innervate.topology.layout import cell_places


def test_triangle_with_two_interfaces() -> None:
    graph = free_graph([("n1", "pc.0"), ("n2.W", "pc.1"), ("n1.3", "n2")])
    assert graph.names == ("n1", "n2")
    assert graph.interfaces == 2
    assert [(graph.label_end(a), graph.label_end(b)) for a, b in graph.links()] == [
        ("n1 W", "pc.0"),
        ("n1 down", "n2 E"),
        ("n2 W", "pc.1"),
    ]
    assert list(graph.depths()) == [1, 1]
    assert len(cell_places(graph)) == 2


def test_named_ports_are_kept_for_their_cables() -> None:
    graph = free_graph([("a", "pc"), ("a", "b"), ("a.0", "c"), ("pc.0", "b")])
    assert graph.label_end(graph.peer[graph.end(0, 0)]) == "c W"
    assert graph.label_end(graph.peer[4 * graph.cells]) == "b E"
    assert graph.label_end(graph.peer[4 * graph.cells + 1]) == "a E"


@pytest.mark.parametrize(
    ("links", "words", "subject"),
    [
        ([("n1", "n1")], "to itself", "link.0"),
        ([("n1.0", "pc"), ("n1.0", "n2")], "already cabled", "link.1"),
        ([("n1.7", "pc")], "no port", "link.0.a"),
        ([("n1", "pc.x")], "no interface port", "link.0.b"),
        ([("n1", "pc.2")], "nothing is on pc.0", "link"),
        ([("", "pc")], "names no cell", "link.0.a"),
        ([("n.", "pc")], "names no cell", "link.0.a"),
        ([("a", x) for x in "bcdef"], "a has no port left", "link.4.a"),
    ],
)
def test_wrong_links(links: list[tuple[str, str]], words: str, subject: str) -> None:
    with pytest.raises(TopologyError, match=words) as caught:
        free_graph(links)
    assert caught.value.subject == subject


@given(st.text(max_size=8))
def test_any_text_is_an_end_or_an_error(text: str) -> None:
    try:
        name, port = split_end(text)
    except TopologyError:
        return
    assert name
    assert port >= -1


@given(st.lists(st.tuples(st.sampled_from("abcdef"), st.sampled_from(["a", "b", "c", "pc"]))))
def test_random_links_are_a_graph_or_an_error(links: list[tuple[str, str]]) -> None:
    try:
        graph = free_graph(links)
    except TopologyError:
        return
    assert sum(1 for _ in graph.links()) == len(links)
    assert len(cell_places(graph)) == graph.cells
