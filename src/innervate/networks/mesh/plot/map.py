"""The field of a mesh as SVG: nodes, links, fence, robots, and the way an alarm took."""

from collections.abc import Collection, Sequence
from typing import Any, NamedTuple

from innervate.networks.mesh.analysis.alarms import Crossing
from innervate.networks.mesh.analysis.fence import rings_of
from innervate.networks.mesh.analysis.paths import Ground
from innervate.networks.mesh.analysis.way import Hop
from innervate.networks.mesh.plot.sheet import Labels, Sheet
from innervate.networks.mesh.protocol.constants import MONITOR
from innervate.plot import svg
from innervate.plot.charts import ticks
from innervate.plot.svg import Drawing, Point
from innervate.scenario.actions.field import RESTART, REVIVE
from innervate.scenario.robots import position_cm

NAMED_MAX = 120  # of more nodes only those with a part to play are named
CROSSINGS_MAX = 24  # marks of more crossings would hide the field
CORNERS_MAX = 40  # of a walk that keep names away
RING_PX = 4.0


def roles(plan: Any) -> dict[int, str]:
    """What nodes are besides relays: gateway, monitor, standby, robot; "" for the others."""
    monitor = plan.params["monitor"]
    found = {}
    for node in range(plan.nodes):
        words = []
        if plan.ranks[node] == 0:
            words.append("gateway")
        elif plan.ranks[node] > 0:
            words.append("standby")
        if node == monitor and (plan.walks or plan.params["points"]):
            words.append("monitor")
        if plan.robots[node]:
            words.append("robot")
        found[node] = " and ".join(words)
    return found


def monitor_of(plan: Any) -> int:
    """Who gets the alarms, at the start."""
    monitor = int(plan.params["monitor"])
    return int(plan.ranks.index(0)) if monitor == MONITOR else monitor


class Alarmed(NamedTuple):
    """The way of one alarm."""

    sent: Sequence[Hop] = ()  # all its transmissions; who flooded it gets a ring
    way: Sequence[Hop] = ()  # the hops that brought it to the monitor
    at_us: int | None = None  # who was off then is crossed out; None = at the end


NO_ALARM = Alarmed()


class Field(NamedTuple):
    """A field that is being drawn."""

    drawing: Drawing
    plan: Any
    sheet: Sheet  # where nodes lie
    names: Labels  # where there is room for names
    on: Sequence[bool]  # which nodes are


def field_map(
    result: Any, sheet: Sheet, title: str, crossings: Sequence[Crossing] = (),
    alarm: Alarmed = NO_ALARM,
) -> Drawing:  # fmt: skip
    """The field, with the crossings of a run, numbered, and the way of one alarm."""
    plan, way, at_us = result.plan, alarm.way, alarm.at_us
    drawing = Drawing(sheet.width, sheet.height, title)
    places = robot_places(plan, sheet, way[0].start_us if way else None)
    names = Labels(sheet.width, sheet.height)
    on = Ground(plan).on_at(result.ended_us if at_us is None else at_us)
    field = Field(drawing, plan, sheet, names, on)
    ground(field)
    walks(field)
    ringed = {hop.node for hop in alarm.sent if hop.flooded}
    for node in sorted(ringed):
        drawing.circle(places[node], sheet.dot + RING_PX + 2, "flooder")
    for hop in way:
        to = hop.to if hop.to < plan.nodes else _next_of(way, hop, monitor_of(plan))
        names.block_line([places[hop.node], places[to]])
        drawing.path(svg.arrow(places[hop.node], places[to], sheet.dot + 3), "way")
    pins = _pins(field, crossings)
    for x, y in pins:
        names.block((x, y - 8), 8.0)
    nodes(field, places, ringed)
    marks(field, pins)
    return drawing


def _next_of(way: Sequence[Hop], hop: Hop, last: int) -> int:
    """Who heard a flooded hop: whoever sent the next one."""
    behind = way.index(hop) + 1
    return way[behind].node if behind < len(way) else last


