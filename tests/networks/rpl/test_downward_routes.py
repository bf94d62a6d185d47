"""Downward routes of RFC 6550, sections 9 and 11.2.2.3, sentence by sentence."""

import pytest

from innervate.networks.rpl import constants as c
from innervate.networks.rpl.downward import DAO_TRIES, LIFE
from tests.networks.rpl.nodes import (
    ROOT,
    ack,
    attached,
    dao,
    data,
    dio,
    fail,
    node,
    parent_of,
    settle,
)


def told_to_parent(one):
    """DAOs that go out now: (target, Path Sequence, life) of each that is named."""
    one.sent.clear()
    if one.node.dao_armed:
        one.fire(c.DAO_DELAY)
    settle(one)
    return [(target, path, frame.life) for frame in one.sent if frame.kind == c.DAO
            for target, path in zip(frame.targets, frame.paths, strict=True)
            if target != c.NOBODY]  # fmt: skip


def storing(**params):
    """A node in storing mode whose parent knows of it."""
    one = attached(**params)
    told_to_parent(one)
    one.sent.clear()
    return one


def of(frames, kind):
    return [frame for frame in frames if frame.kind == kind]


def packets(one):
    return [f for f in one.sent if c.DATA <= f.kind < c.DATA + 3]


def test_a_new_dao_parent_is_told_after_delay_dao():
    """9.5: "When a node adds a node to its DAO parent set, it SHOULD schedule a DAO message
    transmission." """
    one = attached()
    assert of(one.sent, c.DAO) == [], "SHOULD delay sending the DAO message"
    assert one.params.dao_us <= one.left(c.DAO_DELAY) < 2 * one.params.dao_us
    assert told_to_parent(one) == [(5, one.node.path_seq, LIFE * one.params.refresh)]


def test_daos_that_come_do_not_reset_delay_dao():
    """9.5: "DAO messages received while the DelayDAO timer is active do not reset the timer." """
    one = storing()
    one.hear(**dao(7, 7))
    at = one.timers[c.DAO_DELAY]
    one.hear(**dao(8, 8))
    assert one.timers[c.DAO_DELAY] == at


def test_storing_nodes_store_and_pass_on_what_daos_say():
    """9.2: "all non-root, non-leaf nodes MUST store routing table entries for destinations learned
    from DAOs"; 9.8: "the node MUST generate a new DAO message and transmit it" """
    one = storing()
    one.hear(**dao(7, 7, 20, 21))
    assert [one.node.via[target] for target in (7, 20, 21)] == [7] * 3
    told = told_to_parent(one)
    assert [target for target, *_ in told] == [7, 20, 21]
    assert {path for _, path, _ in told} == {241}, "their own Path Sequences, not ours"


def test_a_dao_goes_to_the_parent_alone():
    """9.8: "It MUST NOT unicast the DAO message to nodes that are not DAO parents." """
    one = storing()
    one.hear(**dio(2, 256))
    one.hear(**dao(7, 7))
    told_to_parent(one)
    assert {frame.to for frame in of(one.sent, c.DAO)} == {1}


def test_daos_without_news_are_not_passed_on():
    """9.2.2: "MAY suppress scheduling a DAO message transmission if that DAO message is not new" """
    one = storing()
    one.hear(**dao(7, 7))
    told_to_parent(one)
    one.hear(**dao(7, 7, number=2))
    assert not one.node.dao_armed
    one.hear(**dao(7, 7, path=242, number=3))
    assert told_to_parent(one) == [(7, 242, LIFE * one.params.refresh)], "a newer Path Sequence"


def test_older_daos_are_ignored():
    """9.3: "Nodes SHOULD ignore DAOs without newer sequence numbers" """
    one = storing()
    one.hear(**dao(7, 20, path=243))
    one.hear(**dao(8, 20, path=242))
    assert one.node.via[20] == 7
    one.hear(**dao(8, 20, path=244, number=2))
    assert one.node.via[20] == 8


def test_no_path_removes_the_route_and_is_passed_on():
    """9.8: "Such a change includes receiving a No-Path DAO." """
    one = storing()
    one.hear(**dao(7, 20, 21))
    told_to_parent(one)
    one.hear(**dao(8, 20, life=0))
    assert one.node.via[20] == 7, "it was not that child's"
    one.hear(**dao(7, 20, life=0, number=2))
    assert one.node.via[20] == c.NONE
    assert [(target, life) for target, _, life in told_to_parent(one)] == [(20, 0)]


