"""What pages show of any simulated network in a field: nodes where they lie, who hears whom."""

from collections.abc import Sequence
from collections.abc import Set as AbstractSet
from typing import Any, ClassVar

import numpy as np

from innervate.analysis.spread import spread
from innervate.scenario.actions.action import Action
from innervate.scenario.actions.field import ACTIONS, CUT, HARM, KILL, RESTORE, REVIVE, TABLE
from innervate.scenario.declared.field import Fault
from innervate.scenario.declared.moving import met, walkers_of
from innervate.sim.field.states import ALIVE, OFF
from innervate.topology.placement import RSSI50_CDB
from innervate.web.channel_view import ChannelView
from innervate.web.engine import Engine
from innervate.web.errors import Refused
from innervate.web.history import History
from innervate.web.messages import number
from innervate.web.view import View

UP, DOWN, AWAY = 1, 0, 2  # of links; AWAY: out of range for now


class FieldView(ChannelView):
    """Nodes at their places, or by who hears whom; links that can be cut."""

    can: tuple[str, ...] = ("kill", "revive", "cut", "heal")
    actions: ClassVar[tuple[Action, ...]] = TABLE
    fault_type: ClassVar[Any] = Fault

    def __init__(self, engine: Engine, history: History) -> None:
        super().__init__(engine, history)
        self.moving = walkers_of(self.plan)
        self.links = Links(self.plan.nodes, self.plan.good, self.moving)

    def scene(self) -> dict[str, Any]:
        """Nodes, links, and the fields that nodes can be coloured by."""
        made = super().scene()
        for one, (x, y) in zip(made["nodes"], self._places(), strict=True):
            one.update(x=x, y=y, role="robot" if one["id"] in self.moving else "node")
        links = [{"id": k, "a": a, "b": b} for k, (a, b) in enumerate(self.links.pairs)]
        return {**made, "links": links}

    def _places(self) -> list[tuple[float, float]]:
        """In units of about the distance between neighbours."""
        plan = self.plan
        if not plan.positions_cm:
            links = np.array(plan.good, np.int64).reshape(-1, 2)
            return [(x, y) for x, y in spread(plan.nodes, links).round(3).tolist()]
        return [(x, y) for x, y in self._drawn(np.array(plan.positions_cm)).tolist()]

    def _drawn(self, places_cm: Any) -> Any:
        """Where places are on the page: (n, 2), in units of half the reach."""
        return (places_cm / (50 * self.plan.air.reach_m)).round(3)

    def arrays(self, flights: bool) -> dict[str, Any]:
        """The state's fields for nodes and links."""
        found = {**super().arrays(flights),
                 "link_up": self.links.up(self.engine.world, self._on(), RSSI50_CDB)}  # fmt: skip
        if self.moving:
            radios = self.engine.world.radios
            found["position"] = self._drawn(np.stack([radios["x"], radios["y"]], axis=1))
        return found

    def takes(self, fault: Any) -> bool:
        """True if a fault takes something away, false if it gives it back."""
        return ACTIONS[fault.action] in HARM

    def cut(self, link: int, heal: bool) -> dict[str, int]:
        """The fault that cuts a link, or restores it."""
        return cut_of(self, self.links.pairs, link, heal)

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


class Links:
    """Pairs of nodes that hear each other: at the start, or a robot that moves and anybody.

    Args:
        count: how many nodes there are.
        good: pairs (a < b) that hear each other at the start.
        moving: who moves.
    """

    def __init__(
        self, count: int, good: Sequence[tuple[int, int]], moving: AbstractSet[int]
    ) -> None:
        self.count = count
        self.pairs = met(count, good, moving)
        self._ends = np.array(self.pairs, np.int64).reshape(-1, 2)
        self._wanders = np.array([bool(moving & set(pair)) for pair in self.pairs], np.bool_)

    def up(self, world: Any, on: Any, least_cdb: int) -> Any:
        """UP, DOWN or AWAY of each; `on` per node, `least_cdb` for a link, 0.01 dBm."""
        a, b = self._ends.T
        there, back = a * self.count + b, b * self.count + a
        near = np.minimum(world.rssi[there], world.rssi[back]) >= least_cdb
        carries = on[a] & on[b] & (world.cut[there] == 0)
        found = np.where(self._wanders & ~near, AWAY, np.where(carries, UP, DOWN))
        return found.astype(np.int64)


def cut_of(view: View, links: Sequence[tuple[int, int]], link: int, heal: bool) -> dict[str, int]:
    """The fault that cuts one of the links in a field, or restores it; Refused if it is so."""
    a, b = links[number("link", link, len(links))]
    if bool(view.engine.world.cut[a * view.plan.nodes + b]) != heal:
        raise Refused("this link is not cut" if heal else "this link is cut already")
    return {"action": RESTORE if heal else CUT, "node": a, "other": b}
