"""From a node file to a node."""

from __future__ import annotations

import ipaddress
from pathlib import Path
from socket import AF_INET6
from typing import TYPE_CHECKING, Any, NoReturn

from innervate.live import private
from innervate.live.addresses import ANY, Peer, as_written, family_of
from innervate.live.errors import LiveError
from innervate.live.links import Link
from innervate.live.node import LiveNode
from innervate.live.nodefile import (
    PYTHON,
    C,
    KeysTable,
    Loaded,
    MulticastTable,
    SerialTable,
    UdpTable,
    address,
    udp_address,
)
from innervate.live.plain import shown
from innervate.live.state import State
from innervate.network import networks

if TYPE_CHECKING:  # it brings ciphers with it, which only nodes with keys need
    from innervate.live.keys import Sealer


BROADCAST = "255.255.255.255"


def build(loaded: Loaded, engine: str = "") -> LiveNode:
    """The node of a node file, not yet started; `engine` in place of what the file says.

    Raises:
        LiveError: it cannot be as written.
    """
    network = networks()[loaded.table.kind]
    node: LiveNode = network.live_node(loaded)
    node.is_awake, node.is_warm = loaded.table.awake, loaded.table.warm
    wanted = engine or loaded.table.engine
    if wanted != PYTHON:
        node.not_in_c = why = network.in_c(node.stack, network)
        if why and wanted == C:
            raise LiveError(f'{loaded.path}: engine = "c": {why}; or write engine = "auto"')
    return node


def links_of(loaded: Loaded) -> list[Link]:
    """The links, their paths numbered through."""
    links: list[Link] = []
    count = 0
    for table in loaded.table.link:
        link = _link(table, f"{loaded.path}: link.{len(links)}", count)
        count += len(link.paths)
        links.append(link)
    _refuse_shared_ports(loaded)
    return links


def _refuse_shared_ports(loaded: Loaded) -> None:
    """Of two links that take the same UDP port the system would let in one."""
    taken: dict[int, tuple[str, int, str]] = {}
    for i, table in enumerate(loaded.table.link):
        if isinstance(table, UdpTable):
            host, port, interface = *udp_address(table.bind, ""), ""
        elif isinstance(table, MulticastTable):
            host, port, interface = *address(table.group, ""), table.interface
        else:
            continue
        for other, (its_host, its_port, its_interface) in taken.items():
            is_same = (host, interface) == (its_host, its_interface)
            is_any = family_of(host) == family_of(its_host) and {host, its_host} & {*ANY}
            if port == its_port != 0 and (is_same or is_any):
                raise LiveError(
                    f"{loaded.path}: link.{i} and link.{other} both take UDP port {port}; give "
                    "one of them another"
                )
        taken[i] = host, port, interface


def _link(table: Any, where: str, port: int) -> Link:
    if isinstance(table, UdpTable):
        from innervate.live.udp import UdpLink

        bind = _of_one_kind(table.bind, f"{where}.bind")
        peers = [_peer(peer, f"{where}.peers.{i}", bind) for i, peer in enumerate(table.peers)]
        if twice := next((one for one in peers if peers.count(one) > 1), None):
            raise LiveError(f"{where}.peers: {as_written(twice)} stands there twice")
        return UdpLink(bind, peers, port)
    if isinstance(table, MulticastTable):
        from innervate.live.multicast import MulticastLink

        own = _interface(table.interface, f"{where}.interface")
        group = _ipv4(table.group, f"{where}.group")
        if not 224 <= int(group[0].partition(".")[0]) < 240:
            raise LiveError(
                f"{where}.group: {group[0]} is no multicast group; they are 224.0.0.0 to "
                "239.255.255.255, like 239.77.0.1"
            )
        return MulticastLink(group, own, port)
    if isinstance(table, SerialTable):
        from innervate.live.serial import SerialLink
        from innervate.live.serial_port import is_speed

        if not is_speed(table.baud):
            raise LiveError(f"{where}.baud: this system has no {table.baud} baud; try 115200")
        return SerialLink(table.device, table.baud, port, table.far)
    raise LiveError(f"{where}: this kind of node has no such link")


def _interface(text: str, where: str) -> str:
    """An interface by its own address."""
    try:
        return str(ipaddress.IPv4Address(text))
    except ValueError:
        raise LiveError(
            f'{where}: "{shown(text)}" is no IPv4 address; write that of the interface, like '
            '"10.0.2.1"'
        ) from None


