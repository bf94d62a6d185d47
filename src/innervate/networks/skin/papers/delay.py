"""III-A.1: the average delay of a packet on its way to the PC, which the paper gives as 6 ms."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from innervate.networks.skin.papers.common import planned
from innervate.networks.skin.protocol.constants import DATA, PORTS
from innervate.networks.skin.sim.simulate import simulate
from innervate.papers.experiment import Claim, Claims, Measured, Point, about, verdict
from innervate.papers.words import joined
from innervate.plot import style

SETUP = "setup-1"
BEACON_HZ = 250
SETTLED_S = 0.5
COUNTED_S = 0.5
TITLE = "III-A.1: delay from a cell to the PC"
CAPTION = f"Setup 1, {COUNTED_S:g} s after {SETTLED_S:g} s; nothing failing."
# Samples a second of each cell: what the interface ports take without loss, and more.
RATES_HZ = (10, 250, 320, 400)
SIX_MS = about(6.0)


def point(rate_hz: int, quick: bool) -> Point:
    """Runs at one rate of samples."""
    seeds = range(1, 2 if quick else 6)
    key = f"delay {SETUP} data {rate_hz} Hz, beacons {BEACON_HZ} Hz, seeds 1-{seeds[-1]}"
    return Point.of(key, 0.3 * len(seeds), measure, rate_hz, seeds)


def points(quick: bool) -> list[Point]:
    """A point for each rate of samples."""
    return [point(rate, quick) for rate in RATES_HZ]


def measure(rate_hz: int, seeds: Sequence[int]) -> dict[str, Any]:
    """Delay from a cell to the PC of all samples together (ms), how many, and the hop latency."""
    parts = []
    for seed in seeds:
        plan = planned(SETUP, seed, SETTLED_S + COUNTED_S, {"data.rate_hz": rate_hz},
                       updates="periodic", beacon_hz=BEACON_HZ)  # fmt: skip
        ways = _Ways(plan.graph)
        simulate(plan, tap=ways)
        parts.append(np.array(ways.took, float))
    delays = np.concatenate(parts) / 1e3
    return {
        "mean": float(delays.mean()),
        "percentiles": np.percentile(delays, range(0, 101, 2)).round(4).tolist(),
        "samples": len(delays),
        "hop_us": list(plan.latency_us),
    }


class _Ways:
    """When samples left their cells and came to the PC.

    `took`: us from a cell's wire to the PC, of the samples that left after the skin had settled.
    """

    def __init__(self, graph: Any) -> None:
        self.first_end = PORTS * graph.cells
        self.left: dict[tuple[int, int], int] = {}
        self.took: list[int] = []

    def __call__(self, rows: Any, frames: Any, until_us: int) -> None:
        data = (frames["kind"] == DATA) & (rows["why"] == 0)
        is_first = data & (rows["out"] == 1) & (frames["hops"] == 0)
        is_last = data & (rows["out"] == 0) & (rows["at"] >= self.first_end)
        for i in np.flatnonzero(is_first | is_last).tolist():
            sample = int(frames["cell"][i]), int(frames["seq"][i])
            time = int(rows["time"][i])
            if is_first[i]:
                self.left[sample] = time
            elif self.left.get(sample, 0) >= SETTLED_S * 1e6:
                self.took.append(time - self.left[sample])


def draw(got: Measured) -> Figure:
    """Share of the samples over their delay."""
    figure, (ax,) = style.panels(style.WIDE_IN, 2.6)
    for i, rate in enumerate(RATES_HZ):
        one = got[point(rate, got.quick)]
        shares = np.linspace(0, 100, len(one["percentiles"]))
        ax.plot(one["percentiles"], shares, color=style.SERIES[i], ls=style.DASHES[i],
                label=f"{rate} Hz: mean {one['mean']:.2f} ms")  # fmt: skip
    ax.axvline(6, color=style.BLACK, lw=1, ls="--", label="the paper's mean, 6 ms")
    ax.set(xlabel="delay from a cell to the PC (ms)", ylabel="samples (%)", ylim=(0, 101))
    ax.set_xlim(0, None)
    ax.legend(loc="center", title="samples a second and cell", title_fontsize=7)
    return figure


def judge(got: Measured) -> Claims:
    """The claim of an average delay of 6 ms, and what it takes a hop."""
    means = {rate: got[point(rate, got.quick)]["mean"] for rate in RATES_HZ}
    first = got[point(RATES_HZ[0], got.quick)]
    low, high = first["hop_us"]
    hops = first["mean"] / ((low + high) / 2e3)
    yield Claim(
        "III-A.1",
        f"an average delay of 6 ms in the network ({SIX_MS.low:g} to {SIX_MS.high:g}; setup 1, "
        f"{RATES_HZ[0]} samples a second and cell, hop latency {low} to {high} us)",
        joined(f"{mean:.2f} ms at {rate} Hz" for rate, mean in means.items())
        + f"; {first['samples']} samples at the first",
        verdict(SIX_MS.has(first["mean"])),
        f"a sample crosses {hops:.1f} hops on the mean; 6 ms would be "
        f"{6 / hops:.1f} ms a hop, ten times the time on the wire and more: the latency of the "
        "paper's cells is not published, and ours (timing.hop_latency_us) is a guess. The "
        "paper subtracts this delay from its convergence times; here they are read off the "
        "cells",
    )
