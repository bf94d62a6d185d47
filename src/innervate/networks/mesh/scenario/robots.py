"""How the robots of a mesh move: whole microseconds and centimetres."""

from itertools import pairwise
from math import sqrt
from typing import NamedTuple

from innervate.dialect import rng
from innervate.networks.mesh.scenario.fence import rings_cm
from innervate.networks.mesh.scenario.model import MeshScenario, RobotTable
from innervate.networks.mesh.scenario.nodes import Nodes
from innervate.networks.mesh.scenario.plan import MeshPlan, Walk
from innervate.topology import astray
from innervate.topology.placement import Point, normal_cdb
from innervate.trace.streams import Stream, stream

POINTS_MAX = 100_000

Box = tuple[int, int, int, int]


def cm(point: tuple[float, float]) -> Point:
    """A point in metres as whole centimetres."""
    return round(100 * point[0]), round(100 * point[1])


def starts(model: MeshScenario, nodes: Nodes) -> dict[int, Point]:
    """Robot -> where it begins, cm, if waypoints say so.

    Raises:
        ScenarioError: a robot that is not there, or is there twice.
    """
    found: dict[int, Point] = {}
    seen = set()
    for i, robot in enumerate(model.robot):
        key = ("robot", i, "node")
        node = nodes.number(key, robot.node)
        if node in seen:
            message = f"there are two robots {nodes.names[node]}; leave one out"
            raise nodes.source.error(key, message)
        seen.add(node)
        if robot.waypoints:
            found[node] = cm(robot.waypoints[0])
    return found


def walks(model: MeshScenario, nodes: Nodes, points: list[Point], duration_us: int) -> list[Walk]:
    """The walk of every robot, one that stands still too; points in cm, empty if nobody knows.

    Raises:
        ScenarioError: a robot without a position, or one that changes its way too often.
    """
    found = []
    for i, robot in _here(model, nodes):
        node = nodes.number(("robot", i, "node"), robot.node)
        draw = stream(model.seed, f"robot/{i}")
        box = _area(model, robot, points)
        if robot.waypoints:
            way = [cm(point) for point in robot.waypoints]
        elif points:
            way = [points[node]]
        elif robot.random and box is not None:
            way = [_somewhere(draw, box)]
        else:
            message = (
                f"robot {nodes.names[node]} has no position; give it waypoints, or random = true "
                "with an area"
            )
            raise nodes.source.error(("robot", i), message)
        walk = _timed(robot, way)
        if robot.random:
            assert box is not None
            if not _wander(robot, walk, draw, box, duration_us):
                message = (
                    f"robot.{i} changes its way more than {POINTS_MAX:,} times; "
                    "make its area larger or its speed lower"
                )
                raise nodes.source.error(("robot", i), message)
        noise_um, hold_us = round(1e6 * robot.position_noise_m), round(1e6 * robot.position_hold_s)
        found.append(Walk(node, tuple(walk), noise_um, hold_us))
    return found


class Errs(NamedTuple):
    """How a robot errs about its place; what changes from sample to sample is `astray.err`'s."""

    noise: int = 0  # standard deviation along each axis, um; 0 = it never errs
    # keep, fresh: what stays of an error from one sample to the next, and what is new, in
    # 1/astray.ONE
    keep: int = 0
    fresh: int = 0
    rng: int = 0  # its own stream
    off_x: int = 0  # off_x, off_y: the error before the first sample, in astray.SIGMA
    off_y: int = 0


def errs(plan: MeshPlan, walk: Walk) -> Errs:
    """How a robot of a plan errs, by the seed and its number alone."""
    if not walk.noise_um:
        return Errs()
    draw = stream(plan.seed, f"position/{walk.node}")
    own = 1 + draw.draw(rng.FIXED_POINT - 1)
    first = (normal_cdb(draw, astray.SIGMA), normal_cdb(draw, astray.SIGMA))
    return Errs(walk.noise_um, *astray.shares(plan.sample_us, walk.hold_us), own, *first)


def _here(model: MeshScenario, nodes: Nodes) -> list[tuple[int, RobotTable]]:
    """The robots of this cluster with their places in the file."""
    return [(i, robot) for i, robot in enumerate(model.robot) if nodes.is_here(robot.node)]


def _area(model: MeshScenario, robot: RobotTable, points: list[Point]) -> Box | None:
    """Where a robot wanders: its area, else where the nodes are, else the fence."""
    if robot.area is not None:
        x0, y0, x1, y1 = (round(100 * value) for value in robot.area)
        return min(x0, x1), min(y0, y1), max(x0, x1), max(y0, y1)
    around = points or (rings_cm(model.fence)[0] if model.fence is not None else [])
    if not around:
        return None
    xs, ys = [x for x, _ in around], [y for _, y in around]
    return min(xs), min(ys), max(xs), max(ys)


def _somewhere(draw: Stream, box: Box) -> Point:
    return draw.uniform(box[0], box[2]), draw.uniform(box[1], box[3])


def _leg_us(robot: RobotTable, a: Point, b: Point) -> int:
    """Time from a to b; a centimetre takes 100 us and more."""
    far_cm = sqrt((a[0] - b[0]) ** 2 + (a[1] - b[1]) ** 2)
    return round(far_cm * 10_000 / robot.speed_mps)


def _timed(robot: RobotTable, way: list[Point]) -> list[tuple[int, int, int]]:
    at = round(robot.start_s * 1e6)
    found = [(at, *way[0])]
    for old, new in pairwise(way):
        if new != old:
            _go(robot, found, new)
    return found


def _go(robot: RobotTable, walk: list[tuple[int, int, int]], new: Point) -> None:
    """Go on to a point, after a pause where the walk has come to."""
    at, *old = walk[-1]
    pause_us = round(robot.pause_s * 1e6)
    if pause_us and len(walk) > 1:
        at += pause_us
        walk.append((at, old[0], old[1]))
    walk.append((at + _leg_us(robot, (old[0], old[1]), new), *new))


def _wander(
    robot: RobotTable, walk: list[tuple[int, int, int]], draw: Stream, box: Box, duration_us: int
) -> bool:
    """Random waypoints until the run ends; False if they are too many."""
    for _ in range(POINTS_MAX // 2):
        if walk[-1][0] >= duration_us:
            return True
        new = _somewhere(draw, box)
        if new != walk[-1][1:]:
            _go(robot, walk, new)
    return False
