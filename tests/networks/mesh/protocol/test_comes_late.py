"""Who switches on between two rounds asks for the round, joins it and has its table at once."""

import pytest

from innervate.networks.mesh.protocol.constants import (
    ALL,
    REPORT_GATEWAY,
    REPORT_ROUND,
    REQUEST,
    TABLE_FREE,
    TABLES,
    WHOLE_GRAPH,
)
from tests.networks.mesh.bench import Bench

S = 1_000_000
CALM = 40 * S  # rounds are 20 s apart and more by then
RING = [(k, (k + 1) % 6) for k in range(6)]


def calm(**more):
    """A ring of six whose tables are there; the next round is far."""
    bench = Bench(6, RING, **more)
    bench.run(CALM)
    assert [node.known for node in bench.nodes] == [1] * 6
    assert bench.gates[0].wait > 10
    return bench


def questions(bench, since=0):
    return [
        (at, i) for at, i, f in bench.sent if f.kind == REQUEST and f.body[0] == ALL and at > since
    ]


def rounds(bench, since):
    return [at for at, _, code, *_ in bench.reports if code == REPORT_ROUND and at > since]


@pytest.mark.parametrize("mode", [TABLES, WHOLE_GRAPH])
def test_who_restarts_has_its_table_again_before_the_next_round(mode):
    bench = calm(mode=mode)
    version = bench.nodes[3].version
    bench.start(3, cause=1)
    assert bench.nodes[3].version == 0
    bench.run(CALM + 4 * S)
    assert {i for _, i in questions(bench)} == {3}
    assert not rounds(bench, CALM)
    assert (bench.nodes[3].gateway, bench.nodes[3].depth) == (0, 4)
    assert bench.nodes[3].version == version


@pytest.mark.parametrize("mode", [TABLES, WHOLE_GRAPH, TABLE_FREE])
def test_its_messages_arrive_as_soon_as_it_was_told(mode):
    bench = calm(mode=mode)
    bench.start(3, cause=1)
    bench.run(CALM + 3 * S)
    bench.send(3, 0, b"here again")
    bench.run(CALM + 3 * S + 50_000)
    assert [bytes(f.body[: f.length])[-10:] for _, i, f in bench.delivered] == [b"here again"]


def test_who_was_off_for_a_round_is_in_the_next_one_soon():
    bench = calm()
    bench.dead.add(3)
    bench.run(CALM + 120 * S)
    assert bench.gates[0].dist[3] == 255
    back = bench.now
    assert bench.gates[0].wait > 15
    bench.start(3, cause=1)
    bench.run(back + 8 * S)
    assert len(rounds(bench, back)) == 1
    assert bench.nodes[3].version == bench.gates[0].version


def test_a_gateway_that_restarts_leads_at_once_if_others_knew_it():
    bench = calm()
    epoch = bench.nodes[1].epoch
    bench.start(0, cause=1)
    bench.run(CALM + 3 * S)
    assert bench.nodes[0].leading
    assert bench.nodes[0].epoch == (epoch + 1) & 255
    assert {(node.gateway, node.epoch) for node in bench.nodes} == {(0, bench.nodes[0].epoch)}
    bench.run(CALM + 6 * S)
    assert {node.version for node in bench.nodes} == {bench.gates[0].version}


def test_a_gateway_that_was_replaced_follows():
    bench = Bench(6, RING, standbys=(1,), standby=1)
    bench.run(CALM)
    bench.dead.add(0)
    bench.run(CALM + 60 * S)
    assert bench.nodes[1].leading
    back = bench.now
    bench.start(0, cause=1)
    bench.run(back + 3 * S)
    assert (bench.nodes[0].leading, bench.nodes[0].gateway) == (0, 1)


def test_who_is_alone_asks_ever_less():
    bench = Bench(3, [(0, 1)])
    bench.run(70 * S)
    first = bench.due[2, 3] % S  # its first beat
    asked = [round((at - first) / S) for at, i in questions(bench) if i == 2]
    assert asked == [1, 3, 7, 15, 31, 63]


def test_who_knows_no_round_tells_none_and_a_question_goes_no_further():
    bench = Bench(4, [(1, 2), (2, 3)])
    bench.run(20 * S)
    asked = questions(bench)
    assert {i for _, i in asked} == {1, 2, 3}
    assert [f.kind for _, i, f in bench.sent if i] == [REQUEST] * len(asked)
    assert [node.gateway for node in bench.nodes[1:]] == [ALL] * 3


def test_neighbours_that_are_asked_by_many_say_it_once():
    bench = Bench(8, [(0, 1), *((1, k) for k in range(2, 8))], jitter_us=900_000)
    bench.run(CALM)
    for k in range(2, 8):
        bench.start(k, cause=1)
    bench.run(CALM + 2 * S)
    before = len(questions(bench, CALM))
    told = [at for at, i, f in bench.sent if f.kind == REQUEST and i == 1 and at > CALM]
    assert before == 6
    assert len(told) <= 2 * bench.params.copies
    bench.run(CALM + 4 * S)
    gateways = {row[1] for row in bench.of(REPORT_GATEWAY) if row[0] > CALM}
    assert gateways == set(range(2, 8))
