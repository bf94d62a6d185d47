"""Section 1: "not scalable, but sufficient for small networks": up to how many nodes?"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from matplotlib.figure import Figure

from innervate.networks.mesh.analysis.summary import summarize
from innervate.networks.mesh.papers.testbed import MeshTestbed, Options
from innervate.networks.mesh.scenario.plan import ONE
from innervate.papers import drawing
from innervate.papers.experiment import Claim, Claims, Measured, Point, verdict
from innervate.papers.words import joined
from innervate.plot import style

TITLE = "1: how small is small"
CAPTION = (
    "Mean degree 8. Airtime of one discovery round and of all that it distributes, as heard where "
    "it is busiest, as a share of the period; only sizes at which everyone got a table. Dotted: "
    "half."
)
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
SCHEMES: dict[str, Options] = {
    "tables": (),
    "graph": (("failover", "graph"),),
    "table-free": (("tables", False),),
}


def point(radio: Radio, scheme: str, nodes: int, quick: bool) -> Point:
    """A single round, and time for all its tables."""
    alone: Options = (("period_s", 3600.0), ("period_max_s", 3600.0))
    duration = 20 + radio.per_node_s * nodes
    testbed = MeshTestbed(nodes, 8, radio.profile, (*alone, *SCHEMES[scheme]), duration)
    return testbed.point("a full round", range(1, 2 if quick else 4), measure)


def points(quick: bool) -> list[Point]:
    """Every radio, scheme and size."""
    return [
        point(radio, scheme, n, quick)
        for radio in RADIOS
        for scheme in SCHEMES
        for n in _ns(radio, scheme, quick)
    ]


def measure(of: MeshTestbed, seed: int) -> dict[str, Any]:
    """Seconds that the channel is busy for one full round, where it is busiest."""
    result = of.run(seed)
    plan, sent = result.plan, result.sent
    spent_us = np.zeros(plan.nodes, np.int64)
    np.add.at(spent_us, sent["node"], sent["end"] - sent["time"])
    hears = np.array(plan.radio.prob_q15).reshape(plan.nodes, plan.nodes) >= ONE // 2
    found = summarize(result)["discovery"]
    busy_s = float((spent_us @ hears + spent_us).max()) / 1e6
    return {"busy_s": busy_s, **{name: found[name] for name in ("with_tables", "tables_s")}}


def _ns(radio: Radio, scheme: str, quick: bool) -> list[int]:
    most = radio.graph_max if scheme == "graph" else 254
    return [n for n in (SOME if quick else radio.nodes) if n <= most]


def shares(got: Measured, radio: Radio, scheme: str) -> tuple[list[int], Any]:
    """(N, share of the period that the busiest channel is busy, all tables new each round)."""
    runs = {n: got[point(radio, scheme, n, got.quick)] for n in _ns(radio, scheme, got.quick)}
    # A round that leaves nodes out costs less than a full one: it says nothing here.
    ns = [n for n, one in runs.items() if all(some in (None, n) for some in one["with_tables"])]
    return ns, np.array([np.mean(runs[n]["busy_s"]) / radio.period_s for n in ns])


def half_full(ns: list[int], share: Any) -> tuple[float, bool]:
    """N at which the share is a half, on straight lines in logarithms; False = extended to it."""
    x, y = np.log(ns), np.log(share)
    above = np.flatnonzero(share >= HALF)
    reached = len(above) > 0
    k = max(1, int(above[0])) if reached else len(ns) - 1
    slope = (y[k] - y[k - 1]) / (x[k] - x[k - 1])
    return float(np.exp(x[k] + (np.log(HALF) - y[k]) / slope)), reached


def draw(got: Measured) -> Figure:
    """Busy share over N, for both radios."""
    figure, axes = style.panels(style.WIDE_IN, 2.7, 1, 2, sharey=True)
    for ax, radio, letter in zip(axes, RADIOS, "ab", strict=True):
        for i, scheme in enumerate(SCHEMES):
            ns, share = shares(got, radio, scheme)
            ax.plot(ns, 100 * share, label=scheme, **drawing.look(i))
        ax.axhline(100 * HALF, color=style.INK, lw=0.8, ls=":")
        ax.set_yscale("log")
        drawing.logarithmic(ax, SOME if got.quick else (10, 30, 100, 250))
        title = f"{letter}  {radio.profile}, a round every {radio.period_s:g} s"
        ax.set(xlabel="nodes N", title=title)
    axes[0].set_ylabel("busiest channel busy (%)")
    axes[0].legend()
    return figure


def judge(got: Measured) -> Claims:
    """How small is small; the other two schemes."""
    for radio in RADIOS:
        found = {scheme: half_full(*shares(got, radio, scheme)) for scheme in SCHEMES}
        words = {
            scheme: f"half full at N = {n:.0f}" + ("" if reached else " by extension")
            for scheme, (n, reached) in found.items()
        }
        ns, share = shares(got, radio, "tables")
        growth = float(np.polyfit(np.log(ns), np.log(share), 1)[0])
        tables, *others = (n for n, _ in found.values())
        yield Claim(
            "1",
            '"This is not scalable, but sufficient for small networks": tables leave half of the '
            f"channel at {radio.profile} up to N = {SMALL}",
            f"{words['tables']}; grows as N^{growth:.2f}; at N = 30 "
            f"{100 * share[ns.index(30)]:.1f} %",
            verdict(tables >= SMALL),
            "if every round changes every table, as with robots that move; an unchanged table is "
            "not sent",
        )
        yield Claim(
            "beyond",
            f"at {radio.profile} the flooded graph and the table-free mode go further than tables",
            joined(f"{scheme}: {words[scheme]}" for scheme in ("graph", "table-free")),
            verdict(min(others) > tables),
            f"the graph fits {radio.graph_max} nodes at most",
        )
    yield _complete(got)


def _complete(got: Measured) -> Claim:
    words, fine = [], True
    for radio in RADIOS:
        for scheme in ("tables", "graph"):
            n = _ns(radio, scheme, got.quick)[-1]
            runs = got[point(radio, scheme, n, got.quick)]
            least = min(runs["with_tables"])
            fine = fine and least == n
            times = [time for time in runs["tables_s"] if time is not None]
            took = f"{np.mean(times):.0f} s" if times else "never all"
            words.append(f"{radio.profile} {scheme}, N = {n}: {least} with tables, {took}")
    return Claim(
        "beyond",
        "at the largest N everyone gets its table in the end",
        joined(words, "; "),
        verdict(fine),
        "" if fine else "not every node was found, or its table was given up",
    )
