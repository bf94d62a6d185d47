"""Do routes settle on shortest ways? Which rule and M leave cells on longer ones (E26)."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np

from innervate import scenario
from innervate.networks.skin.papers.common import joined, seeds_of
from innervate.networks.skin.papers.steps import Steps
from innervate.networks.skin.protocol.constants import NONE
from innervate.papers.experiment import Claim, Point, Results, Span, verdict

HZ = 250
K = 3
LOOKS = (25, 50, 100)  # periods after switching on, and after the cut
CUT_AFTER = 200
NOBODY = Span(0, 0)  # cells on a longer way


class Variant(NamedTuple):
    """Rule, updates and M (0 = min(k, 5))."""

    rule: str
    updates: str
    m: int


PAPER = Variant("paper", "periodic", 1)
WAVE = Variant("feasible", "wave", 1)
VARIANTS = (
    PAPER,
    Variant("paper-lax", "periodic", 1),
    Variant("feasible", "periodic", 1),
    Variant("feasible", "periodic", 0),
    Variant("feasible", "triggered", 1),
    WAVE,
    Variant("feasible", "wave", 0),
)


def seeds(quick: bool) -> range:
    """Skins that are looked at."""
    return seeds_of(3 if quick else 20)


def _key(setup: str, variant: Variant, quick: bool) -> str:
    rule, updates, m = variant
    return f"steady {setup} {rule} {updates} m={m} k={K} seeds 1-{len(seeds(quick))}"


def points(setup: str, quick: bool) -> list[Point]:
    """A point for each variant of a setup."""
    return [
        Point.of(
            _key(setup, variant, quick),
            0.03 * len(seeds(quick)),
            *(longer_all, setup, variant, seeds(quick)),
        )
        for variant in VARIANTS
    ]


def longer_all(setup: str, variant: Variant, some: Sequence[int]) -> list[list[list[int]]]:
    """See longer; one entry a seed."""
    return [longer(setup, variant, seed) for seed in some]


def longer(setup: str, variant: Variant, seed: int) -> list[list[int]]:
    """Cells not on a shortest way: at LOOKS after switching on, and after interface 1 is cut."""
    rule, updates, m = variant
    period = 1 / HZ
    overrides: list[tuple[str, Any]] = [
        ("protocol.rule", rule),
        ("protocol.updates", updates),
        ("protocol.beacon_hz", HZ),
        ("protocol.k", K),
        ("data.rate_hz", 0),
        ("event", [{"action": "cut", "interface": 1, "at_s": CUT_AFTER * period}]),
        ("duration_s", (CUT_AFTER + LOOKS[-1] + 1) * period),
    ]
    if m:
        overrides.append(("protocol.m", m))
    steps = Steps(scenario.load(setup, overrides, seed))
    found: list[list[int]] = []
    for start, depths in ((0, steps.plan.depths), (CUT_AFTER, _depths_after(setup))):
        shortest = np.array(depths)
        found.append([])
        for look in LOOKS:
            steps.to((start + look) * period)
            found[-1].append(_count(steps.world.cells, shortest))
    return found


def _count(cells: Any, shortest: Any) -> int:
    parent = cells["parent"]
    dist = cells["dist"][np.arange(len(shortest)), np.maximum(parent, 0)] + 1
    return int(((parent == NONE) | (dist > shortest)).sum())


def _depths_after(setup: str) -> list[int]:
    """Shortest ways without interface 1."""
    ports = scenario.load(setup).model.interface
    left = [{"row": port.row, "column": port.column} for port in ports[:1]]
    depths: list[int] = scenario.plan(
        scenario.load(setup, [("interface", left), ("event", [])])
    ).depths
    return depths


def judge(setup: str, cells: int, results: Results, quick: bool) -> Claim:
    """Does the wave mode with M = 1 leave longer ways, as the printed rule does?"""
    first = LOOKS[0]
    words = []
    for variant in VARIANTS:
        found = np.array(results[_key(setup, variant, quick)])  # skin, occasion, look
        after_start, after_cut = ((found[:, i, 0] > 0).sum() for i in (0, 1))
        number = f"M = {variant.m}" if variant.m else "M = 3"
        words.append(f"{variant.rule} {variant.updates} {number}: {after_start}, {after_cut}")
    wave = np.array(results[_key(setup, WAVE, quick)])
    return Claim(
        "beyond",
        f"wave with M = 1 leaves no cell on a longer way, {cells} cells (E26)",
        f"skins of {len(wave)} with a longer way {first} periods after start-up, after the cut: "
        + joined(words),
        verdict(NOBODY.has(*wave.ravel())),
        "E26: with M = 1 a nearer neighbour whose number always comes later stays forbidden until "
        "the phases have drifted; numbers that travel as a wave come by the shortest way first",
    )
