"""Standbys that ask whether the gateway lives: how soon they lead, what they inherit, what not."""

import pytest

from innervate.networks.mesh.protocol.constants import (
    ALARM,
    CONTROL,
    CROSS,
    E2E_ACK,
    GRAPH,
    REPORT_GATEWAY,
    REPORT_ROUND,
    REQUEST,
    RESPONSE,
)
from innervate.networks.mesh.protocol.queue import WAITS
from tests.networks.mesh.net import Net, geometric, line, ring
from tests.networks.mesh.sim.test_alarms import OUT, fenced

GUARD = dict(standby=1, guard_us=200_000)
SURE = 25_000_000  # by then a standby has learned how soon it is answered
SOON = 3_000_000


def leaders(net):
    return [i for i, node in enumerate(net.nodes) if node.leading and i not in net.dead]


def guarded(count=12, standbys=(3, 7), links=(), **settings):
    net = Net(count, links or geometric(count, 5, 3), standbys=standbys, **{**GUARD, **settings})
    net.run(SURE)
    return net


def kill(net, who):
    net.kill(who)
    net.reports.clear()
    net.sent.clear()
    return net.now


@pytest.mark.parametrize("settings", [{}, {"mode": 1}, {"mode": 2}, {"mtu": 64}, {"failover": 2}])
def test_a_standby_leads_within_two_seconds_and_all_have_tables_within_three(settings):
    net = guarded(**settings)
    died = kill(net, 0)
    net.run(died + SOON)
    assert leaders(net) == [3]
    assert max(at for at, *_ in net.of(REPORT_GATEWAY)) - died < 1_600_000
    live = [node for i, node in enumerate(net.nodes) if i]
    assert {node.gateway for node in live} == {3}
    if settings != {"mode": 2}:
        assert {node.table_epoch for node in live} == {net.nodes[3].epoch}


def test_gateways_that_die_one_after_the_other_are_each_followed_within_three_seconds():
    net = guarded(standbys=(3, 7, 9))
    for gone, heir in ((0, 3), (3, 7), (7, 9)):
        died = kill(net, gone)
        net.run(died + SOON)
        assert leaders(net) == [heir]
        live = [i for i in range(12) if i not in net.dead]
        assert {net.nodes[i].table_epoch for i in live} == {net.nodes[heir].epoch}
        net.run(died + 12_000_000)


def test_who_takes_over_inherits_the_graph_but_for_the_dead_one():
    """Nobody is asked for links."""
    net = guarded(links=ring(6), count=6, standbys=(3,))
    died = kill(net, 0)
    net.run(died + SOON)
    assert not [f for _, _, f in net.sent if f.kind == RESPONSE]
    assert net.gates[3].links == 4


def test_the_second_standby_leads_where_the_first_is_dead_too():
    net = guarded()
    net.kill(3)
    died = kill(net, 0)
    net.run(died + 5_000_000)
    assert leaders(net) == [7]
    assert max(at for at, *_ in net.of(REPORT_GATEWAY)) - died < 2_500_000


def test_a_gateway_that_was_switched_on_anew_is_one_that_leads_no_more():
    net = guarded()
    kill(net, 0)
    net.revive(0)
    net.run(net.now + SOON)
    assert leaders(net) == [3]
    assert net.nodes[0].gateway == 3


def test_nobody_takes_over_from_a_gateway_that_lives():
    """One question in two waits, also where four frames in ten are lost."""
    net = Net(8, geometric(8, 4, 3), standbys=(7, 3), loss=0.4, seed=4, **GUARD)
    net.run(60_000_000)
    assert leaders(net) == [0]
    assert {i for _, i, *_ in net.of(REPORT_ROUND)} == {0}
    questions = {f.seq for _, i, f in net.sent if f.kind == GRAPH and f.origin == i == 7}
    assert 20 < len(questions) <= 150


