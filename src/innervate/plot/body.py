"""The report of a run of any network: headline, figures to know, graph, reports over time."""

import sys
from collections.abc import Collection, Mapping
from functools import partial
from html import escape
from typing import Any

import numpy as np

from innervate.analysis.spread import laid_out
from innervate.kernel.words import number_of
from innervate.network import networks
from innervate.plot import charts, page, svg
from innervate.plot.happened import event_words
from innervate.plot.lines import traffic_lines
from innervate.plot.page import figure, pictures, section, table, tiles
from innervate.plot.words import count_words, figure_words
from innervate.sim.tables import get

SIDE = 420.0
DRAWN_MAX = 400  # nodes of a graph that is drawn
NAMED_MAX = 60
CHARTS_MAX = 8
UNTOLD = ("number", "rng", "choice", "asked")  # a table's first column; a generator's own

Places = dict[str, tuple[float, float]]


def body(result: Any, summary: Mapping[str, Any]) -> str:
    """All of it, as HTML."""
    return page.joined(
        top(result, summary), graph(result.plan, result.counts.off), _over_time(result),
        _nodes(result), page.events(result, partial(event_words, result.plan)),
    )  # fmt: skip


def notebook(result: Any, summary: Mapping[str, Any]) -> str:
    """What a notebook shows of a run, as HTML."""
    return top(result, summary) + graph(result.plan, result.counts.off)


def top(result: Any, summary: Mapping[str, Any]) -> str:
    """What happened, and the figures to know."""
    over = (
        f"{summary['name']}: {summary['kind']}, {number_of(summary['nodes'], 'node')}; "
        f"{figure_words(result.ended_us / 1e6, 4)} s, seed {summary['seed']}"
    )
    frames, messages = summary["frames"], summary["messages"]
    frame, sent = ("reception", " due") if result.counts.is_shared else ("frame", " sent")
    numbers = [
        _counted(frames["sent"], frame, sent),
        _counted(frames["lost"], frame, " lost"),
        _counted(messages["delivered"], "message", " delivered"),
        _counted(summary["events"], "event"),
    ]
    said = page.paragraphs(f"{line}." for line in traffic_lines(summary, result.counts))
    return page.top(over, summary, tiles(numbers), said)


def _counted(count: int, thing: str, did: str = "") -> tuple[str, str]:
    """A figure to know, and its words."""
    return count_words(count), f"{thing}{'' if count == 1 else 's'}{did}"


def graph(plan: Any, off: Collection[int] = ()) -> str:
    """The network: nodes where they lie, or on a circle; nothing if it is too large to be read.

    Those that are `off` at the end are crossed.
    """
    made = networks()[plan.kind].graph(plan)
    if not 0 < len(made.nodes) <= DRAWN_MAX:
        return ""
    places = _places(made.nodes, made.edges)
    width, height = (max(spots) + 40 for spots in zip(*places.values(), strict=True))
    drawing = svg.Drawing(width, height, f"graph of {len(made.nodes)} nodes")
    for a, b, _about in made.edges:
        drawing.line(places[a], places[b], "cable")
    for node, (name, (x, y)) in enumerate(places.items()):
        drawing.circle((x, y), 5, "off" if node in off else "relay")
        if node in off:
            drawing.path(svg.cross(x, y, 7), "struck")
        if len(places) <= NAMED_MAX:
            drawing.text((x, y - 9), name, "small", "middle")
    links = number_of(len(made.edges), "link")
    if networks()[plan.kind].medium == "channel":
        links = "on one channel"
    crossed = "; crossed: off at the end" if off else ""
    text = f"{number_of(len(made.nodes), 'node')}, {links}{crossed}."
    return section("The network", pictures([figure(drawing, "", text)], "two"))


def _places(nodes: list[tuple[str, dict[str, Any]]], edges: Any) -> Places:
    """Where nodes are drawn: as their first two coordinates say, or else by who is linked."""
    spots, _unit = laid_out(nodes, edges)
    spots -= spots.min(axis=0)
    spots *= (SIDE - 80) / max(float(spots.max()), 1e-9)
    spots += 40
    return {name: (x, y) for (name, _), (x, y) in zip(nodes, spots.tolist(), strict=True)}


def _over_time(result: Any) -> str:
    """How often what was reported and delivered, added up over time."""
    end_s = max(result.ended_us / 1e6, 1e-6)
    marks = [charts.Mark(fault.at_us / 1e6, "") for fault in result.plan.faults
             if fault.at_us <= result.ended_us]  # fmt: skip
    text = "So many so far; dashed: the events below." if marks else "So many so far."
    figures = []
    for name, times in _series(result)[:CHARTS_MAX]:
        x, y = charts.Axis(0, end_s, "s"), charts.Axis(0, max(1, len(times)))
        shown = charts.Steps(np.sort(times) / 1e6, np.arange(1, len(times) + 1), x, y,
                             f"{name} over time", marks=marks[: charts.BARS_MAX])  # fmt: skip
        figures.append(figure(shown.drawing, name, text))
    return section("Over time", pictures(figures, "two"))


def _series(result: Any) -> list[tuple[str, Any]]:
    """(name, times in us) of deliveries and of every kind of report, the most frequent first."""
    found = []
    rows, deliveries = result.rows.get("rows"), result.rows.get("deliveries")
    names = _report_names(result.plan.kind)
    for code in np.unique(rows["code"]).tolist() if rows is not None else ():
        found.append((f"reports {names.get(code, code)}", rows["time"][rows["code"] == code]))
    found.sort(key=lambda one: -len(one[1]))
    if deliveries is not None and len(deliveries):
        found.insert(0, ("messages delivered", deliveries["time"]))
    return found


def _report_names(kind: str) -> dict[int, str]:
    """What a protocol, or a module beside it, calls the codes of its reports: REPORT_..."""
    network = networks()[kind]
    if not network.has("protocol"):
        return {}
    package, head = network.protocol.__package__, "REPORT_"
    beside = [one for name, one in sorted(sys.modules.items()) if name.startswith(f"{package}.")]
    return {
        code: name.removeprefix(head).lower().replace("_", " ")
        for one in (*(beside if package else ()), network.protocol)
        for name, code in vars(one).items() if name.startswith(head)
    }  # fmt: skip


def _nodes(result: Any) -> str:
    """What the nodes of a network that declares its fields were at the end, as a table."""
    network = networks()[result.plan.kind]
    nodes = network.graph(result.plan).nodes
    cells = getattr(result.world, "cells", getattr(result.world, "stations", None))
    declares = network.has("fields") and hasattr(network.fields, "STATE")
    if cells is None or not declares or len(nodes) > NAMED_MAX:
        return ""
    shown = [field for field in network.fields.STATE if not field[1] and field[0] not in UNTOLD]
    names = [name + ", off" * (node in result.counts.off) for node, (name, _) in enumerate(nodes)]
    rows = [
        (escape(name), *(str(int(get(cells, node, field[0]))) for field in shown))
        for node, name in enumerate(names)
    ]
    head = ("node", *(f'<span title="{escape(f[5])}">{f[0]}</span>, {escape(f[4])}' for f in shown))
    return section("Nodes at the end", table(head, rows))
