"""What the tables of a running skin say of all its cells at once."""

from __future__ import annotations

from typing import Any

import numpy as np

from innervate.analysis.ways import NOWHERE, follow
from innervate.protocol.skin_words import BEACON, COMMAND, DATA
from innervate.sim import wheel
from innervate.sim.wires import DELAYED
from innervate.sim.world import DEAD
from innervate.topology import PORTS
from innervate.web.skin_scene import nodes_of_ends

FLIGHTS_MAX = 2_000
KINDS = {BEACON: "beacon", DATA: "data", COMMAND: "command"}


class Cables:
    """A graph's cables as arrays.

    Attributes:
        cells, ports: how many cells there are, and interface ports of the PC.
        peer: per end the other one, -1 none.
        node_of: per end its node; interface ports are the nodes behind the cells.
        ends: per link its two ends, the lower first.
    """

    def __init__(self, plan: Any) -> None:
        graph = plan.graph
        self._plan = plan
        self.cells, self.ports = graph.cells, graph.interfaces
        self.peer = np.frombuffer(graph.peer, np.int32).astype(np.int64)
        self.node_of = nodes_of_ends(graph)
        self.ends = np.array(list(graph.links()), np.int64).reshape(-1, 2)

    def ways(self, world: Any) -> dict[str, Any]:
        """Per node its parent, the interface port that its way leads to over live cables, hops.

        And `unconnected`: how many cells that are on have no way.
        """
        cells, ports = self.cells, self.ports
        parent = world.watch.port
        end = PORTS * np.arange(cells) + np.maximum(parent, 0)
        hop = np.where(parent >= 0, self.node_of[self.peer[end]], NOWHERE)
        live = (parent >= 0) & ((world.epoch[end] & 1) == 0)
        none = np.full(ports, NOWHERE)
        is_port = np.arange(cells + ports) >= cells
        root, depth = follow(np.concatenate([np.where(live, hop, NOWHERE), none]), is_port)
        lost = (world.alive[:cells] != DEAD) & (root[:cells] == NOWHERE)
        return {
            "parent": np.concatenate([hop, none]),
            "port": np.where(root == NOWHERE, NOWHERE, root - cells),
            "depth": depth,
            "unconnected": int(np.count_nonzero(lost)),
        }

    def flights(self, world: Any, now_us: int) -> list[dict[str, Any]]:
        """Frames on their way, at most FLIGHTS_MAX."""
        first, last = int(world.run["pool_slots"][0]), int(world.wheel.pool[wheel.FRESH])
        events = world.wheel.events[first:last]
        on_way = (events["bucket"] != wheel.NIL) & (events["kind"] != DELAYED)
        slots = np.flatnonzero(on_way)[:FLIGHTS_MAX]
        to = events["target"][slots].astype(np.int64)
        sent = self.peer[to]
        latency = world.ends["latency"][sent]
        if self._plan.latency_per_frame:
            latency = np.full(len(to), sum(self._plan.latency_us) // 2)
        part = np.clip(1 - (events["time"][slots] - now_us) / latency, 0.0, 1.0).round(3)
        columns = (self.node_of[sent], self.node_of[to], world.frames["kind"][slots], part)
        return [
            {"a": a, "b": b, "kind": KINDS.get(kind, "restart"), "p": p}
            for a, b, kind, p in zip(*(column.tolist() for column in columns), strict=True)
        ]
