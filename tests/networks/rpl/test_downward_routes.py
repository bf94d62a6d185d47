"""Downward routes of RFC 6550, sections 9 and 11.2.2.3, sentence by sentence."""

from innervate.networks.rpl.protocol import constants as c
from innervate.networks.rpl.protocol import kinds, timers
from innervate.networks.rpl.protocol.downward import FOR_EVER, LIFE
from tests.networks.rpl import nodes as rpl


def test_a_new_dao_parent_is_told_after_delay_dao():
    """9.5: "When a node adds a node to its DAO parent set, it SHOULD schedule a DAO message
    transmission." """
    one = rpl.attached()
    assert rpl.of(one.sent, kinds.DAO) == [], "SHOULD delay sending the DAO message"
    assert one.params.dao_us <= one.left(timers.DAO_DELAY) < 2 * one.params.dao_us
    assert rpl.told_to_parent(one) == [(5, one.node.path_seq, LIFE * one.params.refresh)]


def test_daos_that_come_do_not_reset_delay_dao():
    """9.5: "DAO messages received while the DelayDAO timer is active do not reset the timer." """
    one = rpl.storing()
    one.hear(**rpl.dao(7, 7))
    at = one.timers[timers.DAO_DELAY]
    one.hear(**rpl.dao(8, 8))
    assert one.timers[timers.DAO_DELAY] == at


def test_storing_nodes_store_and_pass_on_what_daos_say():
    """9.2: "all non-root, non-leaf nodes MUST store routing table entries for destinations learned
    from DAOs"; 9.8: "the node MUST generate a new DAO message and transmit it" """
    one = rpl.storing()
    one.hear(**rpl.dao(7, 7, 20, 21))
    assert [one.node.via[target] for target in (7, 20, 21)] == [7] * 3
    told = rpl.told_to_parent(one)
    assert [target for target, *_ in told] == [7, 20, 21]
    assert {path for _, path, _ in told} == {241}, "their own Path Sequences, not ours"


def test_a_dao_goes_to_the_parent_alone():
    """9.8: "It MUST NOT unicast the DAO message to nodes that are not DAO parents." """
    one = rpl.storing()
    one.hear(**rpl.dio(2, 256))
    one.hear(**rpl.dao(7, 7))
    rpl.told_to_parent(one)
    assert {frame.to for frame in rpl.of(one.sent, kinds.DAO)} == {1}


def test_daos_without_news_are_not_passed_on():
    """9.2.2: "MAY suppress scheduling a DAO message transmission if that DAO message is not
    new" """
    one = rpl.storing()
    one.hear(**rpl.dao(7, 7))
    rpl.told_to_parent(one)
    one.hear(**rpl.dao(7, 7, number=2))
    assert not one.node.dao_armed
    one.hear(**rpl.dao(7, 7, path=242, number=3))
    assert rpl.told_to_parent(one) == [(7, 242, LIFE * one.params.refresh)], "a newer Path Sequence"


def test_older_daos_are_ignored():
    """9.3: "Nodes SHOULD ignore DAOs without newer sequence numbers" """
    one = rpl.storing()
    one.hear(**rpl.dao(7, 20, path=243))
    one.hear(**rpl.dao(8, 20, path=242))
    assert one.node.via[20] == 7
    one.hear(**rpl.dao(8, 20, path=244, number=2))
    assert one.node.via[20] == 8


def test_no_path_removes_the_route_and_is_passed_on():
    """9.8: "Such a change includes receiving a No-Path DAO." """
    one = rpl.storing()
    one.hear(**rpl.dao(7, 20, 21))
    rpl.told_to_parent(one)
    one.hear(**rpl.dao(8, 20, life=0))
    assert one.node.via[20] == 7, "it was not that child's"
    one.hear(**rpl.dao(7, 20, life=0, number=2))
    assert one.node.via[20] == c.NONE
    assert [(target, life) for target, _, life in rpl.told_to_parent(one)] == [(20, 0)]


