"""Frames to bytes by the thousand: what `wire` does for one record, for whole arrays of them.

It reads the same layouts; a test holds every byte against `wire`'s.
"""

from typing import Any

import numpy as np

from innervate.wire import crc
from innervate.wire.layout import SPARE

CRC_BYTES = 2


def _crc_table() -> Any:
    table = np.arange(256, dtype=np.uint32) << 8
    for _ in range(8):
        table = np.where(table & 0x8000, (table << 1) ^ 0x1021, table << 1) & 0xFFFF
    return table.astype(np.uint16)


CRC_TABLE = _crc_table()


def pack(fields: Any, head: int, head_bits: int, size: int, records: Any) -> Any:
    """Whole frames of one kind, a row of `size` bytes each: head, fields, CRC."""
    rows = np.zeros((len(records), size), np.uint8)
    _put(rows, 0, head_bits, np.full(len(records), head, np.int64))
    at = head_bits
    for name, many, bits, _signed in fields:
        if name == SPARE:
            at += bits
            continue
        values = records[name].astype(np.int64)
        for column in values.T if many else (values,):
            _put(rows, at, bits, column)
            at += bits
    _seal(rows)
    return rows


def _put(rows: Any, at: int, bits: int, values: Any) -> None:
    """As wire.bits.put, for a column of values."""
    values = values & ((1 << bits) - 1)
    while bits > 0:
        room = 8 - (at & 7)
        taken = min(room, bits)
        bits -= taken
        part = (values >> bits) & ((1 << taken) - 1)
        rows[:, at >> 3] |= (part << (room - taken)).astype(np.uint8)
        at += taken


def _seal(rows: Any) -> None:
    """The last two bytes of every row become the CRC of those in front."""
    end = rows.shape[1] - CRC_BYTES
    found = np.full(len(rows), crc.START, np.uint16)
    for i in range(end):
        found = (found << np.uint16(8)) ^ CRC_TABLE[(found >> np.uint16(8)) ^ rows[:, i]]
    rows[:, end] = found >> np.uint16(8)
    rows[:, end + 1] = found & np.uint16(255)


def by_kind(frames: Any, forms: dict[int, tuple[Any, int, int, int]]) -> list[bytes]:
    """The bytes of frames, given as an array of records with a column `kind`.

    `forms`: per kind its fields, head, bits of the head, and bytes in all; other kinds stay empty.
    """
    made = [b""] * len(frames)
    for kind, (fields, head, head_bits, size) in forms.items():
        where = np.flatnonzero(frames["kind"] == kind)
        if len(where):
            packed = pack(fields, head, head_bits, size, frames[where]).tobytes()
            for i, place in enumerate(where.tolist()):
                made[place] = packed[i * size : (i + 1) * size]
    return made
