"""The protocol's small parts: comparisons, generator, outbox, plain classes."""

from collections import Counter

import pytest
from hypothesis import given
from hypothesis import strategies as st

from innervate.dialect import arith, outbox, plain, rng
from innervate.dialect.arith import HALF30, MASK30
from innervate.networks.skin.protocol import fields as skin_fields

CLOCK = st.integers(0, MASK30)
NUMBER = st.integers(0, 65_535)


class Chooser:
    """What a state that draws needs."""

    def __init__(self, seed=1):
        self.rng = rng.seeded(seed)
        self.choice = rng.GENERATE
        self.asked = 0


@given(CLOCK, st.integers(0, HALF30 - 1))
def test_after_is_wrap_safe(reading, ahead):
    assert arith.after((reading + ahead) & MASK30, reading)
    if ahead:
        assert not arith.after(reading, (reading + ahead) & MASK30)


@given(NUMBER, st.integers(1, 32_767))
def test_later_is_serial_arithmetic(number, ahead):
    newer = (number + ahead) & 65_535
    assert arith.later(newer, number)
    assert not arith.later(number, newer)
    assert not arith.later(number, number)


def test_numbers_half_a_circle_apart_are_not_later_either_way():
    assert not arith.later(0, 32_768)
    assert not arith.later(32_768, 0)


@given(st.integers(0, 1 << 70))
def test_a_seed_is_a_usable_state(seed):
    state = rng.seeded(seed)
    assert 0 < state < rng.FIXED_POINT
    assert rng.step(state) != state


@given(st.integers(1, rng.FIXED_POINT - 1))
def test_the_generator_stays_in_range(state):
    assert 0 < rng.step(state) < 1 << 30


@given(st.integers(0, 1 << 40), st.one_of(st.integers(1, 9), st.integers(1, (1 << 30) - 1)))
def test_a_draw_is_in_range(seed, n):
    chooser = Chooser(seed)
    for _ in range(3):
        assert 0 <= rng.draw(chooser, n) < n


@pytest.mark.parametrize("n", [2, 3, 7, 100])
def test_draws_are_uniform(n):
    chooser = Chooser(12_345)
    counts = Counter(rng.draw(chooser, n) for _ in range(3000 * n))
    assert set(counts) == set(range(n))
    assert all(abs(count - 3000) < 300 for count in counts.values()), counts


def test_large_draws_reach_both_halves():
    chooser = Chooser(99)
    draws = [rng.draw(chooser, 1 << 29) for _ in range(2000)]
    assert 900 < sum(value < 1 << 28 for value in draws) < 1100
    assert len({value & 0x7FFF for value in draws}) > 1800


def test_a_script_replaces_the_generator():
    chooser = Chooser(7)
    before = chooser.rng
    chooser.choice = 2
    assert rng.draw(chooser, 4) == 2
    assert chooser.asked == 4
    assert rng.draw(chooser, 2) == 1  # the greatest there is
    assert chooser.rng == before


def test_the_generator_has_a_long_period():
    state = start = rng.seeded(1)
    for _ in range(200_000):
        state = rng.step(state)
        assert state != start


# Outbox.


def fresh_outbox(limit=3):
    return plain.Outbox(plain.make("Frame", skin_fields.FRAME), limit)


def test_actions_are_kept_in_order():
    out = fresh_outbox(4)
    out.frame[outbox.send(out, 2, 5, outbox.URGENT)].kind = 1
    outbox.set_timer(out, 1, 77)
    outbox.report(out, 9, 8, 7)
    out.frame[outbox.deliver(out, 2)].kind = 2
    found = [(act.kind, act.a, act.b, act.c) for act in out.action[: out.count[0]]]
    assert found == [
        (outbox.SEND, 2, 5, outbox.URGENT), (outbox.SET_TIMER, 1, 77, 0),
        (outbox.REPORT, 9, 8, 7), (outbox.DELIVER, 2, 0, 0),
    ]  # fmt: skip
    assert [out.frame[0].kind, out.frame[3].kind] == [1, 2]
    assert not out.overflow[0]


def test_an_overflow_is_never_silent():
    out = fresh_outbox(3)
    places = [outbox.report(out, code, 0, 0) for code in range(5)]
    assert places == [0, 1, 2, 2, 2]  # always a place that can be written to
    assert out.count[0] == 3
    assert out.overflow[0]
    assert [act.a for act in out.action] == [0, 1, 2]


# Plain classes.


def test_a_plain_class_has_the_declared_fields_nearest_to_zero():
    cell = plain.make("Cell", skin_fields.CELL)()
    assert cell.dist == [0, 0, 0, 0]
    assert cell.own_load == 1
    assert cell.parent == 0
    with pytest.raises(AttributeError):
        cell.nonsense = 1


def test_fields_as_long_as_the_node_has_ports():
    pc = plain.make("Pc", skin_fields.SINK, skin_fields.SINK_PORT, ports=5)()
    assert pc.size == [0] * 5
    assert pc.sq == 0
