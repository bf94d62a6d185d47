"""Node files of a skin's plan: its cells, and the PC, which is the last."""

from __future__ import annotations

import asyncio
from collections.abc import Coroutine
from typing import Any

from innervate.live.deployment import Deployment, Pairs, Stage, Table
from innervate.live.play import ask, sleep_until
from innervate.networks.skin.protocol.constants import PORTS
from innervate.scenario.actions import ON_LINKS


class SkinDeployment(Deployment):
    """The cells of a skin and the PC."""

    def layout(self) -> tuple[list[str], Pairs]:
        """See Deployment."""
        graph = self.plan.graph
        links, self._ends, self._cable_of_end = cables_of(graph)
        return [*(f"c{i}" for i in range(graph.cells)), "pc"], links

    def in_order(self, number: int, cables: list[int]) -> list[int]:
        """The PC's are in order of its interface ports; a cell's file names its ports."""
        if number < self.plan.graph.cells:
            return cables
        return sorted(cables, key=lambda k: self._ends[k][1])

    def file(self, number: int, cables: list[int]) -> tuple[Table, dict[str, Table]]:
        """See Deployment."""
        plan, tables = self.plan, {"protocol": dict(self.plan.params)}
        if number == plan.graph.cells:
            return {"role": "sink"}, tables
        rate_hz = 1e6 / plan.data_period_us if plan.data_period_us else 0.0
        ports = [self._ends[k][self.links[k].index(number)] for k in cables]
        return {"role": "cell", "ports": ports, "rate_hz": rate_hz}, tables

    def cable_of(self, fault: Any) -> int:
        """See Deployment."""
        return self._cable_of_end[fault.end] if self.word(fault) in ON_LINKS else -1

    def others(self, stage: Stage) -> list[Coroutine[Any, Any, None]]:
        """The PC sends the scenario's commands."""
        return [self._play_orders(stage)]

    async def _play_orders(self, stage: Stage) -> None:
        began = asyncio.get_running_loop().time()
        for order in self.plan.orders:
            await sleep_until(began + order.at_us / 1e6)
            cell = None if order.cell < 0 else order.cell
            request = {"do": "command", "code": order.code, "value": order.value, "cell": cell}
            await ask(stage.socket("pc"), request)


def cables_of(
    graph: Any,
) -> tuple[list[tuple[int, int]], list[tuple[int, int]], dict[int, int]]:
    """Cables of a skin: pairs of nodes, the port at either end; and the cable of every end."""
    links: list[tuple[int, int]] = []
    ends: list[tuple[int, int]] = []
    cable_of: dict[int, int] = {}
    sockets = PORTS * graph.cells
    for end, other in enumerate(graph.peer):
        if end < other:
            here = (end // PORTS, end % PORTS)
            there = (other // PORTS, other % PORTS)
            if other >= sockets:
                there = (graph.cells, other - sockets)
            cable_of[end] = cable_of[other] = len(links)
            links.append((here[0], there[0]))
            ends.append((here[1], there[1]))
    return links, ends, cable_of
