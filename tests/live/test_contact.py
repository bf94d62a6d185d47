"""First contact: nothing recorded, relayed or pretended makes a neighbour or comes twice."""

import pytest

from innervate.cli import live_status
from innervate.live.contact import KNOCKS
from innervate.live.knocks import ANSWERED, SHUT_S
from innervate.live.session import REKEY_US
from innervate.wire import seal
from tests.live import time_by_hand
from tests.live.net import Mesh
from tests.live.pair import (
    KEY,
    OTHER,
    Wire,
    anew,
    begin,
    join,
    joined,
    network_sealer,
    own_sealer,
    settle,
    two,
)
from tests.live.time_by_hand import timed

VALVE = b"OPEN VALVE"


def kinds(make):
    """A test for nodes with the network's key, and for nodes with identities."""
    return pytest.mark.parametrize("make", make, ids=["network", "identity"])


BOTH = kinds([network_sealer, own_sealer])


@BOTH
@timed
async def test_what_one_seals_the_other_opens_25_bytes_longer(make):
    a, b = await two(make)
    a.frame(VALVE)
    b.frame(b"done")
    await settle()
    assert (b.got, a.got) == ([(1, VALVE)], [(2, b"done")])
    assert len(a.said[-1]) == len(VALVE) + seal.OVERHEAD_BYTES == len(VALVE) + 25
    assert not any(VALVE in said for said in a.said)
    assert a.sealer.dropped == b.sealer.dropped == {}


@BOTH
@timed
async def test_frames_before_the_first_contact_wait_a_little(make):
    a, b = Wire(), Wire()
    join(a, b)
    begin(make(1), a)
    a.frame(b"early")
    begin(make(2), b)
    await settle()
    assert b.frames() == [b"early"]


@BOTH
@pytest.mark.parametrize("has_asked", [False, True])
@timed
async def test_a_recording_is_worth_nothing_to_a_node_that_was_started_anew(make, has_asked):
    """Its state is lost, its clock wherever it likes: it has drawn other keys."""
    a, b = await two(make)
    a.frame(VALVE)
    await settle()
    assert b.frames() == [VALVE]
    recorded = list(a.said)
    for is_there in (True, False):
        if not is_there:
            a.sealer.stop()
            a.others = []
        again = Wire()
        join(a, again) if is_there else None
        begin(make(2), again)
        if has_asked:  # what was recorded may be an answer
            await settle(0.001)
        for _ in range(3):
            for data in recorded:
                again.hear(data)
            await settle()
        assert again.frames() == []
        again.sealer.stop()


@BOTH
@timed
async def test_nothing_is_taken_twice_or_on_another_path(make):
    a, b = await two(make)
    for k in range(5):
        a.frame(bytes([k]))
    await settle()
    assert b.frames() == [bytes([k]) for k in range(5)]
    for data in [data for data in a.said if data[0] == seal.FRAME]:
        b.hear(data)
    assert (len(b.got), b.sealer.dropped) == (5, {"sealed: replayed": 5})
    begin(b.sealer, b, elsewhere := Wire("elsewhere"))  # its sessions are over
    for data in a.said:
        b.hear(data)
        elsewhere.hear(data)
    assert (len(b.got), elsewhere.got) == (5, [])


@BOTH
@timed
async def test_two_starts_of_one_number_use_no_nonce_twice(make):
    """The same number, the same keys, the same clock: what they seal has nothing in common."""
    said = []
    for _ in range(2):
        a, b = await two(make)
        for k in range(20):
            a.frame(b"the same frame %d" % k)
        await settle()
        sealed = slice(seal.HEADER_BYTES, -seal.TAG_BYTES)  # tags are of the headers, too
        said += [data[sealed] for data in a.said if data[0] == seal.FRAME]
        a.sealer.stop()
        b.sealer.stop()
    assert len(said) == len(set(said)) == 40


@BOTH
@pytest.mark.parametrize("where", range(0, 40, 3))
@timed
async def test_no_byte_of_any_message_can_be_changed(make, where):
    a, b = Wire(), Wire()
    join(a, b)

    def twist(data):
        changed = bytearray(data)
        changed[where % len(data)] ^= 0x20
        return [bytes(changed)]

    a.change = twist
    begin(make(1), a)
    begin(make(2), b)
    await settle(0.5)
    for wire in (a, b):
        wire.frame(VALVE)
    await settle(0.2)
    assert (a.got, b.got) == ([], [])
    assert sum(b.sealer.dropped.values()) > 0
    a.change = lambda data: [data]
    await settle(4.0)
    a.frame(VALVE)
    await settle(0.2)
    assert VALVE in b.frames()


@pytest.mark.parametrize(
    "stranger",
    [lambda: network_sealer(2, {1: OTHER}), lambda: network_sealer(2, {2: KEY}),
     lambda: own_sealer(2)],
    ids=["another key", "another number of the key", "an identity"],
)  # fmt: skip
@timed
async def test_a_stranger_is_nobody(stranger):
    a, b = joined(network_sealer(1), stranger())
    await settle(3.0)
    assert a.sealer.counts["handshakes"] == b.sealer.counts["handshakes"] == 0
    assert sum(a.sealer.dropped.values()) > 0
    assert all(said[0] >= seal.FIRST for said in a.said)  # and it is not answered


@timed
async def test_another_kind_of_network_is_not_ours():
    a, _b = joined(own_sealer(1), own_sealer(2, kind="skin"))
    await settle(3.0)
    assert a.sealer.counts["handshakes"] == 0


