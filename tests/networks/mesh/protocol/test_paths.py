"""The gateway's arithmetic against networkx: distances, next hops, alternates, tables as bytes."""

import networkx as nx
import pytest
from hypothesis import Phase, given, settings
from hypothesis import strategies as st

from innervate.dialect import plain
from innervate.networks.mesh.protocol import fields as mesh_fields
from innervate.networks.mesh.protocol import pack as mesh_pack
from innervate.networks.mesh.protocol import paths as mesh_paths
from innervate.networks.mesh.protocol import table as mesh_table
from innervate.networks.mesh.protocol.fields import NEIGHBOURS
from innervate.networks.mesh.protocol.graph_jobs import fill_graph
from innervate.networks.mesh.protocol.search import is_edge
from tests.networks.mesh.bench import DEFAULTS, Frame, Params

FAR = NONE = 255
Gate = plain.make("Gate64", mesh_fields.gate(64))
Node = plain.make("Node64", mesh_fields.node(64))


@st.composite
def graphs(draw, most=14):
    n = draw(st.integers(2, most))
    share = draw(st.sampled_from([0.05, 0.15, 0.3, 0.6]))
    return nx.fast_gnp_random_graph(n, share, seed=draw(st.integers(0, 10_000)))


def gateway_of(graph, mtu=127):
    """A gateway that was told these links, its distances measured."""
    params, gate, node = Params(), Gate(), Node()
    own = {"nodes": len(graph), "width": 64, "row": mesh_fields.row_bytes(64), "mtu": mtu}
    for name, value in {**DEFAULTS, **own}.items():
        setattr(params, name, value)
    for a, b in graph.edges:
        mesh_paths.note_heard(gate, params, a, b)
        mesh_paths.note_heard(gate, params, b, a)
    mesh_paths.build_graph(gate, params)
    mesh_paths.measure_all(gate, params)
    return node, gate, params


def tables_of(graph):
    """Of every node: it, the gateway that has made its table, and how far all are apart."""
    _, gate, params = gateway_of(graph)
    far = dict(nx.all_pairs_shortest_path_length(graph))
    for s in graph:
        mesh_paths.make_table(gate, params, s)
        yield s, gate, params, far


@settings(max_examples=25, deadline=None, phases=(Phase.generate,))
@given(graphs())
def test_distances_and_next_hops(graph):
    for s, gate, params, far in tables_of(graph):
        for d in graph:
            assert mesh_paths.hops(gate, params, s, d) == far[s].get(d, FAR)
            best = [u for u in graph[s] if d in far[u] and far[u][d] + 1 == far[s].get(d)]
            assert gate.next[d] == (min(best) if best and s != d else NONE)


@settings(max_examples=25, deadline=None, phases=(Phase.generate,))
@given(graphs())
def test_alternates_are_loop_free_and_protect_the_node_where_one_can(graph):
    """RFC 5286 inequalities 1 and 3; else the first hop of a shortest path around the main one."""
    for s, gate, _, far in tables_of(graph):
        for d in set(far[s]) - {s}:
            main, alt = gate.next[d], gate.alt[d]
            others = [u for u in graph[s] if u != main]
            free = [u for u in others if far[u][d] < far[u][s] + far[s][d]]
            safe = [u for u in free if d == main or far[u][d] < far[u][main] + far[main][d]]
            if free:
                best = safe or free
                nearest = min(far[u][d] for u in best)
                assert alt == min(u for u in best if far[u][d] == nearest), (s, d)
            elif d == main:
                assert alt == NONE
            else:
                without = graph.subgraph(set(graph) - {main})
                if not nx.has_path(without, s, d):
                    assert alt == NONE
                    continue
                long = nx.shortest_path_length(without, s, d)
                assert nx.shortest_path_length(without.subgraph(set(without) - {s}), alt, d) \
                    == long - 1  # fmt: skip


def test_links_count_both_ways_and_for_three_rounds():
    params, gate = gateway_of(nx.path_graph(3))[2], Gate()
    pairs = [(0, 1), (1, 0), (1, 2), (2, 1)]  # of the first four, and in a byte of their own
    for there, back in (pairs[:2], pairs[2:]):
        mesh_paths.note_heard(gate, params, *there)
        mesh_paths.build_graph(gate, params)
        assert gate.links == 0
        mesh_paths.begin_round(gate, params)
        mesh_paths.note_heard(gate, params, *back)
        for links in (1, 1, 0, 0):  # `there` was heard a round before
            mesh_paths.build_graph(gate, params)
            assert gate.links == links
            mesh_paths.begin_round(gate, params)
    for pair in pairs:
        mesh_paths.note_heard(gate, params, *pair)
    for links in (2, 2, 2, 0):
        mesh_paths.build_graph(gate, params)
        assert gate.links == links
        mesh_paths.begin_round(gate, params)


def parts_of(node, gate, params, s, room):
    count = mesh_pack.pack(node, gate, params, s, room, -1, -1)
    for index in range(count):
        node.q_length[0] = 0
        mesh_pack.pack(node, gate, params, s, room, index, 0)
        yield node.q_body[: node.q_length[0]]


@pytest.mark.parametrize("mtu", [64, 127])
@settings(max_examples=5, deadline=None, phases=(Phase.generate,))
@given(graph=graphs(64))
def test_tables_go_through_parts_that_have_room(mtu, graph):
    node, gate, params = gateway_of(graph, mtu)
    for s in (0, len(graph) // 2):
        mesh_paths.make_table(gate, params, s)
        far = mesh_paths.hops(gate, params, 0, s)
        if far == FAR:
            continue
        room = params.mtu - 13 - far - (far + 2) - 4
        if room < 8:
            continue
        assert mesh_pack.room_at(node, gate, params, s) == room
        got = Node()
        for k in range(128):
            got.next[k] = got.alt[k] = NONE
        for part in parts_of(node, gate, params, s, room):
            assert len(part) <= room
            frame = Frame()
            frame.length = len(part)
            frame.body[: len(part)] = part
            mesh_table.read_groups(got, params, frame, 0, 64)
        n = len(graph)
        assert got.next[64 : 64 + n] == gate.next[:n]
        assert got.alt[64 : 64 + n] == gate.alt[:n]


@pytest.mark.parametrize("mtu", [64, 127])
@settings(max_examples=6, deadline=None, phases=(Phase.generate,))
@given(graph=graphs(64), order=st.randoms())
def test_the_whole_graph_goes_through_its_parts_in_any_order(mtu, graph, order):
    node, gate, params = gateway_of(graph, mtu)
    size = mesh_table.part_bytes(params)
    count = -(-mesh_table.graph_bytes(params) // size)
    got = Node()
    for k in range(len(got.edges)):
        got.edges[k] = order.randrange(2) * 0xFF  # what an older graph has left
    parts = list(range(count))
    order.shuffle(parts)
    for index in parts:
        node.q_length[0] = node.q_path_len[0] = 0
        fill_graph(node, gate, params, 0, index, count)
        frame = Frame()
        frame.length = node.q_length[0]
        assert 11 + 1 + frame.length + 2 <= mtu
        frame.body[: frame.length] = node.q_body[: frame.length]
        mesh_table.read_edges(got, params, frame, index)
    sparse = max(degree for _, degree in graph.degree) <= NEIGHBOURS  # else the lowest ids are kept
    for a in graph:
        for b in range(a + 1, len(graph)):
            there = is_edge(got, params, a, b)
            assert there == is_edge(got, params, b, a)
            assert there == mesh_paths.is_known(gate, params, a, b)
            assert there == graph.has_edge(a, b) or not sparse
