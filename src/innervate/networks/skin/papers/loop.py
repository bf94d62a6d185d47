"""Erratum E25: the printed rule closes forwarding loops: one as a picture, and how many."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from innervate.analysis.ways import NOWHERE, Numbers, follow
from innervate.networks.skin.analysis.recovery import next_hops
from innervate.networks.skin.analysis.rows import loop_episodes, parent_changes, parents
from innervate.networks.skin.papers.common import RULES, Case, Rule
from innervate.networks.skin.plot.history import Moment
from innervate.networks.skin.plot.map import route_map
from innervate.networks.skin.plot.sheet import Sheet
from innervate.networks.skin.protocol.constants import NONE
from innervate.networks.skin.sim.observer import LOOP_OPEN
from innervate.networks.skin.sim.simulate import simulate
from innervate.papers.experiment import Claim, Claims, Measured, Point, Span, verdict
from innervate.papers.words import joined
from innervate.plot import paint, style, svg
from innervate.plot.svg import Drawing

TITLE = "Erratum E25: a forwarding loop under the printed rule"
CAPTION = (
    "Setup 1, 250 Hz, k = 5. a: cells served by port 1 in orange. b: parents when the "
    "longest-standing ring of the recovery closed (purple); pale purple: sends into the ring; "
    "hollow: no parent, or behind one. Red cross: the cable that fails. c: loops in each recovery."
)
SHOWN = Case("setup-1", 250, 5, "paper", "periodic", 1)
SHOWN_SEED = 1
PRINTED, LAX = RULES[1:]
SLOWER = Rule("paper", 5)  # printed and counted slower
CURED = (Rule("strict", 0), Rule("feasible", 0))
NONE_AT_ALL = Span(0, 0)
CUT_PORT, INTO_RING = 1, 3  # which port's colour cells have
MAP_IN = 2.3


def loops(rule: Rule, quick: bool) -> Point:
    """Recoveries of a rule; E25 counts twenty."""
    case = rule.case("setup-1", 250, 5)
    return Point.each(f"loops of {case}", 0.02, 5 if quick else 20, count, case)


def points(quick: bool) -> list[Point]:
    """The picture's run, and the loops of every rule."""
    made = [loops(rule, quick) for rule in (PRINTED, LAX, SLOWER, *CURED)]
    return [*made, Point.of(f"loop picture seed {SHOWN_SEED}", 0.2, picture)]


def count(case: Case, seed: int) -> dict[str, Any]:
    """Loops of one recovery: how many, the longest in ms, the largest in cells."""
    result = simulate(case.plan(seed))
    found = loop_episodes(result)
    stood = np.where(found.closed_us < 0, result.ended_us, found.closed_us) - found.opened_us
    longest_ms = float(stood.max(initial=0)) / 1e3
    return {"episodes": len(stood), "longest_ms": longest_ms,
            "cells": int(found.length.max(initial=0))}  # fmt: skip


def picture() -> dict[str, Any]:
    """Parents before the cut and when the longest-standing ring closed."""
    result = simulate(SHOWN.plan(SHOWN_SEED))
    found = loop_episodes(result)
    longest = int(np.argmax(found.closed_us - found.opened_us))
    opened, cell = int(found.opened_us[longest]), int(found.cell[longest])
    cut_us = result.plan.faults[0].at_us
    rows = result.rows
    at_ring = (rows["code"] == LOOP_OPEN) & (rows["node"] == cell) & (rows["time"] == opened)
    parents = _parents(result, int(np.flatnonzero(at_ring)[0]))
    return {
        "before": _parents(result, int(np.searchsorted(rows["time"], cut_us))),
        "then": parents,
        "ring": _ring(result.plan.graph, parents, cell),
        "after_ms": (opened - cut_us) / 1e3,
        "stood_ms": float(found.closed_us[longest] - opened) / 1e3,
    }


def _parents(result: Any, behind: int) -> list[int]:
    """Parent port of every cell after the first `behind` rows."""
    changes = parent_changes(result)
    first = int(np.searchsorted(changes.row, behind))
    found: list[int] = parents(changes, result.plan.graph.cells, first).tolist()
    return found


def _ring(graph: Any, parents: list[int], start: int) -> list[int]:
    hops = next_hops(graph, np.array(parents))
    ring, node = [start], int(hops[start])
    while node != start and len(ring) <= graph.cells:
        ring.append(node)
        node = int(hops[node])
    return ring


def draw(got: Measured) -> Figure:
    """The skin before the cut and with the ring; loops of all recoveries."""
    shown = got.values[f"loop picture seed {SHOWN_SEED}"]
    graph = SHOWN.plan(SHOWN_SEED).graph
    figure = style.figure(style.WIDE_IN, 3.3)
    before, then, bars = figure.subplots(1, 3, width_ratios=(1, 1, 0.95))
    hops = next_hops(graph, np.array(shown["before"]))
    root = graph.peer[4 * graph.cells + CUT_PORT] // 4
    servers = np.where(_ends(hops, graph.cells) == root, CUT_PORT, 0)
    paint.paint(before, _map(graph, hops, servers), MAP_IN)
    before.set_title("a  the cable of port 1 fails")
    _draw_ring(then, graph, shown)
    then.set_title(f"b  {shown['after_ms']:.1f} ms later")
    _bars(bars, got)
    return figure


