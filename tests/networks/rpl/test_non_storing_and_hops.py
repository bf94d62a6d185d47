"""RFC 6550 in non-storing mode (9.4, 9.7, 11.2.2.3); what is done for every hop."""

import pytest

from innervate.networks.rpl.protocol import constants as c
from innervate.networks.rpl.protocol import kinds, sizes, timers
from innervate.networks.rpl.protocol.downward import DAO_TRIES, LIFE
from tests.networks.rpl import nodes as rpl


def up(source, parent, path=241, number=1):
    """A DAO that has come to the root."""
    return {"kind": kinds.DAO_UP, "src": 1, "dsn": number, "origin": source, "dest": rpl.ROOT,
            "hops": 9, "info": parent, "path": path, "rssi": -60}  # fmt: skip


def root_of_chain(length):
    """A root that knows the chain 0 - 1 - 2 - ... - length."""
    root = rpl.node(rpl.ROOT, storing=0)
    for k in range(1, length + 1):
        root.hear(**up(k, k - 1, number=k))
        rpl.settle(root)
    root.sent.clear()
    root.reports.clear()
    return root


def test_the_dao_goes_to_the_root_and_names_the_parent():
    """9.7: "DAOs are sent directly to the root along a default route", "The DODAG Parent Address
    subfield of a Transit Information option MUST contain one or more addresses." """
    one = rpl.attached(storing=0)
    (frame,) = one.fire(timers.DAO_DELAY)
    assert (frame.kind, frame.dest, frame.to, frame.info) == (kinds.DAO_UP, rpl.ROOT, 1, 1)


def test_on_the_way_a_dao_is_a_packet():
    one = rpl.attached(storing=0)
    one.hear(**(up(9, 8) | {"src": 7}))
    assert (one.sent[-1].kind, one.sent[-1].to, one.sent[-1].info) == (kinds.DAO_UP, 1, 8)
    assert one.node.via[9] == c.NONE


def test_a_root_in_non_storing_mode_forgets_as_well():
    """6.7.6: "Default Lifetime": "the lifetime that is used as default for all RPL routes" """
    root = rpl.node(rpl.ROOT, storing=0, refresh=2)
    root.hear(**up(7, rpl.ROOT))
    rpl.ticks(root, 3)
    root.hear(**up(7, rpl.ROOT, number=2))  # the same Path Sequence: sent again, not anew
    rpl.ticks(root, LIFE * 2 - 4)
    assert root.node.via[7] == rpl.ROOT
    rpl.ticks(root, 1)
    assert root.node.via[7] == c.NONE


def test_a_dao_is_repeated_until_the_root_acknowledges_it():
    """9.3: "A node receiving a unicast DAO message with the 'K' flag set SHOULD respond with a
    DAO-ACK." "up until an implementation-specific number of retries" """
    one = rpl.attached(storing=0)
    for _ in range(DAO_TRIES):
        assert rpl.of(one.fire(timers.DAO_DELAY), kinds.DAO_UP)
        rpl.settle(one)
    assert one.fire(timers.DAO_DELAY) == []
    one = rpl.attached(storing=0)
    one.fire(timers.DAO_DELAY)
    rpl.settle(one)
    one.hear(kind=kinds.DAO_ACK, src=1, dsn=3, origin=0, dest=5, hops=9, path=one.node.path_seq)
    assert one.fire(timers.DAO_DELAY) == []
    root = rpl.node(rpl.ROOT, storing=0)
    root.hear(**up(1, rpl.ROOT))
    (answer,) = rpl.of(root.sent, kinds.DAO_ACK)
    assert (answer.to, answer.dest, answer.path) == (1, 1, 241)


@pytest.mark.parametrize(("hops", "kind"), [(1, 0), (2, 1), (5, 1), (6, 2), (17, 2)])
def test_the_root_writes_the_whole_way_into_a_packet(hops, kind):
    """9.4: "the root builds a strict source routing header, hop-by-hop, by recursively looking up
    one-hop information that ties a Target (address or prefix) and a transit address together" """
    root = root_of_chain(hops)
    (frame,) = root.give(1, dest=hops)
    assert (frame.kind, frame.to, frame.length, frame.down) == (kinds.DATA + kind, 1, hops - 1, 1)
    assert [*frame.near, *frame.far][: frame.length] == list(range(2, hops + 1))


def test_a_way_that_is_longer_than_a_frame_is_none():
    root = root_of_chain(18)
    assert root.give(1, dest=18) == []
    assert root.reports == [(c.REPORT_NO_ROUTE, 18, 0)]


def test_a_circle_is_no_way():
    root = root_of_chain(3)
    root.hear(**up(1, 3, path=242, number=9))
    rpl.settle(root)
    root.sent.clear()
    assert root.give(1, dest=3) == []


