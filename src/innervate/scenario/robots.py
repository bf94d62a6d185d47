"""Robots of any network in a field: how they move, in whole microseconds and centimetres."""

from bisect import bisect_right
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise
from math import sqrt
from operator import itemgetter
from typing import Annotated, NamedTuple, Protocol

from msgspec import Meta

from innervate.dialect import rng
from innervate.scenario import keys
from innervate.scenario.events import Finding
from innervate.scenario.lines import Key
from innervate.scenario.source import Source
from innervate.topology import astray
from innervate.topology.placement import Point, normal_cdb
from innervate.trace.streams import Stream, stream

POINTS_MAX = 100_000

Box = tuple[int, int, int, int]
NodeId = Annotated[int | str, Meta(description='a node by number from 0, or by name, like "n3"')]
Metres = Annotated[
    float, Meta(ge=-100_000, le=100_000, description="a number of metres within +-100000")
]
Place = Annotated[tuple[Metres, Metres], Meta(description="a point [x, y] in metres")]
Seconds = Annotated[float, keys.number("seconds", 0, limit=100_000)]
SampleHz = Annotated[float, Meta(ge=1, le=1000, description="positions per second, 1 to 1000")]


class RobotTable(keys.Table, frozen=True, kw_only=True):
    """[[robot]]: a node that moves."""

    node: NodeId
    waypoints: Annotated[
        list[Place], Meta(max_length=10_000, description="a list of points [x, y] in metres")
    ] = []  # noqa: RUF012
    random: bool = False
    area: Annotated[
        tuple[Metres, Metres, Metres, Metres] | None,
        Meta(description="a rectangle [x, y, x, y] in metres, two opposite corners"),
    ] = None
    speed_mps: Annotated[float, keys.number("m/s", 0.001, 100)] = 1.0
    start_s: Seconds = 0.0
    pause_s: Seconds = 0.0
    position_noise_m: Annotated[float, keys.number("metres", 0, 100)] = 0.0
    position_hold_s: Annotated[float, keys.number("seconds", 0, 3_600)] = 0.0


@dataclass(frozen=True, slots=True)
class Walk:
    """How a robot moves: straight between points, then it stays."""

    node: int  # the robot
    # (time us, x cm, y cm), ascending in time; before the first it stands there.
    points: tuple[tuple[int, int, int], ...]
    noise_um: int = 0  # along each axis, standard deviation of where it believes to be, um
    hold_us: int = 0  # after so long 1/e of an error is left, us; 0: each sample has one of its own


class Nodes(Protocol):
    """Who may be a robot: nodes by number, each with a name."""

    source: Source
    names: list[str]

    def number(self, key: Key, given: int | str) -> int:
        """The number of a node; ScenarioError if there is none."""


def findings(robot: RobotTable, index: int) -> Iterator[Finding]:
    """What cannot be of a robot by its table alone."""
    key = ("robot", index)
    if robot.random and len(robot.waypoints) > 1:
        message = f"robot.{index} is random and has waypoints; keep the first, its start, or none"
        yield (*key, "waypoints"), message
    if robot.area is not None and not robot.random:
        yield (*key, "area"), f"robot.{index}.area goes with random = true"
    if robot.position_hold_s and not robot.position_noise_m:
        message = f"robot.{index}.position_hold_s goes with position_noise_m"
        yield (*key, "position_hold_s"), message


def position_cm(walk: Walk, time_us: float) -> tuple[float, float]:
    """Where the robot is: straight between its points, standing before the first and at the last.

    Raises:
        ValueError: the walk has no points.
    """
    if not walk.points:
        raise ValueError("a walk needs at least one point")
    behind = bisect_right(walk.points, time_us, key=itemgetter(0))
    if behind in (0, len(walk.points)):
        _, x, y = walk.points[max(0, behind - 1)]
        return (x, y)
    (t0, x0, y0), (t1, x1, y1) = walk.points[behind - 1], walk.points[behind]
    share = (time_us - t0) / (t1 - t0)
    return (x0 + share * (x1 - x0), y0 + share * (y1 - y0))


def cm(point: tuple[float, float]) -> Point:
    """A point in metres as whole centimetres."""
    return round(100 * point[0]), round(100 * point[1])


def starts(robots: Sequence[RobotTable], nodes: Nodes) -> dict[int, Point]:
    """Robot -> where it begins, cm, if waypoints say so.

    Raises:
        ScenarioError: a robot that is not there, or is there twice.
    """
    found: dict[int, Point] = {}
    seen = set()
    for i, robot in enumerate(robots):
        key = ("robot", i, "node")
        node = nodes.number(key, robot.node)
        if node in seen:
            message = f"there are two robots {nodes.names[node]}; leave one out"
            raise nodes.source.error(key, message)
        seen.add(node)
        if robot.waypoints:
            found[node] = cm(robot.waypoints[0])
    return found


class Ground(NamedTuple):
    """Where robots walk, and for how long."""

    points: Sequence[Point]  # where nodes are at first, cm; empty if nobody knows
    around: Sequence[Point]  # corners of where a robot wanders that has no area, cm
    seed: int
    duration_us: int


def walks(robots: Iterable[tuple[int, RobotTable]], nodes: Nodes, ground: Ground) -> list[Walk]:
    """The walk of every robot, one that stands still too; `robots` with their places in the file.

    Raises:
        ScenarioError: a robot without a position, or one that changes its way too often.
    """
    found = []
    for i, robot in robots:
        node = nodes.number(("robot", i, "node"), robot.node)
        draw = stream(ground.seed, f"robot/{i}")
        box = _area(robot, ground.around)
        if robot.waypoints:
            way = [cm(point) for point in robot.waypoints]
        elif ground.points:
            way = [ground.points[node]]
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
            if not _wander(robot, walk, draw, box, ground.duration_us):
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


def errs(walk: Walk, seed: int, sample_us: int) -> Errs:
    """How a robot that is told its place so often errs, by the seed and its number alone."""
    if not walk.noise_um:
        return Errs()
    draw = stream(seed, f"position/{walk.node}")
    own = 1 + draw.draw(rng.FIXED_POINT - 1)
    first = (normal_cdb(draw, astray.SIGMA), normal_cdb(draw, astray.SIGMA))
    return Errs(walk.noise_um, *astray.shares(sample_us, walk.hold_us), own, *first)


def _area(robot: RobotTable, around: Sequence[Point]) -> Box | None:
    """Where a robot wanders: its area, else between the outermost points around."""
    if robot.area is not None:
        x0, y0, x1, y1 = (round(100 * value) for value in robot.area)
        return min(x0, x1), min(y0, y1), max(x0, x1), max(y0, y1)
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
