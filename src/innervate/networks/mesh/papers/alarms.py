"""Sections 2.1 and 2.2: how soon the monitor knows of a crossing, and how far the robot got."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.figure import Figure

from innervate.networks.mesh.papers import crossing
from innervate.networks.mesh.papers.crossing import BOTH, DOCUMENT, ROUTED, Scheme
from innervate.networks.mesh.scenario.profiles import FAST
from innervate.papers import drawing
from innervate.papers.experiment import Claim, Claims, Measured, Point, verdict
from innervate.plot import style

TITLE = "2.1, 2.2: a robot crosses the fence"
CAPTION = (
    "A robot walks straight out of a fence of 70 m x 70 m at 1 m/s; 8 of 28 other nodes die 0.1 s "
    "before. Share of crossings that took longer; dotted: what was asked for at 1 %. Of the flood "
    "its first copy at the monitor is shown, sent beside the routed one."
)
DEAD = (0, 8)
WORST = 8
OURS = (ROUTED, BOTH, crossing.GRAPH_ROUTED, crossing.GRAPH_BOTH)
SCHEMES = (ROUTED, BOTH, crossing.GRAPH_ROUTED, crossing.GRAPH_BOTH, DOCUMENT)
MS, METRES = 70, 0.15
ALARM_BYTES = 31  # with a path of two


def air_ms() -> float:
    """A frame of an alarm, its turnaround and mean backoff: the least that a hop takes."""
    backoff_us = FAST.backoff_us * 7 / 2
    frame_us = (FAST.phy_bytes + ALARM_BYTES) * FAST.byte_ns / 1000
    return (backoff_us + FAST.turnaround_us + frame_us) / 1000


def points(quick: bool) -> list[Point]:
    """Every scheme without and with dead nodes."""
    return [crossing.point(scheme, k, quick) for scheme in SCHEMES for k in DEAD]


def draw(got: Measured) -> Figure:
    """Latency without and with dead nodes; overrun."""
    figure, axes = style.panels(style.WIDE_IN, 2.9, 1, 3, sharey=True)
    columns = ("a  nobody dead", 0, "ms"), ("b  8 dead", 8, "ms"), (
        f"c  overrun at 1 m/s, {WORST} dead", WORST, "overrun_m"
    )  # fmt: skip
    for ax, (title, dead, name) in zip(axes, columns, strict=True):
        for i, scheme in enumerate(SCHEMES):
            _curve(ax, crossing.told(got, scheme, dead)[name], i, scheme.name)
        if name == "ms":
            flooded = crossing.told(got, BOTH, dead)["flood_ms"]
            _curve(ax, flooded, len(SCHEMES), "flooded copies alone")
            ax.axvline(MS, color=style.INK, lw=0.8, ls=":")
            ax.set(xscale="log", xlim=(2, 4000), xlabel="from alarm to monitor (ms)")
        ax.set_title(title)
    axes[2].axvline(METRES, color=style.INK, lw=0.8, ls=":", label="asked for, 99 %")
    axes[2].set(xscale="log", xlim=(0.005, 6), xlabel="outside when the monitor knows (m)")
    axes[0].set(ylabel="crossings slower (%)", yscale="log", ylim=(0.3, 110))
    axes[0].set_yticks((1, 10, 100), ("1", "10", "100"))
    drawing.legend(figure, axes, ncols=4)
    return figure


def _curve(ax: Any, values: Any, i: int, label: str) -> None:
    """The share of values above x: its tail is what counts."""
    how = {"color": style.SERIES[i], "ls": style.DASHES[i % 4], "lw": 1}
    drawing.tail(ax, np.sort(values), label=label, **how)


def in_words(values: Any, unit: str, digits: int) -> str:
    """Median and 99th percentile of the finite values, as "1.2 / 3.4 ms"."""
    p50, p99 = np.percentile(values[np.isfinite(values)], (50, 99))
    return f"{p50:.{digits}f} / {p99:.{digits}f} {unit}"


def judge(got: Measured) -> Claims:
    """The document's two metrics; ours; what is left."""
    yield _within(got, ROUTED, 0, "2.1", '"Our design is optimized for low latency thanks to the '
                  f'routing by next hop tables": nobody dead, 99 % within {MS} ms and '
                  f"{METRES:g} m")  # fmt: skip
    yield _within(
        got, DOCUMENT, 0, "2.1",
        "the same with the document's own rule, where a lost frame is taken for a death",
        "one transmission a hop: a lost frame costs an end-to-end timeout of 250 ms or more",
    )  # fmt: skip
    yield _within(
        got, DOCUMENT, WORST, "2.2",
        '"the fence crossing event delivery must happen even if some intermediate nodes '
        "malfunctioned\", by the document's rule",
        "it does happen, as alarms are repeated until they are acknowledged, but too late",
    )  # fmt: skip
    for scheme in OURS:
        claim = f"{scheme.name}: all alarms with {WORST} unknown dead, 99 % within {MS} ms and "
        yield _within(
            got, scheme, WORST, "beyond", f"{claim}{METRES:g} m",
            "every dead hop costs three transmissions and their waits, one after the other",
        )  # fmt: skip
    yield _flood(got)
    yield _floor(got)


def _within(
    got: Measured, scheme: Scheme, dead: int, figure: str, claim: str, why: str = ""
) -> Claim:
    """All come, and 99 % in time; ours need a reason only where they do not."""
    runs = crossing.told(got, scheme, dead)
    over, came = runs["overrun_m"], int(runs["came"].sum())
    late = np.percentile(over, 99)
    good = bool(runs["came"].all() and np.percentile(runs["ms"], 99) <= MS and late <= METRES)
    measured = (
        f"{scheme.name}, {dead} dead: {came} of {len(over)}, {in_words(runs['ms'], 'ms', 1)}, "
        f"overrun {in_words(over, 'm', 3)}"
    )
    return Claim(figure, claim, measured, verdict(good), "" if good and scheme in OURS else why)


def _flood(got: Measured) -> Claim:
    runs = crossing.told(got, BOTH, WORST)
    first = runs["flood_ms"]
    routed, both = (
        np.percentile(crossing.told(got, scheme, WORST)["ms"], 99) for scheme in (ROUTED, BOTH)
    )
    return Claim(
        "beyond",
        "a flood beside the routed alarm shortens the tail and costs nothing in the median",
        f"{WORST} dead: 99 % {routed:.1f} ms routed alone, {both:.1f} ms both; flooded copies "
        f"alone {in_words(first, 'ms', 1)}, {sum(np.isfinite(first))} of {len(first)} came; the "
        f"flood won {int(runs['by_flood'].sum())} times",
        verdict(both < routed),
        "a flood needs no table and no ack; the routed copy is what is acknowledged",
    )


def _floor(got: Measured) -> Claim:
    runs = crossing.told(got, BOTH, WORST)
    came = runs["came"] > 0
    hops, over = runs["hops"][came], runs["overrun_m"][came]
    each = runs["ms"][came] / hops
    sample = 0.02  # m, at 1 m/s and 50 Hz
    return Claim(
        "beyond",
        "what is left is the air: a sample, then a frame and its backoff for every hop",
        f"{np.median(each):.1f} ms a hop in the median, {hops.mean():.1f} hops, at most "
        f"{hops.max():.0f}; a frame with its turnaround and mean backoff is {air_ms():.1f} ms; of "
        f"{np.median(over):.3f} m overrun up to {sample:g} m is the time between two samples",
        verdict(np.median(each) < 1.5 * air_ms()),
        "shorter is only a faster radio, more samples, or PREDICT, which comes 0.5 s before",
    )
