"""Who has no table, or one that does not know the recipient: up first, and back as it came."""

import pytest

from innervate.networks.mesh.protocol.constants import (
    ALTERNATE,
    DATA,
    E2E_ACK,
    RANDOM,
    SEARCH,
    TABLE,
)
from innervate.networks.mesh.protocol.route import NONE, learn_way, planned
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


def brought(bench, to, origin, sender):
    """What `to` has for `origin` after a packet of it came from `sender`."""
    frame = Frame()
    frame.kind, frame.origin, frame.link_src = DATA, origin, sender
    learn_way(bench.nodes[to], bench.params, frame)
    return planned(bench.nodes[to], bench.params, origin)


@pytest.mark.parametrize(("failover", "learned"), [(SEARCH, 7), (ALTERNATE, NONE), (RANDOM, NONE)])
def test_ways_are_learned_where_packets_search_for_theirs(failover, learned):
    """The document's rules know what the gateway said, and no more."""
    assert brought(Bench(9, COMB, failover=failover), 1, 3, 7) == learned


def test_what_a_table_says_stands():
    bench = Bench(9, COMB)
    assert [brought(bench, 1, 3, sender) for sender in (7, 2)] == [7, 2], "the newest, before it"
    bench.run(SETTLED)
    assert bench.nodes[1].version
    assert brought(bench, 1, 3, 7) == 2
    bench.nodes[1].next[bench.nodes[1].bank * bench.params.width + 3] = NONE
    assert [brought(bench, 1, 3, sender) for sender in (7, 2)] == [7, 7], "whom it leaves out"
