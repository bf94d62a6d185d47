"""What is particular to runs of a skin: the simulation, the summary, the tables."""

from collections.abc import Callable, Iterator
from typing import Any

from innervate.networks.skin import tables
from innervate.networks.skin.analysis import frames
from innervate.networks.skin.analysis.summary import summarize
from innervate.networks.skin.columns import columns
from innervate.networks.skin.protocol.constants import TICK
from innervate.networks.skin.scenario.plan import Plan
from innervate.networks.skin.sim import simulate as simulator
from innervate.sim.status import ON_FRAME, ON_INPUT, ON_START, ON_TIMER
from innervate.topology import PORT_NAMES
from innervate.trace.tables import Table

# Received samples are kept by default as long as they fit easily: some 60 MB.
RECEIVED_MAX = 1_000_000

__all__ = ["columns", "simulate", "summarize", "tables_of", "written_of"]


def tables_of(_result: Any) -> tuple[Table, ...]:
    """The tables of a run."""
    return tables.TABLES


def written_of(result: Any) -> tuple[Table, ...]:
    """Those that are written: without samples where none were kept."""
    kept = result.has_deliveries
    return tuple(table for table in tables.TABLES if kept or table is not tables.RECEIVED)


def simulate(
    plan: Any,
    *,
    plain: bool,
    checks: bool,
    received: bool | None,
    progress: Callable[[int, int], None] | None,
) -> Any:
    """Run a skin's plan; with `received` all samples are kept, None = unless very many."""
    if received is None:
        received = 0 < samples(plan) <= RECEIVED_MAX
    result = simulator.simulate(
        plan, plain=plain, checks=checks, deliveries=received, progress=progress
    )
    if checks:
        frames.check_conserved(result)
    return result


def samples(plan: Any) -> int:
    """About how many samples all cells take."""
    if plan.data_period_us == 0:
        return 0
    return int(plan.graph.cells * (plan.duration_us // plan.data_period_us + 1))


def trail(plan: Plan, until_us: int) -> Iterator[Any]:
    """Pieces of the trail of a plan, in order: structured arrays with the fields of tables.TRAIL.

    Each belongs to the caller; together they are what `simulate(plan, trail=True)` keeps.
    """
    running = simulator.simulation(plan, checks=False, observe=False, trail=True)
    return running.pieces("trail", until_us)


def call_words(plan: Plan, row: Any) -> str:
    """A row of the trail in words: "p0 r3 c4: beacon period"."""
    node, handler, port = int(row["node"]), int(row["handler"]), int(row["port"])
    what = {
        ON_START: "switched on" if port == 0 else "restarted",
        ON_FRAME: f"frame on port {_port(plan, node, port)}",
        ON_TIMER: "beacon period" if port == TICK else "beacon that had to wait",
        ON_INPUT: "sample of its sensors",
    }[handler]
    return f"{plan.graph.label(node)}: {what}"


def _port(plan: Plan, node: int, port: int) -> str:
    return str(port) if node == plan.graph.sink else PORT_NAMES[port]
