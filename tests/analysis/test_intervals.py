from math import exp, lgamma, log1p, pi, sqrt

import pytest

from innervate.analysis.intervals import (
    mean_interval,
    median_interval,
    quantile,
    quantile_interval,
    t_quantile,
    wilson,
)

# Student's t as textbooks print it, to three places: shares, then a row for every freedom.
SHARES = (0.75, 0.90, 0.95, 0.975, 0.99, 0.995, 0.9995)
TABLE = {
    1: (1.000, 3.078, 6.314, 12.706, 31.821, 63.657, 636.619),
    2: (0.816, 1.886, 2.920, 4.303, 6.965, 9.925, 31.599),
    3: (0.765, 1.638, 2.353, 3.182, 4.541, 5.841, 12.924),
    4: (0.741, 1.533, 2.132, 2.776, 3.747, 4.604, 8.610),
    5: (0.727, 1.476, 2.015, 2.571, 3.365, 4.032, 6.869),
    9: (0.703, 1.383, 1.833, 2.262, 2.821, 3.250, 4.781),
    10: (0.700, 1.372, 1.812, 2.228, 2.764, 3.169, 4.587),
    19: (0.688, 1.328, 1.729, 2.093, 2.539, 2.861, 3.883),
    30: (0.683, 1.310, 1.697, 2.042, 2.457, 2.750, 3.646),
    60: (0.679, 1.296, 1.671, 2.000, 2.390, 2.660, 3.460),
    120: (0.677, 1.289, 1.658, 1.980, 2.358, 2.617, 3.373),
    1000: (0.675, 1.282, 1.646, 1.962, 2.330, 2.581, 3.300),
    10**9: (0.674, 1.282, 1.645, 1.960, 2.326, 2.576, 3.291),
}


@pytest.mark.parametrize("freedom", TABLE)
def test_students_t_as_in_the_books(freedom):
    found = [round(t_quantile(share, freedom), 3) for share in SHARES]
    assert found == list(TABLE[freedom])


def density(t, freedom):
    """Student's density, by its definition."""
    half = freedom / 2
    log = lgamma(half + 0.5) - lgamma(half) - 0.5 * (1 + freedom) * log1p(t * t / freedom)
    return exp(log) / sqrt(pi * freedom)


@pytest.mark.parametrize("share", [0.55, 0.9, 0.975, 0.9995])
@pytest.mark.parametrize("freedom", [6, 7, 199, 200, 201, 202, 500])
def test_below_a_quantile_lies_its_share_of_the_density(share, freedom):
    steps, end = 2000, t_quantile(share, freedom)
    points = [density(end * i / steps, freedom) for i in range(steps + 1)]
    odd, even = sum(points[1::2]), sum(points[2:-1:2])
    simpson = (points[0] + 4 * odd + 2 * even + points[-1]) * end / (3 * steps)
    assert 0.5 + simpson == pytest.approx(share, abs=2e-8)


def test_half_lies_below_the_middle():
    for freedom in (1, 2, 3, 200, 201):
        assert t_quantile(0.5, freedom) == pytest.approx(0.0, abs=1e-9)


def test_mean_interval():
    found = mean_interval([1.0, 2.0, 3.0, 4.0, 5.0])
    assert found.value == 3.0
    assert found.high - found.value == pytest.approx(1.9632, abs=1e-3)
    assert found.value - found.low == pytest.approx(1.9632, abs=1e-3)
    assert mean_interval([7.0]) == (7.0, 7.0, 7.0)
    # Two values 2 apart: 1.4142 / sqrt(2) = 1 times the quantiles of one degree of freedom.
    assert mean_interval([4.0, 6.0]) == pytest.approx((5.0, 5 - 12.7062, 5 + 12.7062), abs=1e-4)
    assert mean_interval([4.0, 6.0], 0.9) == pytest.approx((5.0, 5 - 6.3138, 5 + 6.3138), abs=1e-4)


def test_quantile():
    assert quantile([3, 1, 2], 0.5) == 2
    assert quantile([0, 10], 0.25) == 2.5
    assert quantile([4], 0.9) == 4
    assert quantile(list(range(101)), 0.95) == pytest.approx(95)
    assert [quantile([5, 1, 3], share) for share in (0, 1)] == [1, 5]
    assert quantile([1, 2, 4], 0.75) == 3
    assert quantile([1, 2, 9], 0.25) == 1.5


def test_a_quantiles_interval_leaves_out_at_most_half_the_chance_that_is_left():
    """Of 4 values 5 in 16 draws have at most one below the median: exactly what is left here."""
    values = [40.0, 10.0, 30.0, 20.0]
    assert median_interval(values, 0.375) == (25.0, 20.0, 30.0)
    assert median_interval(values, 0.376) == (25.0, 10.0, 40.0)
    assert quantile_interval(values, 0.75, 0.1)[1:] == (30.0, 40.0)
    assert median_interval([7.0]) == (7.0, 7.0, 7.0)


def test_wilson():
    assert wilson(19, 20) == pytest.approx((0.95, 0.76387, 0.99112), abs=1e-5)
    assert wilson(1, 2) == pytest.approx((0.5, 0.09453, 0.90547), abs=1e-5)
    assert wilson(0, 1000).low == 0.0
    # With no hit, z^2 / (n + z^2) is the upper end, and mirrored the lower one with hits alone.
    assert wilson(5, 5).low == pytest.approx(5 / (5 + 1.959964**2), abs=1e-6)
    assert wilson(0, 1000).high == pytest.approx(0.00383, abs=1e-5)
    assert wilson(5, 5).high == 1.0


@pytest.mark.parametrize(("level", "z"), [(0.9, 1.644854), (0.95, 1.959964), (0.99, 2.575829)])
@pytest.mark.parametrize(("hits", "trials"), [(1, 2), (19, 20), (3, 1000), (7, 7), (0, 4), (1, 1)])
def test_at_either_end_of_wilsons_interval_the_share_is_z_deviations_off(hits, trials, level, z):
    share, low, high = wilson(hits, trials, level)
    assert low <= share <= high
    for end in (low, high):
        if 0 < end < 1:
            off = abs(share - end) / sqrt(end * (1 - end) / trials)
            assert off == pytest.approx(z, abs=1e-5)


@pytest.mark.parametrize(
    "wrong",
    [
        lambda: mean_interval([]),
        lambda: quantile([], 0.5),
        lambda: quantile([1], 1.5),
        lambda: quantile([1], -0.1),
        lambda: wilson(-1, 2),
        lambda: wilson(0, 0),
        lambda: t_quantile(0.49, 3),
        lambda: wilson(1, 0),
        lambda: wilson(3, 2),
        lambda: t_quantile(1.0, 3),
        lambda: t_quantile(0.9, 0),
    ],
)
def test_nonsense_is_refused(wrong):
    with pytest.raises(ValueError, match="need"):
        wrong()


def test_values_that_are_all_the_same_have_no_width():
    same = 2 / 11
    assert sum([same] * 3) / 3 != same
    assert mean_interval([same] * 3) == (same, same, same)
