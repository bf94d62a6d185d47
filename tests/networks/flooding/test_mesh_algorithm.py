"""Meshtastic's "Mesh Broadcast Algorithm", sentence by sentence, on the handlers."""

import pytest

from innervate.network import networks
from innervate.networks.flooding.protocol import node as p
from innervate.prove.theory import prove
from tests.networks.one import One

FLOODING = networks()["flooding"]
FAINT, LOUD = -95, -65
ALL = p.EVERYBODY
PLACE = 0  # the first packet waits in the first place, whose timer has its number
OWN = p.PLACES


@pytest.fixture
def node():
    return One(FLOODING, 5)


def packet(number=1, **more):
    """A packet of node 1 for all, as it was sent first."""
    usual = {"kind": p.PACKET, "origin": 1, "id": number, "dest": ALL, "hops": 3, "start": 3}
    return usual | {"rssi": FAINT} | more


def test_every_node_rebroadcasts_what_it_receives(node):
    """Layer 3: "every node rebroadcasts a packet it receives, up till a certain hop limit" """
    body = [9, 8, 7, 6, 5, 4, 3, 2]
    assert node.hear(**packet(body=body)) == [], "it waits first"
    (again,) = node.fire(PLACE)
    assert (again.origin, again.id, again.dest, again.body) == (1, 1, ALL, body)


def test_the_hop_limit_is_decremented(node):
    """Layer 3: "sees a packet with a HopLimit other than zero, it will decrement that HopLimit" """
    node.hear(**packet(hops=2))
    assert node.fire(PLACE)[0].hops == 1


def test_what_is_handed_up_is_what_came(node):
    came = packet(hops=2, start=6, want=1, body=[1, 2, 3, 4, 5, 6, 7, 8], made_at=77, dest=5)
    node.hear(**came)
    (told,) = node.delivered
    assert {name: getattr(told, name) for name in came} == came


def test_what_is_passed_on_is_what_came_with_one_hop_less(node):
    came = packet(hops=2, start=6, want=1, body=[1, 2, 3, 4, 5, 6, 7, 8], made_at=77, dest=9)
    node.hear(**came)
    (sent,) = node.fire(PLACE)
    expected = {**came, "hops": 1, "rssi": 0}
    assert {name: getattr(sent, name) for name in came} == expected


@pytest.mark.parametrize(("hops", "start", "back"), [(3, 3, 2), (1, 3, 3), (2, 3, 3), (7, 0, 2)])
def test_an_answer_may_go_two_hops_more_than_the_question_went(node, hops, start, back):
    """Whatever a frame says of itself: as far as it can go, and never less than nothing."""
    (ack,) = node.hear(**packet(dest=5, want=1, hops=hops, start=start))
    assert (ack.hops, ack.start) == (back, back)


def test_a_hop_limit_of_zero_is_not_rebroadcast(node):
    """Overview: "a packet with a hop limit of zero, it will not rebroadcast the message" """
    node.hear(**packet(hops=0))
    assert PLACE not in node.timers
    assert len(node.delivered) == 1


def test_three_hops_by_default_and_seven_at_most():
    """Header: flags of 3 bits, "HopLimit" and "HopStart (original HopLimit)" """
    assert FLOODING.fields.DEFAULTS["hops"] == 3
    sent = One(FLOODING, 5).give(p.MESSAGE, dest=ALL)
    assert (sent[0].hops, sent[0].start) == (3, 3)
    bits = {name: bits for _kind, _name, fields in FLOODING.frames.LAYOUTS
            for name, _many, bits, _signed in fields}  # fmt: skip
    assert bits["hops"] == bits["start"] == 3
    assert {name: high for name, _, _, high, *_ in FLOODING.fields.PARAMS}["hops"] == 7


def test_frames_are_of_whole_bytes_each_number_in_no_more_bits_than_it_has():
    """Six of header; behind them 16 of what users say, or two of what is acknowledged."""
    frames, ranges = FLOODING.frames, {field[0]: field[2:4] for field in FLOODING.fields.FRAME}
    sizes = {name: frames.KIND_BITS + sum(bits * max(many, 1) for _, many, bits, _ in fields)
             for _kind, name, fields in frames.LAYOUTS}  # fmt: skip
    assert sizes == {"packet": 8 * (6 + 16), "ack": 8 * (6 + 2)}
    for _kind, _name, fields in frames.LAYOUTS:
        for name, _many, bits, _signed in fields:
            assert not name or ranges[name][1].bit_length() == bits


