"""Retransmission: no message is tried when its recipient could not tell it any more."""

from itertools import pairwise

from innervate.networks.mesh.protocol import constants as c
from innervate.networks.mesh.protocol import queue as mesh_queue
from innervate.networks.mesh.protocol.retransmission import AHEAD_MAX
from tests.networks.mesh.net import Net, line

READY = 4_000_000
STAR = [(0, 1), (0, 2)]


def codes(net, who, code):
    return [(a, b) for _, i, found, a, b in net.reports if i == who and found == code]


def heard(net, who):
    return [bytes(f.body[: f.length]) for _, i, f in net.delivered if i == who and f.kind == c.DATA]


def test_a_slow_round_trip_does_not_stretch_the_tries_beyond_what_the_recipient_remembers():
    net = Net(3, line(3), e2e_adapt=1, e2e_us=30_000)
    net.run(READY)
    net.nodes[0].round_trip = 10_000_000
    net.kill(2)
    net.send(0, 2)
    memory_us = net.params.forget * net.params.tick_us
    net.run(READY + memory_us)
    assert len(codes(net, 0, c.REPORT_EXPIRED)) == 1
    last = max(at for at, who, frame in net.sent if who == 0 and frame.kind == c.DATA)
    assert last - READY < memory_us


def test_retried_messages_teach_a_longer_round_trip_but_step_by_step():
    net = Net(3, line(3), e2e_adapt=1, e2e_us=30_000)
    net.run(READY)
    net.send(0, 2)
    net.run(READY + 100_000)
    short = net.nodes[0].round_trip
    assert 0 < short < 10_000
    net.lost = lambda frame, to: frame.kind == c.E2E_ACK and net.now < READY + 800_000
    net.send(0, 2)
    net.run(READY + 2_000_000)
    assert len(codes(net, 0, c.REPORT_ARRIVED)) == 2
    assert short < net.nodes[0].round_trip <= (7 * short + 2 * net.params.e2e_us) // 8


def test_no_packet_goes_so_far_ahead_that_an_older_one_could_not_come_any_more():
    net = Net(3, STAR)
    net.run(READY)
    for to in (1, 2):
        net.send(0, to, b"first")
    net.run(READY + 200_000)
    net.neighbours[0].discard(1)
    net.send(0, 1, b"late", handle=7)
    for k in range(AHEAD_MAX):
        net.send(0, 2, b"%d" % k)
        net.run(net.now + 10_000)
    assert heard(net, 2)[1:] == [b"%d" % k for k in range(AHEAD_MAX)]
    net.send(0, 1, b"ahead", handle=9)
    assert codes(net, 0, c.REPORT_FULL) == [(9, c.NO_ROOM)]
    net.neighbours[0].add(1)
    net.run(net.now + 10_000_000)
    assert 7 in [handle for handle, _ in codes(net, 0, c.REPORT_ARRIVED)]
    net.send(0, 1, b"ahead", handle=9)
    net.run(net.now + 200_000)
    assert heard(net, 1) == [b"first", b"late", b"ahead"]


def test_acks_do_not_shut_out_a_message_that_is_still_tried():
    net = Net(2, [(0, 1)])
    net.run(READY)
    net.send(0, 1, b"first")
    net.run(READY + 200_000)
    net.lost = lambda frame, to: frame.kind == c.DATA and frame.origin == 0
    net.send(0, 1, b"late")
    for k in range(2 * AHEAD_MAX):
        net.send(1, 0, b"%d" % k)
        net.run(net.now + 10_000)
    assert len(heard(net, 0)) == 2 * AHEAD_MAX
    net.lost = lambda frame, to: False
    net.run(net.now + 10_000_000)
    assert heard(net, 1) == [b"first", b"late"]


def forget(net, who, seq):
    """A node loses a packet that it has acknowledged, as if it had been restarted."""
    node = net.nodes[who]
    for i, found in enumerate(node.q_seq):
        if found == seq and node.q_state[i]:
            mesh_queue.drop(node, net.params, i)


def test_acks_of_others_do_not_use_up_the_tries_of_one_that_is_lost_on_its_way():
    net = Net(3, line(3), e2e_adapt=1, e2e_us=30_000)
    net.run(READY)
    net.send(0, 2, b"late", handle=7)
    late = net.nodes[0].seq
    net.lost = lambda frame, to: to == 2 and frame.seq == late and net.now < READY + 100_000
    for k in range(40):
        net.send(0, 2, b"%d" % k)
        until = net.now + 10_000
        while net.now < until:
            net.run(net.now + 500)
            if k < 10:
                forget(net, 1, late)  # before its hop's ack is missed
    assert 7 in [handle for handle, _ in codes(net, 0, c.REPORT_ARRIVED)]
    assert heard(net, 2).count(b"late") == 1
    tries = [at for at, who, frame in net.sent if who == 0 and frame.seq == late]
    assert all(b - a > net.params.e2e_us // 2 for a, b in pairwise(tries))


def test_an_ack_for_an_earlier_life_does_not_say_that_a_recipient_knows_this_one():
    net = Net(2, line(2))
    net.run(READY)
    net.lost = lambda frame, to: frame.kind == c.E2E_ACK
    net.send(0, 1, b"old")
    net.run(READY + 100_000)
    (old,) = [frame.seq for _, i, frame in net.delivered if i == 1 and frame.kind == c.DATA]
    late = next(frame for _, _, frame in net.sent if frame.kind == c.E2E_ACK)
    net.revive(0)
    net.nodes[0].seq = (old - 5_000) & 65_535  # it lost its numbers, and drew others
    net.push(net.now, ("frame", 0, late))
    net.run(2 * READY)
    net.lost = lambda frame, to: False
    net.send(0, 1, b"new")
    net.run(2 * READY + 1_000_000)
    assert heard(net, 1) == [b"old", b"new"]