def test_a_changed_parent_is_told_of_the_whole_sub_dodag():
    """9.2.1: "MUST increment the Path Sequence counter, and generate a new DAO message, when
    ... the DODAG Parent Address subfield list is to be changed" """
    one = rpl.storing()
    one.hear(**rpl.dao(7, 7, 20))
    rpl.told_to_parent(one)
    before = one.node.path_seq
    one.hear(**rpl.dio(2, 60))
    assert rpl.parent_of(one) == 2
    told = rpl.told_to_parent(one)
    assert [(t, p) for t, p, life in told if life] == [(5, before + 1), (7, 241), (20, 241)]
    assert [frame.to for frame in rpl.of(one.sent, kinds.DAO)] == [2, 1]


def test_a_parent_that_was_left_is_told_so():
    """9.8: "When a node removes a node from its DAO parent set, it SHOULD send a No-Path DAO
    message to that removed DAO parent to invalidate the existing route." """
    one = rpl.storing()
    one.hear(**rpl.dao(7, 7, 20))
    rpl.told_to_parent(one)
    one.hear(**rpl.dio(2, 60))
    assert [t for t, _, life in rpl.told_to_parent(one) if not life] == [5, 7, 20]
    one.hear(**rpl.dio(2, c.INFINITE))
    assert [t for t, _, life in rpl.told_to_parent(one) if not life] == [5, 7, 20], (
        "a detached one, too"
    )
    assert {frame.to for frame in rpl.of(one.sent, kinds.DAO)} == {2}
    assert rpl.told_to_parent(one) == []


def test_a_dao_that_is_not_acknowledged_is_sent_again():
    """9.3: "MAY reschedule the DAO message transmission for another attempt" """
    one = rpl.attached()
    one.fire(timers.DAO_DELAY)
    rpl.fail(one)
    assert [target for target, *_ in rpl.told_to_parent(one)] == [5]
    assert rpl.told_to_parent(one) == []


def test_a_dtsn_that_grows_asks_for_daos():
    """9.6: "If a node hears one of its DAO parents increment its DTSN, the node MUST schedule a DAO
    message transmission" """
    one = rpl.storing()
    one.hear(**rpl.dao(7, 7))
    rpl.told_to_parent(one)
    one.hear(**rpl.dio(2, 256, dtsn=250))
    assert not one.node.dao_armed, "2 is not our parent"
    one.hear(**rpl.dio(1, 256, dtsn=241))
    assert [target for target, *_ in rpl.told_to_parent(one)] == [5, 7]
    assert one.node.dtsn == 240, "in storing mode it is not passed on"


def test_in_non_storing_mode_a_dtsn_is_passed_on():
    """9.6: "In Non-Storing mode, if a node hears one of its DAO parents increment its DTSN, the
    node MUST increment its own DTSN." """
    one = rpl.attached(storing=0)
    one.hear(**rpl.dio(1, 256, dtsn=241))
    assert one.node.dtsn == 241


def test_packets_go_up_until_somebody_knows_the_way_down():
    """8.1: "This default route enables a packet to be forwarded Upward until it eventually hits a
    common ancestor from which it will be routed Downward to the destination." """
    one = rpl.storing()
    one.hear(**rpl.data(7, 20))
    assert [(f.to, f.down) for f in rpl.packets(one)] == [(1, 0)]
    rpl.ack(one)
    one.told()
    rpl.ack(one)
    one.hear(**rpl.dao(8, 20, number=2))
    one.hear(**rpl.data(7, 20, number=3))
    assert [(f.to, f.down) for f in rpl.packets(one)][1:] == [(8, 1)]


def test_what_cannot_go_down_is_sent_back():
    """11.2.2.3: "the router SHOULD send the packet back to the parent that passed it with the
    Forwarding-Error 'F' bit set and the 'O' bit left untouched" """
    one = rpl.storing()
    one.hear(**rpl.data(1, 20, down=1, sender_rank=1))
    assert [(f.to, f.back, f.down) for f in rpl.packets(one)] == [(1, 1, 1)]


