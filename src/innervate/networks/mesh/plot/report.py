"""The part of a report that is about meshes."""

from collections import Counter
from collections.abc import Mapping
from functools import partial
from typing import Any

from innervate.kernel.words import number_of
from innervate.networks.mesh.analysis.alarms import Crossing, all_crossings
from innervate.networks.mesh.analysis.messages import NEVER
from innervate.networks.mesh.analysis.network import gateways
from innervate.networks.mesh.analysis.nodes import nodes
from innervate.networks.mesh.analysis.way import copies, way
from innervate.networks.mesh.plot import charts as mesh_charts
from innervate.networks.mesh.plot import film as mesh_film
from innervate.networks.mesh.plot import map as mesh_map
from innervate.networks.mesh.plot.sheet import Sheet
from innervate.networks.mesh.plot.words import REPORTS, fault_words, opening, sentences
from innervate.networks.mesh.scenario.words import forwarding
from innervate.plot import page, svg, words
from innervate.plot.page import ROWS_MAX, details, figure, keys, pictures, section, table, tiles

OPEN_MAX = 40  # a longer table of nodes is folded
NODES_HEAD = ("node", "role", "neighbours", "depth", "table", "control bytes", "forwarded",
              "on the air", "suspected")  # fmt: skip


def body(result: Any, summary: Mapping[str, Any]) -> str:
    """Headline, status, numbers and pictures of a mesh run, as HTML."""
    crossings = all_crossings(result)
    sheet = Sheet(result.plan)
    return page.joined(
        top(result, summary),
        field(result, sheet, crossings),
        _film(result, sheet, crossings),
        _charts(result, summary, crossings),
        _crossings(result, crossings),
        nodes_section(result),
        _flows(result, summary),
        page.events(result, partial(fault_words, result.plan)),
        _reports(result),
    )


def notebook(result: Any, summary: Mapping[str, Any]) -> str:
    """What a notebook shows of a run, as HTML."""
    return top(result, summary) + field(result, Sheet(result.plan), all_crossings(result))


def top(result: Any, summary: Mapping[str, Any]) -> str:
    """What happened, and the figures to know."""
    model = result.plan.scenario.model
    over = (
        f"{opening(summary)}, radio {model.radio.profile}, "
        f"failover {forwarding(result.plan)}; seed {summary['seed']}"
    )
    said = page.paragraphs(sentences(result, summary))
    return page.top(over, summary, said, tiles(_figures(result, summary)))


def _figures(result: Any, summary: Mapping[str, Any]) -> list[tuple[str, str]]:
    found, latency, alarms = [], summary["latency_ms"], summary["alarms"]
    if alarms["delivered"]:
        found.append((words.ms_words(alarms["latency_ms"]["p99"]), "99 % of the alarms took that"))
        found.append((f"{words.figure_words(alarms['overrun_m']['p99'], 2)} m",
                      "99 % of the robots were no farther out"))  # fmt: skip
    if summary["delivery_ratio"] is not None:
        found.append((words.share_words(summary["delivery_ratio"]), "of the messages delivered"))
    if latency["p50"] is not None:
        found.append((words.ms_words(latency["p50"]), "median latency of messages"))
    if summary["discovery"]["recall"] is not None:
        share = words.share_words(summary["discovery"]["recall"])
        found.append((share, "of the good links found in the first round"))
    busiest = summary["airtime"]["busiest_share"]
    name = result.plan.names[summary["airtime"]["busiest"]]
    found.append((words.share_words(busiest), f"of the time node {name}, the busiest, sent"))
    return [*found, page.took(summary, result.ended_us / 1e6)]


def shown_crossing(crossings: list[Crossing]) -> Crossing | None:
    """The crossing that pictures show: one that the monitor never heard of, else the slowest."""
    raised = [crossing for crossing in crossings if crossing.raised_us != NEVER]
    missed = [c for c in raised if c.accepted_us == NEVER and not c.open]
    came = [crossing for crossing in raised if crossing.accepted_us != NEVER]
    if missed:
        return missed[0]
    return max(came, key=lambda c: c.accepted_us - c.raised_us, default=None)


def field(result: Any, sheet: Sheet, crossings: list[Crossing]) -> str:
    """The map, with the way of the alarm that took longest."""
    shown = shown_crossing(crossings)
    sent = copies(result, shown) if shown is not None else []
    hops = way(result, shown, sent) if shown is not None else []
    at_us = shown.crossed_us if shown is not None else None
    drawing = mesh_map.field_map(
        result, sheet, "The field", crossings, mesh_map.Alarmed(sent, hops, at_us)
    )
    text = "Nodes where they are; lines are links that were good in both directions at the start."
    if not sheet.metres:
        text = "Nodes that hear each other lie near each other; it is no map of where they are."
    if shown is not None and hops:
        number = crossings.index(shown) + 1
        text += (
            f" The alarm of crossing {number}, the slowest, and who was off then: "
            f"{number_of(len(hops), 'hop')}, {'flooded' if shown.flooded else 'routed'}."
        )
    led = [gateway["node"] for gateway in gateways(result)]
    if led and result.plan.ranks[led[-1]] != 0:
        text += f" Roles are those at the start: at the end {result.plan.names[led[-1]]} leads."
    inside = keys(mesh_map.legend(result, crossings, hops, at_us))
    return section("The field", f'<div class="wide map">{figure(drawing, "", text)}</div>' + inside)


