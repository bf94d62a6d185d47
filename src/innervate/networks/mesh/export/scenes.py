"""A mesh in a recording: nodes, good links and the fence, and robots as they move."""

from collections.abc import Iterator, Mapping
from typing import Any

from innervate.export import schemas
from innervate.export.scenes import (
    BLUE,
    DARK,
    GREY,
    LINE_LOOP,
    LINE_PAIRS,
    ORANGE,
    STEP_US,
    YELLOW,
    Channel,
    Message,
    ball,
    entity,
    lines,
    stamp,
    text,
)
from innervate.scenario.robots import position_cm


def channels(plan: Any, _tables: Mapping[str, Any]) -> list[Channel]:
    """What there is to show."""
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
    drawn = [lines(LINE_PAIRS, 0.05, GREY, ends)]
    drawn += [lines(LINE_LOOP, 0.2, ORANGE, [(x, y, 0.0) for x, y in ring]) for ring in rings]
    balls, texts = [], []
    for node, place in enumerate(places):
        if node not in moving:
            balls.append(ball(place, 1.0, DARK if plan.ranks[node] >= 0 else BLUE))
            texts.append(text(place, plan.names[node]))
    ground = entity(0, "field", spheres=balls, lines=drawn, texts=texts)
    yield 0, {"deletions": [], "entities": [ground]}
    for at in _steps(plan):
        entities = []
        for walk in plan.walks:
            x, y = position_cm(walk, at)
            place = (x / 100, y / 100, 0.0)
            entities.append(entity(at, f"robot {plan.names[walk.node]}",
                                    spheres=[ball(place, 1.4, YELLOW)],
                                    texts=[text(place, plan.names[walk.node])]))  # fmt: skip
        if entities:
            yield at, {"deletions": [], "entities": entities}
