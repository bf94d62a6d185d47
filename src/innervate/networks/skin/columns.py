"""From the rows of a simulation to the columns of a run's tables."""

from typing import Any

import numpy as np

from innervate.networks.skin.analysis import rows
from innervate.networks.skin.protocol.constants import PORTS
from innervate.networks.skin.tables import LINKS, LOOPS, OUTAGES, RECEIVED, ROUTES
from innervate.trace.tables import Table, taken

Columns = dict[str, Any]


def columns(table: Table, result: Any) -> Columns:
    """One array for every column of a table."""
    return _MAKERS[table.name](result)


def _named(table: Table, found: Any) -> Columns:
    return {column.name: getattr(found, column.name) for column in table.columns}


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
    closed = found.closed_us.tolist()
    return _named(LOOPS, found) | {
        "closed_us": [None if time == rows.NEVER else time for time in closed]
    }


def _received(result: Any) -> Columns:
    part = result.deliveries
    made = taken(RECEIVED, part)
    for i in range(3):
        made[f"force_{i}"] = np.ascontiguousarray(part["force"][:, i])
        made[f"accel_{'xyz'[i]}"] = np.ascontiguousarray(part["accel"][:, i])
    return made


_MAKERS = {
    ROUTES.name: lambda result: _named(ROUTES, rows.parent_changes(result)),
    LINKS.name: _links,
    OUTAGES.name: _outages,
    LOOPS.name: _loops,
    RECEIVED.name: _received,
}