def _film(result: Any, sheet: Sheet, crossings: list[Crossing]) -> str:
    shown = shown_crossing(crossings)
    if shown is None:
        return ""
    drawing = mesh_film.film(result, shown, sheet)
    number = crossings.index(shown) + 1
    low, high = mesh_film.window(shown, result.ended_us)
    slower = mesh_film.CYCLE_S / ((high - low) / 1e6)
    text = (
        f"Crossing {number} at {shown.crossed_us / 1e6:.3f} s, {slower:.0f} times slower than it "
        "was. Arrows are the routed copy of the alarm, dashed where nobody heard it; waves its "
        "flood; grey lines and rings all other packets. Acks of hops are left out."
    )
    inside = figure(drawing, "", text)
    controls = page.film_controls(mesh_film.CYCLE_S)
    steps = details("The same, step by step", _steps(result, shown))
    return section(
        "A crossing, in slow motion", f'<div class="wide map film">{inside}{controls}</div>{steps}'
    )


def _steps(result: Any, crossing: Crossing) -> str:
    """Every transmission of an alarm, as a table."""
    names = [svg.clean(name) for name in result.plan.names]
    rows = []
    for hop in copies(result, crossing)[:ROWS_MAX]:
        to = names[hop.to] if hop.to < len(names) else "all"
        rows.append((
            f"{(hop.start_us - crossing.raised_us) / 1e3:.1f}",
            names[hop.node],
            to,
            "flooded" if hop.flooded else "routed",
            f"{hop.path_len}",
            f"{hop.receivers}",
        ))  # fmt: skip
    return table(("ms after the alarm", "from", "to", "copy", "hop", "heard by"), rows)


def _charts(result: Any, summary: Mapping[str, Any], crossings: list[Crossing]) -> str:
    figures = [
        mesh_charts.latency(result, summary),
        mesh_charts.over_time(result),
        mesh_charts.alarms(result.plan, crossings),
        mesh_charts.airtime(summary),
    ]
    return section("How well it went", pictures([page.panel(one) for one in figures if one], "two"))


def _crossings(result: Any, crossings: list[Crossing]) -> str:
    """A line for every crossing."""
    if not crossings:
        return ""
    names = [svg.clean(name) for name in result.plan.names]
    rows = []
    for i, crossing in enumerate(crossings, 1):
        came = crossing.accepted_us != NEVER
        by = "nobody noticed" if crossing.raised_by == NEVER else names[crossing.raised_by]
        warned = crossing.warned_us != NEVER
        rows.append((
            str(i),
            f"{crossing.crossed_us / 1e6:.3f} s",
            names[crossing.robot],
            by,
            words.ms_words((crossing.accepted_us - crossing.raised_us) / 1e3) if came else
            "still open at the end" if crossing.open else "never",
            f"{crossing.hops}, {'flooded' if crossing.flooded else 'routed'}" if came else "",
            f"{words.figure_words(crossing.overrun_m, 2)} m",
            words.ms_words((crossing.crossed_us - crossing.warned_us) / 1e3) + " before"
            if warned else "no",
        ))  # fmt: skip
    head = ("number", "at", "robot", "raised by", "monitor knew after", "hops", "overrun", "warned")
    return section("Crossings", page.beginning(head, rows, ", in crossings.parquet"))


def nodes_section(result: Any) -> str:
    """The section "Node by node"."""
    plan, role = result.plan, mesh_map.roles(result.plan)
    rows = []
    for node in nodes(result):
        leads = node.on and node.depth == 0 and plan.ranks[node.node] > 0
        said = (role[node.node], "leads" if leads else "", "" if node.on else "off")
        what = ", ".join(word for word in said if word)
        rows.append((
            svg.clean(plan.names[node.node]),
            what,
            f"{node.neighbours}",
            "unknown" if node.depth is None else f"{node.depth}",
            f"{node.version}" if node.version else "none",
            f"{node.control_bytes:,}",
            f"{node.forwarded:,}",
            words.share_words(node.share),
            f"{node.suspected:,}",
        ))  # fmt: skip
    made = table(NODES_HEAD, rows)
    if len(rows) > OPEN_MAX:
        made = details(f"All {len(rows)} nodes", made)
    return section("Node by node", made)


def _flows(result: Any, summary: Mapping[str, Any]) -> str:
    """A line for every flow of the scenario."""
    flows = summary["flows"]
    if len(flows) < 2:
        return ""
    model = result.plan.scenario.model
    rows = []
    for flow in flows[:ROWS_MAX]:
        asked = model.flow[flow["flow"]]
        latency, ratio = flow["latency_ms"], flow["delivery_ratio"]
        rows.append((
            svg.clean(f"{asked.from_} to {asked.to}"),
            f"{flow['offered']:,}",
            "" if ratio is None else words.share_words(ratio),
            "" if latency["p50"] is None else words.ms_words(latency["p50"]),
            "" if latency["p99"] is None else words.ms_words(latency["p99"]),
        ))  # fmt: skip
    head = ("flow", "messages", "delivered", "half within", "99 % within")
    return section("Flows", table(head, rows))


def _reports(result: Any) -> str:
    """How often nodes reported what."""
    kinds = Counter(REPORTS.get(code, f"code {code}") for code in result.rows["code"].tolist())
    cells = [(svg.clean(name), f"{count:,}") for name, count in kinds.most_common()]
    inside = details("How often which report", table(("what", "times"), cells)) if cells else ""
    return section("What the nodes reported", inside)
