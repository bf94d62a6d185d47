"""What a recording shows in three dimensions, and its states: messages with their times, in order.

Colours are safe for colour-blind readers; what they say is in the other messages, too.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from typing import Any, NamedTuple

from innervate.analysis.fence import position_cm
from innervate.export import schemas
from innervate.export.states import Point, States

STEP_US = 100_000  # between two states
FORCE_MAX_MN = 3000
GREY, BLUE, ORANGE, YELLOW, DARK = (
    (0.6, 0.6, 0.6), (0.0, 0.45, 0.7), (0.9, 0.4, 0.0), (0.95, 0.9, 0.25), (0.2, 0.2, 0.2),
)  # fmt: skip
LINE_STRIP, LINE_LOOP, LINE_PAIRS = 0, 1, 2

Message = tuple[int, Any]  # us, content


class Channel(NamedTuple):
    """One kind of messages of a recording.

    Attributes:
        topic: its name, "/cells".
        schema: of its messages.
        messages: (time us, content), in order of time.
    """

    topic: str
    schema: schemas.Schema
    messages: Iterator[Message]


def stamp(time_us: int) -> dict[str, int]:
    """A time as Foxglove has it."""
    return {"sec": time_us // 1_000_000, "nsec": time_us % 1_000_000 * 1000}


def channels(plan: Any, tables: Mapping[str, Any]) -> list[Channel]:
    """What there is to show of a kind of network; tables are polars frames by name."""
    if plan.kind == "skin":
        return _skin(plan, tables)
    if plan.kind == "mesh":
        return _mesh(plan)
    return []


def _skin(plan: Any, tables: Mapping[str, Any]) -> list[Channel]:
    def told(make: Callable[[int, States], Any]) -> Iterator[Message]:
        states = States(plan, tables, STEP_US)
        return ((at, make(at, now)) for at, now in states.snapshots())

    found = [
        Channel("/cells", schemas.CELLS, told(_cells)),
        Channel("/scene", schemas.SCENE, told(_balls)),
    ]
    if len(tables.get("received", ())):
        found.append(Channel("/touch", schemas.TOUCH, told(_touch)))
    return found


def _cells(at: int, now: States) -> Any:
    """A message of all cells."""
    return {
        "timestamp": stamp(at),
        "unrouted": now.unrouted,
        "cut_off": now.cut_off,
        "parent_port": list(now.parent),
        "hops": now.hops,
    }


def _touch(at: int, now: States) -> Any:
    """A message of what the PC knew of the touch."""
    known = now.known(at)
    return {
        "timestamp": stamp(at),
        "force_mn": [f if k else 0 for f, k in zip(now.force, known, strict=True)],
        "proximity": [p if k else 0 for p, k in zip(now.proximity, known, strict=True)],
        "known": known,
    }


def _balls(at: int, now: States) -> Any:
    """Cells as balls, and a line from each to its parent."""
    known = now.known(at)
    balls, ways = [], []
    for cell, place in enumerate(now.places):
        colour = BLUE if now.hops[cell] >= 0 else ORANGE
        share = min(1.0, now.force[cell] / FORCE_MAX_MN) if known[cell] else 0.0
        mixed = tuple((1 - share) * a + share * b for a, b in zip(colour, YELLOW, strict=True))
        balls.append(_ball(place, 0.012, mixed))
        above = now.above(cell)
        if 0 <= above < now.graph.sink:
            ways += [place, now.places[above]]
    return {
        "deletions": [],
        "entities": [_entity(at, "cells", spheres=balls),
                     _entity(at, "parents", lines=[_lines(LINE_PAIRS, 0.002, DARK, ways)])],
    }  # fmt: skip


def _mesh(plan: Any) -> list[Channel]:
    found = []
    if plan.positions_cm:
        found.append(Channel("/scene", schemas.SCENE, _field(plan)))
    if plan.walks:
        found.append(Channel("/robots", schemas.ROBOT, _robots(plan)))
    return found


def _steps(plan: Any) -> Iterator[int]:
    yield from range(0, plan.duration_us, STEP_US)


def _robots(plan: Any) -> Iterator[Message]:
    for at in _steps(plan):
        for walk in plan.walks:
            x, y = position_cm(walk, at)
            yield at, {"timestamp": stamp(at), "node": walk.node, "x_m": x / 100, "y_m": y / 100}


def _field(plan: Any) -> Iterator[Message]:
    """Nodes, good links and the fence once; robots whenever they have moved."""
    places = [(x / 100, y / 100, 0.0) for x, y in plan.positions_cm]
    moving = {walk.node for walk in plan.walks}
    ends = [place for a, b in plan.good if not moving & {a, b} for place in (places[a], places[b])]
    fence = plan.scenario.model.fence
    rings = [fence.polygon, *fence.holes] if fence is not None else []
    lines = [_lines(LINE_PAIRS, 0.05, GREY, ends)]
    lines += [_lines(LINE_LOOP, 0.2, ORANGE, [(x, y, 0.0) for x, y in ring]) for ring in rings]
    balls, texts = [], []
    for node, place in enumerate(places):
        if node not in moving:
            balls.append(_ball(place, 1.0, DARK if plan.ranks[node] >= 0 else BLUE))
            texts.append(_text(place, plan.names[node]))
    ground = _entity(0, "field", spheres=balls, lines=lines, texts=texts)
    yield 0, {"deletions": [], "entities": [ground]}
    for at in _steps(plan):
        entities = []
        for walk in plan.walks:
            x, y = position_cm(walk, at)
            place = (x / 100, y / 100, 0.0)
            entities.append(_entity(at, f"robot {plan.names[walk.node]}",
                                    spheres=[_ball(place, 1.4, YELLOW)],
                                    texts=[_text(place, plan.names[walk.node])]))  # fmt: skip
        if entities:
            yield at, {"deletions": [], "entities": entities}


def _pose(place: Point) -> Any:
    x, y, z = (round(value, 4) for value in place)
    still = {"x": 0, "y": 0, "z": 0, "w": 1}
    return {"position": {"x": x, "y": y, "z": z}, "orientation": still}


def _color(rgb: tuple[float, ...]) -> Any:
    r, g, b = (round(value, 3) for value in rgb)
    return {"r": r, "g": g, "b": b, "a": 1}


def _ball(place: Point, size: float, rgb: tuple[float, ...]) -> Any:
    span = {"x": size, "y": size, "z": size}
    return {"pose": _pose(place), "size": span, "color": _color(rgb)}


def _lines(kind: int, thickness: float, rgb: tuple[float, ...], points: list[Point]) -> Any:
    corners = [_pose(point)["position"] for point in points]
    return {
        "type": kind, "pose": _pose((0, 0, 0)), "thickness": thickness, "scale_invariant": False,
        "points": corners, "color": _color(rgb), "colors": [], "indices": [],
    }  # fmt: skip


def _text(place: Point, text: str) -> Any:
    above = (place[0], place[1], place[2] + 1.5)
    return {
        "pose": _pose(above), "billboard": True, "font_size": 12, "scale_invariant": True,
        "color": _color(DARK), "text": text,
    }  # fmt: skip


def _entity(at: int, name: str, **parts: Any) -> Any:
    kinds = ("arrows", "cubes", "spheres", "cylinders", "lines", "triangles", "texts", "models")
    return {
        "timestamp": stamp(at), "frame_id": "world", "id": name, "lifetime": stamp(0),
        "frame_locked": False, "metadata": [], **{kind: parts.get(kind, []) for kind in kinds},
    }  # fmt: skip
