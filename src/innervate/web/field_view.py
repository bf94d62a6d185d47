"""What pages show of any simulated network in a field: nodes where they lie, who hears whom."""

from collections.abc import Sequence
from typing import Any, ClassVar

import numpy as np

from innervate.analysis.spread import spread
from innervate.scenario.actions.action import Action
from innervate.scenario.actions.field import ACTIONS, CUT, HARM, KILL, RESTORE, REVIVE, TABLE
from innervate.scenario.declared.field import Fault
from innervate.sim.field.states import ALIVE, OFF
from innervate.web.channel_view import ChannelView
from innervate.web.errors import Refused
from innervate.web.messages import number
from innervate.web.view import View


class FieldView(ChannelView):
    """Nodes at their places, or by who hears whom; links that can be cut."""

    can: tuple[str, ...] = ("kill", "revive", "cut", "heal")
    actions: ClassVar[tuple[Action, ...]] = TABLE
    fault_type: ClassVar[Any] = Fault

    def scene(self) -> dict[str, Any]:
        """Nodes, links, and the fields that nodes can be coloured by."""
        made = super().scene()
        for one, (x, y) in zip(made["nodes"], self._places(), strict=True):
            one.update(x=x, y=y)
        links = [{"id": k, "a": a, "b": b} for k, (a, b) in enumerate(self.plan.good)]
        return {**made, "links": links}

    def _places(self) -> list[tuple[float, float]]:
        """In units of about the distance between neighbours."""
        plan = self.plan
        if not plan.positions_cm:
            links = np.array(plan.good, np.int64).reshape(-1, 2)
            return [(x, y) for x, y in spread(plan.nodes, links).round(3).tolist()]
        unit = 50 * plan.air.reach_m
        return [(round(x / unit, 3), round(y / unit, 3)) for x, y in plan.positions_cm]

    def arrays(self, flights: bool) -> dict[str, Any]:
        """The state's fields for nodes and links."""
        on, count = self._on(), self.plan.nodes
        pairs = np.array(self.plan.good, np.int64).reshape(-1, 2)
        cut = np.asarray(self.engine.world.cut)[pairs[:, 0] * count + pairs[:, 1]]
        up = on[pairs[:, 0]] & on[pairs[:, 1]] & (cut == 0)
        return {**super().arrays(flights), "link_up": up.astype(np.int64)}

    def takes(self, fault: Any) -> bool:
        """True if a fault takes something away, false if it gives it back."""
        return ACTIONS[fault.action] in HARM

    def cut(self, link: int, heal: bool) -> dict[str, int]:
        """The fault that cuts a link, or restores it."""
        return cut_of(self, self.plan.good, link, heal)

    def kill(self, node: int, revive: bool) -> dict[str, int]:
        """The fault that switches a node off, or on."""
        return {**super().kill(node, revive), "action": REVIVE if revive else KILL}

    def _on(self) -> Any:
        """Per node, true while it is on; before anything happens, who will be."""
        if not int(self.engine.world.run["handled"][0]):
            return np.array(self.plan.absent) == 0
        return self.engine.world.radios["state"][: self.plan.nodes] == ALIVE

    def _away(self) -> Any:
        """Per node, true while it is yet to come."""
        state = self.engine.world.radios["state"][: self.plan.nodes]
        return (state == OFF) & (np.array(self.plan.absent) != 0)


def cut_of(view: View, links: Sequence[tuple[int, int]], link: int, heal: bool) -> dict[str, int]:
    """The fault that cuts one of the links in a field, or restores it; Refused if it is so."""
    a, b = links[number("link", link, len(links))]
    if bool(view.engine.world.cut[a * view.plan.nodes + b]) != heal:
        raise Refused("this link is not cut" if heal else "this link is cut already")
    return {"action": RESTORE if heal else CUT, "node": a, "other": b}
