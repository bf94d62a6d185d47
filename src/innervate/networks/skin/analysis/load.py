"""Whose data leave through which interface port at the end of a run, and how evenly."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from innervate.analysis.ways import NOWHERE, Numbers, follow
from innervate.networks.skin.analysis.recovery import next_hops
from innervate.networks.skin.protocol.constants import NONE, PORTS
from innervate.sim.cables.world import ALIVE
from innervate.sim.tables import column

NO_PORT = -1


def interface_of(result: Any) -> Numbers:
    """Interface port that every cell's data leave through at the end of the run.

    Follows the chain of parents over live cables; NO_PORT (-1) where it does not reach the PC.
    """
    graph = result.plan.graph
    parent = column(result.world.cells, "parent")
    alive = np.array(result.world.alive[: graph.cells]) == ALIVE
    parent = np.where(alive, parent, NONE)  # before a cell starts its record says port 0
    epoch = np.array(result.world.epoch, np.int64)
    ends = PORTS * np.arange(graph.cells) + np.maximum(parent, 0)
    parent = np.where(epoch[ends] & 1, NONE, parent)
    return interfaces_along(graph, parent)


def interfaces_along(graph: Any, parent: Numbers) -> Numbers:
    """The same for given parent ports (-1 none), all cables live."""
    hop = next_hops(graph, parent)
    last, _ = follow(hop, hop == graph.sink)  # the cell that is cabled to the PC
    ends = PORTS * last + parent[last]
    port = np.frombuffer(graph.peer, np.int32)[ends] - PORTS * graph.cells
    return np.where(last != NOWHERE, port, NO_PORT).astype(np.int64)


def port_loads(result: Any) -> list[int]:
    """Cells that each interface port serves at the end of the run."""
    port = interface_of(result)
    return [int(n) for n in np.bincount(port[port >= 0], minlength=result.plan.graph.interfaces)]


def balance_factor(loads: Sequence[int]) -> float | None:
    """Eq. 8 [skin III-A.2]: 1 if all ports carry the same, 1/n if one carries all; None if none."""
    squares = sum(load * load for load in loads)
    return sum(loads) ** 2 / (len(loads) * squares) if squares else None