def robot_places(plan: Any, sheet: Sheet, at_us: int | None) -> dict[int, Point]:
    """Places of all nodes; of robots at a time, if one is given."""
    found = {node: sheet.node(node) for node in range(plan.nodes)}
    if at_us is not None and sheet.metres:
        for walk in plan.walks:
            found[walk.node] = sheet.of_cm(position_cm(walk, at_us))
    return found


def ground(field: Field) -> None:
    """Fence, links between nodes that stay where they are, and a scale."""
    drawing, plan, sheet, names, on = field
    found = rings_of(plan) if sheet.metres else []
    rings = [[sheet.of_cm(corner) for corner in ring] for ring in found]
    if rings:
        drawing.path("".join(svg.polyline(ring) + "z" for ring in rings), "zone")
    links = [(a, b) for a, b in plan.good if not (plan.robots[a] or plan.robots[b])]
    for a, b in links:
        drawing.line(*sheet.between(a, b), "mesh" if on[a] and on[b] else "mesh gone")
    names.avoid(sheet.between(a, b) for a, b in links)
    for ring in rings:
        drawing.path(svg.polyline(ring) + "z", "fence")
        names.block_line([*ring, ring[0]])
    if sheet.metres:
        _measure(drawing, sheet)


def _measure(drawing: Drawing, sheet: Sheet) -> None:
    """A bar that says how long so many metres are."""
    metres = ticks(0.0, 130.0 / (100 * sheet.scale), 2)[-1]
    long = 100 * metres * sheet.scale
    if long < 1:
        return
    x, y = sheet.width - 14 - long, sheet.height - 12
    drawing.path(f"M{x:g},{y - 4:g}v4h{svg.number(long)}v-4", "axis")
    drawing.text((x + long / 2, y - 6), f"{metres:g} m", "small", "middle")


def walks(field: Field) -> None:
    """The ways that robots walk; nothing if the sheet has no metres."""
    drawing, plan, sheet, names, _ = field
    for walk in plan.walks if sheet.metres else ():
        points = [sheet.of_cm((x, y)) for _, x, y in walk.points]
        if len(points) > 1:
            drawing.path(svg.polyline(points), "walk")
            names.block_line(points[:CORNERS_MAX])


def _pins(field: Field, crossings: Sequence[Crossing]) -> list[Point]:
    """Where robots left the fence, in order of time; none if the sheet has no metres."""
    walk_of = {walk.node: walk for walk in field.plan.walks}
    return [
        field.sheet.of_cm(position_cm(walk_of[crossing.robot], crossing.crossed_us))
        for crossing in (crossings[:CROSSINGS_MAX] if field.sheet.metres else ())
    ]


def marks(field: Field, pins: Sequence[Point]) -> None:
    """Pins where robots left the fence, numbered."""
    for i, (x, y) in enumerate(pins, 1):
        field.drawing.path(pin((x, y)), "warn")
        place = field.names.put((x, y - 8), str(i), 11.0, strong=True)
        if place is not None:
            field.drawing.text(place[0], str(i), "alarm strong", place[1])


def pin(at: Point) -> str:
    """Path data of a pin whose tip is at a place."""
    return svg.polygon(at[0], at[1], [(0, 0), (-5, -13), (5, -13)])


def nodes(field: Field, places: dict[int, Point], ringed: Collection[int] = ()) -> None:
    """Nodes by their shapes, and as many names as there is room for; `ringed`: with a ring."""
    drawing, plan, sheet, names, on = field
    role = roles(plan)
    for node in range(plan.nodes):
        symbol(drawing, places[node], sheet.dot, role[node], on[node], _tip(plan, node, role))
        names.block(places[node], sheet.dot + (RING_PX + 1 if node in ringed else 2))
    # Those with a part to play are named first: the others find what room is left.
    for node in sorted(range(plan.nodes), key=lambda i: (not role[i], i)):
        if plan.nodes > NAMED_MAX and not role[node]:
            break
        words = plan.names[node] + (f" {role[node]}" if role[node] else "")
        gap = sheet.dot + (9 if role[node] or node in ringed else 4)
        place = names.put(places[node], words, gap, strong=bool(role[node]))
        if place is not None:
            drawing.text(place[0], words, "small strong" if role[node] else "small", place[1])


