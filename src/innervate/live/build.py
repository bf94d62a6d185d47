"""From a node file to a node."""

from __future__ import annotations

import secrets
from collections.abc import Callable
from typing import Any

from innervate.live.errors import LiveError
from innervate.live.keys import Sealer, read_key
from innervate.live.links import Link
from innervate.live.node import LiveNode
from innervate.live.nodefile import (
    DeliverTable,
    KeysTable,
    Loaded,
    MediumTable,
    MulticastTable,
    SerialTable,
    UdpTable,
    address,
)
from innervate.live.state import State


def build(loaded: Loaded) -> LiveNode:
    """The node of a node file, not yet started.

    Raises:
        LiveError: it cannot be as written.
    """
    return BUILDERS[loaded.table.kind](loaded)


def links_of(loaded: Loaded) -> list[Link]:
    """The links, their paths numbered through."""
    links: list[Link] = []
    count = 0
    for table in loaded.table.link:
        link = _link(table, f"{loaded.path}", count)
        count += len(link.paths)
        links.append(link)
    return links


def _link(table: Any, where: str, port: int) -> Link:
    if isinstance(table, UdpTable):
        from innervate.live.udp import UdpLink

        peers = [address(peer, where) for peer in table.peers]
        return UdpLink(address(table.bind, where), peers, port)
    if isinstance(table, MulticastTable):
        from innervate.live.udp import MulticastLink

        return MulticastLink(address(table.group, where), table.interface, port)
    if isinstance(table, SerialTable):
        from innervate.live.serial import SerialLink

        return SerialLink(table.device, table.baud, port, table.far)
    raise LiveError(f"{where}: this kind of node has no such link")


def state_of(loaded: Loaded) -> State:
    """What this node keeps over a restart, in a file beside its own."""
    return State(loaded.path.parent / (loaded.table.state or f"{loaded.name}.state"))


def sealer_of(loaded: Loaded, state: State) -> Sealer | None:
    """What seals this node's frames; None if the file names no keys."""
    table = loaded.table
    if table.keys is None:
        return None
    keys = keys_of(table.keys, loaded)
    return Sealer(table.kind, table.number, keys, table.keys.use, state)


def keys_of(table: KeysTable, loaded: Loaded) -> dict[int, bytes]:
    """Keys by number.

    Raises:
        LiveError: a number is not 0 to 15, or a key is none.
    """
    keys = {}
    for number, text in table.secret.items():
        if not (number.isascii() and number.isdigit() and int(number) <= 15):
            raise LiveError(f"{loaded.path}: keys.secret.{number}: numbers of keys are 0 to 15")
        keys[int(number)] = read_key(text, loaded.path.parent)
    return keys


def _mesh(loaded: Loaded) -> LiveNode:
    from innervate.live.profile import fence_parameters, mesh_parameters
    from innervate.networks.mesh.live.messages import MeshNode
    from innervate.networks.mesh.live.order import Orderly
    from innervate.networks.mesh.live.stack import MeshStack

    table = loaded.table
    assert table.nodes is not None
    ranks = {"gateway": 0, "standby": table.rank}
    rank = ranks.get(table.role or "node", -1)
    params = mesh_parameters(table.nodes, dict(table.protocol), f"{loaded.path}")
    if table.fence is not None:
        rings = [table.fence.polygon, *table.fence.holes]
        params.update(fence_parameters(rings, f"{loaded.path}"))
    stack = MeshStack(table.number, rank, params, secrets.randbits(60), table.robot)
    state = state_of(loaded)
    sealer, deliver = sealer_of(loaded, state), table.deliver or DeliverTable()
    orderly = Orderly(1000 * deliver.wait_ms, deliver.buffer)
    links, in_order = links_of(loaded), deliver.in_order
    return MeshNode(loaded.name, stack, links, sealer, state, orderly, in_order)


def _skin(loaded: Loaded) -> LiveNode:
    from innervate.live.profile import skin_parameters
    from innervate.networks.skin.live.nodes import CellNode, CellStack, SinkNode, SinkStack

    table, links, state = loaded.table, links_of(loaded), state_of(loaded)
    params = skin_parameters(dict(table.protocol), f"{loaded.path}")
    paths = sum(len(link.paths) for link in links)
    sealer = sealer_of(loaded, state)
    if table.role == "sink":
        return SinkNode(loaded.name, SinkStack(params, paths), links, sealer, state)
    ports = table.ports or list(range(paths))
    if len(ports) != paths or len(set(ports)) != paths:
        raise LiveError(
            f"{loaded.path}: ports must name the cell's port of each of its {paths} paths, "
            "each once: W, E, up, down = 0 to 3"
        )
    stack = CellStack(table.number, params, secrets.randbits(60), ports)
    return CellNode(loaded.name, stack, links, sealer, state, table.rate_hz)


def _radio(loaded: Loaded) -> LiveNode:
    from innervate.live.profile import radio_parameters
    from innervate.networks.radio.live.medium import MediumRadio
    from innervate.networks.radio.live.station import RadioNode, StationStack, check_parameters

    table, where = loaded.table, f"{loaded.path}"
    if len(table.link) != 1 or not isinstance(table.link[0], MediumTable):
        raise LiveError(f'{where}: a station has one [[link]], of kind = "medium"')
    if table.keys is not None:
        raise LiveError(f"{where}: frames on a shared channel are not sealed; remove [keys]")
    params = radio_parameters(dict(table.protocol), where)
    check_parameters(params)
    stack = StationStack(table.number, params, secrets.randbits(60))
    radio = MediumRadio(table.number, address(table.link[0].address, where))
    return RadioNode(loaded.name, stack, radio, f"medium {table.link[0].address}")


BUILDERS: dict[str, Callable[[Loaded], LiveNode]] = {
    "mesh": _mesh, "skin": _skin, "radio": _radio,
}  # fmt: skip
