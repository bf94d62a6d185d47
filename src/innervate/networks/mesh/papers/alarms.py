"""Sections 2.1 and 2.2: how soon the monitor knows of a crossing, and how far the robot got."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from innervate.networks.mesh.papers import crossing
from innervate.networks.mesh.papers.crossing import (
    BOTH,
    DOCUMENT,
    GRAPH_BOTH,
    GRAPH_ROUTED,
    ROUTED,
    Scheme,
)
from innervate.networks.mesh.scenario.profiles import FAST
from innervate.papers.experiment import Claim, Experiment, Point, Results, verdict
from innervate.plot import style

DEAD = (0, 8)
WORST = 8
SCHEMES = (ROUTED, BOTH, GRAPH_ROUTED, GRAPH_BOTH, DOCUMENT)
MS, METRES = 70, 0.15
ALARM_BYTES = 31  # with a path of two


def seeds_of(quick: bool) -> range:
    """One crossing each; a 99th percentile wants 300, and a few robots are cut off."""
    return range(1, 21 if quick else 401)


def air_ms() -> float:
    """A frame of an alarm, its turnaround and mean backoff: the least that a hop takes."""
    backoff_us = FAST.backoff_us * 7 / 2
    frame_us = (FAST.phy_bytes + ALARM_BYTES) * FAST.byte_ns / 1000
    return (backoff_us + FAST.turnaround_us + frame_us) / 1000


def points(quick: bool) -> list[Point]:
    """Every scheme without and with dead nodes."""
    return [crossing.point(scheme, k, seeds_of(quick)) for scheme in SCHEMES for k in DEAD]


def _runs(results: Results, scheme: Scheme, dead: int, quick: bool) -> list[dict[str, Any]]:
    return crossing.told(results, scheme, dead, seeds_of(quick))


def waits(runs: list[dict[str, Any]], name: str = "ms") -> Any:
    """Milliseconds until the monitor knew; infinite where it never did."""
    return np.sort([np.inf if run[name] is None else run[name] for run in runs])


def draw(results: Results, quick: bool) -> Figure:
    """Latency without and with dead nodes; overrun."""
    figure, axes = style.panels(style.WIDE_IN, 2.9, 1, 3, sharey=True)
    for ax, dead, letter in zip(axes, DEAD, "ab", strict=False):
        for i, scheme in enumerate(SCHEMES):
            _curve(ax, waits(_runs(results, scheme, dead, quick)), i, scheme.name)
        flooded = waits(_runs(results, BOTH, dead, quick), "flood_ms")
        _curve(ax, flooded, len(SCHEMES), "flooded copies alone")
        ax.axvline(MS, color=style.INK, lw=0.8, ls=":")
        ax.set_xscale("log")
        ax.set_xlim(2, 4000)
        ax.set_xlabel("from alarm to monitor (ms)")
        ax.set_title(f"{letter}  {dead} dead" if dead else f"{letter}  nobody dead")
    for i, scheme in enumerate(SCHEMES):
        far = np.sort([run["overrun_m"] for run in _runs(results, scheme, WORST, quick)])
        _curve(axes[2], far, i, scheme.name)
    axes[2].axvline(METRES, color=style.INK, lw=0.8, ls=":", label="asked for, 99 %")
    axes[2].set_xscale("log")
    axes[2].set_xlim(0.005, 6)
    axes[2].set_xlabel("outside when the monitor knows (m)")
    axes[2].set_title(f"c  overrun at 1 m/s, {WORST} dead")
    axes[0].set_ylabel("crossings slower (%)")
    axes[0].set_yscale("log")
    axes[0].set_ylim(0.3, 110)
    axes[0].set_yticks((1, 10, 100), ("1", "10", "100"))
    found = {}
    for ax in axes:
        found.update(dict(zip(*reversed(ax.get_legend_handles_labels()), strict=True)))
    figure.legend(found.values(), found.keys(), loc="outside lower left", ncols=4)
    return figure


def _curve(ax: Axes, values: Any, i: int, label: str) -> None:
    """The share of values above x: its tail is what counts."""
    share = 100 * (1 - np.arange(len(values)) / len(values))
    ax.step(values, share, where="pre", color=style.SERIES[i], ls=style.DASHES[i % 4],
            lw=1, label=label)  # fmt: skip


def in_words(values: Any, unit: str, digits: int) -> str:
    """Median and 99th percentile of the finite values, as "1.2 / 3.4 ms"."""
    known = values[np.isfinite(values)]
    p50, p99 = np.percentile(known, (50, 99))
    return f"{p50:.{digits}f} / {p99:.{digits}f} {unit}"


def _line(results: Results, scheme: Scheme, dead: int, quick: bool) -> str:
    runs = _runs(results, scheme, dead, quick)
    came = sum(run["came"] for run in runs)
    over = np.array([run["overrun_m"] for run in runs])
    return (
        f"{scheme.name}, {dead} dead: {came} of {len(runs)}, {in_words(waits(runs), 'ms', 1)}, "
        f"overrun {in_words(over, 'm', 3)}"
    )


def _good(results: Results, scheme: Scheme, dead: int, quick: bool) -> bool:
    runs = _runs(results, scheme, dead, quick)
    late = np.percentile([run["overrun_m"] for run in runs], 99)
    come = all(run["came"] for run in runs)
    return bool(come and np.percentile(waits(runs), 99) <= MS and late <= METRES)


def judge(results: Results, quick: bool) -> list[Claim]:
    """The document's two metrics; ours; what is left."""
    return [
        Claim(
            "2.1",
            '"Our design is optimized for low latency thanks to the routing by next hop tables": '
            f"nobody dead, 99 % within {MS} ms and {METRES:g} m",
            _line(results, ROUTED, 0, quick),
            verdict(_good(results, ROUTED, 0, quick)),
        ),
        Claim(
            "2.1",
            "the same with the document's own rule, where a lost frame is taken for a death",
            _line(results, DOCUMENT, 0, quick),
            verdict(_good(results, DOCUMENT, 0, quick)),
            "one transmission a hop: a lost frame costs an end-to-end timeout of 250 ms or more",
        ),
        Claim(
            "2.2",
            '"the fence crossing event delivery must happen even if some intermediate nodes '
            "malfunctioned\", by the document's rule",
            _line(results, DOCUMENT, WORST, quick),
            verdict(_good(results, DOCUMENT, WORST, quick)),
            "it does happen, as alarms are repeated until they are acknowledged, but too late",
        ),
        *(
            Claim(
                "beyond",
                f"{scheme.name}: all alarms with {WORST} unknown dead, 99 % within {MS} ms and "
                f"{METRES:g} m",
                _line(results, scheme, WORST, quick),
                verdict(_good(results, scheme, WORST, quick)),
                ""
                if _good(results, scheme, WORST, quick)
                else "every dead hop costs three "
                "transmissions and their waits, one after the other",
            )
            for scheme in (ROUTED, BOTH, GRAPH_ROUTED, GRAPH_BOTH)
        ),
        _flood(results, quick),
        _floor(results, quick),
    ]


