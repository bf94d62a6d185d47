"""The gateway: tables and graphs that arrive, standbys, who comes back, the table-free mode."""

import itertools

import pytest

from innervate.networks.mesh.analysis import network
from innervate.networks.mesh.protocol.constants import (
    DATA,
    GRAPH,
    REPORT_ARRIVED,
    REPORT_GATEWAY,
    REPORT_TABLE,
    REPORT_TABLES,
    SOURCE_ROUTE,
    TABLE,
)
from innervate.networks.mesh.sim.simulate import simulate
from innervate.scenario import loads, plan
from tests.networks.mesh.net import Net, geometric, line, ring


def leaders(net):
    return [i for i, node in enumerate(net.nodes) if node.leading and i not in net.dead]


def without(net):
    return [i for i, node in enumerate(net.nodes) if not node.version and i not in net.dead]


@pytest.mark.parametrize("mtu", [64, 127])
@pytest.mark.parametrize("mode", [0, 1])
def test_everybody_gets_its_table_over_lossy_links(mode, mtu):
    """Fragments are lost and sent again; those that are there are not."""
    net = Net(12, geometric(12, 5, 3), mode=mode, mtu=mtu, loss=0.2, seed=2)
    net.run(35_000_000)
    assert not without(net)
    parts = [f for _, _, f in net.sent if f.kind == (GRAPH if mode else TABLE)]
    assert all(11 + f.path_len + f.length + 2 <= mtu for f in parts)


def test_tables_of_more_parts_than_the_queue_has_room_for_go_on():
    """Once they waited for an ack that nobody owed: two such tables at once held up all others."""
    net = Net(30, geometric(30, 5, 3), mtu=44, queue=6)
    net.run(5_000_000)
    assert not without(net)
    assert max(part_count(f) for _, _, f in net.sent if f.kind == TABLE) > net.params.queue - 3


@pytest.mark.slow
@pytest.mark.parametrize(("nodes", "within_s"), [(50, 200), (120, 1200)])
def test_everybody_gets_its_table_at_38k4(nodes, within_s):
    for seed in range(1, 6):
        made = plan(loads(
            f'kind="mesh"\nnodes={nodes}\nduration_s={within_s}\nseed={seed}\n'
            'radio.profile="38k4"\nradio.mean_degree=8'
        ))  # fmt: skip
        ran = simulate(made, checks=False)
        found = network.discovery(ran, network.acked_kinds(ran.sent))
        assert found["with_tables"] == nodes, f"seed {seed}: {found}"
        assert found["recall"] >= 0.95, f"seed {seed}"


def part_count(frame):
    """Of how many a table's part is one: behind the route, the epoch and the version."""
    return frame.body[frame.body[0] + 4] & 15


@pytest.mark.parametrize("mode", [0, 1])
def test_who_was_switched_off_gets_its_table_again(mode):
    """It acknowledged the same one before; the graph may not have changed at all."""
    net = Net(6, ring(6), mode=mode)
    net.run(12_000_000)
    assert not without(net)
    net.kill(3)
    net.run(12_200_000)
    net.revive(3)
    net.run(80_000_000)
    assert not without(net)
    net.kill(3)
    net.run(200_000_000)
    net.revive(3)
    net.run(330_000_000)
    assert not without(net)


def test_a_gateway_that_was_switched_off_is_followed_again():
    """Without standby: its rounds count from the beginning, and nobody may take them for old."""
    net = Net(4, line(4))
    net.run(60_000_000)
    old = net.nodes[3].table_epoch, net.nodes[3].version
    net.kill(0)
    net.cut(2, 3)
    net.join(1, 3)
    net.run(70_000_000)
    net.revive(0)
    net.run(110_000_000)
    assert leaders(net) == [0]
    assert {node.epoch for node in net.nodes} == {net.nodes[0].epoch}
    assert (net.nodes[3].table_epoch, net.nodes[3].version) != old
    net.send(3, 0)
    net.run(110_100_000)
    assert net.delivered[-1][2].path[:2] == [3, 1]


def test_and_soon_where_it_need_not_wait_for_a_standby():
    net = Net(4, line(4), dead=8)
    net.run(60_000_000)
    net.kill(0)
    net.run(61_000_000)
    net.revive(0)
    net.run(72_000_000)
    assert leaders(net) == [0]
    assert {node.epoch for node in net.nodes} == {net.nodes[0].epoch}
    assert not without(net)


