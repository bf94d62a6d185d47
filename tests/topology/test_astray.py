"""How far off robots believe themselves to be: normal numbers from whole ones, errors that last."""

from statistics import NormalDist, correlation, fmean, stdev
from types import SimpleNamespace as Of

import pytest
from hypothesis import given
from hypothesis import strategies as st

from innervate.topology import astray
from innervate.topology.astray import ONE, SIGMA

TABLE = astray.normal_table()
BITS = 1 << 30


@given(st.integers(0, BITS - 1))
def test_a_number_is_as_rare_as_its_draw(drawn):
    """Within 1/256 of how rare it is, as wide as a part of an octave is at most."""
    found = astray.normal(TABLE, drawn) / SIGMA
    rare = ((drawn >> 1) + 0.5) / BITS
    assert (found < 0) == bool(drawn & 1)
    low, high = (-NormalDist().inv_cdf(min(rare * k, 0.5)) for k in (257 / 256, 255 / 256))
    assert low - 2e-6 <= abs(found) <= high + 2e-6


def test_all_numbers_together_have_no_mean_and_a_spread_of_one():
    """Every draw there is, as often as it comes: the middle of each place of the table."""
    weights = [2 ** max(0, (left >> 8) - 1) for left in range(len(TABLE))]
    assert sum(weights) == BITS // 2
    square = sum(w * (z / SIGMA) ** 2 for w, z in zip(weights, TABLE, strict=True))
    assert square / sum(weights) == pytest.approx(1, abs=1e-4)
    assert max(TABLE) / SIGMA == pytest.approx(6.12, abs=0.01)


def drawn(count, keep=0, fresh=ONE, rng=4_711):
    walk = Of(rng=rng, off_x=0, off_y=0, keep=keep, fresh=fresh)
    found = []
    for _ in range(count):
        astray.err(walk, TABLE)
        found.append((walk.off_x / SIGMA, walk.off_y / SIGMA))
    return zip(*found, strict=True)


def test_errors_of_a_stream_are_normal_along_both_axes_and_know_nothing_of_each_other():
    xs, ys = drawn(20_000)
    for one in (xs, ys):
        assert fmean(one) == pytest.approx(0, abs=0.03)
        assert stdev(one) == pytest.approx(1, abs=0.02)
        assert sum(abs(z) > 2 for z in one) / len(one) == pytest.approx(0.0455, abs=0.006)
        assert correlation(one[1:], one[:-1]) == pytest.approx(0, abs=0.03)
    assert correlation(xs, ys) == pytest.approx(0, abs=0.03)


def test_an_error_fades_and_its_spread_stays():
    keep, fresh = astray.shares(20_000, 200_000)
    assert keep / ONE == pytest.approx(0.904837, abs=1e-6)
    xs, ys = drawn(40_000, keep, fresh)
    for one in (xs, ys):
        assert stdev(one) == pytest.approx(1, abs=0.06)
        for late, share in ((1, 0.904837), (10, 0.367879)):
            assert correlation(one[late:], one[:-late]) == pytest.approx(share, abs=0.06)


@pytest.mark.parametrize("hold_us", [0, 1, 20_000, 10**6, 3_600 * 10**6])
def test_what_stays_and_what_is_new_make_the_same_spread(hold_us):
    keep, fresh = astray.shares(1_000, hold_us)
    assert keep**2 + fresh**2 == pytest.approx(ONE**2, rel=1e-8)
    assert fresh > 0
    if hold_us < 2:
        assert (keep, fresh) == (0, ONE)


@pytest.mark.parametrize(("sigma_um", "off", "cm"), [
    (100_000, SIGMA, 10), (100_000, -SIGMA, -10), (1_000, SIGMA, 0), (5_000, SIGMA, 1),
    (4_999, SIGMA, 0), (5_001, -SIGMA, -1), (100_000_000, 6 * SIGMA, 60_000),
])  # fmt: skip
def test_an_error_is_told_in_whole_cm(sigma_um, off, cm):
    assert astray.centimetres(sigma_um, off) == cm
