"""Section 2.1: are the tables' ways the shortest, and how often is there another next hop?"""

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from innervate.networks.mesh.papers.document import SHORTEST, beyond, said
from innervate.networks.mesh.papers.lossy import NONE, row_of
from innervate.networks.mesh.papers.testbed import MeshTestbed, seeds
from innervate.papers import drawing
from innervate.papers.experiment import Claims, Measured, Point, sized, verdict
from innervate.papers.words import joined, percent
from innervate.plot import style
from innervate.topology.placement import UNREACHABLE, distances, good_links, neighbours

TITLE = "2.1: shortest ways, and other ones"
CAPTION = (
    "30 nodes after one round. a: hops by the tables over hops of the shortest way, over all links "
    "loud enough to be reported, mean of all pairs that the tables connect; hollow: they do not "
    "connect all. b: what kind of neighbour an entry's alternate is."
)
READINGS = ("tree", "each", "list")
KINDS = ("around the next hop, too", "free of loops", "last resort", "none")
FILLS = (style.BLUE, style.SKY, style.ORANGE, style.FAINT)
degrees = sized((6, 8), (5, 6, 8, 10, 12))  # mean degrees of the networks


def point(reading: str, degree: int, quick: bool) -> Point:
    """One round and its tables."""
    testbed = MeshTestbed(degree=degree, protocol=(("discovery", reading),), duration_s=8.0)
    return testbed.point("ways by tables", seeds(quick), measure)


def points(quick: bool) -> list[Point]:
    """A point for each reading of discovery and mean degree."""
    return [point(reading, degree, quick) for reading in READINGS for degree in degrees(quick)]


def measure(of: MeshTestbed, seed: int) -> dict[str, Any]:
    """Every pair's way by the tables, and the alternates of every entry."""
    result = of.run(seed)
    plan, nodes = result.plan, range(result.plan.nodes)
    # Links loud enough to be reported both ways: what a perfect round would find. Good links are
    # 1 dB louder, so ways over them alone are a little longer; nodes know whole dBm.
    known = good_links(plan.radio.rssi_cdb, plan.nodes, 100 * plan.params["min_rssi"] - 50)
    near = neighbours(plan.nodes, known)
    far = [distances(near, node) for node in nodes]
    next_, alt = ([row_of(result, node, name) for node in nodes] for name in ("next", "alt"))
    bare = [all(way == NONE for way in row) for row in next_]
    stretches, apart, out = [], 0, 0
    kinds = [0] * len(KINDS)
    for a in nodes:
        for b in nodes:
            if a == b or far[a][b] == UNREACHABLE:
                continue
            hops = _hops(next_, a, b)
            if hops:
                stretches.append(hops / far[a][b])
            else:
                apart += 1
                out += bare[a] or bare[b]
            if next_[a][b] != NONE:
                kinds[_kind(far, a, b, next_[a][b], alt[a][b])] += 1
    return {"stretch": float(np.mean(stretches)), "p99": float(np.percentile(stretches, 99)),
            "broken": apart, "bare": out, "pairs": apart + len(stretches),
            "kinds": kinds}  # fmt: skip


def _hops(next_: list[list[int]], here: int, dest: int) -> int:
    """Hops from next hop to next hop; 0 = nobody knows on, or it goes round."""
    for hops in range(1, len(next_) + 1):
        here = next_[here][dest]
        if here in (dest, NONE):
            return hops if here == dest else 0
    return 0


def _kind(far: list[list[int]], node: int, dest: int, way: int, other: int) -> int:
    """Which of KINDS an alternate is [RFC 5286], by the true distances."""
    if other == NONE:
        return 3
    if far[other][dest] >= far[other][node] + far[node][dest]:
        return 2
    return 0 if far[other][dest] < far[other][way] + far[way][dest] else 1


def mean(got: Measured, reading: str, degree: int) -> float:
    """Hops by tables over hops of the shortest path, mean over all seeds."""
    return float(np.mean(got[point(reading, degree, got.quick)]["stretch"]))


