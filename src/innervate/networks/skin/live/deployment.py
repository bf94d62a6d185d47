"""Node files of a skin's plan: its cells, and the PC, which is the last."""

import re
from collections.abc import Iterator

from innervate.live.deployment import Deployment, Pairs, Table
from innervate.topology import Graph

_FILE = re.compile(r"[A-Za-z0-9_][A-Za-z0-9_.-]{0,39}", re.ASCII)
_TAKEN = ("pc", "medium", "scenario")  # by processes and files of their own


def cell_names(graph: Graph) -> list[str]:
    """The cells' names of the graph where each can name a node's file, else c0, c1 .. for all."""
    names = list(graph.names)
    if names and all(_FILE.fullmatch(name) and name not in _TAKEN for name in names):
        return names
    return [f"c{i}" for i in range(graph.cells)]


class SkinDeployment(Deployment):
    """The cells of a skin and the PC."""

    def layout(self) -> tuple[list[str], Pairs]:
        """Names of the cells and "pc", and the cables as pairs."""
        return [*cell_names(self.plan.graph), "pc"], self.cables()

    def is_board(self, number: int) -> bool:
        """The cells; the PC is a PC."""
        return number < int(self.plan.graph.cells)

    def in_order(self, number: int, cables: list[int]) -> list[int]:
        """The PC's are in order of its interface ports; a cell's file names its ports."""
        if number < self.plan.graph.cells:
            return cables
        return sorted(cables, key=lambda k: self.port_of(number, k))

    def file(self, number: int, cables: list[int]) -> tuple[Table, dict[str, Table]]:
        """The head of a node's file, and its tables."""
        plan, tables = self.plan, {"protocol": dict(self.plan.params)}
        if number == plan.graph.cells:
            return {"role": "sink", "nodes": number + 1}, tables
        rate_hz = 1e6 / plan.data_period_us if plan.data_period_us else 0.0
        ports = [self.port_of(number, k) for k in cables]
        return {"role": "cell", "ports": ports, "rate_hz": rate_hz}, tables

    def inputs(self) -> Iterator[tuple[float, str, Table]]:
        """The PC sends the scenario's commands."""
        for order in self.plan.orders:
            cell = None if order.cell < 0 else order.cell
            request = {"do": "command", "code": order.code, "value": order.value, "cell": cell}
            yield order.at_us / 1e6, "pc", request
