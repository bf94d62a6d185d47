"""RPL at the edges: node 0 below another root, nodes that there are not, counters that are full."""

import pytest

from innervate.networks.rpl.protocol import kinds, sizes, timers
from innervate.networks.rpl.protocol import packets as parts
from innervate.networks.rpl.protocol.node import ALARM, MESSAGE
from tests.networks.rpl import nodes as rpl


def test_node_0_is_a_target_like_others_where_it_is_not_the_root():
    one = rpl.storing(root=9)
    one.hear(**rpl.dao(0, 0))
    assert one.node.via[0] == 0
    rpl.told_to_parent(one)
    one.hear(**rpl.dio(1, 256, dtsn=241))  # our parent asks for all that we reach
    assert {target for target, *_ in rpl.told_to_parent(one)} == {0, 5}


@pytest.mark.parametrize("storing_", [0, 1])
@pytest.mark.parametrize("dest", [sizes.NODES - 1, sizes.NODES, sizes.NODES + 1])
def test_a_packet_for_a_node_that_there_is_not_goes_to_the_parent_like_others(storing_, dest):
    one = rpl.attached(storing=storing_)
    rpl.told_to_parent(one)
    one.sent.clear()
    one.give(MESSAGE, dest=dest)
    assert [(frame.to, frame.dest) for frame in rpl.packets(one)] == [(1, dest)]


def test_an_alarm_goes_to_the_root():
    one = rpl.attached(root=9)
    rpl.told_to_parent(one)
    one.sent.clear()
    one.give(ALARM)
    assert [(frame.to, frame.dest) for frame in rpl.packets(one)] == [(1, 9)]


@pytest.mark.parametrize(("heard", "sends"), [(0, 1), (254, 1), (255, 0), (300, 0)])
def test_as_many_as_there_can_be_suppress_a_dio(heard, sends):
    """6550, 6.7.6: DIORedundancyConstant is an 8-bit number; its greatest is counted to, too."""
    one = rpl.attached(dio_k=255)
    one.fire(timers.TRICKLE)
    one.told()
    one.fire(timers.TRICKLE)  # the next interval begins
    for _ in range(heard):
        one.hear(**rpl.dio(1, 256))
    sent = one.fire(timers.TRICKLE)
    assert len([frame for frame in sent if frame.kind == kinds.DIO]) == sends


def test_who_loses_its_memory_knows_its_neighbours_no_better_than_a_new_one():
    one, fresh = rpl.attached(), rpl.node()
    assert any(one.node.nbr_etx)
    one.start(cause=1)
    for name in ("nbr", "nbr_rank", "nbr_etx", "via", "owed", "left", "parent", "rank", "known"):
        assert getattr(one.node, name) == getattr(fresh.node, name), name


def test_a_frame_of_which_nothing_is_said_says_nothing():
    frame = rpl.node().frame_class()
    for name, length, low, high, *_ in rpl.RPL.fields.FRAME:
        full = high if high > 0 else low
        setattr(frame, name, [full] * length if length else full)
    parts.clean(frame)
    for name, length, *_ in rpl.RPL.fields.FRAME:
        assert getattr(frame, name) == ([0] * length if length else 0), name
