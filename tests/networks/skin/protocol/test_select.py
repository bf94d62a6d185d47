"""The choice of a parent: as the specification prints it, and the short cut that `hear` takes."""

import random

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.networks.skin.bench import REAL
from tests.networks.skin.checks import (
    DISTANCES,
    RULES,
    UPDATES,
    CellBench,
    check_react,
    check_select,
    random_step,
)

FIRST = st.sampled_from([0, 1, 5000, 32_765, 65_530, 65_535])
LOADS = st.sampled_from([0, 1, 2, 5, 40, 4095])
HEAR = st.tuples(
    st.just("hear"), st.integers(0, 3), st.sampled_from(DISTANCES), st.integers(0, 7),
    LOADS, LOADS, st.integers(0, 1),
)  # fmt: skip
STEP = st.one_of(HEAR, HEAR, HEAR, st.just(("tick",)), st.just(("soon",)))
HISTORY = st.lists(STEP, max_size=40)
KEYS = st.fixed_dictionaries(
    {
        "rule": st.sampled_from(RULES),
        "k": st.integers(1, 4),
        "balancing": st.booleans(),
        "balance_periods": st.integers(1, 3),
        "max_depth": st.sampled_from([3, 64, 254]),
    }
)


@given(HISTORY, FIRST, st.sampled_from(UPDATES), KEYS)
@settings(max_examples=150, deadline=None)
def test_hearing_a_beacon_equals_selecting_among_all_ports(history, first, updates, keys):
    check_react(history, first, updates=updates, **keys)


@given(HISTORY, FIRST, st.sampled_from(UPDATES), st.integers(0, 1), KEYS)
@settings(max_examples=150, deadline=None)
def test_select_chooses_what_the_specification_says(history, first, updates, may_balance, keys):
    check_select(history, first, updates=updates, may_balance=may_balance, **keys)


def walk(seed, steps, **keys):
    draw = random.Random(seed)
    history = [random_step(draw) for _ in range(steps)]
    keys = {"balancing": True, "balance_periods": 2, **keys}
    return check_react(history, draw.randrange(65_536), **keys)


@pytest.mark.parametrize("updates", ["triggered", "wave"])
@pytest.mark.parametrize("rule", RULES)
def test_so_it_is_along_random_walks(rule, updates):
    compared = sum(walk(seed, 100, rule=rule, updates=updates, k=1 + seed % 4) for seed in range(8))
    assert compared > 320


@pytest.mark.slow
@pytest.mark.parametrize("updates", ["triggered", "wave"])
@pytest.mark.parametrize("rule", RULES)
def test_so_it_is_along_many_random_walks(rule, updates):
    for seed in range(400):
        walk(seed, 200, rule=rule, updates=updates, k=1 + seed % 5)


@given(HISTORY, FIRST, KEYS)
@settings(max_examples=50, deadline=None)
def test_news_is_always_on_its_way(history, first, keys):
    # `hear` looks for news only where its own choice could have made some.
    for updates in ("triggered", "wave"):
        bench = CellBench(REAL, first, updates=updates, **keys)
        for step in history:
            bench.play(step)
            skin = bench.protocol.skin
            waiting = skin.is_news(bench.cell, bench.params) and not bench.cell.soon
            assert not waiting, f"news without a timer after {step} of {history}"