def test_what_was_heard_before_is_ignored(node):
    """Overview: "it checks to see if it has heard that message before. If it has it ignores" """
    node.hear(**packet())
    node.fire(PLACE)
    node.hear(**packet(hops=2))
    assert PLACE not in node.timers
    assert len(node.delivered) == 1
    node.hear(**packet(number=2))
    node.hear(**packet(origin=2))
    assert len(node.delivered) == 3, "another id, and the same of another sender, are others"


def test_who_hears_another_rebroadcast_does_not(node):
    """Layer 3: "listens a short while to see if another node has already rebroadcasted the packet.
    If so, it will not rebroadcast." """
    node.hear(**packet())
    node.hear(**packet(hops=2))
    assert node.fire(PLACE) == []
    assert node.node.spared == 1


def test_the_fainter_a_packet_the_sooner_it_is_rebroadcast(node):
    """Layer 3: "The CW size is small for a low SNR, such that nodes that are further away are more
    likely to flood first" """

    def longest(rssi):
        waits = set()
        for number in range(60):
            node.hear(**packet(number=number + 1000 * (rssi + 100), rssi=rssi))
            waits.add(node.left(PLACE) // node.params.slot_us)
            node.fire(PLACE)
        return max(waits) - 2 * node.params.cw_max

    faint, middle, loud = longest(FAINT), longest(-80), longest(LOUD)
    assert faint < 1 << node.params.cw_min
    assert faint < middle < loud < 1 << node.params.cw_max
    assert loud > 128


@pytest.mark.parametrize(("rssi", "bits"), [(FAINT, 3), (-98, 3), (-80, 5), (LOUD, 8), (-3, 8)])
def test_a_wait_is_so_many_slots_and_some_of_a_window(node, rssi, bits):
    """Firmware, RadioInterface::getTxDelayMsecWeighted: 2 CWmax slots, and a draw of 2^CW."""
    waits = []
    for drawn in (0, (1 << bits) - 1, 1 << bits):
        node.node.choice = drawn
        node.hear(**packet(number=drawn, rssi=rssi))
        waits.append(node.left(PLACE) // node.params.slot_us - 2 * node.params.cw_max)
        node.fire(PLACE)
    assert waits == [0, (1 << bits) - 1, (1 << bits) - 1]


def test_a_wait_is_a_random_multiple_of_slot_times(node):
    """Layer 1: "a node has to wait a random multiple of slot times" """
    waits = []
    for number in range(20):
        node.hear(**packet(number=number, rssi=LOUD))
        waits.append(node.left(PLACE))
        node.fire(PLACE)
    assert len(set(waits)) > 15
    assert all(wait % node.params.slot_us == 0 for wait in waits)


def test_hearing_a_rebroadcast_is_an_acknowledgement(node):
    """Layer 2: "the original sender listens to see if at least one node is rebroadcasting this
    packet" and "generates an implicit ACK" """
    (sent,) = node.give(p.MESSAGE, dest=ALL)
    node.hear(**packet(number=sent.id, origin=5, hops=2))
    assert node.reports == [(p.REPORT_ACKED, sent.id, 0)]
    assert node.fire(OWN) == []


def test_without_a_rebroadcast_it_is_sent_again(node):
    """Layer 2: "If after some time we don't hear anyone rebroadcast our packet, we will timeout and
    re-transmit" """
    (sent,) = node.give(p.MESSAGE, dest=ALL, body=[1] * 8)
    (again,) = node.fire(OWN)
    assert again == sent


def test_three_times_at_most_and_then_a_negative_acknowledgement(node):
    """Layer 2: "will be resent a maximum of three times", "internally generate a NAK" """
    (sent,) = node.give(p.MESSAGE, dest=9)
    assert [len(node.fire(OWN)) for _ in range(4)] == [1, 1, 1, 0]
    assert node.reports == [(p.REPORT_GAVE_UP, sent.id, 3)]
    assert OWN not in node.timers


def test_acknowledgements_of_broadcasts_are_suppressed(node):
    """Layer 2: "Since ACKs for broadcasts would rapidly flood the channel, the normal ACK behavior
    is suppressed." """
    assert node.hear(**packet(want=1)) == []
    assert {frame.kind for frame in node.fire(PLACE)} == {p.PACKET}


def test_the_recipient_of_a_direct_message_acknowledges_it(node):
    """Layer 2: "For direct messages, the intended recipient will also send a real ACK all the way
    back to the original sender" """
    (ack,) = node.hear(**packet(dest=5, want=1, hops=2))
    assert (ack.kind, ack.dest, ack.ack, ack.origin) == (p.ACK, 1, 1, 5)
    assert len(node.delivered) == 1
    assert PLACE not in node.timers, "a message that is here goes no further"


def test_a_real_acknowledgement_ends_the_wait(node):
    """Layer 2: "the device will only retransmit when it received no ACK at all" """
    (sent,) = node.give(p.MESSAGE, dest=1)
    node.hear(**packet(kind=p.ACK, number=77, dest=5, ack=sent.id))
    assert node.reports == [(p.REPORT_ACKED, sent.id, 1)]
    assert node.fire(OWN) == []


def test_others_pass_acknowledgements_and_direct_messages_on(node):
    """Layer 3: "attempt to rebroadcast on behalf of the original sending node" """
    node.hear(**packet(dest=7, want=1))
    (again,) = node.fire(PLACE)
    assert (again.dest, again.want) == (7, 1)
    node.hear(**packet(kind=p.ACK, number=2, dest=7, ack=40))
    assert (node.fire(PLACE)[0].kind, node.sent[-1].ack) == (p.ACK, 40)
    assert node.delivered == []


def test_a_retransmission_of_the_origin_is_passed_on_again(node):
    """Firmware, FloodingRouter: "when the ACK got lost, we will handle the packet again to make
    sure it gets an implicit ACK" """
    node.hear(**packet())
    node.fire(PLACE)
    node.hear(**packet())
    assert node.fire(PLACE)[0].id == 1
    assert len(node.delivered) == 1


def test_nobody_passes_his_own_packet_on(node):
    (sent,) = node.give(p.MESSAGE, dest=ALL)
    node.hear(**packet(number=sent.id, origin=5, hops=2))
    assert not any(node.node.waits)


def test_a_node_that_lost_its_memory_takes_other_numbers(node):
    (sent,) = node.give(p.MESSAGE, dest=ALL)
    node.node.id = 0
    node.start(cause=1)
    assert node.give(p.MESSAGE, dest=ALL)[0].id != sent.id


def test_what_has_no_place_is_told(node):
    for number in range(p.PLACES + 1):
        node.hear(**packet(number=number))
    assert node.reports == [(p.REPORT_FULL, 1, p.PLACES)]
    for _ in range(p.OWN + 1):
        node.give(p.MESSAGE, dest=ALL)
    assert node.reports[1:] == [(p.REPORT_FULL, 5, node.node.id)]


def test_what_was_met_long_ago_is_forgotten(node):
    node.hear(**packet(hops=0))
    for _ in range(p.SEEN):
        node.fire(p.FORGET)
    node.hear(**packet(hops=0))
    assert len(node.delivered) == 2


def test_the_oldest_is_forgotten_first(node):
    for number in (1, 2, 3):
        node.hear(**packet(number=number, hops=0))
    known = [{1, 2, 3}]
    while known[-1]:
        node.fire(p.FORGET)
        left = {number for number in known[-1] if p.is_known(node.node, 1, number)}
        if left != known[-1]:
            known.append(left)
    assert known == [{1, 2, 3}, {2, 3}, {3}, set()]


def test_so_many_are_remembered(node):
    for number in range(p.SEEN + 1):
        node.hear(**packet(number=number, hops=0))
    assert [p.is_known(node.node, 1, number) for number in (0, 1, p.SEEN)] == [False, True, True]


def test_all_stays_in_range_whatever_comes_in_and_every_branch_is_taken():
    """Of any state and any frame; the ranges of what waits are those of what is sent."""
    (theory,) = FLOODING.prove.theories(FLOODING)
    came = prove(theory)
    assert [(one.name, bad.goal) for one in came.checked for bad in one.refuted] == []
    assert came.is_as_expected
    frame = {name: (low, high) for name, _, low, high, *_ in FLOODING.fields.FRAME}
    state = {name: (low, high) for name, _, low, high, *_ in FLOODING.fields.STATE}
    waits = {"packet": "id", "made": "made_at"} | {
        name: name for name in ("kind", "origin", "dest", "hops", "start", "want", "ack", "body")
    }
    assert {name: state[name] for name in waits} == {name: frame[of] for name, of in waits.items()}


def test_the_explorer_hands_in_a_message_for_all_and_one_for_a_node():
    assert FLOODING.fields.GIVEN == ((p.MESSAGE, {"dest": ALL}), (p.MESSAGE, {"dest": 1}))
