"""From the rows of a simulation to the columns of a run's tables."""

from __future__ import annotations

from typing import Any

import numpy as np

from innervate.analysis import rows
from innervate.protocol.skin_words import PORTS
from innervate.trace.tables import LINKS, LOOPS, OUTAGES, RECEIVED, ROUTES, Table

Columns = dict[str, Any]


def columns(table: Table, result: Any) -> Columns:
    """One array for every column of a table."""
    return _MAKERS[table.name](result)


def _routes(result: Any) -> Columns:
    changes = rows.parent_changes(result)
    return {
        "time_us": changes.time_us,
        "cell": changes.cell,
        "old": changes.old,
        "new": changes.new,
        "balancing": changes.balancing,
    }


def _links(result: Any) -> Columns:
    changes = rows.broken_changes(result)
    peer = np.frombuffer(result.plan.graph.peer, np.int32)
    return {
        "time_us": changes.time_us,
        "cell": changes.end // PORTS,
        "port": changes.end % PORTS,
        "to": np.minimum(peer[changes.end] // PORTS, result.plan.graph.sink),
        "broken": changes.broken == 1,
    }


def _outages(result: Any) -> Columns:
    lost, apart = rows.unrouted_steps(result), rows.apart_steps(result)
    at = np.union1d(lost.row, apart.row)
    return {
        "time_us": result.rows["time"][at],
        "unrouted": rows.values_at(lost, at),
        "cut_off": rows.values_at(apart, at),
    }


def _loops(result: Any) -> Columns:
    found = rows.loop_episodes(result)
    closed = [None if time == rows.NEVER else time for time in found.closed_us.tolist()]
    return {
        "opened_us": found.opened_us,
        "closed_us": closed,
        "cell": found.cell,
        "length": found.length,
    }


def _received(result: Any) -> Columns:
    part = result.deliveries
    made = {
        "time_us": part["time"],
        "interface": part["port"],
        **{name: part[name] for name in ("cell", "seq", "hops", "proximity", "temperature")},
        "latency_us": part["latency"],
    }
    for i in range(3):
        made[f"force_{i}"] = part["force"][:, i]
        made[f"accel_{'xyz'[i]}"] = part["accel"][:, i]
    # Fields of rows lie apart in memory; polars wants each in one piece.
    return {name: np.ascontiguousarray(values) for name, values in made.items()}


_MAKERS = {
    ROUTES.name: _routes,
    LINKS.name: _links,
    OUTAGES.name: _outages,
    LOOPS.name: _loops,
    RECEIVED.name: _received,
}
