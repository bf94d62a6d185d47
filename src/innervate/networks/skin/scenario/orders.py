"""Commands that the PC sends down to the cells: [[command]] tables as orders at their times."""

from dataclasses import dataclass

from innervate.networks.skin.scenario.graph import cell_at
from innervate.networks.skin.scenario.model import CommandTable, SkinScenario
from innervate.networks.skin.scenario.rules import commands_of
from innervate.scenario.source import Source
from innervate.topology import Graph
from innervate.trace.streams import stream

ALL = -1
CELLS_MAX = 65_535  # 65535 in a command means all


@dataclass(frozen=True, slots=True)
class Order:
    """One command of the PC to cells."""

    at_us: int  # when the PC is told to send it, true time, us
    cell: int  # whom it is for; ALL = every cell
    code: int  # what is to be done, 0..255
    value: int  # its argument, 0..65535


def orders(source: Source, graph: Graph, model: SkinScenario) -> list[Order]:
    """All commands of a scenario, in order of time, then of the file.

    Raises:
        ScenarioError: no such cell, or too many cells to be told apart.
    """
    if model.command and graph.cells > CELLS_MAX:
        message = f"{graph.cells:,} cells cannot be sent commands: one numbers {CELLS_MAX:,}"
        raise source.error(("command", 0), f"{message}; leave [[command]] out")
    found: list[Order] = []
    for index, table in enumerate(model.command):
        cell = _cell(source, graph, index, table)
        draw = stream(model.seed, f"command/{index}")
        first_us = round(table.at_s * 1e6)
        for i in range(commands_of(table, model.duration_s)):
            at_us = first_us + (round(i * 1e6 / table.rate_hz) if i else 0)
            whom = draw.draw(graph.cells) if table.random else cell
            found.append(Order(max(at_us, 1), whom, table.code, table.value))
    return sorted(found, key=lambda order: order.at_us)


def _cell(source: Source, graph: Graph, index: int, table: CommandTable) -> int:
    if table.cell is not None:
        return cell_at(source, graph, table.cell, ("command", index, "cell"))
    if table.node is not None:
        return cell_at(source, graph, table.node, ("command", index, "node"))
    return ALL
