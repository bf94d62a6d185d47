"""The fence over a mesh: who raises what when, floods, acknowledgements, silence afterwards."""

import pytest

from innervate.networks.mesh.protocol.constants import (
    ALARM,
    CLEAR,
    CROSS,
    FLOOD,
    LOST,
    POSITION,
    REPORT_ALARM,
    REPORT_ARRIVED,
)
from tests.networks.mesh.net import Net, line, ring

READY = 4_000_000
SQUARE = dict(
    points=4,
    px=[0, 1000, 1000, 0] + [0] * 44,
    py=[0, 0, 1000, 1000] + [0] * 44,
    after=[1, 2, 3, 0] + [0] * 44,
)
INSIDE, OUT = (500, 500), (500, -50)


def fenced(count, links, robot, **settings):
    net = Net(count, links, robots=(robot,), **{**SQUARE, **settings})
    net.run(READY)
    net.sample(robot, *INSIDE)
    net.run(READY + 1_500_000)
    net.sent.clear()
    return net


def alarms(net, kind=CROSS):
    return [(at, i, f) for at, i, f in net.delivered if f.kind == ALARM and f.body[3] == kind]


def raised(net):
    return [(i, kind) for _, i, code, kind, _ in net.reports if code == REPORT_ALARM]


def floods(net, i):
    return {f.ttl for _, who, f in net.sent if who == i and f.kind == ALARM and f.flags & FLOOD}


def test_a_crossing_is_flooded_at_once_and_told_once():
    net = fenced(4, line(4), 3)
    crossed = net.now
    net.sample(3, *OUT)
    net.run(crossed + 5_000_000)
    ((at, who, frame),) = alarms(net)
    assert who == 0
    assert at - crossed < 100_000
    assert frame.body[0] == 3
    assert floods(net, 3) == {1}, "acknowledged: no other instance"
    assert [row for row in net.of(REPORT_ARRIVED) if row[1] == 3]
    assert raised(net) == [(3, CROSS)], "outside, acknowledged: nobody else raises it again"


def test_the_first_frame_of_a_crossing_is_the_flood():
    """So that a dead next hop, three transmissions, does not hold it up."""
    net = fenced(4, line(4), 3)
    net.kill(2)
    net.sample(3, *OUT)
    net.run(net.now + 100_000)
    own = [f for _, i, f in net.sent if i == 3 and f.kind == ALARM]
    assert own[0].flags & FLOOD
    assert not own[1].flags & FLOOD


def test_a_flood_ends_where_others_passed_it_on_or_the_monitor_has_it():
    """Twelve nodes that all hear each other, but the robot the monitor: two of each would be 22."""
    links = [(a, b) for a in range(12) for b in range(a) if (a, b) != (11, 0)]
    for seed in range(5):
        net = fenced(12, links, 11, seed=seed)
        net.sample(11, *OUT)
        net.run(net.now + 200_000)
        assert len(alarms(net)) == 1
        copies = [i for _, i, f in net.sent if f.kind == ALARM and f.flags & FLOOD]
        assert len(copies) <= 11, "fewer than one of each"


def test_a_flood_passes_the_only_node_that_leads_on():
    """0 - 1 - three others - the robot: 1 hears all copies of the three, and sends its own."""
    links = [(0, 1), (1, 2), (1, 3), (1, 4), (2, 3), (2, 4), (3, 4), (2, 5), (3, 5), (4, 5)]
    for seed in range(10):
        net = fenced(6, links, 5, seed=seed)
        net.lost = lambda frame, to: frame.kind == ALARM and not frame.flags & FLOOD
        crossed = net.now
        net.sample(5, *OUT)
        net.run(crossed + 100_000)
        assert len(alarms(net)) == 1, seed


