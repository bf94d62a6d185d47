"""What the tables of a running skin say of all its cells at once."""

from typing import Any

import numpy as np

from innervate.analysis.ways import NOWHERE, follow
from innervate.networks.skin.protocol.constants import BEACON, COMMAND, DATA
from innervate.sim.cables.world import DEAD
from innervate.topology import PORTS
from innervate.web.cables import Cables

KINDS = {BEACON: "beacon", DATA: "data", COMMAND: "command"}


class SkinCables(Cables):
    """A skin's cables as arrays.

    Attributes:
        cells, ports: how many cells there are, and interface ports of the PC.
    """

    def __init__(self, plan: Any) -> None:
        super().__init__(plan, KINDS, "restart")
        self.cells, self.ports = plan.graph.cells, plan.graph.interfaces

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
