"""Upward routes of RFC 6550 (sections 8 and 11) with MRHOF, RFC 6719, sentence by sentence."""

import pytest

from innervate.networks.rpl.protocol import constants as c
from innervate.networks.rpl.protocol import kinds, timers
from tests.networks.rpl import nodes as rpl

HIDDEN = -93  # dBm: 88 % of the frames are received: an ETX of 1.29


def joined(*dios, **params):
    one = rpl.node(**params)
    for each in dios:
        one.hear(**each)
    return one


def test_the_root_advertises_root_rank():
    """8.2.2.2: "A DODAG root MUST advertise a Rank of ROOT_RANK."; 17: "a value of
    MinHopRankIncrease" """
    root = rpl.node(0)
    (frame,) = root.fire(timers.TRICKLE)
    assert (frame.kind, frame.rank, frame.version) == (kinds.DIO, rpl.STEP, rpl.VERSION)
    root.hear(**rpl.dio(1, 64))
    assert rpl.parent_of(root) is None, "8.2.1: a DODAG parent set of size zero"


def test_rank_is_greater_than_the_parents():
    """8.2.1: "A node's Rank MUST be greater than all elements of its DODAG parent set." """
    for rank in (128, 300, 1000):
        one = joined(rpl.dio(1, rank))
        assert one.node.rank >= rank + rpl.STEP


def test_mrhof_adds_the_etx_of_the_link_to_the_rank():
    """6719, 3.5: "It locally computes the ETX of links to its neighbors and adds this value to
    their advertised Rank", "assign Rank equal to ETX * 128" """
    assert joined(rpl.dio(1, 256)).node.rank == 256 + 128
    assert joined(rpl.dio(1, 256, rssi=HIDDEN)).node.rank == 256 + 165
    assert joined(rpl.dio(1, 300)).node.rank == 300 + 128


def test_the_lowest_path_cost_wins():
    """6719, 3.2.2: "MUST select the candidate neighbor with the lowest path cost" """
    one = joined(rpl.dio(1, 512), rpl.dio(2, 256, rssi=HIDDEN), rpl.dio(3, 256))
    assert rpl.parent_of(one) == 2, "3 is better by less than the threshold"
    assert rpl.parent_of(joined(rpl.dio(1, 512), rpl.dio(3, 256))) == 3


def test_hysteresis_keeps_a_parent_that_is_little_worse():
    """6719, 3.2.2: "smaller than cur_min_path_cost by less than PARENT_SWITCH_THRESHOLD, the node
    MAY continue to use the current preferred parent" """
    one = joined(rpl.dio(1, 384), rpl.dio(2, 256))
    assert one.params.switch == 192
    assert rpl.parent_of(one) == 1
    one.hear(**rpl.dio(2, 190))
    assert rpl.parent_of(one) == 2


def test_bad_links_are_left_out():
    """6719, 3.2.2: "greater than MAX_LINK_METRIC, the node SHOULD exclude that link" """
    one = joined(rpl.dio(1, 128))
    rpl.settle(one)
    one.node.nbr_etx[one.node.parent] = 513
    one.hear(**rpl.dio(2, 128))
    assert rpl.parent_of(one) == 2


def test_etx_is_learnt_from_acknowledgements():
    """13: "derived from events such as association states and L2 acknowledgements" """
    one = rpl.attached()
    one.give(2)
    one.told()
    one.fire(timers.ACK_WAIT)
    rpl.settle(one)
    assert one.node.nbr_etx[one.node.parent] == (3 * 128 + 2 * 128) // 4
    before = one.node.rank
    one.give(2)
    rpl.settle(one)
    assert one.node.rank < before


def test_a_neighbour_that_does_not_answer_is_no_candidate():
    """8.2.1: "a RPL node MUST NOT consider this node in the candidate neighbor set" """
    one = rpl.attached()
    one.hear(**rpl.dio(2, 256))
    one.give(2)
    rpl.fail(one)
    assert rpl.parent_of(one) == 2, "the link looks worse after one frame"
    one = rpl.attached(reroutes=8)
    one.give(2)
    rpl.fail(one)
    rpl.fail(one)
    assert one.node.rank == c.INFINITE
    one.hear(**rpl.dio(1, 256))
    assert rpl.parent_of(one) == 1, "until it determines that it is again reachable"