def test_a_changed_parent_is_told_of_the_whole_sub_dodag():
    """9.2.1: "MUST increment the Path Sequence counter, and generate a new DAO message, when ... the
    DODAG Parent Address subfield list is to be changed" """
    one = storing()
    one.hear(**dao(7, 7, 20))
    told_to_parent(one)
    before = one.node.path_seq
    one.hear(**dio(2, 60))
    assert parent_of(one) == 2
    told = told_to_parent(one)
    assert [(t, p) for t, p, life in told if life] == [(5, before + 1), (7, 241), (20, 241)]
    assert [frame.to for frame in of(one.sent, c.DAO)] == [2, 1]


def test_a_parent_that_was_left_is_told_so():
    """9.8: "When a node removes a node from its DAO parent set, it SHOULD send a No-Path DAO message
    to that removed DAO parent to invalidate the existing route." """
    one = storing()
    one.hear(**dao(7, 7, 20))
    told_to_parent(one)
    one.hear(**dio(2, 60))
    assert [t for t, _, life in told_to_parent(one) if not life] == [5, 7, 20]
    one.hear(**dio(2, c.INFINITE))
    assert [t for t, _, life in told_to_parent(one) if not life] == [5, 7, 20], (
        "a detached one, too"
    )
    assert {frame.to for frame in of(one.sent, c.DAO)} == {2}
    assert told_to_parent(one) == []


def test_a_dao_that_is_not_acknowledged_is_sent_again():
    """9.3: "MAY reschedule the DAO message transmission for another attempt" """
    one = attached()
    one.fire(c.DAO_DELAY)
    fail(one)
    assert [target for target, *_ in told_to_parent(one)] == [5]
    assert told_to_parent(one) == []


def test_a_dtsn_that_grows_asks_for_daos():
    """9.6: "If a node hears one of its DAO parents increment its DTSN, the node MUST schedule a DAO
    message transmission" """
    one = storing()
    one.hear(**dao(7, 7))
    told_to_parent(one)
    one.hear(**dio(2, 256, dtsn=250))
    assert not one.node.dao_armed, "2 is not our parent"
    one.hear(**dio(1, 256, dtsn=241))
    assert [target for target, *_ in told_to_parent(one)] == [5, 7]
    assert one.node.dtsn == 240, "in storing mode it is not passed on"


def test_in_non_storing_mode_a_dtsn_is_passed_on():
    """9.6: "In Non-Storing mode, if a node hears one of its DAO parents increment its DTSN, the node
    MUST increment its own DTSN." """
    one = attached(storing=0)
    one.hear(**dio(1, 256, dtsn=241))
    assert one.node.dtsn == 241


def test_packets_go_up_until_somebody_knows_the_way_down():
    """3.3: "the packet travels towards a common ancestor at which point it is forwarded in the Down
    direction" """
    one = storing()
    one.hear(**data(7, 20))
    assert [(f.to, f.down) for f in packets(one)] == [(1, 0)]
    ack(one)
    one.told()
    ack(one)
    one.hear(**dao(8, 20, number=2))
    one.hear(**data(7, 20, number=3))
    assert [(f.to, f.down) for f in packets(one)][1:] == [(8, 1)]


def test_what_cannot_go_down_is_sent_back():
    """11.2.2.3: "the router SHOULD send the packet back to the parent that passed it with the
    Forwarding-Error 'F' bit set and the 'O' bit left untouched" """
    one = storing()
    one.hear(**data(1, 20, down=1, sender_rank=1))
    assert [(f.to, f.back, f.down) for f in packets(one)] == [(1, 1, 1)]


def test_what_comes_back_removes_the_route_and_is_sent_again():
    """11.2.2.3: "MUST remove the routing states that caused forwarding to that neighbor, clear the
    Forwarding-Error bit, and attempt to send the packet again" """
    root = node(ROOT)
    root.hear(**dao(7, 20))
    root.hear(**data(7, 20, number=2, down=1, back=1))
    assert root.node.via[20] == c.NONE
    assert packets(root) == []
    assert root.reports == [(c.REPORT_NO_ROUTE, 20, 0)], "a root has nobody to send it back to"
    one = storing()
    one.hear(**dao(7, 20))
    told_to_parent(one)
    one.hear(**data(7, 20, number=2, down=1, back=1))
    assert [(f.to, f.back) for f in packets(one)] == [(1, 1)], "the process will recurse"


