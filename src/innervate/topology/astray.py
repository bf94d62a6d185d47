"""How far off robots believe themselves to be, in whole numbers: the same on any machine.

An error is of first order (Gauss-Markov): of the last one a share stays, the rest is new, so that
its spread is always the same. What stays after a time `hold` is a share of 1/e.
"""

import math
from functools import cache
from statistics import NormalDist

from innervate.dialect.rng import LOW15, step

SIGMA = 1 << 20  # an error as large as its standard deviation
SHARE_BITS = 30
ONE = 1 << SHARE_BITS
UM_PER_CM = 10_000

TAIL_BITS = 29  # of a draw of 30 bits; the other one is its sign
MANTISSA_BITS = 8
MANTISSA = 1 << MANTISSA_BITS
OCTAVES = TAIL_BITS - MANTISSA_BITS - 1


@cache
def normal_table() -> tuple[int, ...]:
    """Normal numbers, in SIGMA, by octave and mantissa of how rare so large ones are."""
    found = []
    for left in range((OCTAVES + 2) << MANTISSA_BITS):
        octave = max(0, (left >> MANTISSA_BITS) - 1)
        rare = (left - (octave << MANTISSA_BITS) + 0.5) * (1 << octave) / (2 << TAIL_BITS)
        found.append(round(-SIGMA * NormalDist().inv_cdf(rare)))
    return tuple(found)


def shares(every_us: int, hold_us: int) -> tuple[int, int]:
    """What stays of an error from one sample to the next, and what is new, in 1/ONE."""
    keep = round(ONE * math.exp(-every_us / hold_us)) if hold_us else 0
    return keep, math.isqrt(ONE * ONE - keep * keep)


def normal(table, drawn):
    """A normally distributed number in SIGMA from one of 30 even bits."""
    left, octave = drawn >> 1, 0
    while left >= 2 * MANTISSA:
        left >>= 1
        octave += 1
    found = table[(octave << MANTISSA_BITS) + left]
    return -found if drawn & 1 else found


def err(walk, normals):
    """The walk's next error along either axis, `off_x` and `off_y` in SIGMA.

    `keep` of the last one stays and `fresh` is new (see `shares`), drawn from the walk's own `rng`;
    `normals` is the normal_table().
    """
    walk.off_x = next_of(walk.off_x, walk.keep, walk.fresh, drawn(walk, normals))
    walk.off_y = next_of(walk.off_y, walk.keep, walk.fresh, drawn(walk, normals))


def drawn(walk, normals):
    """A normally distributed number from the walk's own stream."""
    high = step(walk.rng)
    walk.rng = step(high)
    return normal(normals, (high & LOW15) << 15 | (walk.rng & LOW15))


def next_of(last, keep, fresh, new):
    """The error after `last`, in SIGMA as that and the `new` normal number."""
    return (keep * last + fresh * new + ONE // 2) >> SHARE_BITS


def centimetres(sigma_um, off):
    """An error in whole cm, where SIGMA is so many um."""
    return (sigma_um * off + UM_PER_CM * SIGMA // 2) // (UM_PER_CM * SIGMA)
