"""Section 1: "not scalable, but sufficient for small networks": up to how many nodes?"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from matplotlib.figure import Figure

from innervate.networks.mesh.analysis.summary import summarize
from innervate.networks.mesh.papers.testbed import MeshTestbed, Options
from innervate.networks.mesh.papers.words import joined
from innervate.networks.mesh.scenario.plan import ONE
from innervate.papers.experiment import Claim, Experiment, Point, Results, verdict
from innervate.plot import style

HALF = 0.5
SMALL = 70  # "sufficient for small networks": more than that, we would not call small


class Radio(NamedTuple):
    """A profile and what is tried with it.

    Attributes:
        period_s: between discovery rounds.
        nodes: how many, up to what is reasonable.
        graph_max: nodes that a flooded graph has room for.
        per_node_s: a round and its tables take less than this for every node.
    """

    profile: str
    period_s: float
    nodes: tuple[int, ...]
    graph_max: int
    per_node_s: float


RADIOS = (
    Radio("250k", 10, (10, 20, 30, 45, 64, 100, 150, 200, 254), 145, 0.5),
    Radio("38k4", 60, (10, 20, 30, 45, 64, 85, 120), 85, 8.0),
)
SOME = (10, 20, 30)
SCHEMES: tuple[tuple[str, Options], ...] = (
    ("tables", ()),
    ("graph", (("failover", "graph"),)),
    ("table-free", (("tables", False),)),
)


def make_testbed(radio: Radio, protocol: Options, nodes: int) -> MeshTestbed:
    """A single round, and time for all its tables."""
    alone: Options = (("period_s", 3600.0), ("period_max_s", 3600.0))
    duration = 20 + radio.per_node_s * nodes
    return MeshTestbed(nodes, 8, radio.profile, (*alone, *protocol), duration)


def measure(of: MeshTestbed, seed: int) -> dict[str, Any]:
    """Seconds that the channel is busy for one full round, where it is busiest."""
    result = of.run(seed)
    plan, sent = result.plan, result.sent
    spent = np.bincount(sent["node"], sent["end"] - sent["time"], plan.nodes) / 1e6
    hears = np.array(plan.radio.prob_q15).reshape(plan.nodes, plan.nodes) >= ONE // 2
    found = summarize(result)["discovery"]
    return {"busy_s": float((spent @ hears + spent).max()), "with_tables": found["with_tables"],
            "tables_s": found["tables_s"], "recall": found["recall"]}  # fmt: skip


def _seeds(quick: bool) -> range:
    return range(1, 2 if quick else 4)


def _ns(radio: Radio, scheme: str, quick: bool) -> list[int]:
    most = radio.graph_max if scheme == "graph" else 254
    return [n for n in (SOME if quick else radio.nodes) if n <= most]


def points(quick: bool) -> list[Point]:
    """Every radio, scheme and size."""
    return [
        make_testbed(radio, protocol, n).point("a full round", _seeds(quick), measure)
        for radio in RADIOS
        for scheme, protocol in SCHEMES
        for n in _ns(radio, scheme, quick)
    ]


def shares(results: Results, radio: Radio, scheme: int, quick: bool) -> tuple[list[int], Any]:
    """(N, share of the period that the busiest channel is busy, all tables new each round)."""
    name, protocol = SCHEMES[scheme]
    ns, found = [], []
    for n in _ns(radio, name, quick):
        runs = results[make_testbed(radio, protocol, n).key_of("a full round", _seeds(quick))]
        # A round that leaves nodes out costs less than a full one: it says nothing here.
        if all(run["with_tables"] in (None, n) for run in runs):
            ns.append(n)
            found.append(np.mean([run["busy_s"] for run in runs]) / radio.period_s)
    return ns, np.array(found)


def half_full(ns: list[int], share: Any) -> tuple[float, bool]:
    """N at which the share is a half, on straight lines in logarithms; False = extended to it."""
    x, y = np.log(ns), np.log(share)
    above = np.flatnonzero(share >= HALF)
    reached = len(above) > 0
    k = max(1, int(above[0])) if reached else len(ns) - 1
    slope = (y[k] - y[k - 1]) / (x[k] - x[k - 1])
    return float(np.exp(x[k] + (np.log(HALF) - y[k]) / slope)), reached


def draw(results: Results, quick: bool) -> Figure:
    """Busy share over N, for both radios."""
    figure, axes = style.panels(style.WIDE_IN, 2.7, 1, 2, sharey=True)
    for ax, radio, letter in zip(axes, RADIOS, "ab", strict=True):
        for i, (name, _) in enumerate(SCHEMES):
            ns, share = shares(results, radio, i, quick)
            ax.plot(ns, 100 * share, style.MARKERS[i], ls=style.DASHES[i], color=style.SERIES[i],
                    label=name)  # fmt: skip
        ax.axhline(100 * HALF, color=style.INK, lw=0.8, ls=":")
        ax.set_xscale("log")
        ax.set_yscale("log")
        ticks = SOME if quick else (10, 30, 100, 250)
        ax.set_xticks(ticks, [str(n) for n in ticks])
        ax.minorticks_off()
        ax.set_xlabel("nodes N")
        ax.set_title(f"{letter}  {radio.profile}, a round every {radio.period_s:g} s")
    axes[0].set_ylabel("busiest channel busy (%)")
    axes[0].legend()
    return figure


def _in_words(found: tuple[float, bool]) -> str:
    n, reached = found
    return f"N = {n:.0f}" if reached else f"N = {n:.0f} by extension"


def judge(results: Results, quick: bool) -> list[Claim]:
    """How small is small; the other two schemes."""
    rows = []
    for radio in RADIOS:
        halves = [half_full(*shares(results, radio, i, quick)) for i in range(len(SCHEMES))]
        ns, share = shares(results, radio, 0, quick)
        growth = float(np.polyfit(np.log(ns), np.log(share), 1)[0])
        rows.append(Claim(
            "1",
            '"This is not scalable, but sufficient for small networks": tables leave half of the '
            f"channel at {radio.profile} up to N = {SMALL}",
            f"half full at {_in_words(halves[0])}; grows as N^{growth:.2f}; at N = 30 "
            f"{100 * share[ns.index(30)]:.1f} %",
            verdict(halves[0][0] >= SMALL),
            "if every round changes every table, as with robots that move; an unchanged table is "
            "not sent",
        ))  # fmt: skip
        rows.append(Claim(
            "beyond", f"at {radio.profile} the flooded graph and the table-free mode go further "
            "than tables",
            joined(f"{SCHEMES[i][0]}: half full at {_in_words(halves[i])}" for i in (1, 2)),
            verdict(min(halves[1][0], halves[2][0]) > halves[0][0]),
            f"the graph fits {radio.graph_max} nodes at most",
        ))  # fmt: skip
    rows.append(_complete(results, quick))
    return rows


def _complete(results: Results, quick: bool) -> Claim:
    words, fine = [], True
    for radio in RADIOS:
        for name, protocol in SCHEMES[:2]:
            n = _ns(radio, name, quick)[-1]
            runs = results[make_testbed(radio, protocol, n).key_of("a full round", _seeds(quick))]
            least = min(run["with_tables"] for run in runs)
            fine = fine and least == n
            times = [run["tables_s"] for run in runs if run["tables_s"] is not None]
            took = f"{np.mean(times):.0f} s" if times else "never all"
            words.append(f"{radio.profile} {name}, N = {n}: {least} with tables, {took}")
    return Claim(
        "beyond",
        "at the largest N everyone gets its table in the end",
        joined(words, "; "),
        verdict(fine),
        "" if fine else "not every node was found, or its table was given up",
    )


EXPERIMENT = Experiment(
    "scale",
    "1: how small is small",
    "Mean degree 8. Airtime of one discovery round and of all that it distributes, as heard where "
    "it is busiest, as a share of the period; only sizes at which everyone got a table. Dotted: "
    "half.",
    points,
    draw,
    judge,
)
