"""What is particular to runs over cables, for a network that has no more to say of them."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any

import numpy as np

from innervate.sim.cables import declared, wires
from innervate.sim.status import ON_FRAME, ON_INPUT, ON_START, ON_TIMER
from innervate.topology import PORT_NAMES
from innervate.trace.tables import Column, Table

_TIME = Column("time_us", "Int64", "us", "when, true time")
_NODE = Column("node", "Int32", "node", "who")
REPORTS = Table(
    "reports",
    "a node reported something",
    (
        _TIME,
        _NODE,
        Column("code", "Int32", "number", "what, as its protocol numbers it"),
        Column("a", "Int32", "", "of the report"),
        Column("b", "Int32", "", "of the report"),
    ),
)
DELIVERIES = Table(
    "deliveries",
    "a node's user got a frame",
    (
        _TIME,
        _NODE,
        Column("port", "Int8", "port", "it came in on; of a timer its number"),
        Column("kind", "Int32", "type", "of the frame; -1 where frames have none"),
        Column("latency_us", "Int32", "us", "since its content was handed in; -1 not known"),
    ),
)
TABLES = (REPORTS, DELIVERIES)
LOST = {
    "cut": wires.LOST_CUT,
    "noise": wires.LOST_NOISE,
    "off": wires.LOST_OFF,
    "queue_full": wires.LOST_QUEUE,
    "broken_link": wires.LOST_BROKEN,
}


def tables_of(_result: Any) -> tuple[Table, ...]:
    """The tables of a run."""
    return TABLES


def written_of(result: Any) -> tuple[Table, ...]:
    """Those that are written: without deliveries where none were kept."""
    return TABLES if result.received_kept else (REPORTS,)


def columns(table: Table, result: Any) -> dict[str, Any]:
    """One array for every column of a table."""
    rows = result.rows if table is REPORTS else result.deliveries
    found = {column.name: rows[column.name.removesuffix("_us")] for column in table.columns}
    return {name: np.ascontiguousarray(values) for name, values in found.items()}


def simulate(
    plan: Any,
    *,
    plain: bool,
    checks: bool,
    received: bool | None,
    progress: Callable[[int, int], None] | None,
) -> Any:
    """Run a plan; what users received is kept unless `received` is false."""
    kept = received is not False
    return declared.simulate(plan, plain=plain, checks=checks, deliveries=kept, progress=progress)


def summarize(result: Any) -> dict[str, Any]:
    """What a person wants to know: frames by what became of them, deliveries, latencies."""
    plan, counters = result.plan, result.counters
    blocks = wires.BLOCKS
    lost = {name: sum(counters[at + block] for block in blocks) for name, at in LOST.items()}
    frames = {"sent": sum(counters[wires.SENT + block] for block in blocks),
              "arrived": result.arrived, "lost": lost}  # fmt: skip
    taken = result.deliveries["latency"]
    taken = np.sort(taken[taken >= 0]) / 1000
    latency: dict[str, float | None] = dict.fromkeys(("mean", "p50", "p95", "max"))
    if len(taken):
        middle, most = taken[len(taken) // 2], taken[min(len(taken) - 1, len(taken) * 95 // 100)]
        figures = (taken.mean(), middle, most, taken[-1])
        latency = {name: round(float(x), 3) for name, x in zip(latency, figures, strict=True)}
    return {
        "kind": plan.kind,
        "name": plan.scenario.name,
        "seed": plan.seed,
        "nodes": plan.graph.cells,
        "cables": sum(1 for _ in plan.graph.links()),
        "simulated_s": result.ended_us / 1e6,
        "wall_s": round(result.wall_s, 3),
        "handler_calls": result.handled,
        "frames": frames,
        "delivered": counters[wires.DELIVERED],
        "latency_ms": latency,
        "reports": {str(code): int(np.count_nonzero(result.rows["code"] == code))
                    for code in np.unique(result.rows["code"]).tolist()},
        "fingerprint": result.fingerprint,
        "interrupted": result.interrupted,
    }  # fmt: skip


def trail(plan: Any, until_us: int) -> Iterator[Any]:
    """Pieces of the trail of a plan, in order: records with the fields of trail.FIELDS."""
    running = declared.simulation(plan, checks=False, observe=False, trail=True)
    return running.pieces("trail", until_us)


def call_words(plan: Any, row: Any) -> str:
    """A row of the trail in words: "n1: frame on port W"."""
    node, handler, port = int(row["node"]), int(row["handler"]), int(row["port"])
    what = {
        ON_START: "switched on" if port == 0 else "restarted",
        ON_FRAME: f"frame on port {PORT_NAMES[port & 3]}",
        ON_TIMER: f"timer {port}",
        ON_INPUT: "given something",
    }[handler]
    return f"{plan.graph.label(node)}: {what}"