def test_what_comes_back_removes_the_route_and_is_sent_again():
    """11.2.2.3: "MUST remove the routing states that caused forwarding to that neighbor, clear the
    Forwarding-Error bit, and attempt to send the packet again" """
    root = rpl.node(rpl.ROOT)
    root.hear(**rpl.dao(7, 20))
    root.hear(**rpl.data(7, 20, number=2, down=1, back=1))
    assert root.node.via[20] == c.NONE
    assert rpl.packets(root) == []
    assert root.reports == [(c.REPORT_NO_ROUTE, 20, 0)], "a root has nobody to send it back to"
    one = rpl.storing()
    one.hear(**rpl.dao(7, 20))
    rpl.told_to_parent(one)
    one.hear(**rpl.data(7, 20, number=2, down=1, back=1))
    assert [(f.to, f.back) for f in rpl.packets(one)] == [(1, 1)], "the process will recurse"


def test_a_child_that_does_not_answer_is_forgotten():
    """9.8: "a node MAY mark the address as unreachable and generate an appropriate No-Path DAO";
    8.2.1: "Routes through an unreachable neighbor MUST be removed" """
    one = rpl.storing()
    one.hear(**rpl.dao(7, 7, 20))
    rpl.told_to_parent(one)
    one.sent.clear()
    one.hear(**rpl.data(1, 20, down=1, sender_rank=1))
    rpl.fail(one)
    assert rpl.packets(one)[-1].to == 7, "once more"
    rpl.fail(one)
    assert [one.node.via[target] for target in (7, 20)] == [c.NONE] * 2
    assert (rpl.packets(one)[-1].to, rpl.packets(one)[-1].back) == (1, 1)
    rpl.settle(one)
    assert {(t, life) for t, _, life in rpl.told_to_parent(one)} == {(7, 0), (20, 0)}


def test_routes_that_are_not_refreshed_end():
    """17: "RemoveTimer": "Expiry may trigger No-Path advertisements" """
    one = rpl.storing()
    one.hear(**rpl.dao(7, 20, life=5))
    one.hear(**rpl.dao(8, 21, life=FOR_EVER))
    rpl.told_to_parent(one)
    rpl.ticks(one, 4)
    assert one.node.via[20] == 7
    rpl.ticks(one, 1)
    assert (one.node.via[20], one.node.via[21]) == (c.NONE, 8)
    assert [(target, life) for target, _, life in rpl.told_to_parent(one)] == [(20, 0)]


def test_a_path_lifetime_begins_with_its_path_sequence():
    """6.7.8: "The period starts when a new Path Sequence is seen." """
    one = rpl.storing()
    for number in range(1, 5):
        one.hear(**rpl.dao(7, 20, life=5, number=number))
        rpl.ticks(one, 1)
    one.hear(**rpl.dao(7, 21, path=242, life=5, number=5))
    rpl.ticks(one, 1)
    assert (one.node.via[20], one.node.via[21]) == (c.NONE, 7)
    one.hear(**rpl.dao(7, 20, path=242, life=5, number=6))
    rpl.ticks(one, 4)
    assert (one.node.via[20], one.node.via[21]) == (7, c.NONE)


def test_who_restarts_is_old_until_its_ways_have_ended():
    """7.2: both "greater than or equal to 128", 241 is less than 245; a limit of the counters."""
    one = rpl.storing()
    one.hear(**rpl.dao(7, 7, path=245, life=5))
    one.hear(**rpl.dao(8, 7, path=241, life=5, number=1))
    assert one.node.via[7] == 7
    rpl.ticks(one, 5)
    one.hear(**rpl.dao(8, 7, path=242, life=5, number=2))
    assert one.node.via[7] == 8


def test_packets_that_nobody_takes_are_told_of_one_by_one():
    one = rpl.node(patience=1)
    for dest in (7, 8):
        one.give(1, dest=dest)
    assert one.node.q_count == 2
    rpl.ticks(one, 2)
    assert one.reports[-2:] == [(c.REPORT_NO_ROUTE, 7, 1), (c.REPORT_NO_ROUTE, 8, 0)]
    assert one.node.q_count == 0


def test_own_routes_are_refreshed():
    """9.2.1: "the Path Lifetime is to be updated (e.g., a refresh or a no-Path)" """
    one = rpl.storing(refresh=2)
    before = one.node.path_seq
    one.fire(timers.TICK)
    assert not one.node.dao_armed
    one.fire(timers.TICK)
    assert rpl.told_to_parent(one)[0][:2] == (5, before + 1)