def shares(got: Measured, reading: str, degree: int) -> Any:
    """Of all entries with a next hop, the share of each kind of alternate."""
    total = np.sum(got[point(reading, degree, got.quick)]["kinds"], axis=0)
    return total / total.sum()


def draw(got: Measured) -> Figure:
    """Stretch over the mean degree, and beside it what kinds of alternates there are."""
    figure, (left, right) = style.panels(style.WIDE_IN, 2.6, 1, 2, width_ratios=(1, 1.25))
    some = degrees(got.quick)
    for i, reading in enumerate(READINGS):
        y = [mean(got, reading, degree) for degree in some]
        left.plot(some, y, label=reading, **style.look(i))
        runs = [got[point(reading, degree, got.quick)] for degree in some]
        apart = [k for k, one in enumerate(runs) if any(one["broken"])]
        left.plot(some, y, markevery=apart, **style.look(i) | drawing.HOLLOW)
    left.axhline(1, color=style.INK, lw=0.6)
    left.set(xlabel="mean degree", ylabel="hops / shortest way", xticks=some,
             title="a  stretch of the tables' ways, by discovery")  # fmt: skip
    left.set_ylim(bottom=0.95)
    _kinds(right, got)
    drawing.legend(figure, left, ncols=3)
    drawing.legend(figure, right, "lower right", ncols=4)
    return figure


def _kinds(ax: Axes, got: Measured) -> None:
    bars = [(reading, degree) for reading in ("tree", "list") for degree in degrees(got.quick)]
    below = np.zeros(len(bars))
    found = np.array([100 * shares(got, *bar) for bar in bars])
    x = np.arange(len(bars)) + 0.7 * np.array([bar[0] == "list" for bar in bars])
    for part, name, colour in zip(found.T, KINDS, FILLS, strict=True):
        ax.bar(x, part, 0.8, bottom=below, color=colour, label=name)
        below += part
    ax.set_xticks(x, [str(degree) for _, degree in bars])
    ax.set(ylim=(0, 104), title="b  alternates")
    ax.set(xlabel="mean degree; left: discovery tree, right: list", ylabel="entries of tables (%)")


def judge(got: Measured) -> Claims:
    """Ways by every reading; alternates."""
    some = degrees(got.quick)
    for reading in READINGS:
        runs, value = got[point(reading, 8, got.quick)], mean(got, reading, 8)
        apart, bare, pairs = (sum(runs[name]) for name in ("broken", "bare", "pairs"))
        fine = value < 1.02 and apart == 0
        why = (
            "A1: the gateway computes ways in the graph that it found, and recall says how much "
            f"that is; {bare} of the {apart} pairs have an end that got no table, which A2 has a "
            "part in: see what a round finds"
        )
        yield said(
            SHORTEST,
            f"discovery {reading}: tables lead the shortest way (our bar: 1.02 times in the mean, "
            "and all pairs have one)",
            f"mean stretch {value:.3f}, 99 % {np.mean(runs['p99']):.2f}; "
            f"{apart} of {pairs} pairs without a way; degrees {joined(some)}: "
            + joined(f"{mean(got, reading, degree):.2f}" for degree in some),
            verdict(fine, *(["A1"] if reading == "list" else [])),
            "" if fine else why,
        )
    found = {degree: shares(got, "list", degree) for degree in some}
    tree = shares(got, "tree", 8)
    yield beyond(
        "nearly every entry has an alternate that cannot loop (0.9 at degree 8)",
        joined(
            f"degree {d}: {percent(v[0] + v[1], 1)}, {percent(v[0], 1)} around the next hop, too"
            for d, v in found.items()
        )
        + f"; of a tree {percent(tree[0] + tree[1], 1)}",
        verdict(found[8][0] + found[8][1] >= 0.9),
        "RFC 5286 by true distances; the rest are last resorts, safe only as packets carry their "
        "path",
    )
