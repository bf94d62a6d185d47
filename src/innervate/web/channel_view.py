"""What pages show of any simulated network on a channel: its nodes by the fields they declare."""

import math
from typing import Any, ClassVar

import numpy as np

from innervate.scenario.actions.action import Action
from innervate.scenario.actions.channel import JOIN, KILL, TABLE
from innervate.scenario.declared.channel import Fault
from innervate.web.declared_view import DELIVERED, Declared
from innervate.web.errors import Refused
from innervate.web.messages import number


class ChannelView(Declared):
    """Nodes in a circle, as all hear each other; who is off is apart from the others."""

    can: tuple[str, ...] = ("kill", "revive")
    actions: ClassVar[tuple[Action, ...]] = TABLE
    fault_type: ClassVar[Any] = Fault
    series: ClassVar[list[dict[str, Any]]] = [
        {"id": "lost", "label": "receptions lost so far", "unit": "receptions"},
        DELIVERED,
    ]
    around: ClassVar[float] = 1.5  # from one node to the next, in their diameters

    def scene(self) -> dict[str, Any]:
        """Nodes, and the fields that they can be coloured by."""
        count = self.plan.nodes
        turns = [2 * math.pi * i / count for i in range(count)]
        radius = self.around * count / (2 * math.pi)
        nodes = [
            {"id": i, "label": f"node {i}", "role": "node",
             "x": round(radius * math.cos(turn), 3), "y": round(radius * math.sin(turn), 3)}
            for i, turn in enumerate(turns)
        ]  # fmt: skip
        return {"nodes": nodes, "links": [], "ports": 0, "fence": None, "series": self.series,
                "fields": self.shown, "ways": False}  # fmt: skip

    def arrays(self, flights: bool) -> dict[str, Any]:
        """The state's fields for nodes."""
        on, away = self._on(), self._away()
        states = self.engine.world.stations[: self.plan.nodes]
        return {
            "node_up": on.astype(np.int64),
            "absent": away.astype(np.int64),
            "link_up": np.zeros(0, np.int64),
            "unconnected": int(np.count_nonzero(~on & ~away)),
            "away": int(np.count_nonzero(away)),
            "apart": 0,
            "fields": self.coloured(states),
            "flights": [],
        }

    def takes(self, fault: Any) -> bool:
        """True if a fault takes something away, false if it gives it back."""
        return bool(fault.action == KILL)

    def cut(self, link: int, heal: bool) -> dict[str, int]:
        """There are no links to be cut."""
        raise Refused("nodes on a channel have no links; switch one off")

    def kill(self, node: int, revive: bool) -> dict[str, int]:
        """The fault that switches a node off, or on."""
        if bool(self._on()[number("node", node, self.plan.nodes)]) == revive:
            raise Refused("this node is on" if revive else "this node is off already")
        return {"action": JOIN if revive else KILL, "node": node}

    def _on(self) -> Any:
        """Per node, true while it is on; before anything happens, who will be."""
        if not int(self.engine.world.run["handled"][0]):
            return np.array(self.plan.absent) == 0
        return self.engine.world.radios["alive"][: self.plan.nodes] != 0

    def _away(self) -> Any:
        """Per node, true while it is yet to come, or has left."""
        if not int(self.engine.world.run["handled"][0]):
            return np.array(self.plan.absent) != 0
        return ~self._on() & (self.engine.world.radios["leaving"][: self.plan.nodes] != 0)
