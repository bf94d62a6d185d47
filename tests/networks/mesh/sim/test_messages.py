"""Messages over a mesh: receipts, retries end to end, at most one delivery, nothing for ever."""

import random
from collections import Counter

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from innervate.networks.mesh.protocol.constants import (
    DATA,
    FIRST,
    PARITY,
    REPORT_ACCEPTED,
    REPORT_ARRIVED,
    REPORT_DROPPED,
    REPORT_EXPIRED,
    REPORT_FULL,
    REPORT_HOP,
)
from tests.networks.mesh.net import Net, geometric, line, reach, ring

RECEIPTS = (REPORT_ACCEPTED, REPORT_HOP, REPORT_ARRIVED, REPORT_EXPIRED, REPORT_FULL)
READY = 4_000_000


def receipts(net, i):
    return [code for _, who, code, *_ in net.reports if who == i and code in RECEIPTS]


def data(net, dest):
    return [frame for _, who, frame in net.delivered if who == dest and frame.kind == DATA]


def sent_by(net, i, kind=DATA):
    return [frame for _, who, frame in net.sent if who == i and frame.kind == kind]


@pytest.mark.parametrize("told", [0, 1])
def test_receipts_come_in_order(told):
    net = Net(4, line(4), told=told)
    net.run(READY)
    net.send(3, 0, b"a")
    net.run(READY + 500_000)
    assert receipts(net, 3) == [REPORT_ACCEPTED, REPORT_HOP, REPORT_ARRIVED]
    (frame,) = data(net, 0)
    assert bytes(frame.body[: frame.length]) == b"a"
    assert frame.path[: frame.path_len] == [3, 2, 1]


def test_a_message_to_a_dead_node_expires_after_retries_of_alternate_parity():
    net = Net(3, line(3))
    net.run(READY)
    net.kill(2)
    net.send(0, 2)
    net.run(READY + 9_000_000)
    assert receipts(net, 0) == [REPORT_ACCEPTED, REPORT_HOP, REPORT_EXPIRED]
    tries = []
    for frame in sent_by(net, 0):
        if frame.dest == 2 and frame.flags & PARITY not in tries[-1:]:
            tries.append(frame.flags & PARITY)
    assert tries == [0, PARITY] * 3
    assert not net.queued()


def test_the_only_copy_dies_with_its_holder_and_is_sent_again():
    """1 and 3 lead from 0 to 2: 1 acknowledges and dies; the retry goes by 3, delivered once."""
    net = Net(4, ring(4))
    net.run(READY)
    net.send(0, 2)
    net.run(READY + 1400)
    holder = net.sent[-1][1] if net.sent[-1][1] in (1, 3) else sent_by(net, 0)[-1].link_dst
    net.kill(holder)
    net.run(READY + 1_000_000)
    assert len(data(net, 2)) == 1
    assert receipts(net, 0)[-1] == REPORT_ARRIVED


def test_first_is_said_until_something_was_acknowledged():
    net = Net(2, line(2))
    net.run(READY)
    for k in range(3):
        net.send(1, 0, b"%d" % k)
        net.run(READY + (k + 1) * 100_000)
    assert [frame.flags & FIRST for frame in sent_by(net, 1)] == [FIRST, 0, 0]


@pytest.mark.parametrize("seq", [3, 40_000])
def test_who_starts_anew_is_heard_at_once_even_if_its_first_packets_are_lost(seq):
    """Whether its new numbers lie before or behind its old ones."""
    net = Net(2, line(2), e2e_tries=0)
    net.run(READY)
    net.nodes[1].seq = 20_000
    net.send(1, 0, b"before")
    net.run(READY + 100_000)
    net.kill(1)
    net.revive(1)
    net.nodes[1].seq = seq
    net.run(READY + 12_000_000)
    net.loss = 1.0
    net.send(1, 0, b"lost")
    net.run(net.now + 500_000)
    net.loss = 0.0
    net.send(1, 0, b"after")
    net.run(net.now + 500_000)
    assert [bytes(f.body[: f.length]) for f in data(net, 0)] == [b"before", b"after"]


def test_the_ninth_message_that_waits_is_refused_and_none_blocks_the_others():
    net = Net(2, line(2))
    net.run(READY)
    net.kill(0)
    for k in range(9):
        net.send(1, 0, handle=k)
    assert receipts(net, 1).count(REPORT_FULL) >= 1
    net.run(READY + 90_000_000)
    assert receipts(net, 1).count(REPORT_EXPIRED) == receipts(net, 1).count(REPORT_ACCEPTED)
    assert not net.queued()


