"""Who has no table, or one that does not know the recipient: up first, and back as it came."""

import pytest

from innervate.networks.mesh.protocol.constants import (
    ACK,
    ACK_WANTED,
    ALARM,
    ALTERNATE,
    DATA,
    DETOURED,
    E2E_ACK,
    END_TO_END,
    MESSAGES,
    NOBODY,
    RANDOM,
    REQUEST,
    RESPONSE,
    SEARCH,
    SOURCE_ROUTE,
    TABLE,
    TABLE_FREE,
    TABLES,
    TO_SEND,
    UNDER_WAY,
    WHOLE_GRAPH,
)
from innervate.networks.mesh.protocol.jobs import pump
from innervate.networks.mesh.protocol.neighbours import place_of
from innervate.networks.mesh.protocol.queue import enqueue
from innervate.networks.mesh.protocol.round import on_request, queued_request
from innervate.networks.mesh.protocol.route import learn_way, planned
from innervate.networks.mesh.protocol.timeout import timeout
from tests.networks.mesh.bench import Bench, Frame
from tests.networks.mesh.net import Net

SETTLED = 5_000_000
# 3 - 2 - 1 - 0 - 5, with a dead end at every node of the way, which is loud.
COMB = [(0, 1), (1, 2), (2, 3), (0, 5), (3, 4), (2, 6), (1, 7), (0, 8)]
DEAD_ENDS = {(4, 3): -50, (6, 2): -50, (7, 1): -50, (8, 0): -50}


def hops(bench, kind, since):
    """Who sent a kind of packet to whom, in order of time."""
    return [(i, f.link_dst) for at, i, f in bench.sent if f.kind == kind and at >= since]


def test_a_packet_goes_up_and_its_ack_back_as_it_came():
    bench = Net(9, COMB, rssi=DEAD_ENDS)
    bench.lost = lambda frame, to: frame.kind == TABLE  # so the gateway alone has one
    bench.run(SETTLED)
    bench.send(3, 5)
    bench.run(SETTLED + 200_000)
    assert hops(bench, DATA, SETTLED) == [(3, 2), (2, 1), (1, 0), (0, 5)]
    assert hops(bench, E2E_ACK, SETTLED) == [(5, 0), (0, 1), (1, 2), (2, 3)]
    bench.send(5, 3)
    bench.run(SETTLED + 400_000)
    assert hops(bench, DATA, SETTLED + 200_000) == [(5, 0), (0, 1), (1, 2), (2, 3)]


def test_what_climbs_to_the_gateway_leaves_a_way_down():
    """Before tables are there nobody has to search: responses have come from everybody."""
    bench = Net(9, COMB, rssi=DEAD_ENDS)
    bench.lost = lambda frame, to: frame.kind == TABLE
    bench.run(SETTLED)
    assert [planned(bench.nodes[i], bench.params, 3) for i in (0, 1, 2)] == [1, 2, 3]
    bench.send(5, 3)
    bench.run(SETTLED + 200_000)
    assert hops(bench, DATA, SETTLED) == [(5, 0), (0, 1), (1, 2), (2, 3)]


