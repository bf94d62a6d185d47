"""Where radio nodes lie, and how loud each is at the others [mesh 6].

Everything is a whole number (cm, 0.01 dB) before it is compared, so that the same seed gives the
same network on any machine. `draw` is a stream of random numbers (see trace/streams.py).
"""

import math
from collections.abc import Sequence
from functools import cache
from statistics import NormalDist
from typing import Protocol

UNHEARD = -32_768  # in `rssi_cdb`: no signal at all
UNREACHABLE = -1  # in `distances`: there is no way
RSSI50_CDB = -9_500  # of networks of one's own: half of the frames are received at -95 dBm
STEP_CDB = 10  # reception is tabulated in steps of 0.1 dB
ONE_Q15 = 32_768  # a chance of 1
NEAREST_CM = 100  # closer than 1 m the path loss is that of 1 m
_NORMAL = NormalDist()
_STEPS = 1 << 53
_MOST = 1 - 1 / _STEPS  # the greatest share below 1

Point = tuple[int, int]


class Draw(Protocol):
    """What is needed of a stream of random numbers."""

    def next64(self) -> int:
        """0 .. 2^64 - 1."""

    def uniform(self, low: int, high: int) -> int:
        """From low to high, both included."""


def square(count: int, side_cm: int, draw: Draw) -> list[Point]:
    """Nodes anywhere in a square, evenly."""
    return [(draw.uniform(0, side_cm), draw.uniform(0, side_cm)) for _ in range(count)]


def grid(count: int, columns: int, spacing_cm: int) -> list[Point]:
    """Nodes on a square grid, row by row; a line is a grid of one row."""
    return [(i % columns * spacing_cm, i // columns * spacing_cm) for i in range(count)]


def normal_cdb(draw: Draw, sigma_cdb: int) -> int:
    """A normally distributed number of 0.01 dB around 0."""
    share = ((draw.next64() >> 11) + 0.5) / _STEPS
    return round(_NORMAL.inv_cdf(share if share < _MOST else _MOST) * sigma_cdb)


def path_loss_cdb(distance_cm: int, exponent_c: int) -> int:
    """What a signal loses between 1 m and a distance, 0.01 dB; `exponent_c` is x 100."""
    return round(10 * exponent_c * math.log10(max(distance_cm, NEAREST_CM) / 100))


def reception_q15(over_cdb: int) -> int:
    """Chance of reception in 1/32768 at so much above the 50 % point (0.01 dB) [mesh 6]."""
    return _chance_q15((over_cdb + STEP_CDB // 2) // STEP_CDB)


@cache
def _chance_q15(steps: int) -> int:
    return round(ONE_Q15 / (1 + math.exp(-min(max(steps, -300), 300) / 10)))


def quality_cdb(quality: float) -> int:
    """How far above the 50 % point a link of this quality is, 0.01 dB, within +-9.21 dB."""
    share = min(max(quality, 1e-4), 1 - 1e-4)
    return round(100 * math.log(share / (1 - share)))


def distance_cm(a: Point, b: Point) -> int:
    """Between two points, rounded down."""
    return math.isqrt((a[0] - b[0]) ** 2 + (a[1] - b[1]) ** 2)


def fading(count: int, shadowing_cdb: int, direction_cdb: int, draw: Draw) -> list[int]:
    """Per sender and receiver (row-major) what a pair gains or loses besides its distance, 0.01 dB.

    Shadowing is the same both ways, the direction's part is not.
    """
    found = [0] * (count * count)
    for a in range(count):
        for b in range(a + 1, count):
            common = normal_cdb(draw, shadowing_cdb) if shadowing_cdb else 0
            there = normal_cdb(draw, direction_cdb) if direction_cdb else 0
            back = normal_cdb(draw, direction_cdb) if direction_cdb else 0
            found[a * count + b] = common + there
            found[b * count + a] = common + back
    return found


def gains(points: Sequence[Point], faded: Sequence[int], exponent_c: int) -> list[int]:
    """Per sender and receiver, rssi at 0 dBm and no loss at 1 m, 0.01 dB; 0 on the diagonal."""
    count = len(points)
    found = list(faded)
    for a in range(count):
        for b in range(a + 1, count):
            loss = path_loss_cdb(distance_cm(points[a], points[b]), exponent_c)
            found[a * count + b] -= loss
            found[b * count + a] -= loss
    return found


def threshold(gain: Sequence[int], count: int, links: int) -> tuple[int, list[tuple[int, int]]]:
    """The gain that so many pairs have both ways, and the pairs (a < b) to weaken by 0.01 dB.

    Pairs that are exactly as loud as the last one would make more links than asked for; those that
    come last are to be weakened. There are 1 .. count * (count - 1) / 2 links.
    """
    loudness = sorted(
        (-min(gain[a * count + b], gain[b * count + a]), a, b)
        for a in range(count)
        for b in range(a + 1, count)
    )
    level = loudness[links - 1][0]
    return -level, [(a, b) for quiet, a, b in loudness[links:] if quiet == level]


def good_links(rssi: Sequence[int], count: int, least: int) -> list[tuple[int, int]]:
    """Links a < b that are at least so loud both ways, 0.01 dBm."""
    return [
        (a, b)
        for a in range(count)
        for b in range(a + 1, count)
        if rssi[a * count + b] >= least and rssi[b * count + a] >= least
    ]


def neighbours(count: int, links: Sequence[tuple[int, int]]) -> list[list[int]]:
    """Per node whom its links lead to."""
    found: list[list[int]] = [[] for _ in range(count)]
    for a, b in links:
        found[a].append(b)
        found[b].append(a)
    return found


def distances(near: Sequence[Sequence[int]], start: int) -> list[int]:
    """Hops from a node to every other; UNREACHABLE where there is no way."""
    found = [UNREACHABLE] * len(near)
    found[start] = 0
    line = [start]
    for node in line:
        for other in near[node]:
            if found[other] == UNREACHABLE:
                found[other] = found[node] + 1
                line.append(other)
    return found


def components(near: Sequence[Sequence[int]]) -> list[list[int]]:
    """The parts a network falls into, largest first, each in order of number."""
    left = set(range(len(near)))
    found = []
    while left:
        hops = distances(near, min(left))
        part = [node for node, far in enumerate(hops) if far >= 0]
        left.difference_update(part)
        found.append(part)
    return sorted(found, key=len, reverse=True)  # of equal ones that with the least number first
