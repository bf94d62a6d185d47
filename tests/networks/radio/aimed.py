"""python -m tests.networks.radio.aimed [RUNS [FIRST]]: openings that begin all but together.

Slow radios; 2 to 6 of up to 8 stations begin within a turnaround and a delay of each other, with
one or several packets of 3 slots and more; sometimes a station is switched on in between. Counted
is what its sender takes for delivered, and not all who were on have got it; and what is left over.
"""

import random
import sys
from collections import Counter
from typing import NamedTuple

from innervate.networks.radio.sim.simulate import simulate
from innervate.scenario.actions.channel import JOIN
from innervate.scenario.declared.channel import Fault
from tests.networks.radio.runs import START_US, radio_plan

TURN_US = 2000


class Range(NamedTuple):
    """How long bits are, and between what the delays of a run are drawn; all us."""

    bits: tuple[int, ...]
    least: int
    most: int


RANGES = (
    Range((1, 4, 8), 20, 331),
    Range((26,), 200, 1000),
    Range((13,), 52, 201),
    Range((26,), 20, 155),
)


def delays(draw, of, bit_us):
    """Bounds that a scenario may have: at most twice the least, and half a slot above it."""
    least = draw.randint(of.least, of.most)
    return least, min(draw.randint(least, 2 * least), of.most, least + 4 * bit_us - 1)


def plan(of, seed):
    """The schedule that a seed stands for."""
    draw = random.Random(f"{of} {seed}")
    bit_us = draw.choice(of.bits)
    bounds = delays(draw, of, bit_us)
    n, size = draw.randint(3, 8), draw.choice((3, 4, 5, 6, 8, 12, 20))
    per_turn = draw.choice((1, 1, 2, 4))
    begin = range(draw.randint(2, min(n, 6)))
    deaf_us = TURN_US + bounds[1]
    at = [[] for _ in range(n)]
    for station in begin:
        first = START_US + draw.randint(0, deaf_us)
        at[station] = [first] * draw.randint(1, per_turn)
        if draw.random() < 0.3:
            at[station].append(first + draw.randint(0, 4 * deaf_us))
    if draw.random() < 0.3:
        at[-1].append(START_US + draw.randint(0, 5 * deaf_us))
    faults, absent = [], [0] * n
    if n > 3 and n > len(begin) and draw.random() < 0.3:
        absent[-1] = 1
        faults = [Fault(START_US + draw.randint(0, 4 * deaf_us), JOIN, n - 1)]
        at[-1] = []
    sizes = [[draw.randint(3, size) for _ in range(4)] for _ in range(n)]
    return radio_plan(n, size, TURN_US, seed, bit_us=bit_us, delay_us=bounds, real=bounds,
                      arrivals=at, wanted=sum(map(len, at)), sizes=sizes, per_turn=per_turn,
                      absent=absent, faults=faults)  # fmt: skip


def search(of, seeds):
    """What went wrong in so many schedules of a range, and the seeds of those in which it did."""
    found, where = Counter(), []
    for seed in seeds:
        result = simulate(plan(of, seed), checks=False)
        counts = result.counts
        wrong = {"silent": counts["silent"], "partial": counts["partial"],
                 "left": result.plan.wanted - counts["completed"]}  # fmt: skip
        found.update(wrong, packets=result.plan.wanted)
        if any(wrong.values()):
            where.append(seed)
    return found, where


if __name__ == "__main__":
    runs, first = (int(word) for word in [*sys.argv[1:], *("8000", "100000")[len(sys.argv) - 1 :]])
    for of in RANGES:
        found, where = search(of, range(first, first + runs))
        print(f"{of}: {dict(found)} {where[:10]}", flush=True)
