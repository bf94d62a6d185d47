"""Who knows no way floods its message, which finds its recipient; the ack comes back on the way."""

import copy

import pytest

from innervate.networks.mesh.protocol.constants import (
    ALL,
    ALTERNATE,
    CONTROL,
    DATA,
    E2E_ACK,
    END_TO_END,
    FLOOD,
    LOUDEST,
    NOBODY,
    ORDERED,
    PARITY,
    RANDOM,
    REQUEST,
    TABLE,
    TABLE_FREE,
    WHOLE_GRAPH,
)
from innervate.networks.mesh.protocol.fields import FORWARDED
from innervate.networks.mesh.protocol.neighbours import SUSPECT, place_of
from innervate.networks.mesh.protocol.queue import enqueue
from innervate.networks.mesh.protocol.route import planned
from tests.networks.mesh.net import Net, line, ring

# 3 - 2 - 1 - 0 - 5, with a dead end at every node of the way.
COMB = [(0, 1), (1, 2), (2, 3), (0, 5), (3, 4), (2, 6), (1, 7), (0, 8)]
SPAN_US = 200_000


def silent(links, **settings):
    """A mesh of which no request is heard: no round, no uplinks, no tables."""
    bench = Net(1 + max(max(pair) for pair in links), links, **{"on_demand": 1, **settings})
    bench.lost = lambda frame, to: frame.kind == REQUEST
    return bench


def sent(bench, kind):
    """Who sent a kind of packet to whom, in order of time."""
    return [(i, f.link_dst) for _, i, f in bench.sent if f.kind == kind]


LIVE = {"queue": 48, "kept": 32, "hop_frames": 16, "gather": 1, "ack_adapt": 1, "e2e_adapt": 1}


@pytest.mark.parametrize("settings", [
    {}, {"told": 1}, {"mode": WHOLE_GRAPH}, LIVE, {"failover": ALTERNATE},
    {"failover": RANDOM, "retry": 0},
])  # fmt: skip
def test_a_message_without_a_way_is_flooded_and_its_ack_comes_back_by_the_trace(settings):
    bench = silent(COMB, **settings)
    bench.send(3, 5)
    bench.run(SPAN_US)
    assert [(i, bytes(f.body[: f.length])) for _, i, f in bench.delivered] == [(5, b"hello")]
    floods = sent(bench, DATA)
    assert {to for _, to in floods} == {ALL}
    assert sorted(i for i, _ in floods) == [0, 1, 2, 3, 4, 6, 7, 8], "each once, and 5 has it"
    assert not any(f.flags & FLOOD for _, _, f in bench.sent if f.kind == DATA)
    assert sent(bench, E2E_ACK) == [(5, 0), (0, 1), (1, 2), (2, 3)]


def test_all_on_the_way_know_both_ends_and_all_others_the_origin():
    bench = silent(COMB)
    bench.send(3, 5)
    bench.run(SPAN_US)
    to_3 = [planned(node, bench.params, 3) for node in bench.nodes]
    assert to_3 == [1, 2, 3, NOBODY, 3, 0, 2, 1, 0]
    assert [planned(bench.nodes[i], bench.params, 5) for i in (3, 2, 1, 0)] == [2, 1, 0, 5]
    bench.sent.clear()
    bench.send(3, 5)
    bench.send(6, 3)
    bench.run(2 * SPAN_US)
    assert sorted(sent(bench, DATA)) == sorted([(3, 2), (2, 1), (1, 0), (0, 5), (6, 2), (2, 3)])


def test_by_itself_nobody_floods_and_nobody_passes_on():
    assert not flooded(silent(COMB, on_demand=0)).delivered, "nobody has heard of anybody"
    bench = silent(COMB)
    bench.params.on_demand = 1
    bench.send(3, 5)
    bench.params.on_demand = 0
    bench.run(SPAN_US)
    assert sent(bench, DATA) == [(3, ALL)]


def flooded(bench):
    bench.send(3, 5)
    bench.run(SPAN_US)
    return bench


@pytest.mark.parametrize(("flags", "reliable"), [(0, 0), (END_TO_END, 0), (ORDERED | 2, 1)])
def test_what_no_ack_comes_back_for_is_not_flooded(flags, reliable):
    """Nor what is in order: its flag has another meaning in what is flooded."""
    params = {"reliable": 1} if reliable else {}
    bench = silent(COMB, **{"reliable": 0, **params})
    bench.send(3, 5, b"\0\0hello", flags=0 if not reliable else flags)
    bench.run(10_000)
    assert ALL not in {to for _, to in sent(bench, DATA)}


def test_a_neighbour_and_a_gateway_that_is_known_are_not_looked_for():
    bench = Net(9, COMB, on_demand=1)
    bench.lost = lambda frame, to: frame.kind == TABLE
    bench.run(3_000_000)
    bench.sent.clear()
    bench.send(3, 2)
    bench.send(3, 0)
    bench.run(3_000_000 + SPAN_US)
    assert not bench.nodes[3].version
    assert sent(bench, DATA) == [(3, 2), (3, 2), (2, 1), (1, 0)]


