"""Several frames under way to each neighbour, and what came handled before something goes."""

from collections import Counter

import pytest

from innervate.networks.mesh.protocol.constants import ACK, DATA, E2E_ACK
from tests.networks.mesh.net import Net, geometric, line

LIVE = dict(hop_frames=16, gather=1, queue=32, kept=32, ack_adapt=1, e2e_adapt=1, e2e_us=30_000)


def settled(count, links, **settings):
    """A net whose nodes have their tables, and know that their neighbours answer."""
    net = Net(count, links, **{**LIVE, **settings})
    net.run(12_000_000)
    return net


def heard(net, who):
    return Counter(frame for i, frame in delivered(net) if i == who)


def delivered(net):
    return [(i, bytes(frame.body[: frame.length])) for _, i, frame in net.delivered]


def frames(net, kind):
    return [frame for _, _, frame in net.sent if frame.kind == kind]


def four_sent():
    """Two nodes, of which one has just sent four messages to the other."""
    net = settled(2, line(2))
    net.sent.clear()
    for k in range(4):
        net.send(0, 1, b"%d" % k)
    return net


def test_frames_to_one_neighbour_do_not_wait_for_each_other():
    net = four_sent()
    net.run(net.now + 100)
    assert len(frames(net, DATA)) == 4


def test_a_dead_neighbour_holds_up_nothing_to_another():
    net = settled(3, [(0, 1), (0, 2)])
    net.kill(1)
    net.sent.clear()
    for k in range(4):
        net.send(0, 1, b"dead")
        net.send(0, 2, b"%d" % k)
    net.run(net.now + 2_500)  # before the first ack is overdue
    assert heard(net, 2) == {b"%d" % k: 1 for k in range(4)}


def test_acks_of_what_came_together_go_together():
    net = four_sent()
    net.run(net.now + 20_000)
    acks = [frame for _, i, frame in net.sent if i == 1 and frame.kind == ACK]
    ends = [frame for _, i, frame in net.sent if i == 1 and frame.kind == E2E_ACK]
    assert [len(acks), acks[0].length] == [1, 9]  # three more of three bytes
    assert [len(ends), ends[0].length] == [1, 8]
    assert net.queued() == {}


@pytest.mark.parametrize("seed", range(6))
def test_what_is_lost_is_sent_again_and_comes_once(seed):
    net = settled(12, geometric(12, 5, seed), loss=0.15, seed=seed)
    for k in range(60):
        net.send(k % 4, 11 - k % 5, b"%d" % k)
        net.run(net.now + 3_000)
    net.run(net.now + 30_000_000)
    came = Counter(text for _, text in delivered(net))
    assert came == {b"%d" % k: 1 for k in range(60)}
    assert net.queued() == {}


@pytest.mark.parametrize("seed", range(6))
def test_with_a_node_dead_on_the_way_the_rest_goes_round(seed):
    links = geometric(12, 5, seed)
    net = settled(12, links, seed=seed)
    for k in range(80):
        if k == 20:
            net.kill(5)
        to = (k % 3) + 8
        net.send(k % 3, to, b"%d" % k)
        net.run(net.now + 3_000)
    net.run(net.now + 30_000_000)
    came = Counter(text for _, text in delivered(net))
    assert set(came.values()) == {1}
    ends = Counter(code for _, _, code, _, _ in net.reports if code in (3, 4))
    assert ends[3] + ends[4] == 80
    assert ends[3] <= len(came)
