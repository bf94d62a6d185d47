"""Reading captures in pcapng, anybody's: any bytes at all give frames, or one clear line."""

import struct
from collections.abc import Iterator
from pathlib import Path
from typing import Any, BinaryIO, NamedTuple

from innervate.export import pcapng
from innervate.export.errors import ExportError
from innervate.export.links import Interface

BLOCK_MAX = 1 << 24
INTERFACES_MAX = 1 << 20


class Packet(NamedTuple):
    """A frame of a capture."""

    interface: int  # number of its interface
    time_ns: int  # when
    data: bytes  # its bytes
    flags: int  # pcapng.INBOUND, OUTBOUND, CRC_ERROR; 0 not said
    comment: str  # what is said of it


class Capture:
    """A capture that is read packet by packet.

    Attributes:
        interfaces: those that were told of so far.
        comment: what the capture says of itself.
        cut_short: the file ends in the middle of a block, as that of a running capture may.
    """

    def __init__(self, path: Path) -> None:
        self.path = path
        self.interfaces: list[Interface] = []
        self.comment = ""
        self.cut_short = False
        self._order = "<"
        self._ticks: list[tuple[int, int]] = []
        self._first = 0  # of this section's interfaces

    def packets(self) -> Iterator[Packet]:
        """All packets, in the order of the file.

        Raises:
            ExportError: the file cannot be read, or is no pcapng.
        """
        try:
            with self.path.open("rb") as file:
                yield from self._read(file)
        except OSError as error:
            raise ExportError(f"{self.path}: {error.strerror}") from None

    def _read(self, file: BinaryIO) -> Iterator[Packet]:
        begun = False
        while head := file.read(8):
            if len(head) < 8 or (not begun and head[:4] != b"\n\r\r\n"):
                if begun:
                    self.cut_short = True
                    return
                raise self._wrong("is no pcapng capture")
            if head[:4] == b"\n\r\r\n":
                begun = True
                head += file.read(4)
                self._begin_section(head)
            kind, total = struct.unpack(f"{self._order}II", head[:8])
            if not 12 <= total <= BLOCK_MAX or total % 4:
                raise self._wrong(f"is damaged: a block of {total} bytes")
            rest = file.read(total - len(head))
            if len(rest) < total - len(head):
                self.cut_short = True
                return
            if rest[-4:] != struct.pack(f"{self._order}I", total):
                raise self._wrong("is damaged: a block does not end as it begins")
            try:
                packet = self._block(kind, head[8:] + rest[:-4])
            except (struct.error, IndexError, ValueError):
                raise self._wrong("is damaged: a block is too short for its kind") from None
            if packet is not None:
                yield packet
        if not begun:
            raise self._wrong("is no pcapng capture")

    def _begin_section(self, head: bytes) -> None:
        magic = head[8:12]
        for order in "<>":
            if magic == struct.pack(f"{order}I", pcapng.MAGIC):
                self._order = order
                self._first = len(self.interfaces)
                return
        raise self._wrong("is no pcapng capture")

    def _block(self, kind: int, body: bytes) -> Packet | None:
        if kind == pcapng.SECTION:
            (version,) = struct.unpack_from(f"{self._order}H", body, 4)
            if version != 1:
                raise self._wrong(f"is pcapng of version {version}; only version 1 is known")
            self.comment = (
                self._options(body[16:]).get(pcapng.COMMENT, b"").decode(errors="replace")
            )
        elif kind == pcapng.INTERFACE:
            self._interface(body)
        elif kind == pcapng.PACKET:
            return self._packet(body)
        return None

    def _interface(self, body: bytes) -> None:
        if len(self.interfaces) >= INTERFACES_MAX:
            raise self._wrong("is damaged: too many interfaces")
        (link_type,) = struct.unpack_from(f"{self._order}H", body)
        options = self._options(body[8:])
        name = options.get(pcapng.NAME, b"").decode("utf-8", "replace")
        text = options.get(pcapng.DESCRIPTION, b"").decode("utf-8", "replace")
        self.interfaces.append(Interface(link_type, name, text))
        code = options.get(pcapng.RESOLUTION, b"\x06")[0]
        per_second = 1 << (code & 127) if code & 128 else 10 ** min(code, 18)
        self._ticks.append((1_000_000_000, per_second))

    def _packet(self, body: bytes) -> Packet:
        head = struct.unpack_from(f"{self._order}IIIII", body)
        number, high, low, size, _original = head
        number += self._first
        if number >= len(self.interfaces):
            raise self._wrong("is damaged: a packet of an interface that is not there")
        if 20 + size > len(body):
            raise ValueError("a packet is longer than its block")
        times, over = self._ticks[number]
        options = self._options(body[20 + (size + 3) // 4 * 4 :])
        flags = options.get(pcapng.FLAGS, b"")
        return Packet(
            number,
            (high << 32 | low) * times // over,
            body[20 : 20 + size],
            struct.unpack(f"{self._order}I", flags)[0] if len(flags) == 4 else 0,
            options.get(pcapng.COMMENT, b"").decode("utf-8", "replace"),
        )

    def _options(self, data: bytes) -> dict[int, bytes]:
        found: dict[int, bytes] = {}
        at = 0
        while at + 4 <= len(data):
            code, size = struct.unpack_from(f"{self._order}HH", data, at)
            if code == pcapng.END:
                break
            found.setdefault(code, data[at + 4 : at + 4 + size])
            at += 4 + (size + 3) // 4 * 4
        return found

    def _wrong(self, what: str) -> Any:
        return ExportError(
            f"{self.path} {what}; give a capture as innervate or Wireshark writes it"
        )
