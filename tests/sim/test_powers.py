"""Tables of decibels against the formulas in floating point."""

import math

import pytest

from innervate.sim.field import powers

STRENGTHS = powers.strength_table()
CHANCES = powers.chance_table()


def test_power_is_linear_in_milliwatts_from_minus_125_to_0_dbm():
    for cdb in range(-12_500, 1, 37):
        exact = pytest.approx(10 ** (cdb / 1000) * 1e15, rel=0.014)  # 0.05 dB, rounding
        assert powers.strength(STRENGTHS, cdb) == exact, cdb


def test_the_floor_and_the_ceiling():
    assert powers.strength(STRENGTHS, powers.FLOOR_CDB) == 1
    assert powers.strength(STRENGTHS, powers.FLOOR_CDB - 1) == 0
    assert powers.strength(STRENGTHS, -32_768) == 0
    assert powers.strength(STRENGTHS, 2_000) == STRENGTHS[-1] == 10**15


def test_nothing_overflows_64_bits():
    strongest = STRENGTHS[-1]
    assert strongest * powers.CAPTURE_ONE < 2**63
    assert 254 * strongest + strongest < 2**62  # below what means deaf


@pytest.mark.parametrize("cdb", [0, 100, 600, 1_000, 2_000])
def test_capture_is_a_ratio(cdb):
    assert powers.capture_ratio(cdb) / powers.CAPTURE_ONE == pytest.approx(
        10 ** (cdb / 1000), rel=0.001
    )


@pytest.mark.parametrize("over", range(-1_500, 1_501, 73))
def test_chance_of_reception(over):
    exact = 1 / (1 + math.exp(-over / 100))
    assert powers.chance(CHANCES, over) / 32_768 == pytest.approx(exact, abs=0.013)  # of 0.05 dB


@pytest.mark.parametrize("exponent_c", [200, 300, 450, 600])
def test_path_loss_is_right_within_a_twentieth_of_a_decibel(exponent_c):
    table = powers.loss_table(exponent_c)
    for cm in (*range(0, 3_000, 7), *(round(10 ** (k / 40)) for k in range(80, 280))):
        exact = exponent_c / 100 * 10 * math.log10(max(cm, 100) / 100)
        assert powers.loss(table, cm * cm) / 100 == pytest.approx(exact, abs=0.05), cm