def test_a_recipient_that_is_gone_is_flooded_for_twice_and_no_more():
    bench = silent(ring(8))
    bench.kill(4)
    bench.send(0, 4)
    bench.run(20_000_000)
    floods = [
        (i, f.flags & PARITY) for _, i, f in bench.sent if f.kind == DATA if f.link_dst == ALL
    ]
    assert len(floods) == len(set(floods)) == 2 * 7
    assert sum(code == 4 for _, _, code, _, _ in bench.reports) == 1, "and then it has expired"


def test_a_retry_floods_anew_where_the_first_was_lost():
    bench = silent(line(4))
    lost = []
    bench.lost = lambda frame, to: (
        frame.kind == REQUEST
        or (frame.kind == DATA and to == 3 and not lost and not lost.append(to))
    )
    bench.send(0, 3)
    bench.run(3_000_000)
    assert lost == [3]
    assert [i for _, i, _ in bench.delivered] == [3]
    assert [i for i, _ in sent(bench, DATA)] == [0, 1, 2, 0, 1, 2]


def test_a_link_that_is_heard_too_faintly_teaches_no_way():
    faint = {(0, 2): -94, (2, 0): -94}
    bench = silent([(0, 1), (1, 2), (0, 2), (2, 3)], rssi=faint)
    bench.send(0, 3)
    bench.run(SPAN_US)
    assert planned(bench.nodes[2], bench.params, 0) == 1


@pytest.mark.parametrize(("others", "passed_on"), [(1, 1), (2, 0)])
def test_who_has_others_frames_to_send_does_not_pass_a_flood_on(others, passed_on):
    """It would be late, and those who passed it on may have forgotten it and do so again."""
    bench = silent(line(4))
    node = bench.nodes[2]
    for _ in range(others):
        enqueue(node, 1_000_000, 2, 0, bench.out)
    bench.send(1, 3)
    bench.run(1_001)
    assert sum(bool(state) for state in node.q_state) == others + passed_on


def test_a_flood_goes_on_at_any_moment_and_before_messages():
    bench = silent([(0, k) for k in range(1, 8)] + [(k, 8) for k in range(1, 8)])
    bench.send(0, 8)
    bench.run(1_001)
    first = [node.q_order.index(max(node.q_order)) for node in bench.nodes[1:8]]
    due = [node.q_due[i] - 1_000 for node, i in zip(bench.nodes[1:8], first, strict=True)]
    assert len(set(due)) == 7
    assert 0 <= min(due) < max(due) <= bench.params.flood_us
    assert {node.q_rank[i] for node, i in zip(bench.nodes[1:8], first, strict=True)} == {CONTROL}


@pytest.mark.parametrize(("on_demand", "left"), [(1, NOBODY), (0, 1)])
def test_a_way_that_fails_is_forgotten(on_demand, left):
    """What comes next is flooded, and does not wait until the neighbour is trusted again."""
    bench = silent(line(4))
    bench.send(0, 3)
    bench.run(SPAN_US)
    assert planned(bench.nodes[0], bench.params, 3) == 1
    bench.params.on_demand = on_demand
    bench.kill(1)
    bench.send(0, 3)
    bench.run(2 * SPAN_US)
    assert planned(bench.nodes[0], bench.params, 3) == left


@pytest.mark.parametrize("failover", [RANDOM, LOUDEST])
@pytest.mark.parametrize("retry", [0, 1])
def test_nobody_else_takes_the_place_of_a_way_that_was_found(failover, retry):
    """The document's rules rewrite tables: who is taken at random knows no way either."""
    bench = silent(ring(8), failover=failover, retry=retry)
    bench.send(0, 3)
    bench.run(SPAN_US)
    bench.kill(1)
    bench.send(0, 3)
    bench.run(1_000_000)
    assert [i for _, i, _ in bench.delivered] == [3, 3]
    assert planned(bench.nodes[0], bench.params, 3) == 7


@pytest.mark.parametrize("failover", [RANDOM, LOUDEST])
def test_by_the_documents_rules_a_neighbour_is_looked_for_too(failover):
    """They ask tables alone, and there is none that says that it is near."""
    bench = Net(9, COMB, on_demand=1, failover=failover)
    bench.lost = lambda frame, to: frame.kind == TABLE
    bench.run(3_000_000)
    assert planned(bench.nodes[3], bench.params, 2) == NOBODY
    bench.send(3, 2)
    bench.run(bench.now + SPAN_US)
    assert [i for _, i, _ in bench.delivered] == [2]


def test_nobody_looks_for_a_gateway_that_is_gone():
    bench = silent(ring(8))
    bench.nodes[0].gone = 4
    bench.send(0, 4)
    bench.run(10_000_000)
    assert sent(bench, DATA) == []


def test_who_has_a_table_that_leaves_the_recipient_out_does_not_flood():
    bench = Net(9, COMB, on_demand=1)
    bench.run(5_000_000)
    bench.sent.clear()
    node = bench.nodes[3]
    node.next[node.bank * bench.params.width + 5] = NOBODY
    bench.send(3, 5)
    bench.run(bench.now + SPAN_US)
    assert node.version
    assert ALL not in {to for _, to in sent(bench, DATA)}