def test_a_child_that_does_not_answer_is_forgotten():
    """9.8: "a node MAY mark the address as unreachable and generate an appropriate No-Path DAO";
    8.2.1: "Routes through an unreachable neighbor MUST be removed" """
    one = storing()
    one.hear(**dao(7, 7, 20))
    told_to_parent(one)
    one.sent.clear()
    one.hear(**data(1, 20, down=1, sender_rank=1))
    fail(one)
    assert packets(one)[-1].to == 7, "once more"
    fail(one)
    assert [one.node.via[target] for target in (7, 20)] == [c.NONE] * 2
    assert (packets(one)[-1].to, packets(one)[-1].back) == (1, 1)
    settle(one)
    assert {(t, life) for t, _, life in told_to_parent(one)} == {(7, 0), (20, 0)}


def test_routes_that_are_not_refreshed_end():
    """17: "RemoveTimer": "Expiry may trigger No-Path advertisements" """
    one = storing(refresh=1)
    one.hear(**dao(7, 20))
    for _ in range(LIFE):
        one.fire(c.TICK)
    assert one.node.via[20] == 7
    one.fire(c.TICK)
    assert one.node.via[20] == c.NONE


def test_own_routes_are_refreshed():
    """9.2.1: "the Path Lifetime is to be updated (e.g., a refresh or a no-Path)" """
    one = storing(refresh=2)
    before = one.node.path_seq
    one.fire(c.TICK)
    assert not one.node.dao_armed
    one.fire(c.TICK)
    assert told_to_parent(one)[0][:2] == (5, before + 1)


# Non-storing mode.


def up(source, parent, path=241, number=1):
    """A DAO that has come to the root."""
    return {"kind": c.DAO_UP, "src": 1, "dsn": number, "origin": source, "dest": ROOT, "hops": 9,
            "info": parent, "path": path, "rssi": -60}  # fmt: skip


def root_of_chain(length):
    """A root that knows the chain 0 - 1 - 2 - ... - length."""
    root = node(ROOT, storing=0)
    for k in range(1, length + 1):
        root.hear(**up(k, k - 1, number=k))
        settle(root)
    root.sent.clear()
    root.reports.clear()
    return root


def test_the_dao_goes_to_the_root_and_names_the_parent():
    """9.7: "DAOs are sent directly to the root along a default route", "The DODAG Parent Address
    subfield of a Transit Information option MUST contain one or more addresses." """
    one = attached(storing=0)
    (frame,) = one.fire(c.DAO_DELAY)
    assert (frame.kind, frame.dest, frame.to, frame.info) == (c.DAO_UP, ROOT, 1, 1)


def test_on_the_way_a_dao_is_a_packet():
    one = attached(storing=0)
    one.hear(**(up(9, 8) | {"src": 7}))
    assert (one.sent[-1].kind, one.sent[-1].to, one.sent[-1].info) == (c.DAO_UP, 1, 8)
    assert one.node.via[9] == c.NONE


def test_a_dao_is_repeated_until_the_root_acknowledges_it():
    """9.3: "A node receiving a unicast DAO message with the 'K' flag set SHOULD respond with a
    DAO-ACK." "up until an implementation-specific number of retries" """
    one = attached(storing=0)
    for _ in range(DAO_TRIES):
        assert of(one.fire(c.DAO_DELAY), c.DAO_UP)
        settle(one)
    assert one.fire(c.DAO_DELAY) == []
    one = attached(storing=0)
    one.fire(c.DAO_DELAY)
    settle(one)
    one.hear(kind=c.DAO_ACK, src=1, dsn=3, origin=0, dest=5, hops=9, path=one.node.path_seq)
    assert one.fire(c.DAO_DELAY) == []
    root = node(ROOT, storing=0)
    root.hear(**up(1, ROOT))
    (answer,) = of(root.sent, c.DAO_ACK)
    assert (answer.to, answer.dest, answer.path) == (1, 1, 241)


@pytest.mark.parametrize(("hops", "kind"), [(1, 0), (2, 1), (5, 1), (6, 2), (17, 2)])
def test_the_root_writes_the_whole_way_into_a_packet(hops, kind):
    """9.4: "the root builds a strict source routing header, hop-by-hop, by recursively looking up
    one-hop information that ties a Target (address or prefix) and a transit address together" """
    root = root_of_chain(hops)
    (frame,) = root.give(1, dest=hops)
    assert (frame.kind, frame.to, frame.length, frame.down) == (c.DATA + kind, 1, hops - 1, 1)
    assert [*frame.near, *frame.far][: frame.length] == list(range(2, hops + 1))


def test_a_way_that_is_longer_than_a_frame_is_none():
    root = root_of_chain(18)
    assert root.give(1, dest=18) == []
    assert root.reports == [(c.REPORT_NO_ROUTE, 18, 0)]