@pytest.mark.parametrize(("version", "kind", "settings", "waits_ms"), [
    (0, DATA, {}, [1000, 2000, 3281]), (1, DATA, {}, [250, 500, 1000]),
    (0, ALARM, {}, [250, 250, 250]), (0, DATA, {"e2e_adapt": 0}, [250, 250, 500]),
    (0, DATA, {"mode": WHOLE_GRAPH}, [250, 500, 1000]),
])  # fmt: skip
def test_who_has_no_table_tries_again_later(version, kind, settings, waits_ms):
    """Each try may be a search, and searches keep tables from coming."""
    bench = Bench(2, [(0, 1)], **{"e2e_adapt": 1, "forget": 60, **settings})
    node = bench.nodes[1]
    node.version, node.wait_kind[0], node.round_trip = version, kind, 0
    found = []
    for node.wait_tries[0] in (1, 2, 3):
        found.append(timeout(node, bench.params, 0) // 1000)
    assert found == waits_ms


@pytest.mark.parametrize(("flags", "parts"), [(DETOURED | END_TO_END, 1), (END_TO_END, 0)])
def test_messages_that_search_do_not_keep_tables_from_going_out(flags, parts):
    """They fill the queue of a gateway, by which all go, for as long as there are no tables."""
    bench = Net(3, COMB[:2])
    bench.run(SETTLED)
    node, gate = bench.nodes[0], bench.gates[0]
    for _ in range(5):
        i = enqueue(node, bench.now + SETTLED, MESSAGES, 1, bench.out)
        node.q_kind[i], node.q_flags[i] = DATA, flags
    gate.job[2], gate.job_parts[2] = TO_SEND, 0
    pump(node, gate, bench.params, bench.now, bench.out)
    assert gate.job[2] == UNDER_WAY
    queued = [k for state, k in zip(node.q_state, node.q_kind, strict=True) if state]
    assert queued.count(TABLE) == parts


def brought(bench, to, origin, sender):
    """What `to` has for `origin` after a packet of it came from `sender`."""
    frame = Frame()
    frame.kind, frame.origin, frame.link_src = DATA, origin, sender
    learn_way(bench.nodes[to], bench.params, frame)
    return planned(bench.nodes[to], bench.params, origin)


@pytest.mark.parametrize(
    ("failover", "learned"), [(SEARCH, 7), (ALTERNATE, NOBODY), (RANDOM, NOBODY)]
)
def test_ways_are_learned_where_packets_search_for_theirs(failover, learned):
    """The document's rules know what the gateway said, and no more."""
    assert brought(Bench(9, COMB, failover=failover), 1, 3, 7) == learned


def test_what_a_table_says_stands():
    bench = Bench(9, COMB)
    assert [brought(bench, 1, 3, sender) for sender in (7, 2)] == [7, 2], "the newest, before it"
    bench.run(SETTLED)
    assert bench.nodes[1].version
    assert brought(bench, 1, 3, 7) == 2
    bench.nodes[1].next[bench.nodes[1].bank * bench.params.width + 3] = NOBODY
    assert [brought(bench, 1, 3, sender) for sender in (7, 2)] == [7, 7], "whom it leaves out"


@pytest.mark.parametrize(("mode", "depths"), [(TABLE_FREE, [3, 4]), (TABLES, [5, 6])])
def test_without_tables_a_shorter_way_counts_that_comes_later(mode, depths):
    """0 - 1 - 5 - 6, and 0 - 2 - 3 - 4 - 5, whose request comes first.

    Who is behind hears of it, too, and goes up by it for the whole period (decision 0073).
    """
    links = [(0, 1), (1, 5), (0, 2), (2, 3), (3, 4), (4, 5), (5, 6)]
    bench = Bench(7, links, mode=mode, copies=15)
    told = set()

    def lost(frame, to):
        if frame.kind == REQUEST:
            told.add(frame.link_src)
        return frame.kind == REQUEST and {frame.link_src, to} == {1, 5} and 6 not in told

    bench.lost = lost
    bench.run(SETTLED)
    assert [bench.nodes[i].depth for i in (5, 6)] == depths


@pytest.mark.parametrize(("rssi", "hops", "depth"), [
    (-92, 1, 2), (-92, 3, 4), (-93, 1, 5), (-60, 4, 5),
])  # fmt: skip
def test_a_way_as_long_or_too_faint_is_no_shorter_one(rssi, hops, depth):
    bench = Bench(3, [(0, 1), (1, 2)], mode=TABLE_FREE)
    bench.run(SETTLED)
    node = bench.nodes[2]
    (request,) = [f for _, i, f in bench.sent if f.kind == REQUEST and i == 1][:1]
    node.depth, node.due = 5, 0
    request.rssi, request.path_len = rssi, hops
    bench.sent.clear()
    on_request(node, bench.params, bench.now, request, place_of(node, bench.params, 1), bench.out)
    assert node.depth == depth
    assert (queued_request(node) >= 0) == (depth < 5)
    assert node.due == 0, "who has responded in this round does not again"


@pytest.mark.parametrize(("mode", "kind", "flags", "taken"), [
    (TABLE_FREE, DATA, END_TO_END, False), (TABLE_FREE, DATA, END_TO_END | SOURCE_ROUTE, True),
    (TABLE_FREE, ALARM, END_TO_END, True), (TABLES, DATA, END_TO_END, True),
    (TABLE_FREE, RESPONSE, 0, True),
])  # fmt: skip
def test_what_climbs_leaves_room_for_what_comes_down(mode, kind, flags, taken):
    """Two whose queues are full of what is for the other one would never move on (0073)."""
    bench = Bench(3, [(0, 1), (1, 2)], mode=mode)
    bench.run(SETTLED)
    node = bench.nodes[1]
    free = MESSAGES + (2 if taken else 4)  # three places are kept for what comes down
    for _ in range(node.places - free):
        i = enqueue(node, bench.now, MESSAGES, 2, bench.out)
        node.q_due[i] = bench.now + 60_000_000
    for seq in (7, 8):  # there is room for one more, and some for better ones
        frame = Frame()
        frame.kind, frame.flags, frame.link_src, frame.link_dst = kind, flags | ACK_WANTED, 2, 1
        frame.origin, frame.dest, frame.seq, frame.ttl = 2, 0, seq, 9
        frame.path_len, frame.path[0], frame.rssi = 1, 2, -60
        frame.length, frame.body[0] = 2, 1  # a source route to 0, or a payload
        bench.push(bench.now + seq, ("frame", 1, frame))
    bench.run(SETTLED + 100)
    acked = [f.seq for at, i, f in bench.sent if at >= SETTLED and (i, f.kind) == (1, ACK)]
    assert acked == ([7, 8] if taken else [7])
