"""A hop that has a packet may say so late: its frame is not sent to it, or anybody else, again."""

import pytest

from innervate.dialect.arith import MASK30
from innervate.networks.mesh.protocol import node as mesh
from innervate.networks.mesh.protocol.constants import (
    ACK,
    ACK_WANTED,
    DATA,
    E2E_ACK,
    PARITY,
    REPORT_HOP,
    REPORT_SUSPECT,
)
from innervate.networks.mesh.protocol.link_quality import UNIT
from innervate.networks.mesh.protocol.queue import DOWN, FREE, UNACKED, WAITS
from tests.networks.mesh.bench import Bench, Frame

SETTLED_US = 12_000_000


def settled(count, links, **settings):
    """Nodes that have their tables; the layer below tells when a frame has left."""
    bench = Bench(count, links, told=1, **settings)
    bench.run(SETTLED_US)
    bench.sent.clear()
    return bench


def messages(bench, node):
    """What a node has sent of messages: to whom."""
    return [frame.link_dst for _, i, frame in bench.sent if i == node and frame.kind == DATA]


def in_state(bench, node, state, tries):
    """Run until a message is in that state of the node's queue, tried so often; its place."""
    one = bench.nodes[node]
    for _ in range(200):
        for i in range(one.places):
            if (one.q_state[i], one.q_kind[i], one.q_tries[i]) == (state, DATA, tries):
                return i
        bench.run(bench.now + 100)
    raise AssertionError("it never was")


def hear(bench, node, frame):
    """The node hears that frame now."""
    now = bench.now & MASK30
    mesh.on_frame(bench.nodes[node], None, bench.params, now, 0, frame, bench.out)
    bench.drain(node)


def copied(bench, place, **changed):
    """The frame in that place of node 0's queue, as somebody else would have it."""
    node, frame = bench.nodes[0], Frame()
    frame.kind, frame.flags, frame.seq = DATA, node.q_flags[place], node.q_seq[place]
    frame.origin, frame.dest, frame.ttl = 0, node.q_dest[place], 40
    frame.length, frame.rssi = 0, -60
    for name, value in changed.items():
        setattr(frame, name, value)
    return frame


def ack(bench, place):
    return copied(bench, place, kind=ACK, link_src=1, link_dst=0)


def passed_on(bench, place):
    frame = copied(bench, place, link_src=1, link_dst=2, path_len=2)
    frame.path[:2] = [0, 1]
    return frame


def end_ack(bench, place):
    frame = copied(bench, place, kind=E2E_ACK, origin=2, dest=0, link_src=1, link_dst=2, flags=0)
    frame.path_len, frame.path[0], frame.length = 1, 2, 2
    frame.body[:2] = [frame.seq >> 8, frame.seq & 255]
    return frame


@pytest.mark.parametrize("tries", [1, 2])
@pytest.mark.parametrize("says", [ack, passed_on, end_ack])
def test_a_frame_that_waits_for_its_backoff_goes_out_for_the_last_time(says, tries):
    bench = settled(3, [(0, 1), (1, 2)])
    bench.lost = lambda frame, to: to == 0  # no ack comes
    bench.send(0, 2, flags=0)
    place = in_state(bench, 0, DOWN, tries)
    hear(bench, 0, says(bench, place))
    bench.run(bench.now + 1_000_000)
    assert messages(bench, 0) == [1] * (tries + 1), "no third try, and nobody else"
    assert (bench.nodes[0].q_state[place], bench.nodes[0].busy) == (FREE, -1)
    assert bench.of(REPORT_SUSPECT) == []


def test_its_owner_is_told_once_that_its_hop_has_it():
    bench = settled(3, [(0, 1), (1, 2)])
    bench.lost = lambda frame, to: to == 0
    bench.send(0, 2, handle=7)
    place = in_state(bench, 0, DOWN, 1)
    for says in (passed_on, ack):
        hear(bench, 0, says(bench, place))
    assert [row[3] for row in bench.of(REPORT_HOP)] == [7]


def bodies(bench):
    """What node 0 has sent of messages."""
    return [bytes(f.body[: f.length]) for _, i, f in bench.sent if i == 0 and f.kind == DATA]


@pytest.mark.parametrize(("tries", "eased"), [(0, 0), (1, UNIT)])
def test_an_end_to_end_ack_eases_once_what_was_sent_in_vain(tries, eased):
    bench = settled(3, [(0, 1), (1, 2)])
    bench.lost = lambda frame, to: to == 0
    bench.send(0, 2, flags=0)
    place = in_state(bench, 0, DOWN, tries)
    end = end_ack(bench, place)
    before = bench.nodes[0].strain = 5 * UNIT
    for _ in range(2):
        hear(bench, 0, end)
    assert before - bench.nodes[0].strain == eased


def test_the_next_frame_goes_out_after_one_that_was_answered_late():
    bench = settled(3, [(0, 1), (1, 2)])
    bench.lost = lambda frame, to: to == 0
    bench.send(0, 2, b"first", flags=0)
    place = in_state(bench, 0, DOWN, 1)
    bench.send(0, 2, b"second", flags=0)
    hear(bench, 0, ack(bench, place))
    assert bodies(bench) == [b"first"] * 2, "one frame at a time is handed down"
    bench.run(bench.now + 1_500)
    assert bodies(bench) == [b"first", b"first", b"second"]


def test_what_its_recipient_has_is_not_sent_at_all():
    bench = settled(3, [(0, 1), (1, 2)])
    bench.nodes[0].busy = 7  # something else is under way
    bench.send(0, 2, flags=0)
    place = in_state(bench, 0, WAITS, 0)
    hear(bench, 0, end_ack(bench, place))
    bench.nodes[0].busy = -1
    bench.run(bench.now + 1_000_000)
    assert messages(bench, 0) == []


def test_an_ack_is_for_the_frame_that_was_sent_not_for_another_try_that_waits():
    bench = settled(3, [(0, 1), (1, 2)])
    bench.lost = lambda frame, to: to == 0
    bench.send(0, 2)
    place = in_state(bench, 0, UNACKED, 1)
    node, behind = bench.nodes[0], place + 1
    for name in ("q_link_dst", "q_origin", "q_seq", "q_kind", "q_flags", "q_state", "q_tries"):
        getattr(node, name)[behind] = getattr(node, name)[place]
    node.busy = behind
    node.q_flags[place] ^= PARITY  # another try of the same message, and it stands before it
    node.q_state[place] = WAITS
    hear(bench, 0, ack(bench, place))
    assert node.q_state[behind] == FREE
    assert node.q_state[place] != FREE


def test_a_giver_that_repeats_itself_has_not_taken_its_packet_back():
    bench = settled(3, [(0, 1)])  # nobody hears node 2
    bench.lost = lambda frame, to: to == 0
    bench.send(0, 2, flags=0)
    in_state(bench, 1, UNACKED, 1)  # node 1 knows nobody else, and gives it back
    again = copied(bench, in_state(bench, 0, DOWN, 1), link_src=0, link_dst=1, path_len=1)
    assert again.flags & ACK_WANTED
    given = len(messages(bench, 1))
    hear(bench, 1, again)
    bench.run(bench.now + 100_000)
    assert len(messages(bench, 1)) > given, "it is given back once more"
