"""II-B.1: after switching on, all cells know a way to the PC within max(H) periods."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from innervate import scenario
from innervate.analysis.rows import unrouted_steps
from innervate.papers.experiment import Claim, Experiment, Point, Results, Span, verdict
from innervate.papers.skin.common import RULE_NAMES, RULES, joined, seeds_of
from innervate.plot import style
from innervate.protocol.skin_words import PORTS
from innervate.sim.simulate import simulate

SETUPS = tuple(f"setup-{i}" for i in range(1, 9))
HZ = 250
K = 3
PERIODS = 60
# Periods beyond max(H): our PC listens for k periods before its first beacon (E27), by which time
# its ports have been found broken, and a period goes by until they are taken back; and a hop's
# latency, 0.16 ms of a period of 4 ms.
WITHIN = Span(high=1.04)


def seeds(quick: bool, lock_step: bool) -> range:
    """Lock-step leaves nothing to chance but latencies."""
    return seeds_of((1 if lock_step else 2) if quick else (2 if lock_step else 20))


def _key(setup: str, rule: tuple[str, int], lock_step: bool, quick: bool) -> str:
    clocks = "lock-step" if lock_step else "free running"
    last = seeds(quick, lock_step)[-1]
    return f"start-up {setup} {rule[0]} m={rule[1]} {HZ} Hz k={K} {clocks}, seeds 1-{last}"


def points(quick: bool) -> list[Point]:
    """All setups, all rules; in lock-step and free running."""
    return [
        Point.of(
            _key(setup, rule, lock_step, quick),
            0.02 * len(seeds(quick, lock_step)),
            *(measure, setup, rule, lock_step, seeds(quick, lock_step)),
        )
        for rule in RULES
        for setup in SETUPS
        for lock_step in (True, False)
    ]


def measure(
    setup: str, rule: tuple[str, int], lock_step: bool, some: Sequence[int]
) -> dict[str, Any]:
    """Periods from the PC's first beacon until every cell has a route; the skin's depth."""
    overrides: list[tuple[str, Any]] = [
        ("protocol.rule", rule[0]),
        ("protocol.updates", "periodic"),
        ("protocol.beacon_hz", HZ),
        ("protocol.k", K),
        ("timing.lock_step", lock_step),
        ("data.rate_hz", 0),
        ("event", []),
        ("duration_s", PERIODS / HZ),
    ]
    if rule[1]:
        overrides.append(("protocol.m", rule[1]))
    found = []
    for seed in some:
        plan = scenario.plan(scenario.load(setup, overrides, seed))
        first = _First(PORTS * plan.graph.cells)
        steps = unrouted_steps(simulate(plan, tap=first))
        done = steps.time_us[-1] if steps.cells[-1] == 0 else np.nan
        found.append(float(done - first.time_us) * HZ / 1e6)
    return {"periods": found, "depth": plan.depth_max}


class _First:
    """Notes when the PC sent for the first time; `first_end` is its first port."""

    def __init__(self, first_end: int) -> None:
        self.first_end = first_end
        self.time_us = -1

    def __call__(self, rows: Any, frames: Any, until_us: int) -> None:
        if self.time_us < 0:
            sent = rows[(rows["at"] >= self.first_end) & (rows["out"] == 1)]
            if len(sent):
                self.time_us = int(sent["start"][0])


def beyond(results: Results, quick: bool, rule: tuple[str, int], lock_step: bool) -> Any:
    """Periods beyond max(H) of every start-up, all setups."""
    found = [results[_key(setup, rule, lock_step, quick)] for setup in SETUPS]
    return np.concatenate([np.array(one["periods"], float) - one["depth"] for one in found])


def draw(results: Results, quick: bool) -> Figure:
    """Each start-up over the depth of its skin."""
    figure, axes = style.panels(style.WIDE_IN, 2.7, 1, len(RULES), sharey=True)
    for ax, letter, rule in zip(axes, "abc", RULES, strict=True):
        for i, (lock_step, name) in enumerate(((True, "lock-step"), (False, "free running"))):
            for place, setup in enumerate(SETUPS):
                one = results[_key(setup, rule, lock_step, quick)]
                x = np.full(len(one["periods"]), place + 0.2 * (2 * i - 1))
                ax.plot(x, one["periods"], style.MARKERS[i], color=style.SERIES[i], ms=2.6,
                        label=name if place == 0 else None)  # fmt: skip
                ax.plot([place - 0.4, place + 0.4], [one["depth"]] * 2, color=style.BLACK, lw=1,
                        label="max(H)" if place == i == 0 else None)  # fmt: skip
        ax.set_xticks(range(len(SETUPS)), [setup[-1] for setup in SETUPS])
        ax.set_xlabel("setup")
        ax.set_title(f"{letter}  {RULE_NAMES[rule[0]]}")
        ax.grid(axis="x", visible=False)
    axes[0].set_ylabel("until all have a route (periods)")
    axes[0].set_ylim(0, None)
    figure.legend(*axes[0].get_legend_handles_labels(), loc="outside upper center", ncols=3)
    return figure


def judge(results: Results, quick: bool) -> list[Claim]:
    """Within max(H) periods of the PC's first beacon, for every rule."""
    return [_claim(results, quick, rule) for rule in RULES]


def _claim(results: Results, quick: bool, rule: tuple[str, int]) -> Claim:
    words, both = [], []
    for lock_step, name in ((True, "lock-step"), (False, "free running")):
        found = beyond(results, quick, rule, lock_step)
        both += found.tolist()
        words.append(
            f"{name}: max(H) {found.min():+.2f} to {found.max():+.2f} T, mean {found.mean():+.2f}, "
            f"{len(found)} start-ups"
        )
    return Claim(
        "II-B.1",
        f"{RULE_NAMES[rule[0]]}: after max(H) T all nodes know a route (setups 1-8; from the PC's "
        "first beacon; one period more because it listened before)",
        joined(words),
        verdict(WITHIN.has(*both), "E20", "E27"),
        "E20: in lock-step a hop takes a period, free running half of one on the mean; E27: the PC "
        "listens for k periods first, so its ports count as broken and are taken back a period "
        "later",
    )


EXPERIMENT = Experiment(
    "startup",
    "II-B.1: start-up",
    f"{HZ} Hz; time from the PC's first beacon until no cell is without a route. Line: max(H), the "
    "depth of the skin, in periods.",
    points,
    draw,
    judge,
)
