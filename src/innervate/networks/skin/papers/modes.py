"""Beyond the paper: recovery of periodic, triggered and wave updates against the detection floor.

A cell cannot act before the cut is detected, k periods on the mean. What comes after is news out
to the border of the cut-off part and a route back; its floor is the hops' latency alone.
"""

from typing import Any, NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from innervate.analysis.intervals import mean_interval
from innervate.networks.skin.papers import steady
from innervate.networks.skin.papers.common import Case, number
from innervate.papers.experiment import Claim, Claims, Measured, Point, Span, beyond, sized, verdict
from innervate.papers.words import joined
from innervate.plot import style

TITLE = "Beyond the paper: how fast can a skin recover?"
CAPTION = (
    "Cut of interface 1 at 250 Hz, rule feasible. Markers: mean; bars: 5 to 95 % of all seeds; "
    "black: asked for of waves at k = 3."
)
HZ = 250
KS = (2, 3, 4, 5)
# Setup, cells, depth of the cut-off part between the interfaces, most ms asked for at k = 3.
SKINS = (("setup-1", 99, 7, 18.0), ("setup-8", 204, 10, 20.0))
LATENCY_MS = 0.12  # mean of 80..160 us a hop, time on the wire included
FROM_FLOOR_MS = Span(-2.0, 2.0)
SOONER_MS = Span(0.1)
GAP_US = 60  # the time a frame takes on the wire
seeds = sized(6, 100)  # of the recoveries of each setting


class Mode(NamedTuple):
    """How cells send: updates, M (0 = min(k, 5)), least time between two beacons."""

    name: str
    updates: str
    m: int = 0
    gap_us: int = -1


PERIODIC = Mode("periodic (the paper)", "periodic")
TRIGGERED = Mode("triggered", "triggered")
WAVE = Mode("wave", "wave")
CLOSE = Mode(f"wave, gap {GAP_US} µs", "wave", gap_us=GAP_US)
OFTEN = Mode("wave, M = 1", "wave", m=1)
DRAWN = (PERIODIC, TRIGGERED, WAVE, CLOSE)
MODES = (*DRAWN, OFTEN)


def case(setup: str, k: int, mode: Mode) -> Case:
    """The case of one setting: a mode's updates under the rule `feasible`."""
    return Case(setup, HZ, k, "feasible", mode.updates, mode.m, gap_us=mode.gap_us)


def points(quick: bool) -> list[Point]:
    """Recoveries of all modes, and steady routes at k = 3."""
    made = [case(setup, k, mode) for setup, *_ in SKINS for k in KS for mode in MODES]
    settled = [steady.point(setup, v, quick) for setup, *_ in SKINS for v in steady.VARIANTS]
    return [one.point(seeds(quick)) for one in made] + settled


def time_ms(got: Measured, setup: str, k: int, mode: Mode, name: str = "routed_ms") -> Any:
    """Time until every reachable cell has a route again, of every seed."""
    one = case(setup, k, mode)
    return one.periods(got, seeds(got.quick), name) * one.period_ms


def after_detection(got: Measured, setup: str, k: int, mode: Mode) -> float:
    """The same from the moment of detection on, mean in ms."""
    routed, detected = (time_ms(got, setup, k, mode, name) for name in ("routed_ms", "detected_ms"))
    return float((routed - detected).mean())


def floor_ms(k: int, depth: int) -> float:
    """Mean detection, and the latency of the hops out and back along the path."""
    return k * 1e3 / HZ + 2 * (depth - 1) * LATENCY_MS


def draw(got: Measured) -> Figure:
    """One panel a skin: mean and 5 to 95 % of all seeds over k."""
    figure, axes = style.panels(style.WIDE_IN, 3.0, 1, 2, sharey=True)
    for ax, letter, (setup, cells, depth, bar) in zip(axes, "ab", SKINS, strict=True):
        _panel(ax, got, setup, depth)
        ax.plot([2.55, 3.45], [bar, bar], color=style.BLACK, lw=1.6, label=f"asked for: {bar:g} ms")
        ax.set_title(f"{letter}  {number(setup)}, {cells} cells")
        ax.legend(loc="upper left", ncols=2, columnspacing=1)
        ax.set_xticks(KS, [f"k = {k}" for k in KS])
        ax.grid(axis="x", visible=False)
    axes[0].set(ylabel="until every cell has a route (ms)", ylim=(0, 95))
    return figure


