"""A takeover: tables stay, nobody looks for who is gone, and it costs little."""

import numpy as np
import pytest

import innervate
from innervate import scenario
from innervate.networks.mesh.analysis.network import CONTROL, acked_kinds, airtime_us
from innervate.networks.mesh.protocol.constants import (
    ALL,
    DATA,
    GRAPH,
    LOUDEST,
    NOBODY,
    RANDOM,
    REPORT_GATEWAY,
    RESPONSE,
    TABLE,
)
from innervate.networks.mesh.protocol.route import planned
from innervate.networks.mesh.protocol.standby import IN_VAIN, SPARE_HOPS, TOLERANCE_MAX
from innervate.networks.mesh.sim.simulate import simulate
from tests.networks.mesh.net import Net, geometric, line, ring
from tests.networks.mesh.sim.test_standby import GUARD, SOON, SURE, guarded, kill, leaders

DIAMOND = [(0, 1), (0, 2), (1, 2), (1, 3), (2, 3)]
LOADED = """
kind = "mesh"
nodes = 30
gateway = 0
standby = [1]
duration_s = 24.0
[[flow]]
from = "all"
to = "monitor"
every_s = 1.0
jitter_s = 1.0
[[event]]
at_s = 17.5
action = "kill"
node = "gateway"
"""


@pytest.mark.parametrize("seed", [3, 5, 9])
def test_with_thirty_messages_a_second_all_have_new_tables_within_three_seconds(seed, tmp_path):
    path = tmp_path / "loaded.toml"
    path.write_text(LOADED)
    assert innervate.run(path, seed=seed).summary["takeover_s"] < 3


@pytest.mark.parametrize("seed", [3, 5, 9])
def test_a_takeover_takes_less_than_five_percent_of_airtime(seed):
    """In the five seconds after the death; it took 13 to 14."""
    plan = scenario.plan(scenario.loads(LOADED.replace("nodes", f"seed = {seed}\nnodes", 1)))
    result = simulate(plan)
    died = plan.faults[0].at_us
    since = result.sent["time"] - died
    counts = np.isin(acked_kinds(result.sent), CONTROL) & (since >= 0) & (since < 5_000_000)
    assert airtime_us(result.sent)[counts].sum() < 0.05 * 5_000_000


def led(net):
    """When nodes began to follow the new gateway."""
    return {i: at for at, i, *_ in net.of(REPORT_GATEWAY)}


@pytest.mark.parametrize("failover", [RANDOM, LOUDEST])
def test_a_table_that_is_lost_rewrites_no_next_hop(failover):
    """By the document's rule the failure of a packet does."""
    net = Net(4, DIAMOND, failover=failover)
    net.lost = lambda frame, to: frame.kind == TABLE and frame.link_src in (1, 2) and to == 3
    net.run(6_000_000)
    assert any(f.kind == TABLE and f.link_dst == 3 for _, _, f in net.sent)
    found = [planned(net.nodes[i], net.params, 3) for i in (1, 2)]
    assert found == [3, 3]


def test_nobody_looks_for_who_does_not_get_its_table():
    """Its gateway sends tables to the dead as well."""
    net = Net(4, DIAMOND)
    net.lost = lambda frame, to: frame.kind == TABLE and to == 3
    net.run(3_000_000)
    sent = [(i, f) for _, i, f in net.sent if f.kind == TABLE and f.dest == 3]
    assert {(i, f.link_dst) for i, f in sent if f.seq == sent[0][1].seq} == {(0, 1), (1, 3)}


def tables(net):
    """Who was sent tables."""
    return {f.dest for _, _, f in net.sent if f.kind == TABLE}


def ways(net):
    """Next hops of all that live, but to the first gateway."""
    return [[planned(node, net.params, to) for to in range(1, 12)] for node in net.nodes[1:]]


def test_all_keep_their_tables_as_those_of_who_takes_over_until_its_next_round():
    net = guarded()
    before = ways(net)
    died = kill(net, 0)
    net.run(died + SOON)
    heir = net.nodes[3]
    assert {(n.version, n.table_epoch) for n in net.nodes[1:]} == {(heir.version, heir.epoch)}
    assert ways(net) == before
    assert {planned(node, net.params, 0) for node in net.nodes[1:]} == {NOBODY}
    assert not tables(net)
    assert not [f for _, _, f in net.sent if f.kind == RESPONSE]
    net.run(died + 14_000_000)
    assert tables(net) == set(range(1, 12)) - {3}
    assert {n.version for n in net.nodes[1:]} == {net.gates[3].version}


@pytest.mark.parametrize("how", ["switched on again", "of another epoch"])
def test_who_has_no_table_to_keep_says_so_and_gets_one(how):
    """The second was away while a standby took over before."""
    net = guarded()
    if how == "switched on again":
        net.revive(8)
        net.run(net.now + 100_000)
    else:
        net.nodes[8].table_epoch -= 1
    died = kill(net, 0)
    net.run(died + SOON)
    assert tables(net) == {8}
    assert {f.origin for _, _, f in net.sent if f.kind == RESPONSE} == {8}
    assert net.nodes[8].version == net.nodes[3].version
    assert net.nodes[8].table_epoch == net.nodes[3].epoch


