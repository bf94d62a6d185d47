"""A takeover under load: the channel is the tables', nobody looks for who is gone."""

import pytest

import innervate
from innervate.networks.mesh.protocol.constants import (
    ALL,
    DATA,
    DETOURED,
    LOUDEST,
    PRIORITY,
    RANDOM,
    REPORT_GATEWAY,
    REPORT_TABLE,
    TABLE,
)
from innervate.networks.mesh.protocol.hop import HUSHED
from innervate.networks.mesh.protocol.route import planned
from innervate.networks.mesh.protocol.standby import EVERYWHERE, PATIENCE_MAX
from tests.networks.mesh.bench import Frame
from tests.networks.mesh.net import Net, line
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


def taken_over(net):
    """The same, of nodes that have followed another gateway before, which is in none of it."""
    for node in net.nodes[1:]:
        node.gateway = 9
    return net


def test_a_table_goes_round_a_hop_that_fails():
    """Node 1 is next on the table's route to 3, and does not reach it: 2 does."""
    net = taken_over(Net(4, DIAMOND))
    net.lost = lambda frame, to: frame.kind == TABLE and frame.link_src == 1 and to == 3
    net.run(3_000_000)
    had = [at for at, i, *_ in net.of(REPORT_TABLE) if i == 3]
    sent = [(at, f.seq) for at, i, f in net.sent if f.kind == TABLE and f.dest == 3 and i == 0]
    assert len({seq for _, seq in sent}) == 1, "its gateway need not send it again"
    assert had[0] - sent[0][0] < net.params.job_us


def test_a_table_goes_round_once():
    """Whoever is cut off is not looked for with a long frame everywhere."""
    assert ways_of_first(taken_over(Net(4, DIAMOND))) == {(0, 1), (1, 3), (1, 2), (2, 3)}


def test_and_not_at_all_in_a_round_of_the_gateway_that_was_there():
    """It sends tables to the dead as well, and each was looked for."""
    assert ways_of_first(Net(4, DIAMOND)) == {(0, 1), (1, 3)}


def ways_of_first(net):
    """The hops that the first table for node 3 is sent over, whom none reaches."""
    net.lost = lambda frame, to: frame.kind == TABLE and to == 3
    net.run(3_000_000)
    sent = [(i, f) for _, i, f in net.sent if f.kind == TABLE and f.dest == 3]
    return {(i, f.link_dst) for i, f in sent if f.seq == sent[0][1].seq}


def test_who_follows_a_new_gateway_begins_no_messages_while_it_hands_out_tables():
    net = guarded(count=4, links=line(4), standbys=(1,))
    died = kill(net, 0)
    net.run(died + 1_600_000)
    assert net.nodes[3].due == HUSHED
    since = led(net)[3]
    net.send(3, 1)
    net.send(3, 1, flags=2 | PRIORITY)
    net.run(died + 5_000_000)
    began = [(at, f.flags & PRIORITY) for at, i, f in net.sent if i == 3 and f.kind == DATA]
    assert began[0] == (died + 1_600_000, PRIORITY), "what is urgent does not wait"
    own = next(at for at, urgent in began if not urgent)
    longest = net.params.collect_us + net.params.spread_us
    assert net.params.collect_us <= own - since <= longest + 1000
    assert len([f for _, i, f in net.delivered if i == 1 and f.kind == DATA]) == 2


def test_others_messages_are_passed_on_meanwhile():
    net = guarded(count=4, links=line(4), standbys=(1,))
    died = kill(net, 0)
    net.run(died + 1_600_000)
    assert net.nodes[2].due == HUSHED
    net.send(1, 3)
    net.run(net.now + 10_000)
    assert [f for _, i, f in net.delivered if i == 3 and f.kind == DATA]


def test_a_standby_that_waited_leads_with_messages_of_its_own():
    net = guarded(count=4, links=line(4), standbys=(1, 2))
    died = kill(net, 0)
    net.run(died + 1_500_000)
    assert net.nodes[2].due == HUSHED
    net.kill(1)
    net.run(net.now + 6_000_000)
    assert leaders(net) == [2]
    net.send(2, 3)
    net.run(net.now + 10_000)
    assert [f for _, i, f in net.delivered if i == 3 and f.kind == DATA]


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


def test_until_the_next_round_or_until_it_is_heard():
    net = guarded(standbys=(3,))
    died = kill(net, 0)
    net.run(died + 14_000_000)
    assert {net.nodes[i].gone for i in range(1, 12)} == {ALL}


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


def impatient(net, path_len, flags=DETOURED):
    """How patient a standby is that hears a packet for the gateway, after so many nodes."""
    frame = Frame()
    frame.kind, frame.flags, frame.link_src, frame.link_dst = DATA, flags, 1, 2
    frame.origin, frame.dest, frame.path_len = 2, 0, path_len
    frame.path[:path_len] = [1] * path_len
    net.nodes[3].patience, net.nodes[3].silent = PATIENCE_MAX, 2
    net.push(net.now, ("frame", 3, frame))
    net.run(net.now + 1)
    return net.nodes[3].patience


def test_a_standby_whose_gateway_is_looked_for_everywhere_has_no_patience():
    net = guarded(count=5, links=line(5), standbys=(3,))
    assert impatient(net, EVERYWHERE - 1) == PATIENCE_MAX
    assert impatient(net, EVERYWHERE, flags=0) == PATIENCE_MAX, "a long way is no search"
    assert impatient(net, EVERYWHERE) == 0
    died = kill(net, 0)
    impatient(net, EVERYWHERE)
    net.run(died + 1_000_000)
    assert leaders(net) == [3]