def _tip(plan: Any, node: int, role: dict[int, str]) -> str:
    return f"{plan.names[node]} (number {node}){', ' + role[node] if role[node] else ''}"


def symbol(drawing: Drawing, at: Point, dot: float, role: str, on: bool, tip: str = "") -> None:
    """A node by its role: square, diamond, triangle, disc; the monitor ringed, off crossed."""
    x, y = at
    if "gateway" in role or "standby" in role:
        size = dot + 1.5 if "gateway" in role else dot + 3
        corners = [(-size, -size), (size, -size), (size, size), (-size, size)]
        if "standby" in role:
            corners = [(0, -size), (size, 0), (0, size), (-size, 0)]
        drawing.path(svg.polygon(x, y, corners), "leader" if on else "off", tip)
    elif "robot" in role:
        size = dot + 2.5
        drawing.path(svg.polygon(x, y, [(0, -size), (size, size), (-size, size)]),
                     "robot" if on else "off", tip)  # fmt: skip
    else:
        round_ = f"M{svg.number(x - dot)},{svg.number(y)}"
        arc = f"a{svg.number(dot)},{svg.number(dot)} 0 1 0 "
        data = f"{round_}{arc}{svg.number(2 * dot)},0{arc}{svg.number(-2 * dot)},0z"
        drawing.path(data, "relay" if on else "off", tip)
    if "monitor" in role:
        drawing.circle(at, dot + RING_PX, "ringed")
    if not on:
        drawing.path(svg.cross(x, y, dot + 2), "struck")


def _off_words(ground: Ground, at_us: int) -> str:
    """Why those are off that are off at a moment; "" if nobody is."""
    plan = ground.plan
    begun = {node for node in range(plan.nodes)
             if not plan.absent[node] and plan.starts_us[node] <= at_us}  # fmt: skip
    begun |= {fault.node for fault in plan.faults
              if fault.action in (REVIVE, RESTART) and fault.at_us <= at_us}  # fmt: skip
    off = {node for node, on in enumerate(ground.on_at(at_us)) if not on}
    said = ("switched off" if off & begun else "", "yet to come" if off - begun else "")
    return ", or ".join(filter(None, said))


def legend(
    result: Any, crossings: Sequence[Crossing], way: Sequence[Hop], at_us: int | None = None
) -> list[tuple[Drawing, str]]:
    """What the shapes of a map stand for, of those that it shows; of a moment, or the end."""
    plan, role = result.plan, set(" ".join(roles(result.plan).values()).split())
    entries: list[tuple[Drawing, str]] = []

    def entry(words: str, draw: Any) -> None:
        icon = Drawing(26, 18, words)
        draw(icon)
        entries.append((icon, words))

    def shape(name: str, on: bool = True) -> Any:
        return lambda icon: symbol(icon, (13, 9), 4.5, name, on)

    for name in ("gateway", "standby", "monitor", "robot"):
        if name in role:
            entry(name, shape(name))
    entry("good link between nodes that stay", lambda icon: icon.line((1, 9), (25, 9), "mesh"))
    off = _off_words(Ground(plan), result.ended_us if at_us is None else at_us)
    if off:
        entry(off, shape("", False))
    if plan.params["points"]:
        entry("fence", lambda icon: icon.line((1, 9), (25, 9), "fence"))
    if plan.walks:
        entry("way of a robot", lambda icon: icon.line((1, 9), (25, 9), "walk"))
    if crossings:
        entry("crossing", lambda icon: icon.path(pin((13, 16)), "warn"))
    if way:
        entry("how the alarm came", lambda icon: icon.path(svg.arrow((0, 9), (26, 9), 1), "way"))
        if any(hop.flooded for hop in way) or crossings:
            entry("flooded it", lambda icon: icon.circle((13, 9), 7.5, "flooder"))
    return entries
