"""What docs/wire.md says of source routes, `ttl` and alternates, sentence by sentence."""

import pytest

from innervate.networks.mesh import frames as wire
from innervate.networks.mesh.protocol import node as mesh
from innervate.networks.mesh.protocol.constants import (
    DATA,
    E2E_ACK,
    FLOOD,
    REPORT_SUSPECT,
    REQUEST,
    RESPONSE,
    SOURCE_ROUTE,
    TABLE,
    TABLE_ACK,
    TABLE_FREE,
)
from innervate.networks.mesh.protocol.frames import copy_frame, is_sound
from innervate.networks.mesh.protocol.paths import is_known
from tests.networks.mesh import shown
from tests.networks.mesh.bench import Bench, Frame
from tests.networks.mesh.net import line, ring

SETTLED = 9_000_000
BEGIN = 48


def of_kind(bench, kind, since=0):
    """(who sent it, frame), in order of time."""
    return [(i, frame) for at, i, frame in bench.sent if frame.kind == kind and at >= since]


def settled(links, **settings):
    bench = Bench(1 + max(max(pair) for pair in links), links, **settings)
    bench.run(SETTLED)
    return bench


def test_a_table_goes_by_its_own_route_which_stays_whole():
    bench = settled(line(4))
    (seq,) = {f.seq for _, f in of_kind(bench, TABLE) if f.dest == 3}
    ways = [(i, f.link_dst, dict(shown.fields(f))["route"])
            for i, f in of_kind(bench, TABLE) if f.seq == seq]  # fmt: skip
    assert ways == [(i, i + 1, [0, 1, 2, 3]) for i in range(3)]
    assert not any(f.flags & SOURCE_ROUTE for _, f in of_kind(bench, TABLE))
    marked = next(f for _, f in of_kind(bench, TABLE))
    marked.flags |= SOURCE_ROUTE
    assert wire.decode(wire.encode(marked), Frame()) == wire.BAD_PAYLOAD


@pytest.mark.parametrize(("mtu", "count"), [(127, 30), (64, 30), (64, 12)])
def test_a_response_lists_as_many_as_fit(mtu, count):
    """Of two packets one got lost, and who had responded was not asked again."""
    bench = settled([(0, i) for i in range(1, count + 1)] + [(1, i) for i in range(2, count + 1)],
                    mtu=mtu)  # fmt: skip
    lists = {
        f.seq: dict(shown.fields(f)) for i, f in of_kind(bench, RESPONSE) if f.origin == i == 1
    }
    most = (mtu - 11 - 2 - 24 - 4) // 2
    assert [len(one["neighbours"]) for one in lists.values()] == [
        min(most, count - at) for at in range(0, count, most)
    ]
    assert all(one["listed"] == min(15, len(one["neighbours"])) for one in lists.values())
    named = {who["id"] for one in lists.values() for who in map(dict, one["neighbours"])}
    assert named == {0, *range(2, count + 1)}
    assert all(is_known(bench.gates[0], bench.params, 1, who) for who in named)


@pytest.mark.parametrize("kind", [REQUEST, RESPONSE, TABLE, TABLE_ACK])
def test_a_route_in_front_of_anything_else_is_dropped(kind):
    bench = settled(line(3))
    _, found = of_kind(bench, kind)[0]
    marked = Frame()
    copy_frame(marked, found)
    assert is_sound(bench.params, marked)
    marked.flags |= SOURCE_ROUTE
    marked.body[: found.length + 1] = [0, *found.body[: found.length]]
    marked.length += 1
    assert wire.decode(wire.encode(marked), Frame()) == wire.OK, "the bytes could be one"
    assert not is_sound(bench.params, marked)
    marked.kind, marked.dest = DATA, 1
    assert is_sound(bench.params, marked)


def test_who_sends_data_on_takes_the_next_hop_out_of_the_route():
    bench = settled(line(4), mode=TABLE_FREE)
    bench.send(0, 3)
    bench.run(SETTLED + 200_000)
    sent = [(i, f) for i, f in of_kind(bench, DATA, SETTLED) if f.origin == 0]
    assert [(i, f.flags & SOURCE_ROUTE, list(f.body[: f.length])) for i, f in sent] == [
        (0, SOURCE_ROUTE, [2, 2, 3, *b"hello"]), (1, SOURCE_ROUTE, [1, 3, *b"hello"]),
        (2, SOURCE_ROUTE, [0, *b"hello"]),
    ]  # fmt: skip
    assert bytes(bench.delivered[-1][2].body[:5]) == b"hello"