def _flood(results: Results, quick: bool) -> Claim:
    runs = _runs(results, BOTH, WORST, quick)
    first = waits(runs, "flood_ms")
    by_flood = sum(run["by_flood"] for run in runs)
    routed, both = (
        np.percentile(waits(_runs(results, scheme, WORST, quick)), 99) for scheme in (ROUTED, BOTH)
    )
    return Claim(
        "beyond",
        "a flood beside the routed alarm shortens the tail and costs nothing in the median",
        f"{WORST} dead: 99 % {routed:.1f} ms routed alone, {both:.1f} ms both; flooded copies "
        f"alone {in_words(first, 'ms', 1)}, {sum(np.isfinite(first))} of {len(runs)} came; the "
        f"flood won {by_flood} times",
        verdict(both < routed),
        "a flood needs no table and no ack; the routed copy is what is acknowledged",
    )


def _floor(results: Results, quick: bool) -> Claim:
    runs = [run for run in _runs(results, BOTH, WORST, quick) if run["came"]]
    hops = np.array([run["hops"] for run in runs])
    each = np.array([run["ms"] for run in runs]) / hops
    over = np.array([run["overrun_m"] for run in runs])
    sample = 0.02  # m, at 1 m/s and 50 Hz
    return Claim(
        "beyond",
        "what is left is the air: a sample, then a frame and its backoff for every hop",
        f"{np.median(each):.1f} ms a hop in the median, {hops.mean():.1f} hops, at most "
        f"{hops.max()}; a frame with its turnaround and mean backoff is {air_ms():.1f} ms; of "
        f"{np.median(over):.3f} m overrun up to {sample:g} m is the time between two samples",
        verdict(np.median(each) < 1.5 * air_ms()),
        "shorter is only a faster radio, more samples, or PREDICT, which comes 0.5 s before",
    )


EXPERIMENT = Experiment(
    "alarms",
    "2.1, 2.2: a robot crosses the fence",
    "A robot walks straight out of a fence of 70 m x 70 m at 1 m/s; 8 of 28 other nodes die 0.1 s "
    "before. Share of crossings that took longer; dotted: what was asked for at 1 %. Of the flood "
    "its first copy at the monitor is shown, sent beside the routed one.",
    points,
    draw,
    judge,
)
