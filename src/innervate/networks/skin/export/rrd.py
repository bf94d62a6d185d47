"""A skin in space: cells where they lie and the way they face, and what each of them did."""

from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import numpy as np

from innervate.export import rrd_parts
from innervate.export.rrd_parts import ALARM, GREY, INK, PALE, PORTS, Column, Parts
from innervate.networks.skin.analysis.load import interfaces_along
from innervate.networks.skin.export.states import States
from innervate.scenario.actions.cables import CUT, KILL, RESTORE, REVIVE

STEP_US = 10_000  # between two states, unless these would be too many
STATES_MAX = 2000
HZ_WITHOUT_DATA = 250  # load is shown as if cells sampled so often
FORCE_MAX_MN = 3000
RADIUS_M, LIFTED_M = 0.006, 0.008
WITHOUT_ROUTE, OFF = 0.6, 0.3  # of that radius
POINTS_MAX = 1000  # of a shape, when it is asked how near it is


def has_places(plan: Any) -> bool:
    """Its nodes lie somewhere in space."""
    return True


def parts(rerun: Any, plan: Any, tables: Mapping[str, Any]) -> Parts:
    """All that is shown of a skin."""
    step_us = max(STEP_US, -(-plan.duration_us // STATES_MAX))
    states = States(plan, tables, step_us)
    places = np.array(states.places, np.float32)
    labels = [plan.graph.label(cell) for cell in range(plan.graph.cells)]
    touched = plan.touch is not None and len(tables.get("received", ())) > 0
    shown = ["state", "load", *(["touch"] if touched else [])]
    still = []
    for name in shown:  # what never changes hides what changes: the sizes of "state" come below
        size = {} if name == "state" else {"radii": RADIUS_M}
        cells = rerun.Points3D(places, labels=labels, show_labels=False, **size)
        still.append((f"skin/{name}", cells))
    around = ["skin/interfaces", "skin/parents", "skin/cuts"]
    still.append(_interfaces(rerun, plan, places))
    lifted = places  # where lines go: in front of the robot's surface
    if normals := _normals(plan):
        facing = np.array(normals, np.float32)
        lifted = places + LIFTED_M * facing
        arrows = rerun.Arrows3D(vectors=0.02 * facing, origins=places, colors=INK, radii=0.0007)
        still.append(("skin/normals", arrows))
        around.append("skin/normals")
    still.append(("unrouted", rerun.SeriesLines(interpolation_mode="StepAfter")))
    body = list(_body(rerun, plan))
    columns = [*_over_time(rerun, plan, states, lifted, touched), *_cuts(rerun, plan, lifted)]
    columns.append(_unrouted(rerun, plan, tables))
    named = [name for name, _ in body]
    views = [(name.capitalize(), [f"skin/{name}", *around, *named]) for name in shown]
    return Parts([*still, *body], columns, [], views, ["unrouted"])


def _over_time(
    rerun: Any, plan: Any, states: States, places: Any, touched: bool
) -> Iterator[Column]:
    """Colours of all cells and ways to their parents, whenever they changed."""
    colours = {name: _Changes() for name in ("state", "load", "touch")}
    sizes, ways = _Changes(), _Changes()
    rate_hz = 1e6 / plan.data_period_us if plan.data_period_us else HZ_WITHOUT_DATA
    share = rate_hz * plan.wire_us * 1e-6  # of a cable that one cell's samples take
    for at, now in states.snapshots():
        port, load = _ports_and_loads(now)
        off = _off(plan, at)
        look = [(GREY, OFF) if cell in off else (ALARM, WITHOUT_ROUTE) if to < 0 else
                (PORTS[to % len(PORTS)], 1.0) for cell, to in enumerate(port)]  # fmt: skip
        colours["state"].add(at, np.array([colour for colour, _ in look], np.uint8))
        sizes.add(at, RADIUS_M * np.array([size for _, size in look], np.float32))
        colours["load"].add(at, rrd_parts.heat(np.minimum(1.0, share * np.array(load))))
        if touched:
            known = np.array(now.known(at))
            force = np.where(known, np.array(now.force) / FORCE_MAX_MN, 0.0)
            colours["touch"].add(at, rrd_parts.heat(np.clip(force, 0.0, 1.0)))
        pairs = [(cell, to) for cell, to in enumerate(now.hop) if 0 <= to < now.graph.sink]
        ways.add(at, np.array(pairs, np.int64).reshape(-1, 2))
    for name, changes in colours.items():
        if changes.rows:
            made = rerun.Points3D.columns(colors=np.concatenate(changes.rows))
            yield Column(f"skin/{name}", changes.times_us, made.partition(changes.lengths))
    made = rerun.Points3D.columns(radii=np.concatenate(sizes.rows))
    yield Column("skin/state", sizes.times_us, made.partition(sizes.lengths))
    yield _strips(rerun, "skin/parents", ways, places, INK, 0.001)


def _off(plan: Any, at: int) -> set[int]:
    """Cells that are switched off at a moment."""
    last = {fault.node: fault.action for fault in plan.faults
            if fault.at_us <= at and fault.action in (KILL, REVIVE)}  # fmt: skip
    return {node for node, action in last.items() if action == KILL}


class _Changes:
    """Values over time, without those that are the same as before."""

    def __init__(self) -> None:
        self.times_us: list[int] = []
        self.rows: list[Any] = []

    def add(self, at: int, row: Any) -> None:
        if not self.rows or not np.array_equal(self.rows[-1], row):
            self.times_us.append(at)
            self.rows.append(row)

    @property
    def lengths(self) -> list[int]:
        return [len(row) for row in self.rows]


def _ports_and_loads(now: States) -> tuple[list[int], list[int]]:
    """Per cell the interface port that its chain leads to, -1 none; how many cells send over it."""
    load = [int(hops > 0) for hops in now.hops]
    for cell in sorted(range(len(load)), key=lambda cell: -now.hops[cell]):
        if now.hops[cell] > 1:
            load[now.hop[cell]] += load[cell]
    return interfaces_along(now.graph, np.array(now.parent, np.int64)).tolist(), load


def _strips(
    rerun: Any, name: str, pairs: _Changes, places: Any, colour: rrd_parts.Rgb, radius: float
) -> Column:
    """Lines between pairs of cells."""
    ends = np.concatenate(pairs.rows) if pairs.rows else np.empty((0, 2), np.int64)
    strips = rerun.LineStrips3D.columns(strips=list(places[ends]))
    count = len(pairs.rows)
    look = rerun.LineStrips3D.columns(colors=[colour] * count, radii=[radius] * count)
    return Column(name, pairs.times_us, [*strips.partition(pairs.lengths), *look])


def _cuts(rerun: Any, plan: Any, places: Any) -> Iterator[Column]:
    """Cables between cells that the scenario has cut, from then on."""
    cut: set[tuple[int, int]] = set()
    changes = _Changes()
    for fault in plan.faults:
        if fault.action in (CUT, RESTORE) and fault.end >= 0:
            graph = plan.graph
            pair = (graph.node_of(fault.end), graph.node_of(graph.peer[fault.end]))
            if max(pair) < graph.sink:
                cut = cut | {pair} if fault.action == CUT else cut - {pair, pair[::-1]}
                changes.add(fault.at_us, np.array(sorted(cut), np.int64).reshape(-1, 2))
    if changes.rows:
        yield _strips(rerun, "skin/cuts", changes, places, ALARM, 0.003)


def _unrouted(rerun: Any, plan: Any, tables: Mapping[str, Any]) -> Column:
    rows = dict(tables["outages"].select("time_us", "unrouted").iter_rows())
    rows.setdefault(plan.duration_us, list(rows.values())[-1])
    made = rerun.Scalars.columns(scalars=[float(count) for count in rows.values()])
    return Column("unrouted", list(rows), made)


def _interfaces(rerun: Any, plan: Any, places: Any) -> tuple[str, Any]:
    """A name at every cell with an interface port, in the colour of its port."""
    graph = plan.graph
    first = graph.end(graph.sink, 0)
    ports = [(port, graph.peer[first + port]) for port in range(graph.interfaces)]
    there = [(port, graph.node_of(end)) for port, end in ports if end >= 0]
    made = rerun.Points3D(
        [places[cell] for _, cell in there],
        radii=1.4 * RADIUS_M,
        colors=[PORTS[port % len(PORTS)] for port, _ in there],
        labels=[f"pc.{port}" for port, _ in there],
    )
    return "skin/interfaces", made


def _normals(plan: Any) -> list[tuple[float, float, float]]:
    """Where cells face, if a robot's description says it; empty elsewhere."""
    body = plan.scenario.model.body
    if body is None:
        return []
    from innervate.topology import normals_from_urdf

    folder = Path(plan.scenario.source.folder)
    return normals_from_urdf(body.urdf, body.links, folder, body.pitch_mm)


def _body(rerun: Any, plan: Any) -> Iterator[tuple[str, Any]]:
    """Shapes of the robot that a cell lies on; none where its meshes are not installed."""
    body = plan.scenario.model.body
    if body is None:
        return
    from innervate.topology import TopologyError, cover
    from innervate.topology.urdf import find_urdf

    path = find_urdf(body.urdf, Path(plan.scenario.source.folder))
    try:
        meshes = list(cover.surfaces(path, "*"))
    except (ModuleNotFoundError, TopologyError):
        return
    cells = np.array(plan.graph.positions).reshape(-1, 3)
    far = np.array([_distances(cells, mesh.triangles_center) for mesh in meshes])
    for number in sorted(set(far.argmin(axis=0).tolist())) if meshes else []:
        mesh = meshes[number]
        corners = mesh.triangles.reshape(-1, 3) / 1000  # each face has its own: flat
        shape = rerun.Mesh3D(
            vertex_positions=corners.astype(np.float32),
            vertex_normals=np.repeat(mesh.face_normals, 3, axis=0).astype(np.float32),
            albedo_factor=PALE,
        )
        yield f"robot/shape_{number}", shape


def _distances(cells: Any, points: Any) -> Any:
    """How far each cell is from a shape, mm, as far as a thousand of its points tell."""
    some = points[:: len(points) // POINTS_MAX + 1]
    return np.array([np.linalg.norm(some - cell, axis=1).min() for cell in cells])
