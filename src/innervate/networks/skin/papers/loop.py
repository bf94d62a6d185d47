"""Erratum E25: the printed rule closes forwarding loops: one as a picture, and how many."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from innervate.networks.skin.analysis.recovery import next_hops, recoveries
from innervate.networks.skin.analysis.rows import loop_episodes, parent_changes
from innervate.networks.skin.papers.common import RULE_NAMES, Case, joined, seeds_of
from innervate.networks.skin.plot.history import Moment
from innervate.networks.skin.plot.map import route_map
from innervate.networks.skin.plot.sheet import Sheet
from innervate.networks.skin.protocol.constants import NONE
from innervate.networks.skin.sim.observer import LOOP_OPEN
from innervate.networks.skin.sim.simulate import simulate
from innervate.papers.experiment import Claim, Experiment, Point, Results, Span, verdict
from innervate.plot import paint, style, svg
from innervate.plot.svg import Drawing

SHOWN = Case("setup-1", 250, 5, "paper", "periodic", 1)
SHOWN_SEED = 1
# Printed, the laxer reading, printed and counted slower; those that are to be loop-free.
LOOPING = (("paper", 1), ("paper-lax", 1), ("paper", 5))
CURED = (("strict", 0), ("feasible", 0))
NONE_AT_ALL = Span(0, 0)
CUT_PORT, INTO_RING = 1, 3  # which port's colour cells have
MAP_IN = 2.3


def seeds(quick: bool) -> range:
    """Recoveries a rule; E25 counts twenty."""
    return seeds_of(5 if quick else 20)


def _case(rule: str, m: int) -> Case:
    return Case("setup-1", 250, 5, rule, "periodic", m)


def points(quick: bool) -> list[Point]:
    """The picture's run, and the loops of every rule."""
    made = [
        Point.of(
            f"loops of {_case(rule, m).key(seeds(quick))}",
            0.02 * len(seeds(quick)),
            *(count_all, _case(rule, m), seeds(quick)),
        )
        for rule, m in (*LOOPING, *CURED)
    ]
    return [*made, Point.of(f"loop picture seed {SHOWN_SEED}", 0.2, picture)]


def count_all(case: Case, some: Sequence[int]) -> list[dict[str, Any]]:
    """See count; one entry a seed."""
    return [count(case, seed) for seed in some]


def count(case: Case, seed: int) -> dict[str, Any]:
    """Loops of one recovery: how many, the longest in ms, the largest in cells; routed in ms."""
    result = simulate(case.plan(seed))
    found = loop_episodes(result)
    stood = np.where(found.closed_us < 0, result.ended_us, found.closed_us) - found.opened_us
    return {
        "episodes": len(stood),
        "longest_ms": float(stood.max()) / 1e3 if len(stood) else 0.0,
        "cells": int(found.length.max()) if len(stood) else 0,
        "routed_ms": recoveries(result)[0]["routed_ms"],
    }


def picture() -> dict[str, Any]:
    """Parents before the cut and when the longest-standing ring closed."""
    result = simulate(SHOWN.plan(SHOWN_SEED))
    found = loop_episodes(result)
    longest = int(np.argmax(found.closed_us - found.opened_us))
    opened = int(found.opened_us[longest])
    cut_us = result.plan.faults[0].at_us
    rows = result.rows
    at_ring = (rows["code"] == LOOP_OPEN) & (rows["node"] == found.cell[longest])
    row = int(np.flatnonzero(at_ring & (rows["time"] == opened))[0])
    parents = _parents(result, row)
    ring = _ring(result.plan.graph, parents, int(found.cell[longest]))
    return {
        "before": _parents(result, int(np.searchsorted(rows["time"], cut_us))),
        "then": parents,
        "ring": ring,
        "after_ms": (opened - cut_us) / 1e3,
        "stood_ms": float(found.closed_us[longest] - opened) / 1e3,
    }


def _parents(result: Any, behind: int) -> list[int]:
    """Parent port of every cell after the first `behind` rows."""
    changes = parent_changes(result)
    parent = np.full(result.plan.graph.cells, NONE, np.int64)
    first = int(np.searchsorted(changes.row, behind))
    parent[changes.cell[:first]] = changes.new[:first]
    return [int(port) for port in parent]


def _ring(graph: Any, parents: list[int], start: int) -> list[int]:
    hops = next_hops(graph, np.array(parents))
    ring, node = [start], int(hops[start])
    while node != start and len(ring) <= graph.cells:
        ring.append(node)
        node = int(hops[node])
    return ring


def draw(results: Results, quick: bool) -> Figure:
    """The skin before the cut and with the ring; loops of all recoveries."""
    shown = results[f"loop picture seed {SHOWN_SEED}"]
    graph = SHOWN.plan(SHOWN_SEED).graph
    figure = style.figure(style.WIDE_IN, 3.3)
    before, then, bars = figure.subplots(1, 3, width_ratios=(1, 1, 0.95))
    hops = next_hops(graph, np.array(shown["before"]))
    below = _below(hops, graph)
    servers = [CUT_PORT if cell in below else 0 for cell in range(graph.cells)]
    paint.paint(before, _map(graph, hops, servers), MAP_IN)
    before.set_title("a  the cable of port 1 fails")
    _draw_ring(then, graph, shown)
    then.set_title(f"b  {shown['after_ms']:.1f} ms later")
    _bars(bars, results, quick)
    return figure


