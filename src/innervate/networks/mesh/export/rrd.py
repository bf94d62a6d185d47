"""A mesh in its field: nodes, good links and the fence, robots on their ways, alarms."""

from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np

from innervate.export.declared_rrd import OFF, off_over_time, way
from innervate.export.recording import INFORMATION, WARNING
from innervate.export.rrd_parts import ALARM, GREY, INK, PORTS, Column, Log, Parts

NODE_M, GATEWAY_M, ROBOT_M = 0.6, 1.1, 1.0  # radii
ROBOT, INSIDE = PORTS[1], PORTS[2]


def has_places(plan: Any) -> bool:
    """Its nodes lie somewhere in space."""
    return bool(plan.positions_cm)


def parts(rerun: Any, plan: Any, tables: Mapping[str, Any]) -> Parts:
    """All that is shown of a mesh; positions become metres, all of them at height 0."""
    places = np.array([(x / 100, y / 100, 0.0) for x, y in plan.positions_cm], np.float32)
    moving = {walk.node for walk in plan.walks}
    fixed = [node for node in range(plan.nodes) if node not in moving]
    crossings = list(tables["crossings"].iter_rows(named=True)) if "crossings" in tables else []
    names = [plan.names[node] for node in fixed]
    still = [
        ("field/nodes", rerun.Points3D(places[fixed], labels=names)),
        ("field/links", _links(rerun, plan, places, moving)),
    ]
    fence = plan.scenario.model.fence
    if fence is not None:
        rings = [[(x, y, 0.0) for x, y in (*ring, ring[0])]
                 for ring in (fence.polygon, *fence.holes)]  # fmt: skip
        still.append(("field/fence", rerun.LineStrips3D(rings, colors=ALARM, radii=0.15)))
    columns = [_nodes(rerun, plan, fixed), *_robots(rerun, plan, crossings)]
    views = [("Field", ["field/**", "robots/**"])]
    return Parts(still, columns, list(_alarms(plan, crossings)), views, [])


def _links(rerun: Any, plan: Any, places: Any, moving: set[int]) -> Any:
    good = [pair for pair in plan.good if not moving & set(pair)]
    strips = [places[[a, b]] for a, b in good]
    return rerun.LineStrips3D(strips, colors=GREY, radii=0.05)


def _nodes(rerun: Any, plan: Any, fixed: list[int]) -> Column:
    """Colours and sizes of the nodes that stay where they are, whenever one goes or comes."""
    latest = off_over_time(plan)
    colours = [[GREY if node in gone else INK if plan.ranks[node] >= 0 else PORTS[0]
                for node in fixed] for gone in latest.values()]  # fmt: skip
    sizes = [[(GATEWAY_M if plan.ranks[node] >= 0 else NODE_M) * (OFF if node in gone else 1.0)
              for node in fixed] for gone in latest.values()]  # fmt: skip
    made = rerun.Points3D.columns(
        colors=np.array(colours, np.uint8).reshape(-1, 3), radii=np.array(sizes).reshape(-1)
    )
    return Column("field/nodes", list(latest), made.partition([len(fixed)] * len(latest)))


def _robots(rerun: Any, plan: Any, crossings: list[dict[str, Any]]) -> Iterator[Column]:
    """Where each robot was, larger and in the fence's colour while it was outside."""
    for walk in plan.walks:
        times, places = way(walk, plan.duration_us)
        outside = [
            any(one["robot"] == walk.node and one["crossed_us"] <= at < one["back_us"]
                for one in crossings)
            for at in times
        ]  # fmt: skip
        made = rerun.Points3D.columns(
            positions=places,
            colors=[ALARM if out else ROBOT for out in outside],
            radii=[ROBOT_M * (1.5 if out else 1.0) for out in outside],
            labels=[plan.names[walk.node]] * len(times),
        )
        name = rerun.escape_entity_path_part(plan.names[walk.node])
        yield Column(f"robots/{name}", times, made)


def _alarms(plan: Any, crossings: list[dict[str, Any]]) -> Iterator[Log]:
    for one in crossings:
        robot = plan.names[one["robot"]]
        yield one["crossed_us"], f"{robot} left the fence", WARNING
        if one["raised_us"] is not None:
            by = plan.names[one["raised_by"]]
            yield one["raised_us"], f"{by} raised the alarm for {robot}", WARNING
        if one["accepted_us"] is not None:
            far = f"{one['overrun_m']:.1f} m outside"
            yield one["accepted_us"], f"the monitor knows that {robot} is out, {far}", WARNING
        if one["back_us"] < plan.duration_us:
            yield one["back_us"], f"{robot} is back", INFORMATION