def _peer(text: str, where: str, bind: Peer) -> Peer:
    """An address at which a neighbour can be sent to and comes from, or a name for one."""
    host, port = _of_one_kind(text, where)
    try:
        one = ipaddress.ip_address(host)
    except ValueError:
        return host, port or _no_peer(text, where)
    if one.is_multicast or one.is_unspecified or host == BROADCAST or not port:
        _no_peer(text, where)
    if family_of(host) != family_of(bind[0]):
        raise LiveError(
            f"{where}: {text} cannot be reached from bind {as_written(bind)}: one is of IPv4, the "
            "other of IPv6; give those of either a link of their own"
        )
    return host, port


def _of_one_kind(text: str, where: str) -> Peer:
    """An address of UDP that says its interface where it has to, and only there; or a name."""
    host, port = udp_address(text, where)
    if family_of(host) == AF_INET6:
        one = ipaddress.IPv6Address(host)
        if one.ipv4_mapped is not None:
            raise LiveError(f"{where}: {text} is of IPv4; write {one.ipv4_mapped}:{port}")
        if one.is_link_local and not one.scope_id:
            raise LiveError(
                f"{where}: {text} is on every interface; say which: [{host}%eth0]:{port}"
            )
        if one.scope_id and not one.is_link_local:
            raise LiveError(f"{where}: {text} is on one interface alone; leave %{one.scope_id} out")
    return host, port


def _no_peer(text: str, where: str) -> NoReturn:
    raise LiveError(
        f"{where}: {text} is no address that a neighbour can have; write its own, like "
        '"10.0.0.2:4700", and for a group a link of kind = "multicast"'
    )


def _ipv4(text: str, where: str) -> tuple[str, int]:
    """An address of a group: no name, and none of IPv6."""
    host, port = address(text, where)
    try:
        return str(ipaddress.IPv4Address(host)), port
    except ValueError:
        raise LiveError(
            f'{where}: "{text}" is no IPv4 address with a port; write one like "127.0.0.1:4700"'
        ) from None


def state_of(loaded: Loaded) -> State:
    """What this node keeps over a restart, in a file beside its own."""
    named = loaded.table.state
    try:
        return State(loaded.path.parent / (named or f"{loaded.name}.state"))
    except LiveError as error:
        raise LiveError(f"{loaded.path}: state: {error}" if named else str(error)) from None


def sealer_of(loaded: Loaded, state: State) -> Sealer | None:
    """What seals this node's frames; None if the file names no keys."""
    table = loaded.table
    if table.keys is None:
        return None
    from innervate.live.keys import Sealer, ring_of

    identity = None
    if table.keys.identity is not None:
        from innervate.live.identity import load

        try:
            identity = load(loaded.path.parent / table.keys.identity, table.number)
        except LiveError as error:
            raise LiveError(f"{loaded.path}: keys.identity: {error}") from None
    keys = keys_of(table.keys, loaded)
    ring = ring_of(table.kind, keys, table.keys.use, identity)
    sealer = Sealer(ring, table.number, state, table.nodes)
    sealer.has_bound_ends = table.keys.ends
    return sealer


def open_keys(loaded: Loaded) -> list[Path]:
    """Files of the node's keys that other users of the machine can read."""
    table = loaded.table.keys
    if table is None:
        return []
    named = [text[5:] for text in table.secret.values() if text.startswith("file:")]
    within = len(named) < len(table.secret)  # a key stands in the node's file itself
    named += [] if table.identity is None else [table.identity]
    files = [loaded.path.parent / name for name in named] + [loaded.path] * within
    return [path for path in files if private.is_open(path)]


def keys_of(table: KeysTable, loaded: Loaded) -> dict[int, bytes]:
    """Keys by number; LiveError if a number is not 0 to 15, or a key is none."""
    from innervate.live.keyring import read_key

    keys = {}
    for number, text in table.secret.items():
        where = f"{loaded.path}: keys.secret.{number}"
        if not (number.isascii() and number.isdigit() and len(number) < 3 and int(number) <= 15):
            raise LiveError(f"{where}: numbers of keys are 0 to 15")
        try:
            keys[int(number)] = read_key(text, loaded.path.parent)
        except LiveError as error:
            raise LiveError(f"{where}: {error}") from None
    return keys
