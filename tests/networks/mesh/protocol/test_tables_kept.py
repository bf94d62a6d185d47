"""Who keeps its table: only of whom the gateway knows which one it has."""

import pytest

from innervate.networks.mesh.protocol import jobs
from innervate.networks.mesh.protocol.constants import CURRENT, TABLE_ACK, TO_SEND
from innervate.networks.mesh.protocol.jobs import give_job, note_lost_table
from innervate.networks.mesh.protocol.paths import NONE
from tests.networks.mesh.bench import WIDTH, Bench

S = 1_000_000
LINKS = [(0, 1), (1, 2), (2, 3), (0, 4), (4, 5)]


def settled():
    """All have their tables; from now on what node 1 says of its own is lost."""
    bench = Bench(6, LINKS, period_max=10)
    bench.run(9 * S)
    assert bench.gates[0].job[:6] == [CURRENT] * 6
    bench.lost = lambda frame, to: frame.kind == TABLE_ACK and frame.origin == 1
    return bench


def way(bench, i, dest):
    node = bench.nodes[i]
    return node.next[node.bank * WIDTH + dest]


def test_who_may_have_the_one_between_is_sent_the_older_one_again():
    """Node 5 dies and comes back: the gateway was told of the first table alone."""
    bench = settled()
    bench.dead.add(5)
    bench.run(60 * S)
    assert way(bench, 1, 5) == NONE
    bench.start(5)
    bench.run(100 * S)
    assert way(bench, 1, 5) == 0
    assert bench.nodes[1].version == bench.gates[0].version


def test_who_restarts_while_a_newer_table_waits_has_lost_the_older_one_too():
    bench = settled()
    gate = bench.gates[0]
    gate.job[1] = TO_SEND
    note_lost_table(gate, 1)
    give_job(gate, bench.params, 1)
    assert gate.job[1] == TO_SEND


@pytest.mark.parametrize("mark", [0, 1])
def test_who_lost_its_table_is_sent_one_whatever_its_mark(mark, monkeypatch):
    monkeypatch.setattr(jobs, "mark_table", lambda gate, params, start: mark)
    bench = settled()
    gate = bench.gates[0]
    note_lost_table(gate, 1)
    give_job(gate, bench.params, 1)
    assert gate.job[1] == TO_SEND
