"""Free graphs: the paper's small counterexamples and wrong ends."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from innervate.topology import TopologyError, free, free_graph
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


@pytest.mark.parametrize(("text", "end"), [
    ("n1", ("n1", -1)), ("n1.2", ("n1", 2)), ("n1.down", ("n1", 3)), ("a.b.E", ("a.b", 1)),
    ("pc", ("pc", -1)), ("pc.0", ("pc", 0)), ("pc.1048575", ("pc", 1_048_575)),
    ("pcs.1", ("pcs", 1)),
])  # fmt: skip
def test_an_end_is_a_name_and_perhaps_a_port(text: str, end: tuple[str, int]) -> None:
    assert split_end(text) == end


@pytest.mark.parametrize(("text", "words"), [
    ("pc.1048576", "no interface port"), ("pc.00000000", "no interface port"),
    ("pc.-1", "no interface port"), ("pc.0.1", "no interface port"), ("pc.", "names no cell"),
    (".1", "names no cell"), (" ", "names no cell"), ("n1.4", "no port is called"),
])  # fmt: skip
def test_what_is_no_end(text: str, words: str) -> None:
    with pytest.raises(TopologyError, match=words):
        split_end(text)


@pytest.mark.parametrize(
    ("ends", "gap"), [(["pc.1"], 0), (["pc.0", "pc.2"], 1), (["pc.3", "pc.1"], 0)]
)
def test_an_interface_port_that_nothing_is_on_is_named(ends: list[str], gap: int) -> None:
    links = [(end, f"n{i}") for i, end in enumerate(ends)]
    most = max(int(end[3:]) for end in ends)
    with pytest.raises(TopologyError, match=f"port pc.{most} but nothing is on pc.{gap};"):
        free_graph(links)
    filled = free_graph([*links, *(("pc", f"m{i}") for i in range(most + 1 - len(ends)))])
    assert filled.interfaces == most + 1


def test_a_cell_has_four_cables_and_the_fifth_is_refused_on_its_side() -> None:
    links = [("a", name) for name in "bcde"]
    assert free_graph(links).neighbours(0) == [1, 2, 3, 4]
    with pytest.raises(TopologyError, match="a has no port left") as caught:
        free_graph([*links, ("f", "a")])
    assert caught.value.subject == "link.4.b"


def test_there_are_no_more_cells_than_there_can_be(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(free, "CELLS_MAX", 3)
    assert free_graph([("a", "b"), ("b", "c")]).cells == 3
    with pytest.raises(TopologyError, match="more than 3 cells") as caught:
        free_graph([("a", "b"), ("c", "d")])
    assert caught.value.subject == "link"