@BOTH
@timed
async def test_a_relay_without_keys_makes_no_neighbour(make):
    """Each end talks to an address of the relay, which hands all on: neither is where it says."""
    ends = (("10.0.0.1:47", "10.0.0.9:47"), ("10.0.7.2:47", "10.0.7.9:47"))
    a, b = await two(make, ends)
    await settle(3.0)
    for wire in (a, b):
        assert wire.sealer.counts["handshakes"] == 0
        assert wire.sealer.dropped["sealed: from another place"] > 0
    a.frame(VALVE)
    await settle()
    assert b.got == []
    near = (("10.0.0.1:47", "10.0.0.2:47"), ("10.0.0.2:47", "10.0.0.1:47"))
    a, b = await two(make, near)
    a.frame(VALVE)
    await settle()
    assert b.got == [(1, VALVE)]


@timed
async def test_a_number_that_does_not_exist_is_refused():
    a, _b = joined(network_sealer(1, nodes=4), network_sealer(7))
    await settle(3.0)
    assert a.sealer.counts["handshakes"] == 0
    assert a.sealer.dropped["sealed: from no node of ours"] > 0


@BOTH
@timed
async def test_two_nodes_with_one_number_are_told_of_by_both(make):
    said = {}
    a, b = Wire("a"), Wire("b")
    join(a, b)
    for wire in (a, b):
        begin(make(5), wire)
        wire.sealer.said = lambda _matter, text, wire=wire: said.setdefault(wire.name, text)
    await settle()
    for name in ("a", "b"):
        assert said[name].startswith("two nodes have our number, 5: it is on")
    assert a.sealer.counts["handshakes"] == 0


@BOTH
@timed
async def test_also_if_only_a_third_node_hears_both(make):
    said = {}
    one, two_, left, right = Wire("one"), Wire("two"), Wire("left"), Wire("right")
    join(one, left)
    join(two_, right)
    begin(make(5), one)
    begin(make(9), left, right)
    await settle()
    begin(make(5), two_)
    for wire in (one, two_, left):
        wire.sealer.said = lambda _matter, text, wire=wire: said.setdefault(wire.name, text)
    for _ in range(5):
        await settle(0.5)
        one.frame(b"I am five")
        two_.frame(b"I am five")
    await settle()
    assert said["left"].startswith("two nodes have one number, 5")
    for name in ("one", "two"):
        assert said[name] == (
            "two nodes have our number, 5: node 9 hears both; give one of them another"
        )


@BOTH
@timed
async def test_a_node_that_was_started_anew_is_no_second_one(make):
    a, b = await two(make)
    for _ in range(3):
        b = anew(make(2), a, b)
        await settle(2.0)
        a.frame(VALVE)
        b.frame(b"back")
        await settle()
        assert b.frames() == [VALVE]
    assert a.frames() == 3 * [b"back"]
    assert a.sealer.twins == b.sealer.twins == {}


@BOTH
@timed
async def test_a_node_that_was_started_anew_is_back_at_once(make):
    a, b = await two(make)
    b = anew(make(2), a, b)
    await settle(0.01)
    a.frame(VALVE)
    await settle(0.01)
    assert b.frames() == [VALVE]


@BOTH
@timed
async def test_keys_of_a_session_are_made_anew_and_nothing_is_lost(make):
    a, b = await two(make)
    count = 60
    for k in range(count):
        a.frame(bytes([k]))
        b.frame(bytes([k]))
        await settle(3 * REKEY_US / 1e6 / count)
    assert a.frames() == b.frames() == [bytes([k]) for k in range(count)]
    indices = {data[1:5] for data in a.said if data[0] == seal.FRAME}
    assert 2 <= len(indices) <= 4
    assert a.sealer.dropped == b.sealer.dropped == {}


@BOTH
@timed
async def test_a_contact_comes_about_over_a_link_that_loses_half(make):
    import random

    chance = random.Random(3)
    a, b = Wire(), Wire()
    join(a, b)
    a.change = b.change = lambda data: [data] * chance.choice((0, 0, 1, 2))
    begin(make(1), a)
    begin(make(2), b)
    for k in range(200):
        await settle(0.1)
        a.frame(bytes([k]))
    await settle(1.0)
    got = b.frames()
    assert len(got) == len(set(got))
    assert len(got) > 70


@BOTH
@timed
async def test_a_flood_of_first_messages_leaves_nothing_behind(make):
    """Also if they are genuine: recorded ones, played again and again."""
    a, b = await two(make)
    contact = b.sealer._contacts[0]
    recorded = []
    for _ in range(50):
        other = Wire()
        begin(make(3), other)
        await settle(0.01)
        recorded += other.said
        other.sealer.stop()
    for _ in range(20):
        for data in recorded:
            b.hear(data)
            await settle(SHUT_S / KNOCKS * (ANSWERED + 1))  # as fast as they are heard
    for _ in range(3):  # the same is answered as before, and costs no curve
        b.hear(recorded[-1])
    assert b.said[-1] == b.said[-2] == b.said[-3]
    assert len(contact._answered) <= 8
    assert len(contact._by_index) < 16
    a.frame(VALVE)
    await settle()
    assert b.frames() == [VALVE]


def test_status_says_so_in_capitals():
    async def main():
        node = Mesh(1, []).nodes[0]
        node.sealer = network_sealer(0)
        await node.start()
        quiet = live_status.lines(node.status())
        node.sealer.note_twin(5, "both are heard here")
        told = live_status.lines(node.status())
        await node.stop()
        return set(told) - set(quiet)

    assert "  TWO NODES HAVE NUMBER 5: both are heard here" in time_by_hand.run(main())