def test_a_circle_is_no_way():
    root = root_of_chain(3)
    root.hear(**up(1, 3, path=242, number=9))
    settle(root)
    root.sent.clear()
    assert root.give(1, dest=3) == []


def test_a_source_route_is_followed_hop_by_hop():
    """9.7: "RPL routes messages Downward using IP source routing" """
    (frame,) = root_of_chain(6).give(1, dest=6, body=[7] * 8)
    for at in range(1, 6):
        one = attached(at, parent=20, storing=0)
        one.hear(**{name: value for name, value in vars(frame).items() if name != "urgent"})
        (frame,) = packets(one)
        assert (frame.to, frame.src) == (at + 1, at)
    last = attached(6, parent=20, storing=0)
    last.hear(**{name: value for name, value in vars(frame).items() if name != "urgent"})
    assert [got.body for got in last.delivered] == [[7] * 8]


def test_from_node_to_node_by_the_root():
    """3.3: "in Non-Storing mode, the packet will travel all the way to a DODAG root before traveling
    Down" """
    one = attached(storing=0)
    (frame,) = one.give(1, dest=9)
    assert (frame.to, frame.down, frame.length) == (1, 0, 0)
    root = root_of_chain(3)
    root.hear(**data(1, 3, number=40, origin=5))
    assert [(f.to, f.length) for f in packets(root)] == [(1, 2)]


def test_a_broken_source_route_is_told_to_the_root():
    """11.2.2.3: "an ICMP error with a new code "Error in Source Routing Header" is sent back to the
    root" """
    one = attached(1, parent=20, storing=0)
    route = {"near": [2, 3, 0, 0], "length": 2, "next": 1, "kind": c.DATA + 1, "down": 1}
    one.hear(**data(20, 3, **route))
    fail(one)
    (error,) = of(one.sent, c.ROUTE_ERROR)
    assert (error.dest, error.to, error.info) == (ROOT, 20, 2)
    root = root_of_chain(3)
    root.hear(kind=c.ROUTE_ERROR, src=1, dsn=77, origin=1, dest=ROOT, hops=9, info=2)
    assert root.node.via[2] == c.NONE
    assert root.give(1, dest=3) == []


# Hops.


def test_a_frame_for_us_is_acknowledged_at_once():
    """IEEE 802.15.4: whatever is on the air; once more if it comes again, and is taken once."""
    one = storing()
    first = one.hear(**data(7, 5))
    assert [(f.kind, f.to, f.dsn, f.urgent) for f in first] == [(c.ACK, 7, 1, 1)]
    assert len(of(one.hear(**data(7, 5)), c.ACK)) == 1
    assert len(one.delivered) == 1


def test_one_frame_is_under_way():
    one = storing()
    one.give(2)
    one.give(2)
    assert len(packets(one)) == 1
    one.told()
    ack(one, src=9)
    assert len(packets(one)) == 1, "that was somebody else's"
    ack(one)
    assert len(packets(one)) == 2


def test_a_frame_is_sent_four_times():
    one = storing()
    one.give(2)
    for tries in range(4):
        assert one.node.tries == tries
        one.told(ok=tries % 2)  # or the channel was busy
        if one.node.waiting:
            one.fire(c.ACK_WAIT)
    assert one.node.rounds == 1


def test_hop_limit_and_full_queues_are_told():
    one = storing()
    one.hear(**data(7, 0, hops=1))
    assert one.reports == [(c.REPORT_HOPS, 0, 9)]
    for _ in range(c.QUEUE + 1):
        one.give(2)
    assert one.reports[1:] == [(c.REPORT_FULL, 0, c.QUEUE)]


def test_packets_wait_for_a_parent_for_a_while():
    one = node()
    assert one.give(2) == []
    for _ in range(one.params.patience):
        one.fire(c.TICK)
        one.told()
    assert one.node.q_count == 0
    assert one.reports == [(c.REPORT_NO_ROUTE, ROOT, 1)]
    late = node()
    late.give(2)
    late.hear(**dio(1, 256))
    assert packets(late)[-1].to == 1


def test_of_many_neighbours_the_farthest_is_forgotten():
    one = attached()
    for src in range(20, 20 + c.NEIGHBOURS - 1):
        one.hear(**dio(src, 2000 + src))
    one.hear(**dio(90, 300))
    known = list(one.node.nbr)
    assert 90 in known
    assert 1 in known
    assert 20 + c.NEIGHBOURS - 2 not in known
