"""Where running nodes are drawn: as their scenario has it, which `live up` leaves beside them."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path

from innervate.network import networks

FILE = "scenario.toml"
Spot = tuple[float, float]


@dataclass(frozen=True, slots=True)
class Drawn:
    """What a scenario says of a map of running nodes."""

    name: str  # the scenario's
    # x and y, y down, by a node's name or a port's, like "n3", "c12", "pc.0".
    places: dict[str, Spot]
    # What the scenario calls them, where that is another name.
    labels: dict[str, str] = field(default_factory=dict)
    fence: list[list[list[float]]] | None = None  # rings of places; None without one
    metres: bool = False  # places are metres
    origin_m: Spot = (0.0, 0.0)  # the place from which nodes say where they are


UNKNOWN = Drawn("live", {})  # of nodes whose scenario is not there


def drawn(sockets: Sequence[Path], kind: str) -> Drawn:
    """The map of nodes whose sockets lie beside their scenario, of that kind; else UNKNOWN."""
    from innervate import scenario as scenarios

    folders = {path.parent for path in sockets}
    file = min(folders, default=Path()) / FILE
    if len(folders) != 1 or not file.is_file():
        return UNKNOWN
    try:
        plan = scenarios.plan(scenarios.load(file))
        if plan.kind != kind:
            return UNKNOWN
        found: Drawn = networks()[kind].live_view().drawn(plan)
        return found
    # Files it names lie elsewhere, or no simulator is here.
    except (scenarios.ScenarioError, ImportError):
        return UNKNOWN
