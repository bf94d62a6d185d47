"""Frames of every kind with values at the ends of their ranges, as bytes; what is refused."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import partial
from itertools import cycle, islice
from typing import Any

from innervate.dialect import plain as records
from innervate.live.keyring import Proven
from innervate.live.session import Session
from innervate.networks.mesh import frames as mesh
from innervate.networks.mesh import payloads
from innervate.networks.mesh.protocol import constants as mesh_const
from innervate.networks.mesh.protocol import fields as mesh_fields
from innervate.networks.radio import frames as radio
from innervate.networks.radio.protocol import fields as radio_fields
from innervate.networks.skin import frames as skin
from innervate.networks.skin.protocol import fields as skin_fields
from innervate.wire import cobs, crc, seal
from innervate.wire.layout import SPARE
from tests.networks.mesh import shown

PATTERNS = ("zeros", "least", "most", "turns", "counting")
BYTES = {"zeros": (0,), "ones": (255,), "turns": (0x55, 0xAA), "counting": range(1, 120)}
KEY = bytes(range(32))
COUNTERS = (0, 1, 1023, 1024, seal.COUNTER_MAX)
FLAGS = (0, mesh_const.SOURCE_ROUTE, mesh_const.DETOURED, 255)


def found() -> Iterator[tuple[str, Callable[[], Any]]]:
    """Name and bytes of everything."""
    for kind, name, layout in skin.LAYOUTS:
        make = partial(_record, skin_fields.FRAME, kind, layout)
        yield f"skin {name}", partial(_packed, make, skin.encode, _read(skin, skin_fields))
    for kind, name, layout in radio.LAYOUTS:
        make = partial(_record, radio_fields.FRAME, kind, layout)
        yield f"radio {name}", partial(_packed, make, radio.encode, _read(radio, radio_fields))
    make = partial(_record, mesh_fields.FRAME, mesh_const.ACK, mesh.HOP_ACK)
    yield "mesh ack", partial(_packed, make, mesh.encode, _read(mesh, mesh_fields))
    for kind, name, _fields in payloads.LAYOUTS:
        yield f"mesh {name}", partial(_mesh, kind)
    yield "sizes", _sizes
    for name, module in (("skin", skin), ("radio", radio), ("mesh", mesh)):
        yield f"{name} refused", partial(_refused, module)
    yield "sealed", _sealed
    yield "seals read", _seals
    yield "replays", _replays
    yield "stuffed", _stuffed


def _values(pattern: str, bits: int, signed: int, count: int) -> list[int]:
    """Numbers of a field: all zero, all least, all greatest, bits that take turns, 1, 2, 3 .."""
    low = -(1 << (bits - 1)) if signed else 0
    most = low + (1 << bits) - 1
    turns = int("10" * 20, 2) & ((1 << bits) - 1)
    one = {"zeros": 0, "least": low, "most": most, "turns": turns + low if signed else turns}
    if pattern == "counting":
        return [min(i + 1, most) for i in range(count)]
    return [one[pattern]] * count


def _record(declared: Any, kind: int, layout: Any, pattern: str) -> Any:
    """A frame whose fields are filled by a pattern."""
    frame = records.make("Frame", declared)()
    frame.kind = kind
    for name, many, bits, signed in layout:
        if name != SPARE:
            values = _values(pattern, bits, signed, max(1, many))
            setattr(frame, name, values if many else values[0])
    return frame


def _packed(make: Any, encode: Any, read: Any) -> Any:
    """Bytes by pattern, and what is read of some."""
    packed = {pattern: encode(make(pattern)) for pattern in PATTERNS}
    told = {f"{name}, read": read(packed[name]) for name in ("turns", "most")}
    return {name: data.hex() for name, data in packed.items()} | told


def _read(module: Any, declared: Any) -> Callable[[bytes], Any]:
    """What a module's decode makes of bytes: every field of the record."""

    def read(data: bytes) -> Any:
        frame = records.make("Frame", declared.FRAME)()
        reason = module.decode(data, frame)
        values = {one[0]: getattr(frame, one[0]) for one in declared.FRAME}
        short = {name: list(value[:12]) if hasattr(value, "__len__") else value
                 for name, value in values.items()}  # fmt: skip
        return {"reason": module.REASONS[reason], **short}

    return read


