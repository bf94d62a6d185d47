"""A skin scenario in a few lines, without running it."""

from __future__ import annotations

from innervate.networks.skin.scenario.plan import LOSS_ONE, RULES, UPDATES, Fault, Plan
from innervate.networks.skin.scenario.warnings import port_rate, warnings
from innervate.scenario.actions.cables import ACTIONS, LOOSE
from innervate.scenario.events import told


def describe(made: Plan) -> str:
    """A plan in words, several lines, without a newline at the end."""
    graph, params = made.graph, made.params
    cables = sum(1 for _ in graph.links())
    ports = f"{graph.interfaces} interface port{'s' if graph.interfaces != 1 else ''}"
    rate_hz = made.scenario.model.data.rate_hz
    data = "off"
    if made.data_period_us:
        room = graph.interfaces * port_rate(made)
        data = (
            f"{rate_hz:g} Hz per cell, {graph.cells * rate_hz:,.0f} samples a second; "
            f"{ports} carr{'y' if graph.interfaces != 1 else 'ies'} at most {room:,.0f}"
        )
    lines = [
        f"{made.scenario.name}: a {made.kind} scenario of {made.duration_us / 1e6:g} s, "
        f"seed {made.seed}",
        f"  cells      {graph.cells:,}, {ports}, {cables:,} cables, "
        f"at most {made.depth_max} hops deep",
        f"  protocol   {RULES[params['rule']]}, {UPDATES[params['updates']]}, "
        f"a beacon every {params['beacon_us'] / 1000:g} ms, k = {params['k']}",
        f"  data       {data}",
    ]
    if made.touch is not None:
        lines.append(
            f"  touch      {made.touch.force_mn / 1000:g} N, "
            f"radius {made.touch.radius_um / 1000:g} mm"
        )
    if made.script:
        lines.append(f"  script     {len(made.script)} steps")
    return "\n".join([*lines, *told(made, fault_words, warnings(made))])


def fault_words(made: Plan, fault: Fault) -> str:
    """A fault in words: "at 2 s cut pc.1 - p0 r16 c7 down"."""
    graph = made.graph
    if fault.end >= 0:
        what = f"{graph.label_end(fault.end)} - {graph.label_end(graph.peer[fault.end])}"
    else:
        what = graph.label(fault.node)
    more = f", loss {fault.loss_q15 / LOSS_ONE:.3g}" if fault.action == LOOSE else ""
    more += f", {fault.frames} frames" if fault.frames else ""
    return f"at {fault.at_us / 1e6:g} s {ACTIONS[fault.action]} {what}{more}"
