"""The few functions that compiled code spells differently say the same as their plain bodies."""

import numba
import pytest
from hypothesis import given
from hypothesis import strategies as st

from innervate.dialect import arith, plain, rng
from innervate.kernel import bits, compilation, lowering, records  # noqa: F401 - known to Numba
from innervate.networks.skin.protocol import cell as skin

SIGNED = st.integers(-(2**63), 2**63 - 1)
HALF = st.integers(0, 2**30 - 1)


@pytest.fixture(scope="module")
def compiled():
    """Compiled twins of the small functions."""
    compilation.register(arith, rng, skin)

    @numba.njit
    def mix(state, word):
        return bits.mix(state, word)

    @numba.njit
    def lowest_bit(word):
        return bits.lowest_bit(word)

    @numba.njit
    def compare(a, b):
        return arith.after(a, b), arith.later(a, b), rng.step(a)

    @numba.njit
    def within(words, low, high):
        return records.within(words, low, high)

    for function, arguments in ((mix, (0, 0)), (lowest_bit, (1,)), (compare, (0, 0))):
        function(*arguments)  # compiled before examples have to keep a deadline
    return mix, lowest_bit, compare, within


@given(state=SIGNED, word=SIGNED)
def test_mix(compiled, state, word):
    mixed = bits.mix(state, word)
    assert compiled[0](state, word) == mixed
    assert -(2**63) <= mixed < 2**63


@given(SIGNED.filter(bool))
def test_lowest_bit(compiled, word):
    lowest = bits.lowest_bit(word)
    assert compiled[1](word) == lowest
    assert word >> lowest & 1
    assert word & (1 << lowest) - 1 == 0


def test_lowest_bit_of_every_place(compiled):
    for bit in range(64):
        word = 1 << bit if bit < 63 else -(1 << 63)
        assert compiled[1](word) == bits.lowest_bit(word) == bit


@given(a=HALF, b=HALF)
def test_comparisons_and_generator(compiled, a, b):
    after, later, step = compiled[2](a, b)
    assert (bool(after), bool(later)) == (bool(arith.after(a, b)), bool(arith.later(a, b)))
    assert step == rng.step(a)


def test_mix_tells_sequences_apart():
    marks = {bits.mix(bits.mix(0, one), two) for one in range(64) for two in range(64)}
    assert len(marks) == 64 * 64


FIELDS = (("mode", 0, 2, 9, "", ""), ("dist", 3, 0, 31, "", ""), ("one", 1, -7, -4, "", ""))


@pytest.mark.parametrize("place", range(5))
def test_every_word_is_seen_to_be_within_its_range(compiled, place):
    low, high = records.bounds(FIELDS)
    row = records.zeros(FIELDS, 1).view("i4")
    words = records.Words(plain.make("Twin", FIELDS)(), FIELDS)
    before, lowest, highest = words[place], int(low[place]), int(high[place])
    for value in (before, lowest - 1, lowest, highest, highest + 1, before):
        words[place] = row[place] = value
        for form, within in ((words, records.within), (row, records.within), (row, compiled[3])):
            assert within(form, low, high) == (lowest <= value <= highest), value
