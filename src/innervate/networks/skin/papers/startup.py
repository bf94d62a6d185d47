"""II-B.1: after switching on, all cells know a way to the PC within max(H) periods."""

from itertools import product
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from innervate.networks.skin.analysis.rows import unrouted_steps
from innervate.networks.skin.papers import common
from innervate.networks.skin.papers.common import RULES, SETUPS, Rule
from innervate.networks.skin.protocol.constants import PORTS
from innervate.networks.skin.sim.simulate import simulate
from innervate.papers import drawing
from innervate.papers.experiment import Claim, Claims, Measured, Point, Span, verdict
from innervate.papers.words import joined
from innervate.plot import style

HZ = 250
K = 3
PERIODS = 60
TITLE = "II-B.1: start-up"
CAPTION = (
    f"{HZ} Hz; time from the PC's first beacon until no cell is without a route. Line: max(H), the "
    "depth of the skin, in periods."
)
CLOCKS = {True: "lock-step", False: "free running"}
# Periods beyond max(H): our PC listens for k periods before its first beacon (E27), by which time
# its ports have been found broken, and a period goes by until they are taken back; and a hop's
# latency, 0.16 ms of a period of 4 ms.
WITHIN = Span(high=1.04)


def point(setup: str, rule: Rule, lock_step: bool, quick: bool) -> Point:
    """Start-ups; lock-step leaves nothing to chance but latencies."""
    what = f"start-up {setup} {rule.name} m={rule.m} {HZ} Hz k={K} {CLOCKS[lock_step]}"
    seeds = (1 if lock_step else 2) if quick else (2 if lock_step else 20)
    return Point.each(what, 0.02, seeds, measure, setup, rule, lock_step)


def points(quick: bool) -> list[Point]:
    """All setups, all rules; in lock-step and free running."""
    cases = product(RULES, SETUPS, CLOCKS)
    return [point(setup, rule, lock_step, quick) for rule, setup, lock_step in cases]


def measure(setup: str, rule: Rule, lock_step: bool, seed: int) -> dict[str, Any]:
    """Periods from the PC's first beacon until every cell has a route; the skin's depth."""
    first_us: list[int] = []

    def note_first(rows: Any, frames: Any, until_us: int) -> None:
        sent = rows[(rows["at"] >= PORTS * plan.graph.cells) & (rows["out"] == 1)]
        if not first_us and len(sent):
            first_us.append(int(sent["start"][0]))

    more = {**common.SILENT, "timing.lock_step": lock_step}
    plan = common.planned(
        setup, seed, PERIODS / HZ, more, rule=rule.name, updates="periodic", beacon_hz=HZ, k=K,
        m=rule.m or None,
    )  # fmt: skip
    steps = unrouted_steps(simulate(plan, tap=note_first))
    done = steps.time_us[-1] if steps.cells[-1] == 0 else np.nan
    return {"periods": float(done - first_us[0]) * HZ / 1e6, "depth": plan.depth_max}


def draw(got: Measured) -> Figure:
    """Each start-up over the depth of its skin."""
    figure, first = common.rule_panels(2.7, lambda ax, rule: _panel(ax, got, rule))
    first.set(ylabel="until all have a route (periods)", ylim=(0, None))
    drawing.legend(figure, first, "upper center", ncols=3)
    return figure


def _panel(ax: Axes, got: Measured, rule: Rule) -> None:
    for i, (lock_step, name) in enumerate(CLOCKS.items()):
        for place, setup in enumerate(SETUPS):
            one = got[point(setup, rule, lock_step, got.quick)]
            x = np.full(len(one["periods"]), place + 0.2 * (2 * i - 1))
            ax.plot(x, one["periods"], style.MARKERS[i], color=style.SERIES[i], ms=2.6,
                    label=name if place == 0 else None)  # fmt: skip
            ax.plot([place - 0.4, place + 0.4], one["depth"][:1] * 2, color=style.BLACK, lw=1,
                    label="max(H)" if place == i == 0 else None)  # fmt: skip
    drawing.each_mode(ax, [setup[-1] for setup in SETUPS])
    ax.set_xlabel("setup")


def judge(got: Measured) -> Claims:
    """Within max(H) periods of the PC's first beacon, for every rule."""
    for rule in RULES:
        words, both = [], []
        for lock_step, name in CLOCKS.items():
            series = [point(setup, rule, lock_step, got.quick) for setup in SETUPS]
            off = [got.floats(one, "periods") - got.floats(one, "depth") for one in series]
            found = np.concatenate(off)
            both += found.tolist()
            words.append(
                f"{name}: max(H) {found.min():+.2f} to {found.max():+.2f} T, mean "
                f"{found.mean():+.2f}, {len(found)} start-ups"
            )
        yield Claim(
            "II-B.1",
            f"{rule.words}: after max(H) T all nodes know a route (setups 1-8; from the PC's "
            "first beacon; one period more because it listened before)",
            joined(words),
            verdict(WITHIN.has(*both), "E20", "E27"),
            "E20: in lock-step a hop takes a period, free running half of one on the mean; E27: "
            "the PC listens for k periods first, so its ports count as broken and are taken back "
            "a period later",
        )
