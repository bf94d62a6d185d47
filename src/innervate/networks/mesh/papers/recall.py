"""Section 1.1: how much of the network a discovery round finds, by reading and by jitter."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from innervate.networks.mesh.analysis.summary import summarize
from innervate.networks.mesh.papers.testbed import MeshTestbed, seeds_of
from innervate.papers import drawing
from innervate.papers.experiment import Claim, Claims, Measured, Point, verdict
from innervate.papers.words import joined, percent
from innervate.plot import style

TITLE = "1.1: what a discovery round finds"
CAPTION = (
    "Mean degree 8; shaded: from the worst network to the best. Recall: share of the good links "
    "that the gateway knows after its first round."
)
USUAL_MS = 100
SOME_MS = (1, 10, 100)
# Readings of "responds to the request", and why they come out as they do.
READINGS = {
    "tree": "once a round",
    "each": "to every request",
    "list": "once, with all it hears",
}
WHY = {
    "tree": "A1: a tree has N - 1 links of about 4 N; Dijkstra has nothing to choose from",
    "each": "A1: the responses collide, and each climbs to the gateway on its own",
    "list": "A1: one response a node names all neighbours that were heard",
}


def jitters(quick: bool) -> tuple[int, ...]:
    """Longest wait before a request is repeated, ms."""
    return SOME_MS if quick else (1, 2, 5, 10, 20, 50, 100, 200)


def sizes(quick: bool) -> tuple[int, ...]:
    """Sizes of the networks, in nodes."""
    return (10, 20, 30) if quick else (10, 20, 30, 45, 60)


def point(quick: bool, reading: str, jitter_ms: int = USUAL_MS, nodes: int = 30) -> Point:
    """Networks that run one discovery round of a reading, and send nothing."""
    protocol = (("discovery", reading), ("jitter_s", jitter_ms / 1000))
    return MeshTestbed(nodes, protocol=protocol, duration_s=8.0).point(
        "round", seeds_of(quick), measure
    )


def points(quick: bool) -> list[Point]:
    """Readings over the jitter, and over the size."""
    made = [point(quick, reading, ms) for reading in READINGS for ms in jitters(quick)]
    others = [n for n in sizes(quick) if n != 30]
    return made + [point(quick, reading, nodes=n) for reading in READINGS for n in others]


def measure(of: MeshTestbed, seed: int) -> dict[str, Any]:
    """What the first round found of the links, and what it cost in airtime and time."""
    found = summarize(of.run(seed))["discovery"]
    return {name: found[name] for name in ("recall", "airtime_s", "with_tables")}


def told(got: Measured, name: str, reading: str, *case: int, **more: int) -> Any:
    """A number of every network."""
    return got[point(got.quick, reading, *case, **more)][name]


def draw(got: Measured) -> Figure:
    """Recall over the jitter, over the size; airtime of a round."""
    figure, axes = style.panels(style.WIDE_IN, 2.8, 1, 3)
    ms, ns = jitters(got.quick), sizes(got.quick)
    for i, reading in enumerate(READINGS):
        _line(axes[0], i, ms, [told(got, "recall", reading, one) for one in ms])
        _line(axes[1], i, ns, [told(got, "recall", reading, nodes=n) for n in ns])
        spent = [np.mean(told(got, "airtime_s", reading, nodes=n)) for n in ns]
        axes[2].plot(ns, spent, **drawing.look(i))
    axes[0].set_xscale("log")
    axes[0].set_xticks(SOME_MS, [str(ms) for ms in SOME_MS])
    axes[0].set(xlabel="jitter of requests (ms)", title="a  30 nodes")
    axes[1].set(xlabel="nodes N", title=f"b  {USUAL_MS} ms")
    for ax in axes[:2]:
        ax.set(ylim=(0, 1.04), ylabel="links found (recall)")
    axes[2].set(yscale="log", xlabel="nodes N", ylabel="airtime of all together (s)",
                title="c  what a round costs")  # fmt: skip
    drawing.legend(figure, axes[0], ncols=3)
    return figure


def _line(ax: Axes, i: int, x: Any, found: list[list[float]]) -> None:
    reading = list(READINGS)[i]
    low, high = ([end(values) for values in found] for end in (min, max))
    ax.fill_between(x, low, high, color=style.SERIES[i], alpha=0.15, lw=0)
    ax.plot(x, [np.mean(values) for values in found], label=f"{reading}: {READINGS[reading]}",
            **drawing.look(i))  # fmt: skip


def judge(got: Measured) -> Claims:
    """The three readings; the text's silence on jitter; what it costs."""
    for reading, words in READINGS.items():
        recalls = told(got, "recall", reading)
        without = sum(count < 30 for count in told(got, "with_tables", reading))
        yield Claim(
            "1.1",
            '"responds to the request by sending a response packet to the node from which the '
            f'request came", {words} ({reading}): the gateway knows the graph (recall 0.98)',
            f"recall {np.mean(recalls):.3f} in the mean, {min(recalls):.3f} to {max(recalls):.3f}; "
            f"{without} of {len(recalls)} networks had nodes without a table",
            verdict(np.mean(recalls) >= 0.98, *(["A1"] if reading == "list" else [])),
            WHY[reading],
        )
    soon = [ms for ms in jitters(got.quick) if ms <= 5]
    means = [float(np.mean(told(got, "recall", "list", ms))) for ms in soon]
    yield Claim(
        "1.1",
        '"broadcasts the same discovery request packet": at once, or within a few ms, is good '
        "enough",
        joined(f"{ms} ms: recall {mean:.3f}" for ms, mean in zip(soon, means, strict=True))
        + f"; {USUAL_MS} ms: {np.mean(told(got, 'recall', 'list')):.3f} (list)",
        verdict(min(means) >= 0.98),
        "neighbours that heard the same request repeat it at the same time: nobody hears either",
    )
    spent = {reading: float(np.mean(told(got, "airtime_s", reading))) for reading in READINGS}
    yield Claim(
        "1.1",
        "to respond to every request costs little more than to respond once",
        joined(f"{reading} {value:.2f} s" for reading, value in spent.items())
        + f" on the air in a round of 30 nodes; each is {spent['each'] / spent['list']:.1f} times "
        "list",
        verdict(spent["each"] < 1.5 * spent["list"]),
        f"A1: as many responses as links; {percent(spent['each'] / 10)} of a period of 10 s",
    )
