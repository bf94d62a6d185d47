"""Node files: TOML that names a node's identity, links, keys and role."""

from __future__ import annotations

import tomllib
from dataclasses import dataclass
from difflib import get_close_matches
from pathlib import Path
from typing import Annotated, Any, Literal

import msgspec
from msgspec import Meta, Struct, field

from innervate.live.errors import LiveError

Port = Annotated[int, Meta(ge=1, le=65_535)]


class UdpTable(Struct, frozen=True, forbid_unknown_fields=True, tag="udp", tag_field="kind"):
    """[[link]] kind = "udp": own address, and one path to each neighbour's."""

    bind: str
    peers: Annotated[list[str], Meta(min_length=1)]


class MulticastTable(
    Struct, frozen=True, forbid_unknown_fields=True, tag="multicast", tag_field="kind"
):
    """[[link]] kind = "multicast": a group on one interface."""

    group: str
    interface: str = "127.0.0.1"


class SerialTable(Struct, frozen=True, forbid_unknown_fields=True, tag="serial", tag_field="kind"):
    """[[link]] kind = "serial": a serial port, up to 4 Mbaud; a pty is one, too."""

    device: str
    far: str = ""
    baud: Annotated[int, Meta(ge=1200, le=4_000_000)] = 115_200


class MediumTable(Struct, frozen=True, forbid_unknown_fields=True, tag="medium", tag_field="kind"):
    """[[link]] kind = "medium": the shared channel of `innervate live medium`."""

    address: str


LinkTable = UdpTable | MulticastTable | SerialTable | MediumTable


class KeysTable(Struct, frozen=True, forbid_unknown_fields=True):
    """[keys]: `secret.N` are keys by number, `use` seals what leaves; `grace_s` at reload."""

    use: Annotated[int, Meta(ge=0, le=15)]
    secret: dict[str, str]
    grace_s: Annotated[float, Meta(ge=0, le=86_400)] = 10.0


class DeliverTable(Struct, frozen=True, forbid_unknown_fields=True):
    """[deliver]: messages in the order in which they were sent."""

    in_order: bool = False
    wait_ms: Annotated[int, Meta(ge=1, le=60_000)] = 10_000
    buffer: Annotated[int, Meta(ge=1, le=4096)] = 256


Ring = Annotated[list[tuple[int, int]], Meta(min_length=3)]


class FenceTable(Struct, frozen=True, forbid_unknown_fields=True):
    """[fence]: corners in units of protocol.unit_cm from its origin; the same in every file."""

    polygon: Ring
    holes: list[Ring] = []


class NodeFile(Struct, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """A node."""

    kind: Literal["mesh", "skin", "radio"]
    number: Annotated[int, Meta(ge=0, le=65_535)]
    name: Annotated[str, Meta(min_length=1, max_length=40, pattern="^[A-Za-z0-9_.-]+$")] | None = (
        None
    )
    nodes: Annotated[int, Meta(ge=1, le=65_535)] | None = None
    role: Literal["node", "gateway", "standby", "cell", "sink", "station"] | None = None
    rank: Annotated[int, Meta(ge=1, le=253)] = 1
    ports: Annotated[list[Annotated[int, Meta(ge=0, le=3)]], Meta(max_length=4)] = []
    socket: str | None = None
    state: str | None = None
    metrics: str | None = None
    rate_hz: Annotated[float, Meta(ge=0, le=1000)] = 0.0
    keys: KeysTable | None = None
    deliver: DeliverTable | None = None
    robot: bool = False
    fence: FenceTable | None = None
    protocol: dict[str, int] = {}
    link: Annotated[list[LinkTable], Meta(min_length=1)] = field(default_factory=list)


@dataclass(frozen=True, slots=True)
class Loaded:
    """A node file that was read.

    Attributes:
        table: what it says.
        path: where it stands; what it names is relative to its folder.
    """

    table: NodeFile
    path: Path

    @property
    def name(self) -> str:
        """The node's name: "n3" if the file gives none."""
        return self.table.name or f"n{self.table.number}"


def load(path: Path) -> Loaded:
    """Read a node file.

    Raises:
        LiveError: it cannot be read or says something that cannot be; one line.
    """
    try:
        raw = tomllib.loads(path.read_text(encoding="utf-8"))
    except OSError as error:
        raise LiveError(f"{path}: cannot be read: {error.strerror}") from None
    except UnicodeDecodeError:
        raise LiveError(f"{path}: is not UTF-8 text; name a node file") from None
    except tomllib.TOMLDecodeError as error:
        raise LiveError(f"{path}: not valid TOML: {error}") from None
    return Loaded(parse(raw, str(path)), path)


def parse(raw: dict[str, Any], where: str = "node") -> NodeFile:
    """The node of a file's tables.

    Raises:
        LiveError: see load().
    """
    _refuse_unknown(raw, where)
    try:
        table = msgspec.convert(raw, NodeFile)
    except msgspec.ValidationError as error:
        raise LiveError(f"{where}: {_readable(str(error))}") from None
    most = 254 if table.kind == "mesh" else 65_536
    if table.nodes is None and table.kind == "mesh":
        raise LiveError(f'{where}: "nodes" is missing: how many ids the mesh has, 1 to 254')
    if table.nodes is not None and not table.number < table.nodes <= most:
        raise LiveError(
            f"{where}: number {table.number} of {table.nodes} nodes cannot be; "
            f"numbers are 0 to nodes - 1, nodes at most {most}"
        )
    roles = ROLES[table.kind]
    if table.role is not None and table.role not in roles:
        raise LiveError(f"{where}: role of a {table.kind} node can be {', '.join(roles)}")
    if table.keys is not None and str(table.keys.use) not in table.keys.secret:
        raise LiveError(f"{where}: keys.use = {table.keys.use}, but there is no such secret")
    for key in ("deliver", "robot", "fence"):
        if getattr(table, key) and table.kind != "mesh":
            raise LiveError(f"{where}: {key} is for nodes of a mesh; remove it")
    return table


ROLES = {
    "mesh": ("node", "gateway", "standby"),
    "skin": ("cell", "sink"),
    "radio": ("station",),
}


def address(text: str, where: str) -> tuple[str, int]:
    """An address and port from "127.0.0.1:4700".

    Raises:
        LiveError: it is none.
    """
    host, _, port = text.rpartition(":")
    if not host or not port.isascii() or not port.isdigit() or int(port) > 65_535:
        raise LiveError(f'{where}: "{text}" is no address; write one like "127.0.0.1:4700"')
    return host, int(port)


def _refuse_unknown(raw: dict[str, Any], where: str) -> None:
    known = NodeFile.__struct_fields__
    for key in raw:
        if key not in known:
            near = get_close_matches(key, known, 1)
            hint = f'; do you mean "{near[0]}"?' if near else f"; it knows {', '.join(known)}"
            raise LiveError(f'{where}: unknown key "{key}"{hint}')


def _readable(message: str) -> str:
    """A validator's message with the key first."""
    what, _, place = message.partition(" - at `$.")
    return f"{place.rstrip('`')}: {what}" if place else message
