"""What a plan's delays say of who hears whom."""

import random

from innervate.networks.radio.scenario.plan import Pairs
from innervate.scenario import load, plan


def drawn(n: int, seed: int) -> list[list[int]]:
    stream = random.Random(seed)
    return [[0 if i == j else stream.choice((-1, 40, 60, 104)) for j in range(n)] for i in range(n)]


def test_pairs_that_do_not_hear_each_other_either_way_are_hidden() -> None:
    for n in range(1, 8):
        delays = drawn(n, n)
        hidden = Pairs.of(delays).hidden
        for i in range(n):
            for j in range(i + 1, n):
                assert ((i, j) in hidden) == (-1 in (delays[i][j], delays[j][i])), (n, i, j)
        assert len(set(hidden)) == len(hidden)


def test_delays_within_bounds_at_both_edges() -> None:
    delays = [[0, 52, -1], [52, 0, 104], [-1, 104, 0]]
    pairs = Pairs.of(delays)
    assert (pairs.hidden, pairs.delay_us) == (((0, 2),), (52, 104))
    assert pairs.within(52, 104)
    assert not pairs.within(53, 104)
    assert not pairs.within(52, 103)


def test_whom_nobody_hears_is_outside_of_nothing() -> None:
    assert Pairs.of([[0]]) == Pairs((), None)
    assert Pairs.of([[0, -1], [-1, 0]]) == Pairs(((0, 1),), None)
    assert Pairs((), None).within(1, 1)


def test_pairs_are_worked_out_once_for_a_plan() -> None:
    made = plan(load("radio-disaster"))
    assert made.pairs is made.pairs