def test_a_packet_goes_to_the_next_parent():
    one = rpl.attached()
    one.hear(**rpl.dio(2, 256))
    one.give(2, body=[5] * 8)
    rpl.fail(one)
    assert (one.sent[-1].to, one.sent[-1].body) == (2, [5] * 8)


def test_ranks_lower_within_a_version():
    """8.2.2.4: "MAY advertise a Rank lower than its prior advertisement" """
    one = rpl.attached(rank=512)
    one.hear(**rpl.dio(2, 128))
    assert one.node.rank == 256


def advertised(one):
    one.fire(timers.TRICKLE)
    one.told()


def test_no_rank_above_l_and_dag_max_rank_increase():
    """8.2.2.4: "MUST NOT advertise an effective Rank higher than L + DAGMaxRankIncrease", "it MUST
    advertise its Rank as INFINITE_RANK" """
    one = rpl.attached(increase=256)
    advertised(one)
    assert one.node.lowest == 384
    one.hear(**rpl.dio(1, 512))
    assert one.node.rank == 640
    one.hear(**rpl.dio(1, 513))
    assert one.node.rank == c.INFINITE
    assert one.sent[-1].rank == c.INFINITE


def test_l_begins_anew_with_a_version():
    """8.2.2.4: "Within the same DODAG Version" """
    one = rpl.attached(increase=256)
    advertised(one)
    one.hear(**rpl.dio(1, 2000, version=rpl.VERSION + 1))
    assert one.node.rank == 2128


def test_a_node_poisons_its_routes():
    """8.2.2.5: "A node poisons routes by advertising a Rank of INFINITE_RANK."; 8.2.2.6: "SHOULD
    immediately advertise this new situation" """
    one = rpl.attached()
    (frame,) = one.hear(**rpl.dio(1, c.INFINITE))
    assert (frame.kind, frame.rank) == (kinds.DIO, c.INFINITE)


def test_nobody_of_infinite_rank_is_a_parent():
    """8.2.2.5: "MUST NOT have any nodes with a Rank of INFINITE_RANK in its parent set" """
    assert rpl.parent_of(joined(rpl.dio(1, c.INFINITE))) is None
    one = rpl.attached()
    one.hear(**rpl.dio(2, 256))
    one.hear(**rpl.dio(1, c.INFINITE))
    assert rpl.parent_of(one) == 2, "8.2.2.7: stay ... through an alternative DODAG parent"


def test_who_is_not_above_us_is_no_parent_at_once():
    """8.2.2.4: "Moving Up does not present the risk to create a loop but moving Down might" """
    one = rpl.attached(rank=256)
    one.hear(**rpl.dio(2, 384))  # as far as we are: it may hang on us
    one.hear(**rpl.dio(1, c.INFINITE))
    assert rpl.parent_of(one) is None
    rpl.settle(one)
    one.hear(**rpl.dio(2, 384))
    assert rpl.parent_of(one) is None, "poison and delay before moving"
    for _ in range(one.params.hold):
        one.fire(timers.TICK)
        rpl.settle(one)
    one.hear(**rpl.dio(2, 384))
    assert rpl.parent_of(one) == 2


def test_a_node_without_a_parent_solicits():
    """6.2: "The DODAG Information Solicitation (DIS) message may be used to solicit a DODAG
    Information Object" """
    one = rpl.node()
    (frame,) = one.fire(timers.TICK)
    assert (frame.kind, frame.to) == (kinds.DIS, 65535)


def test_it_solicits_ever_more_rarely_and_for_ever():
    one, asked = rpl.node(), []
    for number in range(1, 600):
        asked += [number] if any(frame.kind == kinds.DIS for frame in one.fire(timers.TICK)) else []
        rpl.settle(one)
    assert asked == [1, 2, 4, 8, 16, 32, *range(64, 600, 64)]


def test_a_newer_version_is_joined_at_once():
    """8.2.2.4: "MAY, at any time after hearing the next DODAGVersionNumber advertised from suitable
    DODAG parents, choose to migrate"; 8.2.2.1: "can safely add a parent of any Rank" """
    one = rpl.attached(rank=256)
    one.hear(**rpl.dio(2, 3000, version=rpl.VERSION + 1))
    assert (one.node.version, rpl.parent_of(one)) == (rpl.VERSION + 1, 2)