def test_where_there_are_many_ways_each_passes_it_on_once():
    bench = silent([(a, b) for a in range(6) for b in range(a) if (a, b) != (5, 0)])
    bench.send(0, 5)
    bench.run(SPAN_US)
    assert sorted(sent(bench, DATA)) == [(i, ALL) for i in range(5)]
    assert len(sent(bench, E2E_ACK)) == 2


def test_after_two_floods_the_message_is_looked_for_as_ever():
    """Who passed a flood on takes the same packet over when it comes to it alone."""
    bench, lost = silent(line(3)), []
    bench.lost = lambda frame, to: (
        frame.kind == REQUEST
        or (frame.kind == DATA and frame.link_dst == ALL and to == 2 and not lost.append(to))
    )
    bench.send(2, 1)
    bench.run(SPAN_US)
    bench.delivered.clear()
    bench.send(0, 2)
    bench.run(10_000_000)
    assert len(lost) == 2
    assert [hop for hop in sent(bench, DATA) if hop[1] != ALL] == [(0, 1), (1, 2)]
    assert [i for _, i, _ in bench.delivered] == [2]


def test_without_tables_the_way_that_was_found_is_taken_and_then_the_one_up():
    bench = Net(9, COMB, mode=TABLE_FREE, on_demand=1)
    bench.run(5_000_000)
    bench.sent.clear()
    for _ in range(2):
        bench.send(6, 4)
        bench.run(bench.now + SPAN_US)
    assert len(bench.delivered) == 2
    ways = [(i, f.link_dst) for _, i, f in bench.sent if f.kind == DATA]
    assert ways[0] == (6, ALL)
    assert ways[-3:] == [(6, 2), (2, 3), (3, 4)], "and not by the gateway"


def test_without_tables_a_way_that_is_suspect_is_not_taken():
    bench = Net(9, COMB, mode=TABLE_FREE, on_demand=1)
    bench.run(5_000_000)
    node = bench.nodes[1]
    node.next[4] = 7
    node.suspect[place_of(node, bench.params, 7)] = SUSPECT
    bench.sent.clear()
    bench.send(1, 4)
    bench.run(bench.now + SPAN_US)
    assert sent(bench, DATA)[0] == (1, 0), "up, to the gateway"


def test_the_gateway_writes_ways_and_does_not_look_for_them():
    bench = Net(9, COMB, mode=TABLE_FREE, on_demand=1)
    bench.run(5_000_000)
    bench.sent.clear()
    bench.nodes[0].next[4] = NOBODY
    bench.send(0, 4)
    bench.run(bench.now + SPAN_US)
    assert sent(bench, DATA) == [(0, 1), (1, 2), (2, 3), (3, 4)]


def test_a_flood_that_was_forgotten_and_comes_again_is_delivered_once():
    bench = silent(line(3))
    bench.send(0, 2)
    bench.run(SPAN_US)
    (flood,) = [f for _, i, f in bench.sent if f.kind == DATA and i == 1]
    for k in range(FORWARDED):
        bench.nodes[2].done_origin[k] = ALL
    bench.push(bench.now, ("frame", 2, bench.heard(1, 2, flood)))
    bench.run(2 * SPAN_US)
    assert [i for _, i, _ in bench.delivered] == [2]


def test_whoever_passes_a_flood_on_stands_in_its_path_and_lets_it_live_one_hop_less():
    bench = silent(line(4))
    bench.send(0, 3)
    bench.run(SPAN_US)
    floods = [f for _, _, f in bench.sent if f.kind == DATA]
    assert [f.ttl - floods[0].ttl for f in floods] == [0, -1, -2]
    assert [list(f.path[: f.path_len]) for f in floods] == [[0], [0, 1], [0, 1, 2]]


class Mixed(Net):
    """A mesh of which only some flood."""

    flooding = frozenset()

    def params_of(self, i):
        if i in self.flooding:
            return self.params
        plain = copy.copy(self.params)
        plain.on_demand = 0
        return plain


@pytest.mark.parametrize(("flooding", "floods", "searched"), [
    ({0, 1, 2, 3}, [0, 1, 2], False), ({0, 2}, [0, 0], True), ({1, 2}, [], True),
])  # fmt: skip
def test_where_only_some_flood_a_message_costs_two_tries_and_comes_once(flooding, floods, searched):
    """Others let a flood pass; then it is looked for as ever."""
    mixed = Mixed(4, line(4), on_demand=1)
    mixed.flooding = flooding
    mixed.run(100_000)  # a round is under way, and nobody has tables
    mixed.send(0, 3)
    mixed.run(10_000_000)
    assert [i for _, i, f in mixed.delivered if f.kind == DATA] == [3]
    hops = sent(mixed, DATA)
    assert [i for i, to in hops if to == ALL] == floods
    assert any(to != ALL for _, to in hops) == searched