def test_a_source_route_is_followed_hop_by_hop():
    """9.7: "RPL routes messages Downward using IP source routing" """
    (frame,) = root_of_chain(6).give(1, dest=6, body=[7] * 8)
    for at in range(1, 6):
        one = rpl.attached(at, parent=20, storing=0)
        one.hear(**{name: value for name, value in vars(frame).items() if name != "urgent"})
        (frame,) = rpl.packets(one)
        assert (frame.to, frame.src) == (at + 1, at)
    last = rpl.attached(6, parent=20, storing=0)
    last.hear(**{name: value for name, value in vars(frame).items() if name != "urgent"})
    assert [got.body for got in last.delivered] == [[7] * 8]


def test_from_node_to_node_by_the_root():
    """9: "P2P messages can flow toward a DODAG root (or a common ancestor) through an Upward route,
    then away from the DODAG root to a destination through a Downward route." """
    one = rpl.attached(storing=0)
    (frame,) = one.give(1, dest=9)
    assert (frame.to, frame.down, frame.length) == (1, 0, 0)
    root = root_of_chain(3)
    root.hear(**rpl.data(1, 3, number=40, origin=5))
    assert [(f.to, f.length) for f in rpl.packets(root)] == [(1, 2)]


def test_a_broken_source_route_is_told_to_the_root():
    """11.2.2.3: "an ICMP error with a new code "Error in Source Routing Header" is sent back to the
    root" """
    one = rpl.attached(1, parent=20, storing=0)
    route = {"near": [2, 3, 0, 0], "length": 2, "next": 1, "kind": kinds.DATA + 1, "down": 1}
    one.hear(**rpl.data(20, 3, **route))
    rpl.fail(one)
    (error,) = rpl.of(one.sent, kinds.ROUTE_ERROR)
    assert (error.dest, error.to, error.info) == (rpl.ROOT, 20, 2)
    root = root_of_chain(3)
    root.hear(kind=kinds.ROUTE_ERROR, src=1, dsn=77, origin=1, dest=rpl.ROOT, hops=9, info=2)
    assert root.node.via[2] == c.NONE
    assert root.give(1, dest=3) == []


def test_a_frame_for_us_is_acknowledged_at_once():
    """IEEE 802.15.4: whatever is on the air; once more if it comes again, and is taken once."""
    one = rpl.storing()
    first = one.hear(**rpl.data(7, 5))
    assert [(f.kind, f.to, f.dsn, f.urgent) for f in first] == [(kinds.ACK, 7, 1, 1)]
    assert len(rpl.of(one.hear(**rpl.data(7, 5)), kinds.ACK)) == 1
    assert len(one.delivered) == 1


def test_one_frame_is_under_way():
    one = rpl.storing()
    one.give(2)
    one.give(2)
    assert len(rpl.packets(one)) == 1
    one.told()
    rpl.ack(one, src=9)
    assert len(rpl.packets(one)) == 1, "that was somebody else's"
    rpl.ack(one)
    assert len(rpl.packets(one)) == 2


def test_a_frame_is_sent_four_times():
    one = rpl.storing()
    one.give(2)
    for tries in range(4):
        assert one.node.tries == tries
        one.told(ok=tries % 2)  # or the channel was busy
        if one.node.waiting:
            one.fire(timers.ACK_WAIT)
    assert one.node.rounds == 1


def test_hop_limit_and_full_queues_are_told():
    one = rpl.storing()
    one.hear(**rpl.data(7, 0, hops=1))
    assert one.reports == [(c.REPORT_HOPS, 0, 9)]
    for _ in range(sizes.QUEUE + 1):
        one.give(2)
    assert one.reports[1:] == [(c.REPORT_FULL, 0, sizes.QUEUE)]


def test_packets_wait_for_a_parent_for_a_while():
    one = rpl.node()
    assert one.give(2) == []
    for _ in range(one.params.patience):
        one.fire(timers.TICK)
        one.told()
    assert one.node.q_count == 0
    assert one.reports == [(c.REPORT_NO_ROUTE, rpl.ROOT, 0)]
    late = rpl.node()
    late.give(2)
    late.hear(**rpl.dio(1, 256))
    assert rpl.packets(late)[-1].to == 1


def test_of_many_neighbours_the_farthest_is_forgotten():
    one = rpl.attached()
    for src in range(20, 20 + sizes.NEIGHBOURS - 1):
        one.hear(**rpl.dio(src, 2000 + src))
    one.hear(**rpl.dio(90, 300))
    known = list(one.node.nbr)
    assert 90 in known
    assert 1 in known
    assert 20 + sizes.NEIGHBOURS - 2 not in known
