"""What makes a skin's scenario weaker than it looks, told before it runs."""

from math import ceil

from innervate.networks.skin.scenario.plan import RULES, UPDATES, Plan
from innervate.networks.skin.scenario.rules import ONE
from innervate.networks.skin.scenario.touch import Touch
from innervate.scenario.cables import LOSS_ONE
from innervate.topology import Graph
from innervate.topology.layout import cell_places
from innervate.topology.weak import weak_points

SETTLE_PERIODS = 3  # beyond the beacons that have to be heard: measured on lines and patches


def warnings(made: Plan) -> list[str]:
    """A sentence for each; none if all is well."""
    if made.script:
        return []
    if made.loss_q15 == LOSS_ONE:
        return ["nobody gets any frame: timing.loss is 1"]
    return [*_touch(made), *_start_up(made), *_load(made)]


def _touch(made: Plan) -> list[str]:
    touch = made.touch
    if touch is None:
        return []
    if not made.data_period_us:
        return ["there is a [touch], but cells send no data, so nobody learns of it; "
                "set data.rate_hz"]  # fmt: skip
    if _comes_near(touch, made.graph):
        return []
    return [
        f"the touch stays more than {touch.radius_um / 1000:g} mm away from all cells, so none "
        "feels it; see touch.path, in mm from the top left cell"
    ]


def _comes_near(touch: Touch, graph: Graph) -> bool:
    """True if it reaches into the rectangle around all cells, which begins at 0, 0."""
    radius = touch.radius_um
    right, bottom = (1000 * max(along) for along in zip(*cell_places(graph), strict=True))
    return any(
        -radius <= x <= right + radius and -radius <= y <= bottom + radius
        for x, y in zip(touch.x_um, touch.y_um, strict=True)
    )


def start_up_us(made: Plan) -> int:
    """About how long it takes at most until every cell has a way, from switching on.

    A port works once as many beacons were heard as make it whole; then routes spread from the PC,
    a period a hop if updates are periodic, else as fast as cells pass news on.
    """
    params = made.params
    heard = ceil(ONE / params["r_r"]) + SETTLE_PERIODS
    by_period = params["updates"] == UPDATES.index("periodic")
    static = params["rule"] == RULES.index("static")
    hop_us = made.wire_us + made.latency_us[1] + params["forward_max_us"]
    if by_period and not static:
        hop_us = params["beacon_us"]
    return heard * params["beacon_us"] + made.depth_max * hop_us


def _start_up(made: Plan) -> list[str]:
    needed_us = start_up_us(made)
    if made.duration_us >= needed_us:
        return []
    return [
        f"the run may end before every cell has a way to the PC: with a beacon every "
        f"{made.params['beacon_us'] / 1000:g} ms that takes up to about {needed_us / 1e6:.3g} s, "
        f"and duration_s is {made.duration_us / 1e6:g}"
    ]


def port_rate(made: Plan) -> float:
    """Samples a second that one cable can carry beside the beacons."""
    return max(0.0, 1e6 / made.wire_us - 1e6 / made.params["beacon_us"])


def _load(made: Plan) -> list[str]:
    """Samples that cannot reach the PC, whatever the protocol does."""
    if not made.data_period_us:
        return []
    graph, one = made.graph, port_rate(made)
    rate = float(made.scenario.model.data.rate_hz)
    offered, room = graph.cells * rate, graph.interfaces * one
    if offered > room:
        ports = f"{graph.interfaces:,} interface ports carry"
        if graph.interfaces == 1:
            ports = "the only interface port carries"
        lost = f"{int(100 * (1 - room / offered))} % or more are lost in the long run"
        return [
            f"{graph.cells:,} cells offer {offered:,.0f} samples a second, but {ports} at most "
            f"{room:,.0f}: {lost}"
        ]
    if offered <= one:
        return []
    tight = [weak for weak in weak_points(graph) if weak.end >= 0 and weak.isolated * rate > one]
    if not tight:
        return []
    worst = tight[0]
    cable = f"{graph.label_end(worst.end)} - {graph.label_end(graph.peer[worst.end])}"
    return [
        f"{worst.isolated:,} cells offer {worst.isolated * rate:,.0f} samples a second over the "
        f"only cable between them and the PC, {cable}, which carries at most {one:,.0f}"
    ]