@pytest.mark.parametrize("failover", [0, 1, 2, 3])
def test_no_packet_stays_for_ever_where_all_neighbours_are_dead(failover):
    """The document's random failover would ask dead neighbours in turn for ever."""
    net = Net(6, [(0, k) for k in range(1, 5)] + [(k, 5) for k in range(1, 5)], failover=failover)
    net.run(READY)
    for k in (1, 2, 3, 4):
        net.kill(k)
    net.send(0, 5, flags=0)
    net.run(READY + 4_000_000)
    assert not net.queued()
    assert [row for row in net.of(REPORT_DROPPED) if row[1] == 0]


def test_a_packet_that_comes_back_stays_one_when_acks_are_lost():
    """0-1-2-3 with 1-4-3: 2 cannot go on and gives back; our ack to it is lost twice."""
    net = Net(5, [(0, 1), (1, 2), (2, 3), (1, 4), (4, 3)])
    net.run(READY)
    net.cut(2, 3)
    lost = []

    def lose(frame, to):
        if frame.kind == 16 and frame.link_src == 1 and to == 2 and len(lost) < 2:
            lost.append(frame.seq)
            return True
        return False

    net.lost = lose
    net.send(0, 3, flags=0)
    net.run(READY + 1_000_000)
    assert len(lost) == 2
    assert len({(t, f.seq) for t, i, f in net.sent if i == 1 and f.link_dst == 4 and f.kind == 8}) \
        == 1  # fmt: skip
    assert len(data(net, 3)) == 1


@settings(max_examples=8, deadline=None)
@given(
    st.integers(0, 10**6),
    st.sampled_from([0.0, 0.1, 0.3]),
    st.sampled_from([(0, 3), (0, 3), (0, 0), (1, 3), (2, 3)]),
    st.sampled_from([0, 1]),
)
def test_at_most_one_delivery_and_nothing_for_ever(seed, loss, reading, told):
    """Whatever is lost, acks too, and whoever dies and starts anew without its memory."""
    chance = random.Random(seed)
    count = chance.choice([4, 6, 8])
    mode, failover = reading
    links = geometric(count, min(4, count - 1), seed)
    net = Net(count, links, mode=mode, failover=failover, told=told, loss=loss, seed=seed,
              thorough=False)  # fmt: skip
    started = {i: [] for i in range(count)}
    net.run(READY)
    for k in range(20):
        i = chance.randrange(count)
        if net.dead and chance.random() < 0.3:
            started[min(net.dead)].append(net.now)
            net.revive(min(net.dead))
        elif i not in net.dead and chance.random() < 0.15:
            net.kill(i)
        elif i not in net.dead:
            dest = chance.choice([chance.randrange(count), 254])
            net.send(i, dest, b"%d" % k, handle=k, flags=chance.choice([0, 2, 2, 34]))
        net.run(net.now + chance.choice([1000, 20_000, 300_000]))
    net.loss = 0.0
    for i in sorted(net.dead):
        started[i].append(net.now)
        net.revive(i)
    net.run(net.now + 90_000_000)
    for _ in range(40):
        if not net.queued():
            break
        net.run(net.now + 50_000)
    assert not net.queued()
    # Who starts anew without its memory may take once more what is still being retried.
    texts = Counter(
        (bytes(f.body[: f.length]), i, sum(at <= time for at in started[i]))
        for time, i, f in net.delivered
        if f.kind == DATA
    )
    assert max(texts.values(), default=0) <= 1, texts


def test_for_the_monitor_is_not_for_all_while_no_gateway_is_known():
    net = Net(3, line(3))
    net.run(READY)
    for i in (0, 1):
        net.kill(i)
    net.revive(1)
    net.send(1, 254)
    net.run(READY + 1_000_000)
    assert receipts(net, 1) == [REPORT_FULL]
    assert not data(net, 2)


@pytest.fixture(scope="module", params=[0, 1], ids=["search", "graph"])
def nets(request):
    """Nets with tables: N = 30, mean degree 8, perfect links."""
    found = []
    for seed in range(3):
        links = geometric(30, 8, seed)
        net = Net(30, links, mode=request.param, seed=seed, thorough=False)
        net.run(8_000_000)
        assert all(node.version for node in net.nodes)
        found.append((net, links))
    return found


@pytest.mark.parametrize("deaths", range(1, 9))
@pytest.mark.few(6)
def test_what_is_connected_is_delivered_around_the_dead(nets, deaths):
    """Unknown to all, before the packet is sent."""
    runs = 0
    for seed, (net, links) in enumerate(nets):
        for k in range(3):
            chance = random.Random(100 * seed + 10 * deaths + k)
            source, dest = chance.sample(range(1, 30), 2)
            dead = chance.sample(sorted(set(range(1, 30)) - {source, dest}), deaths)
            if dest not in reach(links, source, set(dead)):
                continue
            runs += 1
            other = net.fork(k)
            for i in dead:
                other.kill(i)
            other.send(source, dest)
            other.run(other.now + 1_500_000)
            assert len(data(other, dest)) == 1, (seed, source, dest, sorted(dead))
    assert runs > 3