def test_activation_puts_new_tables_into_force_when_all_have_theirs():
    net = Net(5, line(5), activation=1)
    net.run(8_000_000)
    done = min(at for at, *_ in net.of(REPORT_TABLES))
    in_force = [at for at, i, *_ in net.of(REPORT_TABLE) if i]
    assert len(in_force) == 4
    assert min(in_force) >= done


def test_who_missed_the_activation_learns_it_from_the_next_request():
    net = Net(3, line(3), activation=1)
    net.lost = lambda frame, to: frame.kind == 5
    net.run(9_000_000)
    assert without(net) == [1, 2]
    net.run(14_000_000)
    assert not without(net)


def test_a_standby_leads_when_the_gateway_is_dead_and_makes_tables():
    net = Net(5, ring(5), standbys=(2, 4), standby=1)
    net.run(12_000_000)
    net.kill(0)
    net.run(12_000_000 + 32_000_000)
    assert leaders(net) == [2]
    net.run(net.now + 4_000_000)
    live = [node for i, node in enumerate(net.nodes) if i]
    assert {node.gateway for node in live} == {2}
    assert {node.table_epoch for node in live} == {net.nodes[2].epoch}
    net.revive(0)
    net.run(net.now + 60_000_000)
    assert leaders(net) == [2], "who comes back listens, and follows"
    assert net.nodes[0].gateway == 2
    assert not without(net)


def test_two_gateways_end_as_one():
    """Cut in two, each half has one; joined again, the newer epoch wins, then the lower id."""
    net = Net(4, line(4), standbys=(3,), standby=1)
    net.run(8_000_000)
    net.cut(1, 2)
    net.run(60_000_000)
    assert leaders(net) == [0, 3]
    net.join(1, 2)
    net.run(90_000_000)
    assert leaders(net) == [3]
    assert {node.gateway for node in net.nodes} == {3}


@pytest.mark.parametrize("epochs", [(7, 7), (255, 0), (3, 131), (131, 3), (0, 255)])
def test_epochs_go_around_and_always_order(epochs):
    net = Net(2, [], standbys=(1,), standby=1)
    net.run(40_000_000)
    assert leaders(net) == [0, 1]
    for node, epoch in zip(net.nodes, epochs, strict=True):
        node.epoch = epoch
    net.join(0, 1)
    net.run(80_000_000)
    ahead = (epochs[1] - epochs[0]) % 256
    assert leaders(net) == [1 if 0 < ahead < 128 else 0]


def test_gateways_are_reported_when_they_change_and_only_then():
    net = Net(3, line(3))
    net.run(50_000_000)
    assert sorted(i for _, i, *_ in net.of(REPORT_GATEWAY)) == [0, 1, 2]


def test_rounds_come_a_period_after_each_other_and_thin_out():
    net = Net(2, line(2))
    net.run(200_000_000)
    rounds = [at // 1_000_000 for at, i, code, *_ in net.reports if code == 8]
    steps = [b - a for a, b in itertools.pairwise(rounds)]
    assert steps[0] in (9, 10), "begins between two ticks"
    assert steps[1:4] == [20, 40, 60], "the first finds links, the others no news"


def test_without_tables_the_gateway_writes_the_way_down():
    net = Net(6, line(6), mode=2)
    net.run(20_000_000)
    net.send(5, 2)
    net.send(0, 4)
    net.run(20_500_000)
    got = {(i, f.origin) for _, i, f in net.delivered if f.kind == DATA}
    assert got == {(2, 5), (4, 0)}
    assert any(f.flags & SOURCE_ROUTE for _, i, f in net.sent if i == 0 and f.kind == DATA)


def test_without_tables_a_failure_comes_back_and_another_way_is_written():
    """0-1-3 and 0-2-3: the way over 1 is cut, 1 is alive."""
    net = Net(5, [(0, 1), (0, 2), (1, 3), (2, 3), (3, 4)], mode=2)
    net.run(20_000_000)
    way = []
    for dead in (1, 2):
        other = net.fork(dead)
        other.kill(dead)
        other.send(0, 4)
        other.run(20_600_000)
        got = [f for _, i, f in other.delivered if i == 4]
        assert len(got) == 1, dead
        assert bytes(got[0].body[: got[0].length]) == b"hello"
        assert [row for row in other.of(REPORT_ARRIVED)]
        way.append(got[0].path[1])
    assert way == [2, 1]
