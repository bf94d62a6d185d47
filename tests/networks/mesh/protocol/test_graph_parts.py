"""The whole graph in more parts than a queue has places: all of it comes, and is said once."""

from itertools import pairwise

import pytest

from innervate.networks.mesh.protocol.constants import (
    CRC_BYTES,
    GRAPH,
    HEADER_BYTES,
    REPORT_TABLE,
    REPORT_TABLES,
    TABLE_ACK,
    TO_SEND,
    WHOLE_GRAPH,
)
from innervate.networks.mesh.protocol.fields import QUEUE
from innervate.networks.mesh.protocol.graph_jobs import pump_graph
from innervate.networks.mesh.protocol.table import PART_HEAD, graph_bytes, part_bytes
from tests.networks.mesh.bench import Bench

LINE = [(0, 1), (1, 2)]
SETTLED = 9_000_000


def bench_of(part, **settings):
    """Three nodes that speak of a graph of 32, `part` bytes of it in a frame."""
    mtu = HEADER_BYTES + CRC_BYTES + 1 + PART_HEAD + part
    return Bench(3, LINE, mode=WHOLE_GRAPH, nodes=32, mtu=mtu, **settings)


def parts_by(bench, node, since=0):
    """Numbers of the parts that a node sent, copies left out, by the packet's number."""
    sent = {f.seq: f.body[3] >> 4 for at, i, f in bench.sent
            if i == node and f.kind == GRAPH and at >= since}  # fmt: skip
    return list(sent.values())


def answers_of(bench, node, since=0):
    return len({f.seq for at, i, f in bench.sent
                if f.kind == TABLE_ACK and f.origin == node and at >= since})  # fmt: skip


@pytest.mark.parametrize("part", [7, 8, 10, 12, 30])
def test_all_parts_are_flooded_once_however_many(part):
    bench = bench_of(part)
    count = -(-graph_bytes(bench.params) // part_bytes(bench.params))
    assert (count > QUEUE) == (part < 12)
    bench.run(SETTLED)
    assert parts_by(bench, 0) == list(range(count))
    assert sorted({i for _, i, *_ in bench.of(REPORT_TABLE)}) == [0, 1, 2]
    assert [row[-1] for row in bench.of(REPORT_TABLES)] == [0], "nobody was given up"
    assert [answers_of(bench, node) for node in (1, 2)] == [1, 1]


def test_who_has_the_graph_says_so_once_for_each_flood():
    bench = bench_of(8, period=60)
    bench.lost = lambda frame, to: frame.kind == TABLE_ACK and frame.origin == 2
    bench.run(SETTLED)
    floods = parts_by(bench, 0).count(0)
    assert floods > 1, "node 2 is not heard: all once more"
    assert answers_of(bench, 1) == floods
    assert parts_by(bench, 0) == floods * list(range(12))


def test_the_gateway_sends_each_part_as_often_as_all_others_do():
    """One that finds the channel full of the part before would be missed by all (decision 0073)."""
    bench = bench_of(30)
    bench.run(SETTLED)
    sent = [f.seq for _, i, f in bench.sent if i == 0 and f.kind == GRAPH]
    assert sent
    assert {sent.count(seq) for seq in sent} == {bench.params.copies}


def test_what_is_new_begins_with_its_first_part():
    """While parts of the graph before wait for places in the queue."""
    bench = bench_of(8, period=60)
    bench.run(SETTLED)
    bench.sent.clear()
    gate = bench.gates[0]
    gate.part = 5
    gate.job[1], gate.job_parts[1] = TO_SEND, 0
    pump_graph(bench.nodes[0], gate, bench.params, bench.now, bench.out)
    bench.drain(0)
    bench.run(bench.now + 2_000_000)
    assert parts_by(bench, 0) == list(range(QUEUE))


@pytest.mark.parametrize(("part", "share"), [(8, 1), (30, 2)])
def test_more_parts_than_a_queue_holds_come_no_sooner_than_they_are_passed_on(part, share):
    """Else all of 145 nodes miss one: it finds the channel full of the others (decision 0079)."""
    bench = bench_of(part)
    bench.run(SETTLED)
    first = {}
    for at, i, f in bench.sent:
        if i == 0 and f.kind == GRAPH:
            first.setdefault(f.seq, at)
    assert (len(first) > QUEUE) == (share == 1)
    times = sorted(first.values())
    gaps = [later - at for at, later in pairwise(times)]
    assert min(gaps) == bench.params.jitter_us // share
