"""Who is there and who is connected, over the good links of a mesh's plan; shortest paths."""

from bisect import bisect_right
from typing import Any

from innervate.scenario.actions.field import CUT, KILL, RESTART, RESTORE, REVIVE
from innervate.topology.placement import distances, neighbours


class Ground:
    """The network as it truly was at any time of a run: good links between nodes that were on.

    Robots count where they were at the start.
    """

    def __init__(self, plan: Any) -> None:
        self.plan = plan
        shaping = (KILL, REVIVE, RESTART, CUT, RESTORE)
        starts = {int(at) for node, at in enumerate(plan.starts_us) if not plan.absent[node]}
        faults = [fault for fault in plan.faults if fault.action in shaping]
        self.times = sorted({0, *starts, *(fault.at_us for fault in faults)})
        self._faults = faults
        self._near: dict[int, list[list[int]]] = {}
        self._far: dict[tuple[int, int], list[int]] = {}

    def on_at(self, time_us: int) -> list[bool]:
        """Per node, whether it is switched on at a time."""
        plan = self.plan
        on = [
            not plan.absent[node] and plan.starts_us[node] <= time_us for node in range(plan.nodes)
        ]
        for fault in self._faults:
            if fault.at_us > time_us:
                break
            if fault.action in (KILL, REVIVE, RESTART):
                on[fault.node] = fault.action != KILL
        return on

    def near_at(self, time_us: int) -> list[list[int]]:
        """Neighbours of every node at a time, in order of number."""
        period = bisect_right(self.times, time_us) - 1
        if period not in self._near:
            self._near[period] = self._neighbours(self.times[period] if period >= 0 else 0)
        return self._near[period]

    def _neighbours(self, time_us: int) -> list[list[int]]:
        on = self.on_at(time_us)
        cut: set[tuple[int, int]] = set()
        for fault in self._faults:
            if fault.at_us <= time_us and fault.action in (CUT, RESTORE):
                pair = (min(fault.node, fault.other), max(fault.node, fault.other))
                (cut.add if fault.action == CUT else cut.discard)(pair)
        links = [(a, b) for a, b in self.plan.good if on[a] and on[b] and (a, b) not in cut]
        return [sorted(nodes) for nodes in neighbours(len(on), links)]

    def hops(self, source: int, dest: int, time_us: int) -> int:
        """Hops of the shortest path at a time; UNREACHABLE if there is none."""
        period = bisect_right(self.times, time_us) - 1
        if (period, dest) not in self._far:
            self._far[period, dest] = distances(self.near_at(time_us), dest)
        return self._far[period, dest][source]