def _panel(ax: Axes, got: Measured, setup: str, depth: int) -> None:
    for i, mode in enumerate(DRAWN):
        for k in KS:
            found = time_ms(got, setup, k, mode)
            x = k + 0.17 * (i - 1.5)
            ax.plot([x, x], np.percentile(found, [5, 95]), color=style.SERIES[i], lw=1)
            ax.plot(x, found.mean(), style.MARKERS[i], color=style.SERIES[i],
                    label=mode.name if k == 2 else None)  # fmt: skip
    for k in KS:
        edges = [k - 0.42, k + 0.42]
        ax.fill_between(edges, 0, k * 1e3 / HZ, color=style.FAINT, lw=0, zorder=0,
                        label="detection, k periods" if k == 2 else None)  # fmt: skip
        ax.plot(edges, [floor_ms(k, depth)] * 2, color=style.SOFT, lw=0.9, ls="--",
                label="floor: and latency out, back" if k == 2 else None)  # fmt: skip


def judge(got: Measured) -> Claims:
    """The bar of the wave mode, the floor, modes compared, M = 1."""
    for setup, cells, _, bar in SKINS:
        found = time_ms(got, setup, 3, WAVE)
        mean = mean_interval(found.tolist())
        yield beyond(
            f"wave, 250 Hz, k = 3, {cells} cells: all routed again in {bar:g} ms on the mean "
            "(asked for)",
            f"{mean.value:.2f} ms (95 % interval {mean.low:.2f} to {mean.high:.2f}, worst "
            f"{found.max():.1f}) of {len(found)} recoveries",
            verdict(Span(high=bar).has(mean.value)),
            "the paper's periodic updates take 40 to 50 ms",
        )
    for setup, cells, depth, _ in SKINS:
        yield _floor(got, setup, cells, depth)
    for setup, cells, *_ in SKINS:
        means = {mode: float(time_ms(got, setup, 3, mode).mean()) for mode in MODES}
        yield beyond(
            f"{cells} cells, k = 3: triggered is faster than periodic, wave faster than both",
            joined(f"{mode.name} {ms:.1f} ms" for mode, ms in means.items()),
            verdict(means[PERIODIC] > means[TRIGGERED] > means[WAVE]),
        )
    yield _sooner(got)
    for setup, cells, *_ in SKINS:
        yield steady.judge(setup, cells, got)


def _floor(got: Measured, setup: str, cells: int, depth: int) -> Claim:
    above = {mode: [after_detection(got, setup, k, mode) for k in KS] for mode in (WAVE, CLOSE)}
    least = 2 * (depth - 1) * LATENCY_MS
    words = joined(
        f"{mode.name}: detection + {min(ms):.2f} to {max(ms):.2f} ms" for mode, ms in above.items()
    )
    return beyond(
        f"wave, {cells} cells: within 2 ms of the floor, which is detection (k periods) and "
        f"{least:.1f} ms of latency out and back",
        f"{words}, k {joined(KS)}",
        verdict(FROM_FLOOR_MS.has(*(ms - least for ms in above[WAVE]))),
        f"what is left above the floor is the gap of 0.5 ms between two beacons of a cell; with a "
        f"gap of {GAP_US} µs all are routed after {time_ms(got, setup, 3, CLOSE).mean():.2f} ms at "
        f"k = 3 (floor {floor_ms(3, depth):.1f} ms). Below it only a smaller k or more beacons "
        "lead",
    )


def _sooner(got: Measured) -> Claim:
    gains = [after_detection(got, setup, k, WAVE) - after_detection(got, setup, k, OFTEN)
             for setup, *_ in SKINS for k in KS]  # fmt: skip
    return beyond(
        f"wave with M = 1 recovers sooner than with M = min(k, 5) (at least {SOONER_MS.low:g} ms)",
        f"{min(gains):+.2f} to {max(gains):+.2f} ms sooner, k {joined(KS)}, 99 and 204 cells",
        verdict(SOONER_MS.has(min(gains))),
        "detection takes longer than a number: by then a newer one has come from the other side",
    )
