"""Decibels to whole numbers: tables that are made before a run.

Power is linear, in units of 10^-15 mW (-150 dBm): of weaker signals nothing is left, stronger ones
than 1 mW (0 dBm) count as that. 254 such signals and a jammer add up to 3e17, and one times 4096,
for the ratio of capture, is 4e18: below 2^63.
"""

import math
from functools import cache

from innervate.topology.placement import reception_q15

FLOOR_CDB = -15_000  # power 1
CEILING_CDB = 0
STEP_CDB = 10
CAPTURE_ONE = 4096

SPREAD_CDB = 1200  # beyond this, a frame is always or never received

MANTISSA_BITS = 8  # 0.026 dB at most with a path loss exponent of 6
MANTISSA = 1 << MANTISSA_BITS
OCTAVES = 44  # of squared distance: 1,000 km
NEAR_CM2 = 10_000  # nearer than 1 m is as 1 m


@cache
def strength_table() -> tuple[int, ...]:
    """Power per 0.1 dB from FLOOR_CDB to CEILING_CDB."""
    steps = range(0, CEILING_CDB - FLOOR_CDB + 1, STEP_CDB)
    return tuple(round(10 ** (step / 1000)) for step in steps)


@cache
def chance_table() -> tuple[int, ...]:
    """Chance of reception in 1/32768, per 0.1 dB from -SPREAD_CDB to SPREAD_CDB about rssi50."""
    steps = range(-SPREAD_CDB, SPREAD_CDB + 1, STEP_CDB)
    return tuple(reception_q15(step) for step in steps)


@cache
def loss_table(exponent_c: int) -> tuple[int, ...]:
    """Path loss in 0.01 dB by octave and mantissa of the squared distance in cm."""
    scale = exponent_c / 100 * 5 * 100
    return tuple(
        round(scale * (octave * math.log10(2) + math.log10((m + MANTISSA + 0.5) / NEAR_CM2)))
        for octave in range(OCTAVES)
        for m in range(MANTISSA)
    )


def capture_ratio(capture_cdb: int) -> int:
    """Signal to interference for capture in 1/4096, rounded down: just so much survives."""
    return max(1, int(CAPTURE_ONE * 10 ** (capture_cdb / 1000)))


def strength(table, cdb):
    """Power of a signal of `cdb`, 0.01 dBm; 0 below the floor."""
    if cdb < FLOOR_CDB:
        return 0
    if cdb > CEILING_CDB:
        cdb = CEILING_CDB
    return table[(cdb - FLOOR_CDB + STEP_CDB // 2) // STEP_CDB]


def chance(table, over_cdb):
    """Chance of reception of a signal so much above rssi50, in 1/32768."""
    within = min(max(over_cdb, -SPREAD_CDB), SPREAD_CDB)
    return table[(within + SPREAD_CDB + STEP_CDB // 2) // STEP_CDB]


def loss(table, cm2):
    """Path loss over a squared distance in cm, in 0.01 dB over that of 1 m."""
    left = max(cm2, NEAR_CM2)
    octave = 0
    while left >= MANTISSA << 10:
        left >>= 8
        octave += 8
    while left >= 2 * MANTISSA:
        left >>= 1
        octave += 1
    return table[(octave << MANTISSA_BITS) + left - MANTISSA]
