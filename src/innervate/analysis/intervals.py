"""Means, quantiles and shares with their confidence intervals."""

from collections.abc import Sequence
from functools import cache
from math import atan, comb, cos, pi, sin, sqrt
from statistics import NormalDist
from typing import NamedTuple

EXACT_UP_TO = 200  # degrees of freedom; beyond, a series about the normal quantile


class Interval(NamedTuple):
    """An estimate and its confidence interval."""

    value: float
    low: float
    high: float


def mean_interval(values: Sequence[float], level: float = 0.95) -> Interval:
    """Mean and Student's confidence interval; one value, or the same ones, have no width.

    Raises:
        ValueError: no values, or a level outside (0, 1).
    """
    count = len(values)
    if count == 0:
        raise ValueError("a mean needs at least one value")
    if min(values) == max(values):  # their sum is rounded, and its share need not be one of them
        return Interval(values[0], values[0], values[0])
    mean = sum(values) / count
    spread = sqrt(sum((value - mean) ** 2 for value in values) / (count - 1))
    half = t_quantile((1 + level) / 2, count - 1) * spread / sqrt(count)
    return Interval(mean, mean - half, mean + half)


def quantile(values: Sequence[float], share: float) -> float:
    """The value below which a share of the values lies, linear between neighbours.

    Raises:
        ValueError: no values, or a share outside 0..1.
    """
    if not values or not 0 <= share <= 1:
        raise ValueError("a quantile needs at least one value and a share from 0 to 1")
    ordered = sorted(values)
    place = share * (len(ordered) - 1)
    below = int(place)
    above = min(below + 1, len(ordered) - 1)
    if place == below or ordered[below] == ordered[above]:  # both may be infinite
        return ordered[below]
    return ordered[below] + (place - below) * (ordered[above] - ordered[below])


def wilson(hits: int, trials: int, level: float = 0.95) -> Interval:
    """Share of hits and Wilson's interval, which holds at 0 and 1 as well.

    Raises:
        ValueError: no trials, or hits outside 0..trials.
    """
    if trials < 1 or not 0 <= hits <= trials:
        raise ValueError("a share needs trials >= 1 and 0 <= hits <= trials")
    z = NormalDist().inv_cdf((1 + level) / 2)
    share = hits / trials
    widened = 1 + z * z / trials
    centre = (share + z * z / (2 * trials)) / widened
    half = z / widened * sqrt(share * (1 - share) / trials + z * z / (4 * trials * trials))
    # Exactly 0 and 1 at the edges, where rounding may miss them.
    low = 0.0 if hits == 0 else centre - half
    high = 1.0 if hits == trials else centre + half
    return Interval(share, low, high)


@cache
def t_quantile(share: float, freedom: int) -> float:
    """Quantile of Student's t distribution, 0.5 <= share < 1, degrees of freedom >= 1."""
    if not 0.5 <= share < 1 or freedom < 1:
        raise ValueError("t_quantile needs 0.5 <= share < 1 and freedom >= 1")
    if freedom > EXACT_UP_TO:
        z = NormalDist().inv_cdf(share)
        first = (z**3 + z) / 4
        second = (5 * z**5 + 16 * z**3 + 3 * z) / 96
        return z + first / freedom + second / freedom**2
    low, high = 0.0, 1.0
    while _t_share(high, freedom) < share:
        high *= 2
    for _ in range(80):
        middle = (low + high) / 2
        if _t_share(middle, freedom) < share:
            low = middle
        else:
            high = middle
    return (low + high) / 2


def _t_share(t: float, freedom: int) -> float:
    """Share of Student's t distribution below t >= 0: finite sums for whole degrees of freedom."""
    angle = atan(t / sqrt(freedom))
    square = cos(angle) ** 2
    odd = freedom % 2
    term = cos(angle) if odd else 1.0
    total = 0.0
    for i in range(freedom // 2):
        total += term
        n = 2 * i + 1 + odd
        term *= square * n / (n + 1)
    if odd:
        return 0.5 + (angle + sin(angle) * total) / pi
    return 0.5 + sin(angle) * total / 2


def quantile_interval(values: Sequence[float], share: float, level: float = 0.95) -> Interval:
    """A quantile and its interval between two of the values, whatever they are spread like.

    The bounds are those values of which as many are too far down (up) with at most half the
    chance that is left. Where there are too few values for that, they are the least and greatest.

    Raises:
        ValueError: no values, or a share outside 0..1.
    """
    ordered, count = sorted(values), len(values)
    middle = quantile(ordered, share)
    chances = [comb(count, i) * share**i * (1 - share) ** (count - i) for i in range(count + 1)]
    rest = (1 - level) / 2
    low = max((r for r in range(1, count + 1) if sum(chances[:r]) <= rest), default=1)
    high = min((r for r in range(1, count + 1) if sum(chances[r:]) <= rest), default=count)
    return Interval(middle, ordered[low - 1], ordered[high - 1])


def median_interval(values: Sequence[float], level: float = 0.95) -> Interval:
    """The median and its interval, whatever the values are spread like."""
    return quantile_interval(values, 0.5, level)
