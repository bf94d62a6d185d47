"""Robots of networks over a field that have no keys of their own."""

from collections.abc import Iterable, Iterator
from typing import Annotated, Any, NamedTuple

from innervate.dialect.folder import UNITS
from innervate.network import networks
from innervate.scenario import robots
from innervate.scenario.declared import shared
from innervate.scenario.events import refuse
from innervate.scenario.keys import whole
from innervate.scenario.lines import Key
from innervate.scenario.source import Source


def check(source: Source, model: Any) -> None:
    """What cannot be of a scenario's robots, or of how they are told where they are.

    Raises:
        ScenarioError: the first thing.
    """
    is_told = placed_of(networks()[model.kind].fields) is not None
    for place, robot in enumerate(model.robot):
        key: Key = ("robot", place)
        refuse(source, robots.findings(robot, place))
        if model.link:
            what = "a robot's links follow from where it is, and [[link]]s do not; leave them out"
            raise source.error(key, what)
        if robot.position_noise_m and not is_told:
            what = f"{model.kind} is not told where its robots are (fields.PLACED): nobody errs"
            raise source.error((*key, "position_noise_m"), what)
    robots.starts(model.robot, Numbered(source, model.nodes))


class MovingTable(robots.RobotTable, frozen=True, kw_only=True):
    """[[robot]]: a node that moves, by its number."""

    node: Annotated[int, whole("", 0)]


class Numbered:
    """Nodes that are called by their numbers."""

    def __init__(self, source: Source, count: int) -> None:
        self.source = source
        self.names = [f"n{i}" for i in range(count)]

    def number(self, key: Key, given: int | str) -> int:
        """The number itself; ScenarioError if there is no such node."""
        node = int(given)
        shared.check_node(self.source, key, node, len(self.names))
        return node


class Placed(NamedTuple):
    """How a network's robots are told where they are: `PLACED` of its fields."""

    kind: int  # of `on_input`; x and y of its item say where
    unit_cm: int  # ... in so many cm
    x: tuple[int, int]  # least and greatest of either; a robot beyond is told these
    y: tuple[int, int]


def placed_of(fields: Any) -> Placed | None:
    """What a network's fields say of places; None = its robots are not told."""
    if not hasattr(fields, "PLACED"):
        return None
    unit, x, y = "", (0, 0), (0, 0)
    for name, _length, low, high, unit_of, _ in fields.FRAME:
        if name == "x":
            unit, x = unit_of, (low, high)
        elif name == "y":
            y = (low, high)
    return Placed(fields.PLACED, UNITS[unit], x, y)


def met(
    count: int, good: Iterable[tuple[int, int]], moving: Iterable[int]
) -> list[tuple[int, int]]:
    """Pairs (a < b) that may hear each other: those that do at first, and a robot and anybody."""
    robots_with = {(min(i, j), max(i, j)) for i in moving for j in range(count) if i != j}
    return sorted({*good, *robots_with})


def walkers_of(plan: Any) -> set[int]:
    """Which nodes of a plan move."""
    return {walk.node for walk in plan.walks}


def lines(plan: Any) -> Iterator[str]:
    """Who moves, in a line of what `check` prints."""
    if plan.walks:
        who = ", ".join(f"n{walk.node}" for walk in plan.walks[:8])
        more = f" and {len(plan.walks) - 8} more" if len(plan.walks) > 8 else ""
        yield f"  robots     {who}{more}, moved {1e6 / plan.sample_us:g} times a second"
