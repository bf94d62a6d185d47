"""The checks can fail: each of these small mistakes in the protocol is caught by a named check.

A mutant is the protocol's source with a text replaced; it runs plain, like all copies (see
skin_bench.changed_protocol). Every check passes on the protocol as it is.
"""

import random

import pytest

from innervate.sim.driver import InvariantBroken
from tests.networks.skin.bench import REAL, changed_protocol
from tests.networks.skin.verify.mutants_checks import CHECKS

# name: (text, replacement, check that finds it)
MUTANTS = {
    # route.py
    "a worse parent is no reason to look around": (
        "if worse or not is_usable(cell, params, port):",
        "if not is_usable(cell, params, port):",
        "react",
    ),
    "hearing a tie moves a cell": (
        "cell.dist[port] >= cell.dist[parent]:", "cell.dist[port] > cell.dist[parent]:", "react"
    ),
    "hearing does not ask the rule": (
        "not (is_usable(cell, params, port) and is_allowed(cell, params, port))",
        "not is_usable(cell, params, port)",
        "network",
    ),
    "an equal feasible distance is good enough": (
        "return sq == cell.fd_sq and dist < cell.fd_dist",
        "return sq == cell.fd_sq and dist <= cell.fd_dist",
        "network",
    ),
    "any route of the same number is feasible": (
        "return sq == cell.fd_sq and dist < cell.fd_dist", "return sq == cell.fd_sq", "network"
    ),
    "fd is set once only": (
        "if nearer_than_fd(cell, cell.sq_own, dist):", "if cell.fd_known == 0:", "network"
    ),
    "fd is a hop too far": ("cell.fd_dist = dist", "cell.fd_dist = dist + 1", "network"),
    "children may become parents": (
        "cell.pf[p] < ONE and cell.child[p] == 0", "cell.pf[p] < ONE", "select"
    ),
    "a port is broken one step too late": (
        "and cell.pf[p] < ONE and cell.child", "and cell.pf[p] <= ONE and cell.child", "select"
    ),
    "routes may be one hop too deep": (
        "return cell.dist[p] < params.max_depth", "return cell.dist[p] <= params.max_depth",
        "select",
    ),
    "strict takes an equal number": (
        "return params.rule != RULE_STRICT and cell.sq[p] == least",
        "return cell.sq[p] == least",
        "simulation",
    ),
    "the printed rule compares with the number of the last choice": (
        "if params.rule == RULE_PAPER and cell.parent != NONE:", "if params.rule == 9:", "select"
    ),
    "the printed Alg. 3 moves as ours does": (
        "if params.balance_rule == BALANCE_PAPER:", "if params.balance_rule == 9:", "select"
    ),
    "balancing moves without a gain": (
        "return -more > cell.own_load", "return -more >= cell.own_load",
        "balances",
    ),
    "balancing takes the heaviest": (
        "if cell.size[p] < cell.size[lightest]:", "if cell.size[p] > cell.size[lightest]:",
        "balances",
    ),
    "a tie always takes its first port": ("skip = draw(cell, count)", "skip = 0", "select"),
    "the distance does not grow": (
        "return min(cell.dist[cell.parent] + 1, INFINITY)",
        "return min(cell.dist[cell.parent], INFINITY)",
        "network",
    ),
    # skin.py
    "nothing is waited for after a loss of memory": (
        "cell.wait = params.k + 3 + params.k // 8", "cell.wait = 0", "restarts"
    ),
    "a cell that balanced keeps its turn": (
        "cell.countdown = 1 + draw(cell, params.balance_periods)\n    cell.own_load",
        "cell.countdown = params.balance_periods\n    cell.own_load",
        "turns",
    ),
    "p_f grows beyond 2": ("min(2 * ONE, penalty", "min(2 * ONE + 1, penalty", "penalty"),
    "p_f shrinks below 0": ("max(0, penalty - params.r_r)", "penalty - params.r_r", "penalty"),
    "a beacon counts for ever": (
        "cell.heard[p] = 0\n        cell.pf[p] = after", "cell.pf[p] = after", "penalty"
    ),
    "the flag of children is lost": (
        "cell.child[port] = child", "cell.child[port] = 0", "settles"
    ),
    "every neighbour is told that it is the parent": (
        "frame.parent = 1 if p == parent else 0", "frame.parent = 1", "settles"
    ),
    "loads of others than children count": (
        "cell.child[p] * cell.load[p]", "cell.load[p]", "settles"
    ),
    "a newer number is announced": (
        "cell.sent_sq = cell.sq_own\n    cell.sent_at",
        "cell.sent_sq = (cell.sq_own + 1) & 65535\n    cell.sent_at",
        "network",
    ),
    "fd is never forgotten": (
        "cell.fd_known = 0\n        cell.fd_dist", "cell.fd_dist", "forgets"
    ),
    "a wave stops at the first cell": (
        "params.updates == WAVE and cell.parent != NONE and later",
        "params.updates == 9 and cell.parent != NONE and later",
        "wave",
    ),
    "news does not keep the gap": (
        "at = (cell.sent_at + params.gap_us) & MASK30", "at = cell.sent_at", "gap"
    ),
    "hops are not counted": (
        "onward.hops = frame.hops + 1\n\n\ndef hand",
        "onward.hops = frame.hops\n\n\ndef hand",
        "data",
    ),
    "samples are not counted on": (
        "cell.seq = (cell.seq + 1) & 255", "cell.seq = cell.seq & 255", "data"
    ),
    # sink.py
    "numbers do not wrap": (
        "own.sq = (own.sq + 1) & MASK16\n        own.sq_known",
        "own.sq = own.sq + 1\n        own.sq_known",
        "wraps",
    ),
    "the PC never counts": (
        "if own.periods >= params.seq_every:", "if own.periods >= 60000:", "recovers"
    ),
    "the PC counts too fast": (
        "if own.periods >= params.seq_every:", "if own.periods >= 1:", "counts"
    ),
    "the PC does not listen": ("own.listen = params.k", "own.listen = 0", "listens"),
    "the PC believes cells that never had a route": (
        "if frame.load > 0 and (own", "if (own", "believes"
    ),
    "the PC tells everyone a size of 0": ("frame.size = pc.size[p]", "frame.size = 0", "settles"),
    # arith.py, rng.py, outbox.py
    "numbers are compared without wrap": (
        "return ahead != 0 and ahead < HALF16", "return a > b", "wraps"
    ),
    "clocks are compared without wrap": (
        "return ((a - b) & MASK30) < HALF30", "return a >= b", "gap wraps"
    ),
    "a draw can be one too many": (
        "return ((x & LOW15) * n) >> 15", "return ((x & LOW15) * (n + 1)) >> 15", "draws"
    ),
    "an overflow is silent": ("out.overflow[0] = 1", "out.overflow[0] = 0", "overflow"),
}  # fmt: skip
CAUGHT = (AssertionError, InvariantBroken, IndexError)


@pytest.mark.parametrize("name", MUTANTS)
def test_a_mutant_is_caught(name):
    old, new, check = MUTANTS[name]
    mutant = changed_protocol((old, new))
    with pytest.raises(CAUGHT):
        CHECKS[check](mutant)


@pytest.mark.parametrize("check", CHECKS)
def test_the_protocol_as_it_is_passes(check):
    CHECKS[check](REAL)


def test_a_copy_behaves_like_the_original():
    copy = changed_protocol()
    assert copy.skin.select is not REAL.skin.select
    for check in random.Random(1).sample(sorted(CHECKS), 4):
        CHECKS[check](copy)


def test_a_text_that_is_not_there_is_no_mutant():
    with pytest.raises(ValueError, match="stands 0 times"):
        changed_protocol(("no such text", ""))


def test_there_are_enough_mutants():
    assert len(MUTANTS) >= 20
    assert {check for *_, check in MUTANTS.values()} == set(CHECKS)