def _ends(hops: Any, cells: int) -> Numbers:
    """The last cell of every cell's chain of parents, NOWHERE where it leads into a ring."""
    return follow(hops, (hops < 0) | (hops >= cells))[0]


def _draw_ring(ax: Axes, graph: Any, shown: Any) -> None:
    hops = next_hops(graph, np.array(shown["then"]))
    root = graph.peer[4 * graph.cells + CUT_PORT] // 4
    if hops[root] == graph.sink:
        hops[root] = -1  # its cable is dead
    ends = _ends(hops, graph.cells)
    ways = np.where(hops[ends] == graph.sink, 0, NONE)
    servers = np.where(ends == NOWHERE, INTO_RING, ways)
    paint.paint(ax, _map(graph, hops, servers, shown["ring"]), MAP_IN)


def _map(graph: Any, hops: Any, served: Numbers, ring: Sequence[int] = ()) -> Drawing:
    """A map whose cells have the colours of these ports, with arrows along a ring."""
    sheet, down = Sheet(graph), graph.peer[4 * graph.cells + CUT_PORT]
    moment = Moment(0, served, hops, served, frozenset({down}), frozenset())
    drawing = route_map(sheet, moment, "", tips=False)
    arrows = "".join(svg.arrow(sheet.cell(c), sheet.cell(int(hops[c])), 4.0) for c in ring)
    if arrows:
        drawing.add("path", class_="way", stroke=style.WINE, d=arrows)
    return drawing


def _bars(ax: Axes, got: Measured) -> None:
    looks: Any = ({"color": style.PURPLE}, {"fc": "white", "ec": style.PURPLE, "lw": 0.7})
    most = 0
    for i, (rule, look) in enumerate(zip((PRINTED, LAX), looks, strict=True)):
        counts = got[loops(rule, got.quick)]["episodes"]
        most = max(most, *counts)
        place = np.arange(1, len(counts) + 1) + 0.2 * (2 * i - 1)
        ax.bar(place, counts, width=0.36, label=rule.words, **look)
    ax.set(xlabel="recovery (seed)", ylabel="forwarding loops")
    ax.set(xticks=[1, *range(5, len(counts) + 1, 5)], ylim=(0, 1.4 * most))
    ax.grid(axis="x", visible=False)
    cured = np.sum([got[loops(rule, got.quick)]["episodes"] for rule in CURED], axis=0)
    words = f"strict, feasible: {cured.sum() or 'none'}"
    ax.plot(np.arange(1, len(counts) + 1), cured, "o", color=style.GREEN, ms=2.5, label=words,
            clip_on=False)  # fmt: skip
    ax.legend(loc="upper left")
    ax.set_title("c  loops in each recovery")


def judge(got: Measured) -> Claims:
    """Is the printed rule loop-free? Are strict and feasible? Does M alone cure it?"""
    for rule, name in ((PRINTED, "printed rule"), (LAX, "its laxer reading")):
        found = got[loops(rule, got.quick)]
        yield Claim(
            "II-B.2",
            f"sequence numbers guarantee a loop-free convergence ({name}, setup 1, k = 5)",
            f"{_looping(found)} of {len(found['cells'])} recoveries with a forwarding loop, "
            f"{sum(found['episodes'])} loops, the longest stood {max(found['longest_ms']):.0f} ms, "
            f"up to {max(found['cells'])} cells",
            verdict(NONE_AT_ALL.has(_looping(found))),
            "E25: while the cut is detected all cells below it end with the same number, then >= "
            "lets every stale route pass",
        )
    cured = {rule.name: sum(got[loops(rule, got.quick)]["episodes"]) for rule in CURED}
    slower = got[loops(SLOWER, got.quick)]
    yield Claim(
        "II-B.2",
        "no loop under the rules strict (F1) and feasible (F2) in the same recoveries",
        joined(f"{rule}: {episodes} loops" for rule, episodes in cured.items())
        + f" in {len(slower['cells'])} recoveries each",
        verdict(NONE_AT_ALL.has(*cured.values())),
    )
    yield Claim(
        "II-B.2",
        "counting slower (M = 5, F3) alone prevents loops under the printed rule",
        f"{_looping(slower)} of {len(slower['cells'])} recoveries with a loop",
        verdict(NONE_AT_ALL.has(_looping(slower))),
        "numbers below the cut stay equal whatever M is" if _looping(slower) else "",
    )


def _looping(found: dict[str, Any]) -> int:
    return sum(episodes > 0 for episodes in found["episodes"])