def _below(hops: Any, graph: Any) -> set[int]:
    """Cells whose chain of parents ends at interface port 1."""
    root = graph.peer[4 * graph.cells + 1] // 4
    found = set()
    for cell in range(graph.cells):
        node = cell
        while node != root and 0 <= hops[node] < graph.cells:
            node = int(hops[node])
        if node == root:
            found.add(cell)
    return found


def _draw_ring(ax: Axes, graph: Any, shown: Any) -> None:
    hops = next_hops(graph, np.array(shown["then"]))
    root = graph.peer[4 * graph.cells + 1] // 4
    if hops[root] == graph.sink:
        hops[root] = -1  # its cable is dead
    servers = []
    for cell in range(graph.cells):
        node, steps = cell, 0
        while 0 <= hops[node] < graph.cells and steps <= graph.cells:
            node, steps = int(hops[node]), steps + 1
        servers.append(0 if hops[node] == graph.sink else NONE)
        if steps > graph.cells:
            servers[-1] = INTO_RING
    paint.paint(ax, _map(graph, hops, servers, shown["ring"]), MAP_IN)


def _map(graph: Any, hops: Any, servers: Sequence[int], ring: Sequence[int] = ()) -> Drawing:
    """A map whose cells have the colours of these ports, with arrows along a ring."""
    sheet, down = Sheet(graph), graph.peer[4 * graph.cells + CUT_PORT]
    served = np.array(servers)
    moment = Moment(0, served, hops, served, frozenset({down}), frozenset())
    drawing = route_map(sheet, moment, "", tips=False)
    arrows = "".join(svg.arrow(sheet.cell(c), sheet.cell(int(hops[c])), 4.0) for c in ring)
    if arrows:
        drawing.add("path", class_="way", stroke=style.WINE, d=arrows)
    return drawing


def _found(results: Results, quick: bool, rule: str, m: int) -> list[dict[str, Any]]:
    found: list[dict[str, Any]] = results[f"loops of {_case(rule, m).key(seeds(quick))}"]
    return found


def _bars(ax: Axes, results: Results, quick: bool) -> None:
    found = [[one["episodes"] for one in _found(results, quick, *rule)] for rule in LOOPING[:2]]
    for i, (counts, (rule, _)) in enumerate(zip(found, LOOPING, strict=False)):
        place = np.arange(1, len(counts) + 1) + 0.2 * (2 * i - 1)
        look = {"color": style.PURPLE} if i == 0 else {"fc": "white", "ec": style.PURPLE, "lw": 0.7}
        ax.bar(place, counts, width=0.36, label=RULE_NAMES[rule], **look)
    ax.set_xlabel("recovery (seed)")
    ax.set_ylabel("forwarding loops")
    ax.set_xticks([1, *range(5, len(found[0]) + 1, 5)])
    ax.grid(axis="x", visible=False)
    ax.set_ylim(0, 1.4 * max(map(max, found)))
    ax.plot([], [], " ", label="strict, feasible: none")
    ax.legend(loc="upper left")
    ax.set_title("c  loops in each recovery")


def judge(results: Results, quick: bool) -> list[Claim]:
    """Is the printed rule loop-free? Are strict and feasible? Does M alone cure it?"""
    printed, lax, slower = (_found(results, quick, *rule) for rule in LOOPING)
    cured = {rule: _found(results, quick, rule, m) for rule, m in CURED}
    return [
        _guarantee(printed, "printed rule"),
        _guarantee(lax, "its laxer reading"),
        Claim(
            "II-B.2",
            "no loop under the rules strict (F1) and feasible (F2) in the same recoveries",
            joined(f"{rule}: {_episodes(found)} loops" for rule, found in cured.items())
            + f" in {len(printed)} recoveries each",
            verdict(NONE_AT_ALL.has(*map(_episodes, cured.values()))),
        ),
        Claim(
            "II-B.2",
            "counting slower (M = 5, F3) alone prevents loops under the printed rule",
            f"{_looping(slower)} of {len(slower)} recoveries with a loop",
            verdict(NONE_AT_ALL.has(_looping(slower))),
            "numbers below the cut stay equal whatever M is" if _looping(slower) else "",
        ),
    ]


def _episodes(found: list[dict[str, Any]]) -> int:
    return sum(one["episodes"] for one in found)


def _looping(found: list[dict[str, Any]]) -> int:
    return sum(one["episodes"] > 0 for one in found)


def _guarantee(found: list[dict[str, Any]], name: str) -> Claim:
    return Claim(
        "II-B.2",
        f"sequence numbers guarantee a loop-free convergence ({name}, setup 1, k = 5)",
        f"{_looping(found)} of {len(found)} recoveries with a forwarding loop, {_episodes(found)} "
        f"loops, the longest stood {max(one['longest_ms'] for one in found):.0f} ms, up to "
        f"{max(one['cells'] for one in found)} cells",
        verdict(NONE_AT_ALL.has(_looping(found))),
        "E25: while the cut is detected all cells below it end with the same number, then >= lets "
        "every stale route pass",
    )


EXPERIMENT = Experiment(
    "loop",
    "Erratum E25: a forwarding loop under the printed rule",
    "Setup 1, 250 Hz, k = 5. a: cells served by port 1 in orange. b: parents when the "
    "longest-standing ring of the recovery closed (purple); pale purple: sends into the ring; "
    "hollow: no parent, or behind one. Red cross: the cable that fails. c: loops in each recovery.",
    points,
    draw,
    judge,
)
