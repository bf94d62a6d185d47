"""Section 2.1: are the tables' ways the shortest, and how often is there another next hop?"""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from innervate.networks.mesh.analysis.paths import UNREACHABLE, distances
from innervate.networks.mesh.papers.testbed import MeshTestbed
from innervate.networks.mesh.papers.words import joined, percent, seeds_of
from innervate.papers.experiment import Claim, Experiment, Point, Results, verdict
from innervate.plot import style
from innervate.sim.tables import get
from innervate.topology.placement import good_links, neighbours

READINGS = ("tree", "each", "list")
DEGREES = (5, 6, 8, 10, 12)
SOME = (6, 8)
NONE = 255
KINDS = ("around the next hop, too", "free of loops", "last resort", "none")


def make_testbed(reading: str, degree: int) -> MeshTestbed:
    """One round and its tables."""
    return MeshTestbed(degree=degree, protocol=(("discovery", reading),), duration_s=8.0)


def measure(of: MeshTestbed, seed: int) -> dict[str, Any]:
    """Every pair's way by the tables, and the alternates of every entry."""
    result = of.run(seed)
    plan, world = result.plan, result.world
    near = neighbours(plan.nodes, _known(plan))
    far = [distances(near, node) for node in range(plan.nodes)]
    width = plan.params["width"]
    next_, alt = ([], [])  # type: tuple[list[list[int]], list[list[int]]]
    for node in range(plan.nodes):
        bank = int(get(world.nodes, node, "bank")) * width
        for table, name in ((next_, "next"), (alt, "alt")):
            row = np.asarray(get(world.nodes, node, name))[bank : bank + plan.nodes]
            table.append(row.tolist())
    stretches, broken = [], 0
    kinds = [0] * len(KINDS)
    for a in range(plan.nodes):
        for b in range(plan.nodes):
            if a == b or far[a][b] == UNREACHABLE:
                continue
            hops = _hops(next_, a, b)
            if hops:
                stretches.append(hops / far[a][b])
            else:
                broken += 1
            if next_[a][b] != NONE:
                kinds[_kind(far, a, b, next_[a][b], alt[a][b])] += 1
    return {"stretch": float(np.mean(stretches)), "p99": float(np.percentile(stretches, 99)),
            "broken": broken, "pairs": broken + len(stretches), "kinds": kinds}  # fmt: skip


def _known(plan: Any) -> list[tuple[int, int]]:
    """Links that are loud enough to be reported both ways: what a perfect round would find.

    Good links are 1 dB louder, so ways over them alone are a little longer.
    """
    least = 100 * plan.params["min_rssi"] - 50  # nodes know whole dBm
    return good_links(plan.radio.rssi_cdb, plan.nodes, least)


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


def _degrees(quick: bool) -> tuple[int, ...]:
    return SOME if quick else DEGREES


def points(quick: bool) -> list[Point]:
    """A point for each reading of discovery and mean degree."""
    return [
        make_testbed(reading, degree).point("ways by tables", seeds_of(quick), measure)
        for reading in READINGS
        for degree in _degrees(quick)
    ]


def told(results: Results, of: MeshTestbed, quick: bool) -> list[dict[str, Any]]:
    """What was measured of these networks, one dict for each seed."""
    runs: list[dict[str, Any]] = results[of.key_of("ways by tables", seeds_of(quick))]
    return runs


def mean(results: Results, reading: str, degree: int, quick: bool) -> float:
    """Hops by tables over hops of the shortest path, mean over all seeds."""
    return float(
        np.mean([run["stretch"] for run in told(results, make_testbed(reading, degree), quick)])
    )


def shares(results: Results, reading: str, degree: int, quick: bool) -> Any:
    """Of all entries with a next hop, the share of each kind of alternate."""
    total = np.sum(
        [run["kinds"] for run in told(results, make_testbed(reading, degree), quick)], axis=0
    )
    return total / total.sum()


def draw(results: Results, quick: bool) -> Figure:
    """Stretch over the mean degree, and beside it what kinds of alternates there are."""
    figure, (left, right) = style.panels(style.WIDE_IN, 2.6, 1, 2, width_ratios=(1, 1.25))
    degrees = _degrees(quick)
    for i, reading in enumerate(READINGS):
        y = [mean(results, reading, degree, quick) for degree in degrees]
        left.plot(degrees, y, style.MARKERS[i], ls=style.DASHES[i], color=style.SERIES[i],
                  label=f"discovery: {reading}")  # fmt: skip
    left.axhline(1, color=style.INK, lw=0.6)
    left.set_xlabel("mean degree")
    left.set_ylabel("hops / shortest way")
    left.set_title("a  stretch of the tables' ways")
    left.set_ylim(0.95, 2.3)
    left.legend(loc="upper left")
    _kinds(right, results, quick)
    return figure


def _kinds(ax: Axes, results: Results, quick: bool) -> None:
    colours = (style.BLUE, style.SKY, style.ORANGE, style.FAINT)
    bars = [(reading, degree) for reading in ("tree", "list") for degree in _degrees(quick)]
    below = np.zeros(len(bars))
    found = np.array([shares(results, *bar, quick) for bar in bars])
    x = np.arange(len(bars)) + 0.7 * np.array([bar[0] == "list" for bar in bars])
    for k, name in enumerate(KINDS):
        ax.bar(x, 100 * found[:, k], 0.8, bottom=below, color=colours[k], label=name)
        below += 100 * found[:, k]
    ax.set_xticks(x, [str(degree) for _, degree in bars])
    ax.set_xlabel("mean degree; left: discovery tree, right: list")
    ax.set_ylabel("entries of tables (%)")
    ax.set_ylim(0, 140)
    ax.set_yticks(range(0, 101, 20))
    ax.set_title("b  alternates")
    ax.legend(loc="upper center", ncols=2)


def judge(results: Results, quick: bool) -> list[Claim]:
    """Shortest ways by reading; alternates."""
    return [*(_shortest(results, quick, reading) for reading in READINGS), _spare(results, quick)]


def _shortest(results: Results, quick: bool, reading: str) -> Claim:
    runs = told(results, make_testbed(reading, 8), quick)
    value = mean(results, reading, 8, quick)
    broken, pairs = (sum(run[name] for run in runs) for name in ("broken", "pairs"))
    degrees = _degrees(quick)
    others = joined(f"{mean(results, reading, d, quick):.2f}" for d in degrees)
    return Claim(
        "2.1",
        '"next hop tables, which contain the next hop calculating according to the shortest path '
        f'to destination by hop count", discovery {reading}',
        f"mean stretch {value:.3f}, 99 % {np.mean([run['p99'] for run in runs]):.2f}; "
        f"{broken} of {pairs} pairs without a way; degrees {joined(degrees)}: {others}",
        verdict(value < 1.02 and broken == 0, *(["A1"] if reading == "list" else [])),
        ""
        if value < 1.02 and broken == 0
        else "A1: shortest in the graph that was found, which is not the network",
    )


def _spare(results: Results, quick: bool) -> Claim:
    found = {d: shares(results, "list", d, quick) for d in _degrees(quick)}
    tree = shares(results, "tree", 8, quick)
    return Claim(
        "beyond",
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


EXPERIMENT = Experiment(
    "stretch",
    "2.1: shortest ways, and other ones",
    "30 nodes after one round. a: hops by the tables over hops of the shortest way, over all links "
    "loud enough to be reported, mean of all pairs that the tables connect. b: what kind of "
    "neighbour an entry's alternate is.",
    points,
    draw,
    judge,
)
