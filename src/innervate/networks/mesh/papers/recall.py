"""Section 1.1: how much of the network a discovery round finds, by reading and by jitter."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from innervate.networks.mesh.analysis.summary import summarize
from innervate.networks.mesh.papers.testbed import MeshTestbed
from innervate.networks.mesh.papers.words import joined, percent, seeds_of
from innervate.papers.experiment import Claim, Experiment, Point, Results, verdict
from innervate.plot import style

READINGS = ("tree", "each", "list")
JITTERS_MS = (1, 2, 5, 10, 20, 50, 100, 200)
SOME_MS = (1, 10, 100)
USUAL_MS = 100
NODES = (10, 20, 30, 45, 60)
SMALL = (10, 20, 30)
WORDS = {"tree": "once a round", "each": "to every request", "list": "once, with all it hears"}


def make_testbed(reading: str, jitter_ms: int = USUAL_MS, nodes: int = 30) -> MeshTestbed:
    """Networks that run one discovery round of a reading, and send nothing."""
    protocol = (("discovery", reading), ("jitter_s", jitter_ms / 1000))
    return MeshTestbed(nodes=nodes, protocol=protocol, duration_s=8.0)


def measure(of: MeshTestbed, seed: int) -> dict[str, Any]:
    """What the first round found of the links, and what it cost in airtime and time."""
    found = summarize(of.run(seed))["discovery"]
    return {name: found[name] for name in ("recall", "airtime_s", "with_tables", "tables_s")}


def _settings(quick: bool) -> list[MeshTestbed]:
    jitters = SOME_MS if quick else JITTERS_MS
    made = [make_testbed(reading, ms) for reading in READINGS for ms in jitters]
    made += [make_testbed(reading, nodes=n) for reading in READINGS for n in _ns(quick) if n != 30]
    return made


def _ns(quick: bool) -> tuple[int, ...]:
    return SMALL if quick else NODES


def points(quick: bool) -> list[Point]:
    """Readings over the jitter, and over the size."""
    return [one.point("round", seeds_of(quick), measure) for one in _settings(quick)]


def told(results: Results, of: MeshTestbed, quick: bool, name: str) -> list[Any]:
    """A number of every network."""
    return [run[name] for run in results[of.key_of("round", seeds_of(quick))]]


def draw(results: Results, quick: bool) -> Figure:
    """Recall over the jitter, over the size; airtime of a round."""
    figure, axes = style.panels(style.WIDE_IN, 2.8, 1, 3)
    jitters = SOME_MS if quick else JITTERS_MS
    _lines(
        axes[0],
        results,
        quick,
        jitters,
        [[make_testbed(r, ms) for ms in jitters] for r in READINGS],
    )
    axes[0].set_xscale("log")
    axes[0].set_xticks(SOME_MS, [str(ms) for ms in SOME_MS])
    axes[0].set_xlabel("jitter of requests (ms)")
    axes[0].set_title("a  30 nodes")
    ns = _ns(quick)
    sizes = [[make_testbed(r, nodes=n) for n in ns] for r in READINGS]
    _lines(axes[1], results, quick, ns, sizes)
    axes[1].set_xlabel("nodes N")
    axes[1].set_title(f"b  {USUAL_MS} ms")
    for ax in axes[:2]:
        ax.set_ylim(0, 1.04)
        ax.set_ylabel("links found (recall)")
    for i, row in enumerate(sizes):
        spent = [np.mean(told(results, of, quick, "airtime_s")) for of in row]
        axes[2].plot(ns, spent, style.MARKERS[i], ls=style.DASHES[i], color=style.SERIES[i])
    axes[2].set_yscale("log")
    axes[2].set_xlabel("nodes N")
    axes[2].set_ylabel("airtime of all together (s)")
    axes[2].set_title("c  what a round costs")
    handles, labels = axes[0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside lower left", ncols=3)
    return figure


def _lines(
    ax: Axes, results: Results, quick: bool, x: Any, testbeds: list[list[MeshTestbed]]
) -> None:
    for i, (reading, row) in enumerate(zip(READINGS, testbeds, strict=True)):
        all_ = [told(results, of, quick, "recall") for of in row]
        mean = [float(np.mean(values)) for values in all_]
        ax.fill_between(x, [min(v) for v in all_], [max(v) for v in all_],
                        color=style.SERIES[i], alpha=0.15, lw=0)  # fmt: skip
        ax.plot(x, mean, style.MARKERS[i], ls=style.DASHES[i], color=style.SERIES[i],
                label=f"{reading}: {WORDS[reading]}")  # fmt: skip


def judge(results: Results, quick: bool) -> list[Claim]:
    """The three readings; the text's silence on jitter; what it costs."""
    return [
        *(_reading(results, quick, reading) for reading in READINGS),
        _at_once(results, quick),
        _cost(results, quick),
    ]


def _reading(results: Results, quick: bool, reading: str) -> Claim:
    recalls = told(results, make_testbed(reading), quick, "recall")
    without = sum(
        count < 30 for count in told(results, make_testbed(reading), quick, "with_tables")
    )
    why = {
        "tree": "A1: a tree has N - 1 links of about 4 N; Dijkstra has nothing to choose from",
        "each": "A1: the responses collide, and each climbs to the gateway on its own",
        "list": "A1: one response a node names all neighbours that were heard",
    }[reading]
    return Claim(
        "1.1",
        '"responds to the request by sending a response packet to the node from which the request '
        f'came", {WORDS[reading]} ({reading}): the gateway knows the graph (recall 0.98)',
        f"recall {np.mean(recalls):.3f} in the mean, {min(recalls):.3f} to {max(recalls):.3f}; "
        f"{without} of {len(recalls)} networks had nodes without a table",
        verdict(float(np.mean(recalls)) >= 0.98, *(["A1"] if reading == "list" else [])),
        why,
    )


def _at_once(results: Results, quick: bool) -> Claim:
    soon = [ms for ms in (SOME_MS if quick else JITTERS_MS) if ms <= 5]
    means = [
        float(np.mean(told(results, make_testbed("list", ms), quick, "recall"))) for ms in soon
    ]
    usual = np.mean(told(results, make_testbed("list"), quick, "recall"))
    return Claim(
        "1.1",
        '"broadcasts the same discovery request packet": at once, or within a few ms, is good '
        "enough",
        joined(f"{ms} ms: recall {mean:.3f}" for ms, mean in zip(soon, means, strict=True))
        + f"; {USUAL_MS} ms: {usual:.3f} (list)",
        verdict(min(means) >= 0.98),
        "neighbours that heard the same request repeat it at the same time: nobody hears either",
    )


def _cost(results: Results, quick: bool) -> Claim:
    spent = {
        r: float(np.mean(told(results, make_testbed(r), quick, "airtime_s"))) for r in READINGS
    }
    return Claim(
        "1.1",
        "to respond to every request costs little more than to respond once",
        joined(f"{reading} {value:.2f} s" for reading, value in spent.items())
        + f" on the air in a round of 30 nodes; each is {spent['each'] / spent['list']:.1f} times "
        "list",
        verdict(spent["each"] < 1.5 * spent["list"]),
        f"A1: as many responses as links; {percent(spent['each'] / 10)} of a period of 10 s",
    )


EXPERIMENT = Experiment(
    "recall",
    "1.1: what a discovery round finds",
    "Mean degree 8; shaded: from the worst network to the best. Recall: share of the good links "
    "that the gateway knows after its first round.",
    points,
    draw,
    judge,
)
