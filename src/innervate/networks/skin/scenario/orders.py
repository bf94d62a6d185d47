"""Commands that the PC sends down to the cells: [[command]] tables as orders at their times."""

from dataclasses import dataclass

from innervate.networks.skin.scenario.graph import Named
from innervate.networks.skin.scenario.model import SkinScenario
from innervate.networks.skin.scenario.rules import commands_of
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


def orders(named: Named, model: SkinScenario) -> list[Order]:
    """All commands of a scenario, in order of time, then of the file.

    Raises:
        ScenarioError: no such cell, or too many cells to be told apart.
    """
    cells = named.graph.cells
    if model.command and cells > CELLS_MAX:
        message = f"{cells:,} cells cannot be sent commands: one numbers {CELLS_MAX:,}"
        raise named.source.error(("command", 0), f"{message}; leave [[command]] out")
    found: list[Order] = []
    for index, table in enumerate(model.command):
        cell = ALL
        for name, where in (("cell", table.cell), ("node", table.node)):
            if where is not None:
                cell = named.cell(where, ("command", index, name))
        draw = stream(model.seed, f"command/{index}")
        first_us = round(table.at_s * 1e6)
        for i in range(commands_of(table, model.duration_s)):
            at_us = first_us + (round(i * 1e6 / table.rate_hz) if i else 0)
            whom = draw.draw(cells) if table.random else cell
            found.append(Order(max(at_us, 1), whom, table.code, table.value))
    return sorted(found, key=lambda order: order.at_us)