def test_parents_are_of_one_version():
    """8.2.2.1: "MUST belong to the same DODAG Version" """
    one = joined(rpl.dio(1, 256, version=rpl.VERSION + 1), rpl.dio(2, 128))
    assert rpl.parent_of(one) == 1
    assert one.node.version == rpl.VERSION + 1, "never a member of a previous DODAG Version"


def test_a_parent_that_has_forgotten_the_version_is_none_any_more():
    """The root has lost its memory twice: it begins anew with one that is over."""
    one = joined(rpl.dio(1, 256, version=rpl.VERSION + 1), rpl.dio(2, 300, version=rpl.VERSION + 1))
    assert rpl.parent_of(one) == 1
    one.hear(**rpl.dio(1, 256))
    assert (rpl.parent_of(one), one.node.version) == (2, rpl.VERSION + 1)
    alone = joined(rpl.dio(1, 256, version=rpl.VERSION + 1))
    alone.hear(**rpl.dio(2, 256))  # of who is no parent it is not news
    assert rpl.parent_of(alone) == 1
    alone.hear(**rpl.dio(1, 256))
    assert (alone.node.parent, alone.node.rank, alone.node.version) == (
        -1,
        c.INFINITE,
        rpl.VERSION + 1,
    )


def test_only_the_root_makes_versions():
    """8.2.2.1: "a node that is a not a root MUST NOT advertise a DODAGVersionNumber higher than the
    highest DODAGVersionNumber it has heard" """
    one = rpl.attached(repair=1)
    one.fire(timers.TICK)
    assert one.node.version == rpl.VERSION
    root = rpl.node(0, repair=1)
    root.fire(timers.TICK)
    assert root.node.version == rpl.VERSION + 1


def test_a_root_that_has_forgotten_goes_beyond_what_others_know():
    """3.2.2: "A DODAG root institutes a global repair operation by incrementing the
    DODAGVersionNumber." """
    root = rpl.node(0)
    root.start(cause=1)
    root.hear(**rpl.dio(3, 256))
    assert root.node.version == rpl.VERSION + 1
    root.hear(**rpl.dio(3, 256))
    assert root.node.version == rpl.VERSION + 1, "once"
    root.hear(**rpl.dio(3, 256, version=rpl.VERSION + 5))
    assert root.node.version == rpl.VERSION + 6


@pytest.mark.parametrize(
    ("down", "sender", "wrong"), [(1, 4, True), (1, 3, False), (1, 2, False), (0, 2, True),
                                  (0, 3, False), (0, 4, False)],
)  # fmt: skip
def test_ranks_have_to_fit_the_direction(down, sender, wrong):
    """11.2.2.2: "the 'O' bit set (to Down) from a node of a higher Rank", "the 'O' bit cleared (for
    Up) from a node of a lower Rank" """
    one = rpl.attached(rank=256)  # our DAGRank is 3
    one.node.via[8] = 7
    one.hear(**rpl.data(2, 8 if down else 0, down=down, sender_rank=sender))
    passed = [frame for frame in one.sent if frame.kind == kinds.DATA]
    assert [frame.error for frame in passed] == [int(wrong)]


def test_a_second_inconsistency_drops_the_packet():
    """11.2.2.2: "a second detection along the path of the same packet should not occur and the
    packet MUST be dropped" """
    one = rpl.attached(rank=256)
    one.hear(**rpl.data(2, 0, sender_rank=2, error=1))
    assert [frame for frame in one.sent if frame.kind == kinds.DATA] == []
    assert one.reports == [(c.REPORT_LOOP, 0, 9)]


def test_the_source_says_no_rank_and_routers_theirs():
    """11.2: SenderRank "set to zero by the source and to DAGRank(rank) by a router" """
    one = rpl.attached(rank=256)
    assert one.give(2)[-1].sender_rank == 0
    rpl.settle(one)
    one.hear(**rpl.data(7, 0, sender_rank=0))
    assert one.sent[-1].sender_rank == 3


def test_into_a_new_version_the_rank_is_infinite():
    """11.2.2.2: "MUST update the SenderRank to INFINITE_RANK as it forwards the packets across the
    discontinuity" """
    one = rpl.attached(rank=256)
    one.node.nbr_version[one.node.parent] = rpl.VERSION + 1
    one.hear(**rpl.data(7, 0))
    assert one.sent[-1].sender_rank == c.INFINITE
