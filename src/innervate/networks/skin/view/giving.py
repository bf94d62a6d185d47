"""Commands of the PC that are given by hand to a simulated skin, and what became of them."""

from dataclasses import dataclass
from typing import Any

from innervate.analysis.headline import every
from innervate.networks.skin.scenario.orders import ALL, Order
from innervate.plot.words import ms_words
from innervate.web.errors import Refused
from innervate.web.history import Logbook
from innervate.web.messages import Give, number


@dataclass(slots=True)
class Given:
    """A command on its way: when it was given, whom it is for, whom it has reached."""

    at_us: int
    cell: int
    reached: int = 0


def order_of(command: Give, at_us: int, cells: int) -> Order:
    """What a page wants the PC to send.

    Raises:
        Refused: there is no such cell.
    """
    if command.node is None:
        return Order(at_us, ALL, command.code, command.value)
    if command.node >= cells:
        raise Refused("this is a port of the PC; commands are for cells")
    return Order(at_us, number("cell", command.node, cells), command.code, command.value)


def begin(log: Logbook, graph: Any, at_us: int, number: int, cell: int) -> Given:
    """The PC was given a command."""
    whom = "all cells" if cell == ALL else graph.label(cell)
    log.often("command", at_us, f"command {number} for {whom}")
    return Given(at_us, cell)


def reached(log: Logbook, graph: Any, given: Given, at_us: int, number: int, cell: int) -> None:
    """A command came to a cell; told for one, and once all have it."""
    given.reached += 1
    took = ms_words((at_us - given.at_us) / 1e3)
    if given.cell != ALL:
        log.often(
            "came", at_us, f"command {number} came to {graph.label(cell)} after {took}", "good"
        )
    elif given.reached == graph.cells:
        whom = every(graph.cells, "cell")
        log.often("came", at_us, f"command {number} came to {whom} after {took}", "good")


def table(order: Order, target: dict[str, Any]) -> dict[str, Any]:
    """The [[command]] table of an order; `target` names its cell as an event does."""
    said = {"at_s": order.at_us / 1e6, "code": order.code, "value": order.value}
    return said if order.cell == ALL else said | target
