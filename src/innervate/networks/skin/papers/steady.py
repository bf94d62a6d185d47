"""Do routes settle on shortest ways? Which rule and M leave cells on longer ones (E26)."""

from typing import Any, NamedTuple

import numpy as np

from innervate import scenario
from innervate.networks.skin.papers.common import SILENT, planned
from innervate.networks.skin.papers.steps import Steps
from innervate.networks.skin.protocol.constants import NONE
from innervate.papers.experiment import Claim, Measured, Point, Span, beyond, verdict
from innervate.papers.words import joined

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


WAVE = Variant("feasible", "wave", 1)
VARIANTS = (
    Variant("paper", "periodic", 1),
    Variant("paper-lax", "periodic", 1),
    Variant("feasible", "periodic", 1),
    Variant("feasible", "periodic", 0),
    Variant("feasible", "triggered", 1),
    WAVE,
    Variant("feasible", "wave", 0),
)


def point(setup: str, variant: Variant, quick: bool) -> Point:
    """Skins that are looked at."""
    rule, updates, m = variant
    what = f"steady {setup} {rule} {updates} m={m} k={K}"
    return Point.each(what, 0.03, 3 if quick else 20, longer, setup, variant)


def longer(setup: str, variant: Variant, seed: int) -> list[list[int]]:
    """Cells not on a shortest way: at LOOKS after switching on, and after interface 1 is cut."""
    rule, updates, m = variant
    cut = {"action": "cut", "interface": 1, "at_s": CUT_AFTER / HZ}
    steps = Steps(planned(
        setup, seed, (CUT_AFTER + LOOKS[-1] + 1) / HZ, SILENT | {"event": [cut]}, rule=rule,
        updates=updates, beacon_hz=HZ, k=K, m=m or None,
    ))  # fmt: skip
    found: list[list[int]] = []
    for start, depths in ((0, steps.plan.depths), (CUT_AFTER, _depths_after(setup))):
        found.append([])
        for look in LOOKS:
            steps.to((start + look) / HZ)
            found[-1].append(_count(steps.world.cells, np.array(depths)))
    return found


def _count(cells: Any, shortest: Any) -> int:
    parent = cells["parent"]
    dist = cells["dist"][np.arange(len(shortest)), np.maximum(parent, 0)] + 1
    return int(((parent == NONE) | (dist > shortest)).sum())


def _depths_after(setup: str) -> list[int]:
    """Shortest ways without interface 1."""
    first = scenario.load(setup).model.interface[0]
    left = [("interface", [{"row": first.row, "column": first.column}]), ("event", [])]
    depths: list[int] = scenario.plan(scenario.load(setup, left)).depths
    return depths


def judge(setup: str, cells: int, got: Measured) -> Claim:
    """Does the wave mode with M = 1 leave longer ways, as the printed rule does?"""
    words = []
    for variant in VARIANTS:
        found = np.array(got[point(setup, variant, got.quick)])  # skin, occasion, look
        after_start, after_cut = (found[:, :, 0] > 0).sum(axis=0)
        number = f"M = {variant.m}" if variant.m else "M = 3"
        words.append(f"{variant.rule} {variant.updates} {number}: {after_start}, {after_cut}")
    wave = np.array(got[point(setup, WAVE, got.quick)])
    return beyond(
        f"wave with M = 1 leaves no cell on a longer way, {cells} cells (E26)",
        f"skins of {len(wave)} with a longer way {LOOKS[0]} periods after start-up, after the cut: "
        + joined(words),
        verdict(NOBODY.has(*wave.ravel())),
        "E26: with M = 1 a nearer neighbour whose number always comes later stays forbidden until "
        "the phases have drifted; numbers that travel as a wave come by the shortest way first",
    )
