"""Any network in space: its nodes by their places or by who is linked, robots on their ways."""

from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np

from innervate.analysis.spread import laid_out
from innervate.export.rrd_parts import ALARM, GREY, INK, PORTS, Column, Parts
from innervate.network import networks
from innervate.scenario.actions import COMES, GOES
from innervate.scenario.robots import Walk, position_cm

STEP_US = 100_000  # between two places of a robot
OFF = 0.4  # of its radius, while a node is switched off
NODE = 0.15  # radius of a node in the distance between two that are linked
ROBOT = PORTS[1]
CM, MM = 0.01, 0.001  # in metres
DELIVERED = "delivered"


def has_places(plan: Any) -> bool:
    """Its graph has nodes; where nobody says where they lie, a link is about a metre long."""
    return bool(networks()[plan.kind].graph(plan).nodes)


def parts(rerun: Any, plan: Any, tables: Mapping[str, Any]) -> Parts:
    """All that is shown of a network of any medium; places become metres, all at height 0."""
    made = networks()[plan.kind].graph(plan)
    spots, unit = laid_out(made.nodes, made.edges)
    places = np.pad(spots * (MM if unit == "mm" else 1.0), ((0, 0), (0, 1))).astype(np.float32)
    number = {name: i for i, (name, _) in enumerate(made.nodes)}
    pairs = [(number[a], number[b]) for a, b, _ in made.edges]
    walks = getattr(plan, "walks", [])
    moving = {walk.node for walk in walks}
    fixed = [node for node in range(len(places)) if node not in moving]
    radius = NODE * _apart(places, pairs)
    strips = [places[[a, b]] for a, b in pairs if not moving & {a, b}]
    names = [made.nodes[node][0] for node in fixed]
    still = [
        ("network/nodes", rerun.Points3D(places[fixed], labels=names)),
        ("network/links", rerun.LineStrips3D(strips, colors=GREY, radii=radius / 8)),
    ]
    columns = [_nodes(rerun, plan, fixed, radius), _delivered(rerun, plan, tables)]
    columns += _cuts(rerun, plan, places, radius)
    for walk in walks:
        columns.append(_robot(rerun, plan, walk, made.nodes[walk.node][0], radius))
    views = [("Network", ["network/**", "robots/**"])]
    return Parts(still, columns, [], views, [DELIVERED])


def _apart(places: Any, pairs: list[tuple[int, int]]) -> float:
    """How far linked nodes are apart, in the middle, m; without links, how much room each has."""
    far = [float(np.linalg.norm(places[a] - places[b])) for a, b in pairs]
    apart = float(np.median(far)) if far else float(np.ptp(places, axis=0).max()) / len(places)
    return apart or 1.0


def off_over_time(plan: Any) -> dict[int, frozenset[int]]:
    """Who is off from when on, us: at the start, and whenever one goes or comes."""
    words = networks()[plan.kind].actions
    off = frozenset(np.flatnonzero(getattr(plan, "absent", [])).tolist())
    found = {0: off}
    for fault in plan.faults:
        if words[fault.action] in GOES:
            off = off | {fault.node}
        elif words[fault.action] in COMES:
            off = off - {fault.node}
        found[fault.at_us] = off
    return found


def _nodes(rerun: Any, plan: Any, fixed: list[int], radius: float) -> Column:
    """Colours and sizes of the nodes that stay where they are, whenever one goes or comes."""
    states = off_over_time(plan)
    colours = [GREY if node in off else INK for off in states.values() for node in fixed]
    sizes = [radius * (OFF if node in off else 1.0) for off in states.values() for node in fixed]
    made = rerun.Points3D.columns(colors=np.array(colours, np.uint8).reshape(-1, 3), radii=sizes)
    return Column("network/nodes", [*states], made.partition([len(fixed)] * len(states)))


def _cuts(rerun: Any, plan: Any, places: Any, radius: float) -> Iterator[Column]:
    """The links that are cut, whenever one is cut or restored."""
    words, cut = networks()[plan.kind].actions, dict[int, list[tuple[int, int]]]()
    now: list[tuple[int, int]] = []
    for fault in plan.faults:
        if words[fault.action] == "cut":
            now = [*now, _ends(plan, fault)]
        elif words[fault.action] == "restore":
            now = [pair for pair in now if pair != _ends(plan, fault)]
        else:
            continue
        cut[fault.at_us] = now
    if not cut:
        return
    strips = [places[[a, b]] for pairs in cut.values() for a, b in pairs]
    made = rerun.LineStrips3D.columns(
        strips=strips, colors=[ALARM] * len(strips), radii=[radius / 4] * len(strips)
    )
    yield Column("network/cuts", [*cut], made.partition([len(pairs) for pairs in cut.values()]))


def _ends(plan: Any, fault: Any) -> tuple[int, int]:
    """The nodes, lower first, of a link that is cut or restored."""
    if hasattr(fault, "other"):
        return min(fault.node, fault.other), max(fault.node, fault.other)
    a, b = (plan.graph.node_of(end) for end in (fault.end, plan.graph.peer[fault.end]))
    return min(a, b), max(a, b)


def way(walk: Walk, duration_us: int) -> tuple[list[int], list[tuple[float, float, float]]]:
    """Moments of a run, us, and where a robot is at each, m."""
    times = [*range(0, duration_us, STEP_US), duration_us]
    return times, [(CM * x, CM * y, 0.0) for x, y in (position_cm(walk, at) for at in times)]


def _robot(rerun: Any, plan: Any, walk: Walk, name: str, radius: float) -> Column:
    """Where a robot was, a little larger than nodes that stay; pale while it is off."""
    times, places = way(walk, plan.duration_us)
    states = off_over_time(plan)
    off = [walk.node in states[max(when for when in states if when <= at)] for at in times]
    made = rerun.Points3D.columns(
        positions=places,
        colors=[GREY if one else ROBOT for one in off],
        radii=[1.5 * radius * (OFF if one else 1.0) for one in off],
        labels=[name] * len(times),
    )
    return Column(f"robots/{rerun.escape_entity_path_part(name)}", times, made)


def _delivered(rerun: Any, plan: Any, tables: Mapping[str, Any]) -> Column:
    """How many messages were delivered so far, at each delivery."""
    times = sorted(tables["deliveries"]["time_us"]) if "deliveries" in tables else []
    count = {at: place for place, at in enumerate(times, 1)}
    counted = [0.0, *(float(number) for number in count.values())]
    return Column(DELIVERED, [0, *count], rerun.Scalars.columns(scalars=counted))