@pytest.mark.parametrize("asks", [0, 1])
def test_a_gateway_that_collects_for_long_is_not_taken_for_dead(asks):
    """Until its first round is over it has no table; who did not respond is asked once more."""
    slow = dict(GUARD, collect_us=7_000_000, asks=asks, period=30, dead=75)
    net = Net(8, ring(8), standbys=(4,), **slow)
    net.lost = lambda frame, to: to == 0 and frame.kind == RESPONSE and frame.origin == 5
    net.run(SURE)
    assert leaders(net) == [0]
    assert {i for _, i, *_ in net.of(REPORT_ROUND)} == {0}


@pytest.mark.parametrize("asks", [0, 1])
def test_nor_is_who_took_over_without_tables(asks):
    slow = dict(GUARD, collect_us=7_000_000, asks=asks, period=30, dead=75)
    net = Net(8, ring(8), standbys=(4, 6), **slow)
    net.lost = lambda frame, to: to == 4 and frame.kind == RESPONSE and frame.origin == 5
    net.run(1_000_000)
    net.kill(0)
    net.run(60_000_000)
    assert leaders(net) == [4]
    assert {i for _, i, *_ in net.of(REPORT_ROUND)} == {0, 4}


def fill(net, who):
    """End-to-end acks take all places of a node's queue, and do not go for twelve seconds."""
    node = net.nodes[who]
    for i in range(node.places):
        node.q_state[i], node.q_rank[i], node.q_kind[i] = WAITS, CONTROL, E2E_ACK
        node.q_due[i] = net.now + 12_000_000


@pytest.mark.parametrize("full", [0, 1, 3])
def test_a_gateway_that_has_much_to_send_is_not_taken_for_dead(full):
    """Nor one whose standby has, or who is between them."""
    net = guarded(count=4, links=line(4), standbys=(3,))
    fill(net, full)
    net.run(net.now + 5_000_000)
    assert leaders(net) == [0]


def test_a_gateway_that_has_much_to_send_begins_its_rounds():
    net = guarded(count=4, links=line(4), standbys=(3,))
    net.sent.clear()
    fill(net, 0)
    net.run(net.now + 11_000_000)
    assert [f for _, i, f in net.sent if i == 0 and f.kind == REQUEST]


def test_where_answers_were_late_a_few_questions_in_vain_prove_nothing():
    net = guarded(count=4, links=[(0, 1), (1, 2), (2, 3)], standbys=(3,))
    assert net.nodes[3].tolerance == 0
    for silence in (700_000, 1_500_000, 2_200_000):
        since = net.now
        net.lost = lambda frame, to, until=since + silence: to == 3 and net.now < until
        net.run(since + 4_000_000)
        assert leaders(net) == [0], "it waits the longer"
    died = kill(net, 0)
    net.run(died + 3_500_000)
    assert leaders(net) == [3], "but not for ever"


def test_parts_that_hear_each_other_again_have_one_gateway_within_a_period():
    net = guarded(count=4, links=[(0, 1), (1, 2), (2, 3)], standbys=(3,))
    net.cut(1, 2)
    net.run(net.now + 12_000_000)
    assert leaders(net) == [0, 3]
    net.join(1, 2)
    net.run(net.now + 11_000_000)
    assert leaders(net) == [3]
    net.kill(3)
    net.run(net.now + 40_000_000)
    assert leaders(net) == [0], "who has stepped down stands by"


def test_an_alarm_for_the_dead_gateway_goes_to_the_new_one_at_once():
    net = fenced(6, ring(6), 2, standbys=(4,), **GUARD)
    net.run(SURE)
    died = kill(net, 0)
    net.sample(2, *OUT)
    net.run(died + SOON)
    led = max(at for at, i, *_ in net.of(REPORT_GATEWAY) if i == 2)
    came = [at for at, i, f in net.delivered if i == 4 and f.kind == ALARM and f.body[3] == CROSS]
    assert came
    assert came[0] - led < 100_000