def test_ttl_counts_hops_not_repetitions():
    bench = settled(line(4))
    bench.lost = lambda f, to: f.kind == DATA and to == 2 and len(of_kind(bench, DATA)) < 4
    bench.send(0, 3)
    bench.run(SETTLED + 200_000)
    assert [(i, f.ttl) for i, f in of_kind(bench, DATA, SETTLED)] == [
        (0, BEGIN - 1), (1, BEGIN - 2), (1, BEGIN - 2), (1, BEGIN - 2), (2, BEGIN - 3),
    ]  # fmt: skip
    assert {f.ttl for _, f in of_kind(bench, REQUEST)} == {BEGIN}, "broadcasts do not count"


def test_another_neighbour_costs_nothing_and_coming_back_one():
    """0-1-2-3 with a dead end, 4, at node 1 that is tried when 2 is dead; 5 leads around."""
    bench = settled([(0, 1), (1, 2), (2, 3), (1, 4), (0, 5), (5, 3)])
    bench.dead.add(2)
    bench.nodes[0].next[bench.nodes[0].bank * bench.params.width + 3] = 1  # as an old table has it
    bench.send(0, 3)
    bench.run(SETTLED + 200_000)
    ways = [(i, f.link_dst, f.ttl) for i, f in of_kind(bench, DATA, SETTLED)]
    assert ways[0] == (0, 1, BEGIN - 1)
    assert {way for way in ways if way[0] == 1 and way[1] in (2, 4)} == {
        (1, 2, BEGIN - 2), (1, 4, BEGIN - 2),
    }  # fmt: skip
    assert (4, 1, BEGIN - 3) in ways
    assert (1, 0, BEGIN - 4) in ways
    assert (0, 5, BEGIN - 5) in ways
    assert bench.of(REPORT_SUSPECT)
    assert any(i == 3 and f.kind == DATA for _, i, f in bench.delivered)


def test_with_none_left_only_its_recipient_takes_a_packet():
    bench = settled(line(3))
    for dest, came in ((1, True), (2, False)):
        frame = Frame()
        frame.kind, frame.flags, frame.link_src, frame.link_dst = DATA, 1, 0, 1
        frame.dest, frame.seq, frame.path_len, frame.rssi = dest, 100 + dest, 1, -60
        begun = len(bench.delivered)
        mesh.on_frame(bench.nodes[1], None, bench.params, bench.now, 0, frame, bench.out)
        bench.drain(1)
        bench.run(bench.now + 100_000)
        assert any(i == dest for _, i, _ in bench.delivered[begun:]) == came


def test_a_neighbour_without_a_loop_free_alternate_has_none():
    """Six in a ring: away from the next hop to 2 leads the long way, to the neighbour 1 nothing."""
    bench = settled(ring(6))
    node = bench.nodes[0]
    bank = node.bank * bench.params.width
    table = [(node.next[bank + d], node.alt[bank + d]) for d in range(1, 6)]
    assert table == [(1, 255), (1, 5), (1, 5), (5, 1), (5, 255)]


@pytest.mark.parametrize("on_demand", [1, 0])
def test_data_to_one_node_that_goes_to_all_looks_for_its_recipient(on_demand):
    bench = Bench(4, line(4), on_demand=1)
    bench.lost = lambda frame, to: frame.kind == REQUEST
    bench.params.on_demand = 1
    bench.send(0, 3)
    bench.params.on_demand = on_demand
    bench.run(200_000)
    found = [(i, f.link_dst, f.flags & FLOOD, f.path_len, f.ttl) for i, f in of_kind(bench, DATA)]
    assert found == [(i, 255, 0, i + 1, 47 - i) for i in range(3 if on_demand else 1)]
    assert len(bench.delivered) == on_demand
    back = [(i, f.link_dst) for i, f in of_kind(bench, E2E_ACK)]
    assert back == ([(3, 2), (2, 1), (1, 0)] if on_demand else [])
