"""Graphs of plans, node by node and link by link, and how they stand in files."""

import json
from array import array
from types import SimpleNamespace as Of

import pytest

from innervate.export import cabled
from innervate.export.graphs import Graph, graphml, node_link
from innervate.networks.mesh.export.graph import graph as mesh_graph
from innervate.networks.radio.export.graph import graph as radio_graph
from innervate.networks.skin.export.capture import interfaces as skin_interfaces
from innervate.networks.skin.export.graph import graph as skin_graph
from innervate.topology import Graph as Cabling
from innervate.topology import free_graph
from tests.networks.skin.runs import line, plan_of


def test_each_way_of_a_meshs_links_has_its_own_quality():
    made = Of(
        nodes=3, names=["a", "b", "c"], ranks=[1, 0, -1], robots=[0, 0, 1],
        positions_cm=[(0, 250), (100, 0), (-50, 5)], good=[(0, 1)],
        radio=Of(prob_q15=[9, 16384, 0, 8192, 9, 1, 0, 0, 9],
                 rssi_cdb=[0, -9050, -12000, -9100, 0, -9999, 0, 0, 0]),
    )  # fmt: skip
    nodes = [
        ("a", {"role": "standby", "number": 0, "robot": False, "x_m": 0.0, "y_m": 2.5}),
        ("b", {"role": "gateway", "number": 1, "robot": False, "x_m": 1.0, "y_m": 0.0}),
        ("c", {"role": "node", "number": 2, "robot": True, "x_m": -0.5, "y_m": 0.05}),
    ]
    edges = [
        ("a", "b", {"quality": 0.5, "rssi_dbm": -90.5, "good": True}),
        ("b", "a", {"quality": 0.25, "rssi_dbm": -91.0, "good": True}),
        ("b", "c", {"quality": 1 / 32768, "rssi_dbm": -99.99, "good": False}),
    ]
    assert mesh_graph(made) == Graph(True, nodes, edges)
    made.positions_cm = []
    assert set(mesh_graph(made).nodes[0][1]) == {"role", "number", "robot"}


def test_stations_that_hear_each_other_are_linked_also_at_one_place():
    made = Of(stations=3, delays_us=[[0, 52, -1], [60, 0, 0], [-1, 3, 0]])
    found = radio_graph(made)
    assert found.directed
    assert found.nodes[2] == ("station 2", {"role": "station", "number": 2})
    assert found.edges == [
        ("station 0", "station 1", {"delay_us": 52}), ("station 1", "station 0", {"delay_us": 60}),
        ("station 1", "station 2", {"delay_us": 0}), ("station 2", "station 1", {"delay_us": 3}),
    ]  # fmt: skip


def test_cells_have_their_places_and_hops_and_the_pc_its_numbered_ports():
    found = skin_graph(plan_of(line(3)))
    assert [about["hops"] for _, about in found.nodes] == [1, 2, 1, 0]
    assert [about.get("x_mm") for _, about in found.nodes] == [0.0, 14.0, 28.0, None]
    assert found.nodes[-1] == ("pc", {"role": "pc", "number": 3, "hops": 0})
    cells = [f"p0 r0 c{i}" for i in range(3)]
    assert found.edges == [
        (cells[0], "pc", {"port_a": "W", "port_b": "0"}),
        (cells[0], cells[1], {"port_a": "E", "port_b": "W"}),
        (cells[1], cells[2], {"port_a": "E", "port_b": "W"}),
        (cells[2], "pc", {"port_a": "E", "port_b": "1"}),
    ]  # fmt: skip


PAIR = free_graph([("a.E", "b.down")])


def test_a_network_of_cables_is_its_nodes_and_cables():
    found = cabled.graph(Of(graph=PAIR))
    assert found == Graph(
        False, [("a", {"number": 0}), ("b", {"number": 1})],
        [("a", "b", {"port_a": "E", "port_b": "down"})],
    )  # fmt: skip
    made = free_graph([("pc.0", "a")])
    assert cabled.graph(Of(graph=made)).nodes == [("a", {"number": 0}), ("pc", {"number": 1})]
    placed = Cabling(2, 0, PAIR.peer, (), ("a", "b"), array("d", [0, 0, 0, 0, 0, 9]))
    assert set(cabled.graph(Of(graph=placed)).nodes[0][1]) == {"number", "x_mm", "y_mm"}


