"""A simulated network of cables as pages have it: who is joined to whom, and what is on its way."""

from collections.abc import Mapping
from typing import Any, ClassVar

import numpy as np

from innervate.scenario.actions.action import Action
from innervate.scenario.actions.cables import CUT, KILL, LOOSE, RESTORE, REVIVE, TABLE
from innervate.scenario.cables import Fault
from innervate.sim import wheel
from innervate.sim.cables.wires import DELAYED
from innervate.sim.cables.world import DEAD
from innervate.topology import PORTS
from innervate.web.errors import Refused
from innervate.web.messages import number
from innervate.web.view import View

FLIGHTS_MAX = 2_000
Numbers = np.ndarray[Any, np.dtype[np.int64]]


def nodes_of_ends(graph: Any) -> Numbers:
    """The node every end belongs to; interface ports are the nodes behind the cells."""
    ends = np.arange(len(graph.peer))
    behind = ends - PORTS * graph.cells
    return np.where(behind < 0, ends // PORTS, graph.cells + behind)


class Cables:
    """A graph's cables as arrays.

    Args:
        plan: whose `graph` it is.
        kinds: what frames are called on pages, by their type.
        otherwise: what those of other types are called.

    Attributes:
        peer: per end the other one, -1 none.
        node_of: per end its node; interface ports are the nodes behind the cells.
        ends: per link its two ends, the lower first.
    """

    def __init__(self, plan: Any, kinds: Mapping[int, str], otherwise: str) -> None:
        graph = plan.graph
        self._plan, self._kinds, self._otherwise = plan, kinds, otherwise
        self.peer = np.frombuffer(graph.peer, np.int32).astype(np.int64)
        self.node_of = nodes_of_ends(graph)
        self.ends = np.array(list(graph.links()), np.int64).reshape(-1, 2)

    def scene(self) -> list[dict[str, int]]:
        """The links of a scene."""
        return [
            {"id": i, "a": int(self.node_of[a]), "b": int(self.node_of[b])}
            for i, (a, b) in enumerate(self.ends.tolist())
        ]

    def up(self, world: Any) -> Numbers:
        """Per link, 1 or 0."""
        found: Numbers = 1 - (world.epoch[self.ends[:, 0]] & 1)
        return found

    def flights(self, world: Any, now_us: int) -> list[dict[str, Any]]:
        """Frames on their way, at most FLIGHTS_MAX."""
        first, last = int(world.run["pool_slots"][0]), int(world.wheel.pool[wheel.FRESH])
        events = world.wheel.events[first:last]
        on_way = (events["bucket"] != wheel.NIL) & (events["kind"] != DELAYED)
        slots = np.flatnonzero(on_way)[:FLIGHTS_MAX]
        to = events["target"][slots].astype(np.int64)
        sent = self.peer[to]
        latency = world.ends["latency"][sent]
        if self._plan.latency_per_frame:
            latency = np.full(len(to), sum(self._plan.latency_us) // 2)
        part = np.clip(1 - (events["time"][slots] - now_us) / latency, 0.0, 1.0).round(3)
        has_kind = "kind" in world.frames.dtype.names
        kinds = world.frames["kind"][slots] if has_kind else np.full(len(slots), -1)
        columns = (self.node_of[sent], self.node_of[to], kinds, part)
        return [
            {"a": a, "b": b, "kind": self._kinds.get(kind, self._otherwise), "p": p}
            for a, b, kind, p in zip(*(column.tolist() for column in columns), strict=True)
        ]


class CabledView(View):
    """Nodes that `cables` join, and what pages can do to both."""

    speed: ClassVar[float] = 0.1
    slow: ClassVar[float] = 0.05
    actions: ClassVar[tuple[Action, ...]] = TABLE
    fault_type: ClassVar[Any] = Fault
    noun: ClassVar[str] = "node"
    cables: Cables

    def takes(self, fault: Any) -> bool:
        """True if a fault takes something away, false if it gives it back."""
        return super().takes(fault) and not (fault.action == LOOSE and fault.loss_q15 == 0)

    def cut(self, link: int, heal: bool) -> dict[str, int]:
        """The fault that cuts a link, or puts it back."""
        a, b = self.cables.ends[number("link", link, len(self.cables.ends))].tolist()
        reasons = int(self.engine.world.ends["impaired"][a]) >> 2
        dead = sum(self.is_dead(self.cables.node_of[end]) for end in (a, b))
        if heal and reasons <= dead:
            off = f"its {self.noun} is switched off"
            raise Refused(off if reasons else "this cable is not cut")
        if not heal and reasons > dead:
            raise Refused("this cable is cut already")
        # As a scenario names it: an interface's cable by the PC's end.
        end = b if b >= PORTS * self.plan.graph.cells else a
        return {"action": RESTORE if heal else CUT, "end": end, "node": -1}

    def is_dead(self, node: int) -> bool:
        """True if a node is switched off; interface ports, behind the others, never are."""
        return node < self.plan.graph.cells and int(self.engine.world.alive[node]) == DEAD

    def kill(self, node: int, revive: bool) -> dict[str, int]:
        """The fault that switches a node off, or on."""
        if self.is_dead(number("node", node, self.plan.graph.cells)) != revive:
            state = "on" if revive else "off already"
            raise Refused(f"this {self.noun} is {state}")
        return {"action": REVIVE if revive else KILL, "end": -1, "node": node}