def test_three_instances_and_then_it_is_raised_anew():
    net = fenced(3, line(3), 2)
    net.kill(1)
    net.sample(2, *OUT)
    net.run(net.now + 1_400_000)
    assert floods(net, 2) == {1, 2, 3}
    net.run(net.now + 3_000_000)
    assert raised(net).count((2, CROSS)) >= 2, "nobody knows: it insists"
    positions = [f for _, i, f in net.sent if i == 2 and f.kind == POSITION]
    assert all(f.body[7] & 2 == 0 for f in positions), "nobody has acknowledged anything"
    net.revive(1)
    net.run(net.now + 20_000_000)
    assert alarms(net)
    count = len(raised(net))
    net.run(net.now + 10_000_000)
    assert len(raised(net)) == count


def test_a_robot_that_crossed_before_it_knew_a_gateway_is_not_forgotten():
    net = Net(2, line(2), robots=(1,), **SQUARE)
    net.kill(0)
    net.queue = [event for event in net.queue if event[2][0] == "timer"]
    net.run(1_000_000)
    net.sample(1, *INSIDE)
    net.sample(1, *OUT)
    net.run(3_000_000)
    assert not raised(net)
    net.start(0)
    net.run(8_000_000)
    assert len(alarms(net)) == 1


def test_a_witness_raises_it_for_a_robot_that_cannot():
    """1 hears 2, 2 hears nobody: its own alarm is never acknowledged."""
    net = fenced(3, line(3), 2)
    net.neighbours[1].discard(2)
    net.params.instances = 0
    net.params.flood = 0
    net.lost = lambda frame, to: frame.kind == ALARM and frame.link_src == 2
    net.sample(2, *OUT)
    net.run(net.now + 3_500_000)
    assert (1, CROSS) in raised(net)
    ((_, who, frame),) = alarms(net)[:1]
    assert (who, frame.origin, frame.body[0]) == (0, 1, 2)
    assert raised(net).count((1, CROSS)) == 1


def test_a_robot_that_falls_silent_is_lost_and_found_again():
    net = fenced(2, line(2), 1)
    net.cut(0, 1)
    net.run(net.now + 3_000_000)
    assert not alarms(net, LOST)
    net.run(net.now + 2_000_000)
    assert len(alarms(net, LOST)) == 1
    net.join(0, 1)
    net.run(net.now + 2_000_000)
    assert len(alarms(net, CLEAR)) == 1


def test_many_robots_lost_at_once_fit_the_outbox():
    robots = tuple(range(1, 20))
    net = Net(20, [(0, k) for k in robots], robots=robots, **SQUARE)
    net.run(READY)
    for k in robots:
        net.sample(k, *INSIDE)
    net.run(READY + 2_000_000)
    for k in robots:
        net.kill(k)
    net.run(net.now + 12_000_000)
    assert {f.body[0] for _, _, f in alarms(net, LOST)} == set(robots)


def test_back_inside_it_is_cleared():
    net = fenced(3, line(3), 2)
    net.sample(2, *OUT)
    net.run(net.now + 500_000)
    net.sample(2, 500, 10)
    net.run(net.now + 500_000)
    assert not alarms(net, CLEAR), "less than 0.2 m"
    net.sample(2, 500, 30)
    net.run(net.now + 1_500_000)
    assert len(alarms(net, CLEAR)) == 1


@pytest.mark.parametrize("watch", [0, 1])
def test_the_alarm_of_a_robot_that_had_been_switched_off_counts(watch):
    """Its numbers begin anew, its positions to the monitor use some up: it is no duplicate."""
    net = fenced(3, line(3), 2, watch=watch)
    net.nodes[2].seq = 20_000
    net.send(2, 0)
    net.run(net.now + 300_000)
    net.kill(2)
    net.revive(2)
    net.nodes[2].seq = 5_000
    net.run(net.now + 12_000_000)
    net.sample(2, *INSIDE)
    net.run(net.now + 3_000_000)
    net.sample(2, *OUT)
    net.run(net.now + 300_000)
    assert len(alarms(net)) == 1


def test_losses_do_not_stop_an_alarm():
    for seed in range(6):
        net = fenced(6, ring(6), 3, seed=seed)
        net.loss = 0.3
        net.sample(3, *OUT)
        net.run(net.now + 3_000_000)
        assert alarms(net), seed