def test_a_network_in_the_air_has_places_in_metres_where_they_are_known():
    made = Of(nodes=3, good=[(0, 2)], positions_cm=[(150, 20), (0, 0), (-5, 400)])
    assert cabled.graph(made) == Graph(
        False,
        [("node 0", {"number": 0, "x_m": 1.5, "y_m": 0.2}),
         ("node 1", {"number": 1, "x_m": 0.0, "y_m": 0.0}),
         ("node 2", {"number": 2, "x_m": -0.05, "y_m": 4.0})],
        [("node 0", "node 2", {})],
    )  # fmt: skip
    assert cabled.graph(Of(nodes=2)) == Graph(
        False, [("node 0", {"number": 0}), ("node 1", {"number": 1})], []
    )


def test_interfaces_of_a_capture_are_the_ports_that_have_a_cable():
    made = Of(graph=PAIR, nodes=2)
    assert cabled.interfaces(made) == [("a E", "node 0 port 1; a E to b down"),
                                       ("b down", "node 1 port 3; b down to a E")]  # fmt: skip
    numbers = cabled.numbers(made)
    assert [int(numbers[end]) for end in (1, 7)] == [0, 1]
    assert cabled.on_air(made) == [("node 0", "node 0"), ("node 1", "node 1")]
    assert cabled.stations(made).tolist() == [0, 1]
    names = skin_interfaces(Of(graph=free_graph([("pc.0", "n1.2")])))
    assert names == [("n1 up", "cell 0 port 2; n1 up to pc.0"),
                     ("pc.0", "pc port 0; pc.0 to n1 up")]  # fmt: skip


ABOUT = {"name": "x", "seed": 2}
NODES = [("a", {"on": True, "x_m": 1.5}), ("b", {"on": False})]
EDGES = [("a", "b", {"quality": 1}), ("a", "b", {})]


@pytest.mark.parametrize("directed", [True, False])
def test_a_file_has_every_attribute_with_its_type(directed):
    text = graphml(ABOUT, directed, NODES, EDGES)
    kinds = [("graph", "name", "string"), ("graph", "seed", "long"), ("node", "on", "boolean"),
             ("node", "x_m", "double"), ("edge", "quality", "long")]  # fmt: skip
    for number, (part, name, kind) in enumerate(kinds):
        key = f'<key id="d{number}" for="{part}" attr.name="{name}" attr.type="{kind}" />'
        assert key in text
    assert f'edgedefault="{"directed" if directed else "undirected"}"' in text
    for data in ("d0>x", "d1>2", "d2>true", "d2>false", "d3>1.5", "d4>1"):
        key, value = data.split(">")
        assert f'<data key="{key}">{value}</data>' in text
    content = json.loads(node_link(ABOUT, directed, NODES, EDGES))
    assert content == {
        "directed": directed, "multigraph": True, "graph": ABOUT,
        "nodes": [{"id": "a", "on": True, "x_m": 1.5}, {"id": "b", "on": False}],
        "edges": [{"source": "a", "target": "b", "key": 0, "quality": 1},
                  {"source": "a", "target": "b", "key": 1}],
    }  # fmt: skip


def test_what_has_no_frames_or_no_cables_says_so_instead_of_a_capture():
    network = Of(run=Of(simulate=None), medium="cables", has=lambda part: False)
    captured = cabled.Captured(network)
    assert captured.refusal(Of(kind="x", graph=PAIR)) == (
        "a x does not say how its frames are laid out"
    )
    assert captured.refusal(Of(kind="x")).startswith("a x has no cables")
    network.medium = "field"
    assert "frames are laid out" in cabled.Captured(network).refusal(Of(kind="x"))
