"""Where running nodes are drawn: as their scenario has it, which `live up` leaves beside them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from innervate import scenario as scenarios
from innervate.scenario import ScenarioError

FILE = "scenario.toml"
Place = tuple[float, float]


@dataclass(frozen=True, slots=True)
class Drawn:
    """What a scenario says of a map of running nodes.

    Attributes:
        name: the scenario's.
        places: x and y, y down, by a node's name or a port's, like "n3", "c12", "pc.0".
        labels: what the scenario calls them, where that is another name.
        fence: rings of places; None without one.
        metres: places are metres.
    """

    name: str
    places: dict[str, Place]
    labels: dict[str, str] = field(default_factory=dict)
    fence: list[list[list[float]]] | None = None
    metres: bool = False


def drawn(sockets: Sequence[Path], kind: str) -> Drawn | None:
    """The map of nodes whose sockets lie beside their scenario; None without one of that kind."""
    folders = {path.parent for path in sockets}
    file = min(folders, default=Path()) / FILE
    if len(folders) != 1 or not file.is_file():
        return None
    try:
        plan = scenarios.plan(scenarios.load(file))
        if plan.kind != kind:
            return None
        return _MAKERS[kind](plan)
    except (ScenarioError, ImportError):  # files it names lie elsewhere, or no simulator is here
        return None


def _mesh(plan: Any) -> Drawn:
    from innervate.web.mesh_scene import Field

    scene = Field(plan).scene()
    names = [f"n{i}" for i in range(plan.nodes)]
    return Drawn(
        name=plan.scenario.name,
        places={
            name: (one["x"], one["y"]) for name, one in zip(names, scene["nodes"], strict=True)
        },
        labels={name: own for name, own in zip(names, plan.names, strict=True) if name != own},
        fence=scene["fence"],
        metres=bool(scene["metres"]),
    )


def _skin(plan: Any) -> Drawn:
    from innervate.web.skin_scene import places

    graph = plan.graph
    names = [f"c{i}" for i in range(graph.cells)]
    ports = [f"pc.{i}" for i in range(graph.interfaces)]
    found = [(float(x), float(y)) for x, y in places(graph).round(3).tolist()]
    return Drawn(
        name=plan.scenario.name,
        places=dict(zip([*names, *ports], found, strict=True)),
        labels={name: graph.label(i) for i, name in enumerate(names)},
    )


def _radio(plan: Any) -> Drawn:
    return Drawn(plan.scenario.name, {})  # stations are drawn in a ring


_MAKERS = {"mesh": _mesh, "skin": _skin, "radio": _radio}
