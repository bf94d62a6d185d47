"""What a recording shows in three dimensions, and its states: messages with their times, in order.

Colours are safe for colour-blind readers; what they say is in the other messages, too.
"""

from collections.abc import Iterator, Mapping
from typing import Any, NamedTuple

from innervate.export import schemas
from innervate.network import networks

STEP_US = 100_000  # between two states
GREY, BLUE, ORANGE, YELLOW, DARK = (
    (0.6, 0.6, 0.6), (0.0, 0.45, 0.7), (0.9, 0.4, 0.0), (0.95, 0.9, 0.25), (0.2, 0.2, 0.2),
)  # fmt: skip
LINE_STRIP, LINE_LOOP, LINE_PAIRS = 0, 1, 2

Point = tuple[float, float, float]
Message = tuple[int, Any]  # us, content


class Channel(NamedTuple):
    """One kind of messages of a recording."""

    topic: str  # its name, "/cells"
    schema: schemas.Schema  # of its messages
    messages: Iterator[Message]  # (time us, content), in order of time


def stamp(time_us: int) -> dict[str, int]:
    """A time as Foxglove has it."""
    return {"sec": time_us // 1_000_000, "nsec": time_us % 1_000_000 * 1000}


def channels(plan: Any, tables: Mapping[str, Any]) -> list[Channel]:
    """What there is to show of a kind of network; tables are polars frames by name."""
    made: list[Channel] = networks()[plan.kind].scenes(plan, tables)
    return made


def _pose(place: Point) -> Any:
    x, y, z = (round(value, 4) for value in place)
    still = {"x": 0, "y": 0, "z": 0, "w": 1}
    return {"position": {"x": x, "y": y, "z": z}, "orientation": still}


def _color(rgb: tuple[float, ...]) -> Any:
    r, g, b = (round(value, 3) for value in rgb)
    return {"r": r, "g": g, "b": b, "a": 1}


def ball(place: Point, size: float, rgb: tuple[float, ...]) -> Any:
    """A sphere; metres, colours 0 .. 1."""
    span = {"x": size, "y": size, "z": size}
    return {"pose": _pose(place), "size": span, "color": _color(rgb)}


def lines(kind: int, thickness: float, rgb: tuple[float, ...], points: list[Point]) -> Any:
    """Lines through points: LINE_STRIP, LINE_LOOP or LINE_PAIRS."""
    corners = [_pose(point)["position"] for point in points]
    return {
        "type": kind, "pose": _pose((0, 0, 0)), "thickness": thickness, "scale_invariant": False,
        "points": corners, "color": _color(rgb), "colors": [], "indices": [],
    }  # fmt: skip


def text(place: Point, words: str) -> Any:
    """Words 1.5 m above a place, as a primitive of the scene."""
    above = (place[0], place[1], place[2] + 1.5)
    return {
        "pose": _pose(above), "billboard": True, "font_size": 12, "scale_invariant": True,
        "color": _color(DARK), "text": words,
    }  # fmt: skip


def entity(at: int, name: str, **parts: Any) -> Any:
    """An entity of a scene, made of primitives by kind."""
    kinds = ("arrows", "cubes", "spheres", "cylinders", "lines", "triangles", "texts", "models")
    return {
        "timestamp": stamp(at), "frame_id": "world", "id": name, "lifetime": stamp(0),
        "frame_locked": False, "metadata": [], **{kind: parts.get(kind, []) for kind in kinds},
    }  # fmt: skip