def test_ways_over_the_dead_gateway_are_not_tried():
    net = guarded(links=ring(6), count=6, standbys=(3,))
    died = kill(net, 0)
    net.run(died + 1_600_000)
    assert planned(net.nodes[1], net.params, 5) == 0
    net.send(1, 5)
    net.run(net.now + 10_000)
    assert [f.path_len for _, i, f in net.delivered if i == 5 and f.kind == DATA] == [4]
    assert not [f for _, _, f in net.sent if f.link_dst == 0 and f.kind == DATA]


def test_who_follows_a_new_gateway_begins_messages_at_once():
    net = guarded(count=4, links=line(4), standbys=(1,))
    died = kill(net, 0)
    net.run(died + 1_600_000)
    net.send(3, 1)
    net.run(net.now + 10_000)
    assert [f for _, i, f in net.delivered if i == 1 and f.kind == DATA]


def test_a_question_is_not_looked_for_everywhere():
    """A dead gateway was, by each of four questions, over 24 nodes."""
    net = guarded(count=20, links=geometric(20, 6, 2), standbys=(3,))
    most = net.nodes[3].depth + SPARE_HOPS
    kill(net, 0)
    net.run(net.now + 900_000)
    asked = [(f.seq, i, f.path_len) for _, i, f in net.sent if f.kind == GRAPH and f.origin == 3]
    assert len({seq for seq, *_ in asked}) >= IN_VAIN
    assert max(long for *_, long in asked) <= most


def test_nor_is_that_of_a_patient_standby_which_leads_within_three_and_a_half_seconds():
    """It waited a second and more between questions, up to 15 s in all."""
    net = guarded(count=20, links=geometric(20, 6, 2), standbys=(3,))
    most = net.nodes[3].depth + SPARE_HOPS
    net.nodes[3].tolerance = TOLERANCE_MAX
    died = kill(net, 0)
    net.run(died + 3_500_000)
    assert leaders(net) == [3]
    assert max(f.path_len for _, _, f in net.sent if f.kind == GRAPH and f.origin == 3) <= most


def test_where_not_all_have_had_tables_nobody_keeps_one():
    """The gateway dies while it hands out its first."""
    net = Net(12, geometric(12, 5, 3), standbys=(3,), **GUARD)
    net.lost = lambda frame, to: frame.kind == TABLE and frame.dest > 7
    net.run(2_000_000)
    net.lose_by_chance()
    assert 0 < sum(node.version > 0 for node in net.nodes[1:]) < 11
    died = kill(net, 0)
    net.run(died + 8_000_000)
    assert leaders(net) == [3]
    assert {f.origin for _, _, f in net.sent if f.kind == RESPONSE} == set(range(1, 12)) - {3}
    assert {node.table_epoch for node in net.nodes[1:]} == {net.nodes[3].epoch}


def test_nobody_looks_for_the_gateway_that_is_gone():
    net = guarded(standbys=(3,))
    died = kill(net, 0)
    for node in range(5, 12):
        net.send(node, 0)
    net.run(died + SOON)
    follows = max(led(net).values())
    late = [at for at, _, f in net.sent if f.kind == DATA and f.dest == 0 and at > follows + 20_000]
    assert not late
    assert {net.nodes[i].gone for i in range(1, 12)} == {0}


def test_until_the_round_after_the_next_for_messages_kept_are_tried_so_long():
    net = guarded(standbys=(3,))
    died = kill(net, 0)
    net.run(died + 14_000_000)
    assert {net.nodes[i].gone for i in range(1, 12)} == {0}
    net.run(died + 24_000_000)
    assert {net.nodes[i].gone for i in range(1, 12) if i != 3} == {ALL}


def test_or_until_a_table_leads_to_it():
    """Node 9 is too far away to hear it, which was switched off and on."""
    net = guarded(count=10, links=line(10), standbys=(3,))
    died = kill(net, 0)
    net.run(died + 2_000_000)
    net.revive(0)
    net.run(died + 10_500_000)
    assert net.nodes[9].gone == 0
    net.run(died + 14_000_000)
    assert [net.nodes[i].gone for i in range(1, 10)] == [ALL] * 9
    assert planned(net.nodes[9], net.params, 0) == 8


def test_who_missed_the_gateway_between_passes_by_nobody_where_the_first_leads_again():
    """Of its request a node that followed it before keeps its table, too."""
    net = guarded(count=4, links=line(4), standbys=(3,))
    node = net.nodes[1]
    node.epoch, node.table_epoch = node.epoch - 2, node.table_epoch - 2
    net.gates[0].taken = 1
    net.run(net.now + 10_000_000)
    assert node.gone == ALL
    assert node.gateway == 0


def test_a_gateway_that_lives_is_not_gone_for_long():
    """The standby that took over by mistake answers it: it does not take over again."""
    net = Net(4, line(4), standbys=(3,), **GUARD)
    net.run(SURE)
    since = net.now
    net.lost = lambda frame, to: to == 3 and net.now < since + 2_000_000
    net.run(since + 2_000_000)
    assert leaders(net) == [3]
    net.send(2, 0)
    net.run(since + 20_000_000)
    assert leaders(net) == [3]
    assert [f for _, i, f in net.delivered if i == 0 and f.kind == DATA and f.origin == 2]
