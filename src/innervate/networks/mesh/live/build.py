"""From a node file to a node of a mesh."""

from __future__ import annotations

from innervate.live.build import links_of, sealer_of, state_of
from innervate.live.machine import machine
from innervate.live.nodefile import Loaded
from innervate.networks.mesh.live.node import MeshNode
from innervate.networks.mesh.live.nodefile import DeliverTable, MeshFile
from innervate.networks.mesh.live.order import Orderly
from innervate.networks.mesh.live.parameters import fence_parameters, mesh_parameters
from innervate.networks.mesh.live.stack import MeshStack


def build(loaded: Loaded) -> MeshNode:
    """The node of a file, not yet started.

    Raises:
        LiveError: it cannot be as written.
    """
    table = loaded.table
    assert isinstance(table, MeshFile)
    assert table.nodes is not None
    ranks = {"gateway": 0, "standby": table.rank}
    rank = ranks.get(table.role or "node", -1)
    params = mesh_parameters(table.nodes, dict(table.protocol), f"{loaded.path}")
    if table.fence is not None:
        rings = [table.fence.polygon, *table.fence.holes]
        params.update(fence_parameters(rings, f"{loaded.path}"))
    stack = MeshStack(table.number, rank, params, machine().chance.getrandbits(60), table.robot)
    state = state_of(loaded)
    sealer, deliver = sealer_of(loaded, state), table.deliver or DeliverTable()
    orderly = Orderly(1000 * deliver.wait_ms, deliver.buffer)
    made = MeshNode(loaded.name, stack, links_of(loaded), sealer, state, orderly)
    made.in_order = deliver.in_order
    return made
