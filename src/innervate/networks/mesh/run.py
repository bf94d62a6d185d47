"""What is particular to mesh runs: the simulation, the summary, the tables."""

from typing import Any

from innervate.networks.mesh import tables as mesh_tables
from innervate.networks.mesh.analysis.alarms import all_crossings
from innervate.networks.mesh.analysis.messages import NEVER, messages
from innervate.networks.mesh.analysis.summary import summarize
from innervate.networks.mesh.plot.words import HANDED, PACKETS, TIMERS
from innervate.networks.mesh.sim import simulate as simulator
from innervate.running.simulating import trail
from innervate.sim.field.access import MAC
from innervate.sim.status import ON_FRAME, ON_INPUT, ON_START, ON_TIMER
from innervate.trace.tables import Table, taken

__all__ = ["call_words", "columns", "simulate", "summarize", "tables_of", "trail"]

Columns = dict[str, Any]


def simulate(plan: Any, *, received: bool | None, **how: Any) -> Any:
    """Run a mesh plan; `received` is for skins."""
    return simulator.simulate(plan, **how)


def tables_of(_result: Any) -> tuple[Table, ...]:
    """The tables of a run."""
    return mesh_tables.TABLES


written_of = tables_of


def columns(table: Table, result: Any) -> Columns:
    """One array for every column of a table."""
    if table.name in _MAKERS:
        return _MAKERS[table.name](result)
    found = taken(table, getattr(result, table.rows))
    if "looped" in found:
        found["looped"] = found["looped"] == 1
    return found


def _or_null(values: Any) -> list[int | None]:
    """Whole numbers, None for those that say NEVER."""
    return [None if value == NEVER else int(value) for value in values]


def _messages(result: Any) -> Columns:
    found = messages(result)
    return {
        **{name: getattr(found, name) for name in ("offered_us", "node", "dest", "flow", "state")},
        **{name: _or_null(getattr(found, name)) for name in ("seq", "delivered_us", "hops")},
    }


def _crossings(result: Any) -> Columns:
    found = all_crossings(result)

    def column(name: str) -> list[Any]:
        return [getattr(crossing, name) for crossing in found]

    return {
        shown.name: _or_null(column(shown.name)) if shown.kind.startswith("Int")
        else column(shown.name)
        for shown in mesh_tables.CROSSINGS.columns
    }  # fmt: skip


_MAKERS = {mesh_tables.MESSAGES.name: _messages, mesh_tables.CROSSINGS.name: _crossings}


def call_words(plan: Any, row: Any) -> str:
    """A row of the trail in words: "node n3: received a table"."""
    handler, port = int(row["handler"]), int(row["port"])
    who = f"node {plan.names[int(row['node'])]}"
    if handler >= MAC:
        return f"{who}: its medium access"
    what = {
        ON_START: "switched on" if port == 0 else "restarted",
        ON_FRAME: f"received {PACKETS.get(port, f'a packet of type {port}')}",
        ON_TIMER: TIMERS.get(port, f"timer {port}"),
        ON_INPUT: HANDED.get(port, f"input {port}"),
    }[handler]
    return f"{who}: {what}"
