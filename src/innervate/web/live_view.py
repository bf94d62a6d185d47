"""What pages show of running nodes, as far as it is a network's own; here that of any network."""

from collections.abc import Callable, Mapping
from typing import Any

from innervate.live.declared import HIDDEN
from innervate.network import Network, networks
from innervate.web.errors import Refused
from innervate.web.live_map import Map, Place, Status
from innervate.web.live_scene import Drawn, Spot
from innervate.web.live_state import State, Told
from innervate.web.messages import Give

Label = Callable[[Place], str]  # how a place is called
# Asks a node something; None = it did not answer.
Ask = Callable[[int, dict[str, Any]], dict[str, Any] | None]


def shown_fields(network: Network) -> list[dict[str, str]]:
    """The declared fields of a node's state that are numbers: name, unit, meaning."""
    declared = getattr(network.fields, "STATE", ()) if network.has("fields") else ()
    return [
        {"name": name, "unit": unit, "meaning": meaning}
        for name, length, _low, _high, unit, meaning in declared
        if not length and name not in HIDDEN
    ]


class LiveView:
    """Running nodes of one kind."""

    map: type[Map] = Map
    state: type[State] = State
    # Name and unit of the plot of nodes that are in trouble.
    lost: tuple[str, str] = ("nodes without a way", "nodes")
    is_quick = False  # what is shown changes all the time: nodes are asked more often
    has_ways = True  # nodes have ways that they can lose and find again

    def drawn(self, plan: Any) -> Drawn:
        """Where nodes are drawn; without places they are drawn by who is linked with whom."""
        return Drawn(plan.scenario.name, {})

    def scene(self, kind: str) -> dict[str, Any]:
        """What a scene has besides that of every network: the fields that nodes tell of."""
        shown = shown_fields(networks()[kind])
        return {"fields": shown} if shown else {}

    def role(self, one: Status) -> str:
        """What a node is on the map."""
        return str(one.get("role", "node"))

    def moved(self, told: Mapping[int, Status], known: Drawn) -> dict[int, Spot]:
        """Where nodes say they are that move about, by node; none unless they say so."""
        return {}

    def news(self, told: Mapping[int, Status], name: Callable[[int], str]) -> list[tuple[str, str]]:
        """What nodes tell of that is not their own state, for the log: (text, level), once each."""
        return []

    def unknown(self, told: list[Status], names: list[str]) -> list[Status]:
        """What stands for nodes of these names that have not answered, beside those that have."""
        one: Status = {"kind": told[0]["kind"], "neighbours": [], "paths": [], "counters": {}}
        return [dict(one) for _ in names]

    def note(self, state: State, now_us: int, told: Mapping[int, Status]) -> None:
        """A new state: what can only be told over some time is worked out."""

    def can(self, last: Mapping[int, Status]) -> tuple[str, ...]:
        """Commands that these nodes understand beside those of every network."""
        return ()

    def give(self, command: Give, where: Map, last: Told, label: Label, ask: Ask) -> str:
        """Give the network a command of its own; what was done, for the log.

        Raises:
            Refused: it was not taken.
        """
        raise Refused("not possible here")