def _mesh(kind: int) -> Any:
    """A packet of the mesh with payloads of each length: which fit, and what is read of some."""
    found: dict[str, Any] = {}
    for name, pattern in BYTES.items():
        for flags in FLAGS:
            fit = []
            for size in range(40):
                body = bytes(islice(cycle(pattern), size))
                if payloads.fits(kind, flags, body, 0, size):
                    fit.append(size)
            found[f"{name}, flags {flags}, lengths"] = fit
            size = fit[len(fit) // 2] if fit else 0
            frame = records.make("Frame", mesh_fields.FRAME)()
            frame.kind, frame.flags, frame.path_len, frame.length = kind, flags, 2, size
            frame.link_src, frame.link_dst, frame.origin, frame.dest = 1, 254, 128, 255
            frame.seq, frame.table_ver, frame.ttl = 0x8001, 200, 64
            frame.path[:2] = [7, 253]
            frame.body[:size] = list(islice(cycle(pattern), size))
            data = mesh.encode(frame)
            found[f"{name}, flags {flags}"] = [data.hex(), mesh.REASONS[mesh.reason_of(data)]]
            told = shown.describe(kind, flags, bytes(frame.body[:size]))
            found[f"{name}, flags {flags}, read"] = [list(pair) for pair in told]
    return found


def _sizes() -> Any:
    """Lengths of frames, by network and kind."""
    return {
        "skin": [list(skin.SIZES.items()), skin.SIZE_MIN, skin.SIZE_MAX],
        "radio": [list(radio.SIZES.items()), radio.SIZE_MIN, radio.PAYLOAD_MAX],
        "mesh": [list(payloads.SIZES.items()), mesh.MTU, mesh.PATH_LEN_AT],
        "seal": [seal.OVERHEAD_BYTES, seal.HEADER_BYTES, seal.TAG_BYTES, seal.KEYS, seal.WINDOW],
        "cobs": cobs.BLOCK,
    }


def _refused(module: Any) -> Any:
    """What is said of bytes of some lengths, by their first byte; of paths, of bytes not sealed."""

    def reason(data: bytes) -> str:
        if hasattr(module, "reason_of"):
            return str(module.REASONS[module.reason_of(data)])
        frame = records.make("Frame", skin_fields.FRAME)()
        return str(module.REASONS[module.decode(data, frame)])

    def whole(first: int, size: int, path: int = 0) -> bytes:
        data = bytearray(size)
        data[0] = first
        if size > mesh.PATH_LEN_AT + 2:
            data[mesh.PATH_LEN_AT] = path
        return crc.seal(data)

    firsts = (0x10, 0x20, 0x30, 0x11, 0x12, 0x13, 0x40, 0x41, 0x42, 0x43, 0x46, 0x7F, 0x80, 0xC1)
    sizes = (2, 3, 4, 7, 8, 9, 11, 12, 13, 14, 15, 16, 17, 20, 22, 24, 60, 127, 128, 200, 1040)
    said = {f"{first:02x}": [f"{size}: {reason(whole(first, size))}" for size in sizes]
            for first in firsts}  # fmt: skip
    paths = [f"{path}: {reason(whole(0x46, 50, path))}" for path in (0, 1, 23, 24, 25, 36, 37, 255)]
    bare = [f"{size}: {reason(bytes(size))}" for size in (0, 1, 2, 9, 30)]
    return said | {"paths": paths, "not sealed": bare}


def _stuffed() -> Any:
    """Bytes on a serial line, around the length of a block."""
    return [
        cobs.encode(bytes(islice(cycle(of), count))).hex()
        for of in BYTES.values()
        for count in (1, 5, 253, 254, 255)
    ]


def _sealed() -> Any:
    """A frame as it is sealed in a session, of each kind."""
    made, who = {}, Proven(0x1234, bytes(8), 5)
    for kind in (seal.FRAME, seal.CONTROL):
        one = Session(1, 0x01020304, (KEY, KEY), who, True)
        for counter in COUNTERS[:-1]:
            one.counter = counter
            made[f"kind {kind:x}, counter {counter}"] = one.close(b"a frame", kind).hex()
    return made


def _seals() -> Any:
    """What is read in front of sealed frames; of which bytes nothing is."""
    long = bytes(range(30))
    marks = (0xBF, 0xC0, 0xC3, 0xC4, 0xC5, 0xC6, 0xD0, 0xFF)
    some = [bytes((first,)) + long[1:size] for first in marks for size in (24, 25, 30)]
    return [[data[:1].hex(), len(data), seal.is_sealed(data), seal.fields(data)] for data in some]


def _replays() -> Any:
    """What a window takes for new: at its edges, after a leap, after a restart."""
    told = {}
    for name, highest, taken in (
        ("fresh", -1, ()),
        ("restarted at 50", 50, ()),
        ("some", -1, (0, 3, 2, 1025, 1030)),
        ("a leap", -1, (5, 5 + seal.WINDOW)),
        ("a leap of one less", -1, (5, 5 + seal.WINDOW - 1)),
        ("far", -1, (9, 9000)),
    ):
        window = seal.Window(highest)
        for counter in taken:
            window.take(counter)
        near = {0, 1, 2, 3, 4, 5, 6, 7, 9, 49, 50, 51, *(window.highest + i for i in (-1, 0, 1))}
        near |= {window.highest - seal.WINDOW + i for i in (-1, 0, 1, 2, 3, 4)}
        told[name] = [[counter, window.is_new(counter)] for counter in sorted(near) if counter >= 0]
    return told
