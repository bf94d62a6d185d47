"""What is particular to mesh runs: the simulation, the summary, the tables."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace
from typing import Any

import numpy as np

from innervate.networks.mesh import tables as mesh_tables
from innervate.networks.mesh.analysis.alarms import all_crossings
from innervate.networks.mesh.analysis.messages import NEVER, messages
from innervate.networks.mesh.analysis.summary import summarize
from innervate.networks.mesh.plot.words import HANDED, PACKETS, TIMERS
from innervate.networks.mesh.sim import simulate as simulator
from innervate.sim.field.access import MAC
from innervate.sim.status import ON_FRAME, ON_INPUT, ON_START, ON_TIMER
from innervate.trace.tables import Table

__all__ = ["call_words", "columns", "simulate", "summarize", "tables_of", "trail"]

Columns = dict[str, Any]


def simulate(
    plan: Any,
    *,
    plain: bool,
    checks: bool,
    received: bool | None,
    progress: Callable[[int, int], None] | None,
) -> Any:
    """Run a mesh plan; `received` is for skins."""
    return simulator.simulate(plan, plain=plain, checks=checks, progress=progress)


def tables_of(_result: Any) -> tuple[Table, ...]:
    """The tables of a run."""
    return mesh_tables.TABLES


written_of = tables_of


def columns(table: Table, result: Any) -> Columns:
    """One array for every column of a table."""
    made = _MAKERS[table.name](result)
    # Fields of rows lie apart in memory; polars wants each in one piece.
    return {
        name: np.ascontiguousarray(values) if isinstance(values, np.ndarray) else values
        for name, values in made.items()
    }


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


def _deliveries(result: Any) -> Columns:
    rows = result.delivered
    return {
        "time_us": rows["time"],
        "hops": rows["path_len"],
        "looped": rows["looped"] == 1,
        **{name: rows[name] for name in ("node", "kind", "flags", "origin", "seq")},
    }


def _sent(result: Any) -> Columns:
    rows = result.sent
    same = [column.name for column in mesh_tables.SENT.columns[2:]]
    return {
        "start_us": rows["time"],
        "end_us": rows["end"],
        **{name: rows[name] for name in same},
    }


def _rounds(result: Any) -> Columns:
    rows = result.rounds
    same = [column.name for column in mesh_tables.ROUNDS.columns[1:]]
    return {"time_us": rows["time"], **{name: rows[name] for name in same}}


def _reports(result: Any) -> Columns:
    rows = result.rows
    return {"time_us": rows["time"], **{name: rows[name] for name in ("node", "code", "a", "b")}}


_MAKERS = {
    mesh_tables.MESSAGES.name: _messages,
    mesh_tables.CROSSINGS.name: _crossings,
    mesh_tables.DELIVERIES.name: _deliveries,
    mesh_tables.SENT.name: _sent,
    mesh_tables.ROUNDS.name: _rounds,
    mesh_tables.REPORTS.name: _reports,
}


def trail(plan: Any, until_us: int) -> Iterator[Any]:
    """The trail of a plan: structured arrays with the fields of trail.FIELDS."""
    shorter = replace(plan, duration_us=until_us)
    yield simulator.simulate(shorter, checks=False, observe=False, trail=True).trail


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
