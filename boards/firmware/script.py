"""Calls written down: rows of numbers and records that Python (`play.py`) and C (`check.c`) read.

A row is what happens, a node, and numbers; then perhaps a record as it lies in C's memory. LIFE
stands for calls that are drawn as they are made, by the same small generator in both languages:
what a node is told then comes out of records that were KEPT before.
"""

from __future__ import annotations

import struct
from typing import Any, BinaryIO

WHAT = ("on_start", "on_frame", "on_timer", "on_input", "on_carrier")
END, STATE, PARAMS, GATE, SAY, BEGIN, LIFE = range(5, 12)
KEPT = {"state": 12, "params": 13, "gate": 14, "frame": 15, "item": 16}
ROW = struct.Struct("<BBxxiii")
SLOTS = 16  # nodes of a simulation at most
KEPT_MOST = {"state": 32, "params": 32, "gate": 1, "frame": 2000, "item": 500}


class Script:
    """Calls as they are written down.

    Args:
        file: to write to.
        every: calls from one SAY to the next; 0 = none but those asked for.
    """

    def __init__(self, file: BinaryIO, every: int = 0) -> None:
        self.file, self.every = file, every
        self.params = b""
        self.calls = 0

    def begin(self) -> None:
        """What comes has nothing to do with what was; nodes and parameters are told anew."""
        self.params, self.calls = b"", 0
        self.file.write(ROW.pack(BEGIN, 0, 0, 0, 0))

    def sync(self, slot: int, state: bytes, gate: bytes | None) -> None:
        """A node's records, as its driver has set them."""
        self.file.write(ROW.pack(STATE, slot, 0, 0, 0) + state)
        if gate is not None:
            self.file.write(ROW.pack(GATE, slot, 0, 0, 0) + gate)

    def call(self, slot: int, name: str, params: bytes, now: int, given: tuple[Any, ...]) -> None:
        """A call of a node."""
        if self.every and self.calls and self.calls % self.every == 0:
            self.say()
        if params != self.params:
            self.params = params
            self.file.write(ROW.pack(PARAMS, 0, 0, 0, 0) + params)
        a, b = given[0], given[1] if len(given) > 1 and isinstance(given[1], int) else 0
        record = given[1] if len(given) > 1 and isinstance(given[1], bytes) else b""
        self.file.write(ROW.pack(WHAT.index(name), slot, now, a, b) + record)
        self.calls += 1

    def keep(self, what: str, number: int, record: bytes) -> None:
        """A record to draw from, with its port or its kind."""
        self.file.write(ROW.pack(KEPT[what], 0, 0, number, 0) + record)

    def life(self, seed: int, calls: int) -> None:
        """A node of its own that is told so much."""
        self.file.write(ROW.pack(LIFE, 0, 0, seed, calls))

    def say(self) -> None:
        """Here the hash over all calls since `begin` is said."""
        self.file.write(ROW.pack(SAY, 0, 0, 0, 0))

    def end(self) -> None:
        """Nothing more comes."""
        self.file.write(ROW.pack(END, 0, 0, 0, 0))
