"""A skin scenario in a few lines, without running it."""

from innervate.kernel.words import number_of
from innervate.networks.skin.scenario.foreseen import foreseen
from innervate.networks.skin.scenario.plan import RULES, UPDATES, Plan
from innervate.networks.skin.scenario.warnings import port_rate, warnings
from innervate.scenario.cables import fault_words as fault_words
from innervate.scenario.events import opening, told


def describe(made: Plan) -> str:
    """A plan in words, several lines, without a newline at the end."""
    graph, params = made.graph, made.params
    cables = sum(1 for _ in graph.links())
    ports = number_of(graph.interfaces, "interface port")
    rate_hz = made.scenario.model.data.rate_hz
    data = "off"
    if made.data_period_us:
        room, offered = graph.interfaces * port_rate(made), graph.cells * rate_hz
        rate = f"{offered:,.0f}" if offered >= 10 else f"{offered:.2g}"
        data = (
            f"{rate_hz:g} Hz per cell, {rate} samples a second; "
            f"{ports} carr{'y' if graph.interfaces != 1 else 'ies'} at most {room:,.0f}"
        )
    lines = [
        opening(made),
        f"  cells      {graph.cells:,}, {ports}, {number_of(cables, 'cable')}, "
        f"at most {number_of(made.depth_max, 'hop')} deep",
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
    return "\n".join([*lines, *told(made, fault_words, [*warnings(made), *foreseen(made)])])
