"""The next round waits, for less than a period, while tables that it would replace go out."""

from innervate.networks.mesh.protocol.constants import REPORT_ROUND, REPORT_TABLES, TABLE
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
