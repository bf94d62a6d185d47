"""Node files: TOML that names a node's identity, links, keys and role."""

import ipaddress
import re
from dataclasses import dataclass
from difflib import get_close_matches
from pathlib import Path
from typing import Annotated, Any, ClassVar, Literal

import msgspec
from msgspec import Meta, Struct, field

from innervate.live import plain
from innervate.live.errors import LiveError
from innervate.network import find, networks

PYTHON, C = "python", "c"  # what runs a node's protocol
HOST = re.compile(r"\w[\w-]*(\.\w[\w-]*)*\.?")
HOST_MAX = 253  # characters
UNKNOWN = re.compile(r"Object contains unknown field `(.*)`")
MISSING = re.compile(r"Object missing required field `(.*)`")
OF_SCENARIOS = {"schema", "duration_s", "seed", "event"}
CHOICES = {"engine": (PYTHON, C, "auto"), "kind": ("udp", "serial", "multicast", "medium")}


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
    """[keys]: an `identity` of the node's own, or `secret.N`, keys of the whole network.

    With `use` handshakes begin; `grace_s` is for a reload. `ends` = False where addresses are
    changed on the way.
    """

    identity: str | None = None
    use: Annotated[int, Meta(ge=0, le=15)] = 0
    secret: dict[str, str] = {}
    ends: bool = True
    grace_s: Annotated[float, Meta(ge=0, le=86_400)] = 10.0


