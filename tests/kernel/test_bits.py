"""The few functions that compiled code spells differently say the same as their plain bodies."""

import numba
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from innervate.dialect import arith, plain, rng
from innervate.kernel import bits, compilation, lowering, records  # noqa: F401 - known to Numba
from innervate.networks.skin.protocol import cell as skin
from innervate.sim.tables import Tables

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

    @numba.njit
    def within_spans(words, low, high, spans):
        return records.within_spans(words, low, high, spans)

    for function, arguments in ((mix, (0, 0)), (lowest_bit, (1,)), (compare, (0, 0))):
        function(*arguments)  # compiled before examples have to keep a deadline
    return mix, lowest_bit, compare, within, within_spans


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


LONG = (("few", 3, -4, 9, "", ""), ("many", 70, 0, 31, "", ""), ("below", 65, -9, -2, "", ""),
        ("least", 0, 2, 9, "", ""), ("last", 0, -(2**31), 2**31 - 1, "", ""))  # fmt: skip


@pytest.mark.parametrize("place", [0, 2, 3, 37, 72, 73, 137, 138, 139])
def test_every_word_of_a_long_record_is_seen_to_be_within_its_range(compiled, place):
    """However far off: a difference of words of 64 bits may wrap round."""
    low, high = records.bounds(LONG)
    spans = Tables(False).spans(LONG)
    row = records.zeros(LONG, 1, word=np.int64).view("i8")
    before, lowest, highest = row[place], int(low[place]), int(high[place])
    ends = [(lowest, highest), (-(2**63), 2**63 - 1), (-(2**32), 2**32)]
    for value in (before, *(end + step for one in ends for end in one for step in (-1, 0, 1))):
        if -(2**63) <= value < 2**63:
            row[place] = value
            for within in (records.within_spans, compiled[4]):
                assert within(row, low, high, spans) == (lowest <= value <= highest), value
