"""A skin in a recording: cells as balls, lines to their parents, the touch as it was received."""

from collections.abc import Callable, Iterator, Mapping
from typing import Any

from innervate.export import scenes, schemas
from innervate.export.scenes import Channel, Message, ball, entity, lines, stamp
from innervate.networks.skin.export.states import States

FORCE_MAX_MN = 3000


def channels(plan: Any, tables: Mapping[str, Any]) -> list[Channel]:
    """What there is to show; tables are polars frames by name."""

    def told(make: Callable[[int, States], Any]) -> Iterator[Message]:
        states = States(plan, tables, scenes.STEP_US)
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
        colour = scenes.BLUE if now.hops[cell] >= 0 else scenes.ORANGE
        share = min(1.0, now.force[cell] / FORCE_MAX_MN) if known[cell] else 0.0
        pairs = zip(colour, scenes.YELLOW, strict=True)
        balls.append(ball(place, 0.012, tuple((1 - share) * a + share * b for a, b in pairs)))
        if 0 <= now.hop[cell] < now.graph.sink:
            ways += [place, now.places[now.hop[cell]]]
    strips = [lines(scenes.LINE_PAIRS, 0.002, scenes.DARK, ways)]
    entities = [entity(at, "cells", spheres=balls), entity(at, "parents", lines=strips)]
    return {"deletions": [], "entities": entities}