class NodeFile(Struct, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """A node. A network whose nodes have keys of their own says so in a subclass.

    Attributes:
        roles: what `role` can be.
        nodes_max: most nodes that a network can have.
        awake: the machine's processors do not sleep while the node runs.
        warm: it goes through what a frame takes 500 times a second, for caches.
    """

    roles: ClassVar[tuple[str, ...]] = ("node",)
    nodes_max: ClassVar[int] = 65_536

    kind: str
    number: Annotated[int, Meta(ge=0, le=65_535)]
    name: Annotated[str, Meta(min_length=1, max_length=40, pattern="^[A-Za-z0-9_.-]+$")] | None = (
        None
    )
    nodes: Annotated[int, Meta(ge=1, le=65_535)] | None = None
    role: str | None = None
    socket: str | None = None
    state: str | None = None
    engine: Literal["python", "c", "auto"] = "python"
    awake: bool = False
    warm: bool = False
    metrics: str | None = None
    keys: KeysTable | None = None
    protocol: dict[str, int] = {}
    link: Annotated[list[LinkTable], Meta(min_length=1)] = field(default_factory=list)

    def check(self, where: str) -> None:
        """What single keys do not show.

        Raises:
            LiveError: the first thing that cannot be; the message begins with `where`.
        """
        if self.nodes is not None and not self.number < self.nodes <= self.nodes_max:
            raise LiveError(
                f"{where}: number {self.number} of {self.nodes} nodes cannot be; "
                f"numbers are 0 to nodes - 1, nodes at most {self.nodes_max}"
            )
        if self.role is not None and self.role not in self.roles:
            raise LiveError(f"{where}: role of a {self.kind} node can be {', '.join(self.roles)}")
        if self.keys is not None and self.keys.identity is not None:
            if self.keys.secret:
                raise LiveError(
                    f"{where}: keys.identity takes the place of keys.secret; remove one"
                )
        elif self.keys is not None and str(self.keys.use) not in self.keys.secret:
            raise LiveError(f"{where}: keys.use = {self.keys.use}, but there is no such secret")


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
    text = plain.text(path, "is not UTF-8 text; name a node file")
    try:
        raw = plain.read(text)
    except ValueError as error:
        raise LiveError(f"{path}: {error}") from None
    return Loaded(parse(raw, str(path), path.parent), path)


def parse(raw: dict[str, Any], where: str = "node", folder: Path = Path()) -> NodeFile:
    """The node of a file's tables; a network of that kind may be a folder beside it, in `folder`.

    What is wrong is a LiveError, as of `load`.
    """
    if wrong := plain.fault(raw):
        raise LiveError(f"{where}: {wrong}")
    if "number" not in raw and raw.keys() & OF_SCENARIOS:
        raise LiveError(f"{where}: a scenario, no node's file; try: innervate live up {where}")
    kind = raw.get("kind")
    network = find(kind, folder, Path()) if isinstance(kind, str) else None
    if network is None:
        raise LiveError(f"{where}: kind must be {' or '.join(networks())}")
    file = network.node_file
    _refuse_unknown(raw, file.__struct_fields__, where)
    try:
        table: NodeFile = msgspec.convert(raw, file)
    except msgspec.ValidationError as error:
        raise LiveError(f"{where}: {_readable(str(error), raw)}") from None
    table.check(where)
    return table


def address(text: str, where: str) -> tuple[str, int]:
    """An address and port from "127.0.0.1:4700"; the host can be a name.

    Raises:
        LiveError: it is none.
    """
    host, _, port = text.rpartition(":")
    digits = port.isascii() and port.isdigit() and len(port) < 6
    if not _is_host(host) or not digits or int(port) > 65_535:
        raise LiveError(
            f'{where}: "{plain.shown(text)}" is no address; write one like "127.0.0.1:4700"'
        )
    return host, int(port)


def udp_address(text: str, where: str) -> tuple[str, int]:
    """The same, or an address of IPv6 from "[fe80::1%eth0]:4700", whose host has no brackets."""
    host, _, port = text.removeprefix("[").rpartition("]:")
    if not host:
        return address(text, where)
    try:
        return str(ipaddress.IPv6Address(host)), address(f"v6:{port}", where)[1]
    except (ValueError, LiveError):
        raise LiveError(
            f'{where}: "{plain.shown(text)}" is no address of IPv6; write one like "[fd00::2]:4700"'
        ) from None


def _is_host(host: str) -> bool:
    """True if it is an address of IPv4 or can be a name, of which the last part is no number.

    A name can have one letter, others than ASCII's, and a point at its end.
    """
    try:
        ipaddress.IPv4Address(host)
    except ValueError:
        is_name = HOST.fullmatch(host) and not host.rstrip(".").rpartition(".")[2].isdigit()
        try:
            return bool(is_name) and len(host.encode("idna").rstrip(b".")) <= HOST_MAX
        except UnicodeError:  # a part that is too long
            return False
    return True


def _refuse_unknown(raw: dict[str, Any], known: tuple[str, ...], where: str) -> None:
    for key in raw:
        if key in known:
            continue
        for other in networks().values():
            if key in other.node_file.__struct_fields__:
                raise LiveError(f"{where}: {key} is for nodes of a {other.name}; remove it")
        near = get_close_matches(key, known, 1)
        hint = f'; do you mean "{near[0]}"?' if near else f"; it knows {', '.join(known)}"
        raise LiveError(f'{where}: unknown key "{key}"{hint}')


def _readable(message: str, raw: dict[str, Any]) -> str:
    """A validator's message with the key first, also where it does not say which of a table's."""
    what, _, place = message.partition(" - at `$.")
    name, rest, _ = place.rstrip("`").partition("[...]")
    if rest:
        table: Any = raw
        for part in name.split("."):
            table = table[part]
        kind = str if "Expected `str`" in what else int
        name += f".{next(key for key, value in table.items() if type(value) is not kind)}"
    what = _plain(what, name.rpartition(".")[2])
    return f"{name}: {what}" if name else what


def _plain(what: str, key: str) -> str:
    """A validator's words as ours, where it says less than is known."""
    if found := UNKNOWN.fullmatch(what):
        return f'unknown key "{found[1]}"; see: innervate docs live'
    if found := MISSING.fullmatch(what):
        return f'"{found[1]}" is missing'
    if what.startswith("Invalid ") and key in CHOICES:
        return f"{what}; it can be {', '.join(CHOICES[key])}"
    return what
