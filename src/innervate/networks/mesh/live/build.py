"""From a node file to a node of a mesh."""

from innervate.live.build import links_of, sealer_of, state_of
from innervate.live.errors import LiveError
from innervate.live.links import Link
from innervate.live.machine import machine
from innervate.live.nodefile import Loaded
from innervate.networks.mesh.live.node import MeshNode
from innervate.networks.mesh.live.nodefile import DeliverTable, MeshFile
from innervate.networks.mesh.live.order import Orderly
from innervate.networks.mesh.live.parameters import fence_parameters, mesh_parameters
from innervate.networks.mesh.live.stack import MeshStack
from innervate.wire.seal import OVERHEAD_BYTES


def build(loaded: Loaded) -> MeshNode:
    """The node of a file, not yet started; a LiveError says what cannot be as written."""
    table = loaded.table
    assert isinstance(table, MeshFile)
    assert table.nodes is not None
    ranks = {"gateway": 0, "standby": table.rank}
    rank = ranks.get(table.role or "node", -1)
    params = mesh_parameters(table.nodes, dict(table.protocol), f"{loaded.path}")
    if table.fence is not None:
        rings = [table.fence.polygon, *table.fence.holes]
        params.update(fence_parameters(rings, f"{loaded.path}"))
    links = links_of(loaded)
    check_mtu(params["mtu"], links, table.keys is not None, f"{loaded.path}")
    stack = MeshStack(table.number, rank, params, machine().chance.getrandbits(60), table.robot)
    state = state_of(loaded)
    sealer, deliver = sealer_of(loaded, state), table.deliver or DeliverTable()
    orderly = Orderly(1000 * deliver.wait_ms, deliver.buffer)
    made = MeshNode(loaded.name, stack, links, sealer, state, orderly)
    made.in_order = deliver.in_order
    return made


def check_mtu(mtu: int, links: list[Link], is_sealed: bool, where: str) -> None:
    """Refuse frames that are longer than a link carries; the message begins with `where`.

    Raises:
        LiveError: those of this one.
    """
    for link in links:
        most = link.frame_max - (OVERHEAD_BYTES if is_sealed else 0)
        if mtu > most:
            raise LiveError(
                f"{where}: protocol.mtu = {mtu}, but {link.paths[0].name} carries frames of at "
                f"most {most} bytes; write mtu = {most} or less, the same into all nodes' files"
            )
