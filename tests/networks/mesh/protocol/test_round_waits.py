"""The next round waits, for less than a period, while tables that it would replace go out.

Who has none gets one first.
"""

from innervate.networks.mesh.protocol.constants import (
    CURRENT,
    REPORT_ROUND,
    REPORT_TABLES,
    TABLE,
    TO_SEND,
)
from innervate.networks.mesh.protocol.jobs import next_job, note_lost_table
from tests.networks.mesh.bench import Bench

S = 1_000_000
CHAIN = [(i, i + 1) for i in range(5)]


def rounds(bench):
    return [at // S for at, _, code, *_ in bench.reports if code == REPORT_ROUND]


def slow(until, **settings):
    """Tables that get no further than node 2 before `until`; a round every 6 s."""
    bench = Bench(6, CHAIN, period=6, period_max=6, job_us=4 * S, job_tries=3, **settings)
    bench.lost = lambda frame, to: frame.kind == TABLE and to > 2 and bench.now < until
    return bench


def test_a_round_waits_until_tables_are_out():
    bench = slow(4 * S)
    bench.run(12 * S)
    assert [at // S for at, _, code, *_ in bench.reports if code == REPORT_TABLES] == [8]
    assert rounds(bench) == [0, 8]


def test_it_waits_for_less_than_another_period():
    bench = slow(60 * S)
    bench.run(12 * S)
    assert rounds(bench) == [0, 10]


def test_it_waits_for_less_than_a_standby_does():
    bench = slow(60 * S, standbys=(1,), standby=1, dead=9, dead_step=0)
    bench.run(40 * S)
    assert {node for _, node, code, *_ in bench.reports if code == REPORT_ROUND} == {0}


def test_where_all_have_their_tables_it_does_not_wait():
    bench = slow(0)
    bench.run(12 * S)
    assert rounds(bench) == [0, 5, 11]  # the first tick comes before a second is over


def test_who_has_no_table_comes_before_who_has_an_older_one():
    """Where rounds end before tables are out the nearest would have them anew, the others none."""
    bench = Bench(5, [(0, 1), (0, 2), (1, 3), (2, 4)])
    node, gate = bench.nodes[0], bench.gates[0]
    bench.run(9 * S)
    assert [gate.job[s] for s in range(1, 5)] == [CURRENT] * 4
    note_lost_table(gate, 4)
    for s in range(1, 5):
        gate.job[s] = TO_SEND
    assert next_job(node, gate, bench.params) == 4
    gate.job_tries[4] = 3
    assert next_job(node, gate, bench.params) == 1, "who does not answer keeps nobody waiting"
