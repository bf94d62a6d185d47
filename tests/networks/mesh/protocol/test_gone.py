"""Who is dead is out of the graph after one round, and keeps nobody's table waiting."""

import pytest

from innervate.networks.mesh.protocol.constants import RESPONSE, TABLE, TABLE_FREE, TREE
from innervate.networks.mesh.protocol.gateway import forget_gone
from innervate.networks.mesh.protocol.paths import begin_round, is_heard, is_known, note_heard
from tests.networks.mesh.bench import Bench

S = 1_000_000
PERIOD = 10 * S
SETTLED = 9 * S
SQUARE = [(0, 1), (0, 2), (1, 3), (2, 3), (1, 2)]


def known(bench, a, b):
    return is_known(bench.gates[0], bench.params, a, b)


def after_a_round(links, gone, count=4, lost=None, **more):
    """Settled; then some die, and a round later."""
    bench = Bench(count, links, **more)
    bench.run(SETTLED)
    bench.dead.update(gone)
    if lost:
        bench.lost = lost
    bench.run(PERIOD + SETTLED)
    return bench


@pytest.mark.parametrize("asks", [0, 1])
def test_whom_two_heard_before_and_nobody_now_is_out_of_the_graph(asks):
    bench = after_a_round(SQUARE, {3}, asks=asks)
    assert not known(bench, 1, 3)
    assert not known(bench, 2, 3)
    assert known(bench, 0, 1)
    assert known(bench, 1, 2)


def test_whom_one_alone_heard_before_may_have_been_missed():
    bench = after_a_round([(0, 1), (1, 2), (2, 3)], {3})
    assert known(bench, 2, 3), "a lost frame is not a death: it counts for three rounds"
    bench.run(80 * S)  # rounds after 10, 30 and 70 s
    assert not known(bench, 2, 3)


def test_who_is_heard_and_does_not_respond_stays():
    bench = after_a_round(
        SQUARE, set(), lost=lambda frame, to: frame.kind == RESPONSE and frame.origin == 3
    )
    assert known(bench, 1, 3)
    assert known(bench, 2, 3)


def test_whose_neighbours_did_not_respond_either_stays():
    """Responses of a whole region are lost: nothing is known of those behind it."""
    bench = after_a_round(SQUARE, set(), lost=lambda frame, to: frame.kind == RESPONSE)
    assert known(bench, 1, 3)
    assert known(bench, 2, 3)


def test_who_comes_back_is_in_the_next_graph():
    bench = after_a_round(SQUARE, {3})
    bench.dead.clear()
    bench.run(2 * PERIOD + SETTLED)
    assert known(bench, 1, 3)
    assert known(bench, 2, 3)


def test_a_gateway_that_only_faint_links_hear_is_not_gone():
    bench = Bench(4, SQUARE)
    bench.run(SETTLED)
    node, gate = bench.nodes[0], bench.gates[0]
    begin_round(gate, bench.params)
    for responds in (1, 2):
        note_heard(gate, bench.params, responds, responds)
    forget_gone(node, gate, bench.params)
    assert is_heard(gate, bench.params, 0, 1)
    assert not is_heard(gate, bench.params, 3, 1)


def test_a_tree_knows_only_what_its_responses_crossed():
    """Lists tell whom nobody heard; without them a link counts for three rounds, as printed."""
    bench = after_a_round(SQUARE, {3}, discovery=TREE)
    assert known(bench, 1, 3) or known(bench, 2, 3)


def test_without_tables_nothing_follows_from_who_is_not_listed():
    """Nodes list their uplinks alone there: that node 3 is in no list is as it was."""
    bench = after_a_round(
        SQUARE, set(), mode=TABLE_FREE,
        lost=lambda frame, to: frame.kind == RESPONSE and frame.origin == 3,
    )  # fmt: skip
    assert known(bench, 1, 3)
    assert known(bench, 2, 3)


def test_who_does_not_answer_keeps_nobody_waiting_for_a_table():
    """Two at a time: two dead ones near by have their tries, then it is the others' turn."""
    star = [(0, k) for k in range(1, 7)]
    bench = Bench(7, star, jobs=2, job_tries=7)
    bench.lost = lambda frame, to: frame.kind == TABLE and to in (1, 2)
    bench.run(3 * SETTLED)
    sent = {k: [] for k in range(1, 7)}
    for at, i, frame in bench.sent:
        if frame.kind == TABLE and i == 0:
            sent[frame.dest].append(at)
    others = [sent[k][0] for k in range(3, 7)]
    tries = 1 + 2 + 3  # the waits of as many, each longer than the one before
    assert max(others) - sent[1][0] < 1.2 * tries * bench.params.job_us
    assert all(bench.nodes[k].version for k in range(3, 7))
    behind = [at for k in (1, 2) for at in sent[k] if at > max(others)]
    assert behind, "who was put behind the others is tried once more"
