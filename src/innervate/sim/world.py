"""Everything a running simulation holds, as tuples of tables.

Compiled, a table is an array of numbers or records; plain, it is a list of numbers or objects.
Records are declared like the protocols' (see `protocol/skin_fields.py`), with 64-bit fields where
the simulator keeps true time.
"""

from __future__ import annotations

from collections.abc import Collection
from typing import Any, NamedTuple

import numpy as np

from innervate.kernel import records
from innervate.protocol import plain

# All fields have 32 bits, those named in WIDE and all of RUN 64.
EVENT = ("time", "bucket", "kind", "target", "epoch")
END = ("busy", "peer", "latency", "impaired", "waiting")
BUFFER = ("loss", "lose", "queued", "first")
CLOCK = ("offset", "rate")
START = ("inverse", "source", "phase")
RUN = (
    "cells", "nodes", "tx_slots", "pool_slots", "rule",
    "wire_us", "latency_low", "latency_high", "latency_per_frame", "queue_frames", "source_us",
    "checks", "observe", "watchful", "status", "fingerprint", "handled", "rng",
    "commands", "next_command", "rows", "row_limit", "deliveries", "delivery_limit",
    "trail", "trail_limit", "taps", "tap_limit",
    "unrouted", "noted", "apart", "joined", "loops", "loops_open",
    "broken", "broken_at", "broken_node", "broken_other",
)  # fmt: skip
COMMAND = ("at", "action", "end", "node", "value", "index")
ROW = ("time", "node", "code", "a", "b")
DELIVERY = (
    "time", "port", "cell", "seq", "hops", "latency",
    "proximity", "force", "temperature", "accel",
)  # fmt: skip
DELAY = ("count", "sum", "high")
TRAIL = ("time", "node", "handler", "port", "fingerprint")
# A frame for a capture: when; when its sender began; whose interface (a cable's end, a node, a
# station); who sent it (mesh, radio); 1 = it left, 0 = it came in; why it got no further.
TAP = ("time", "start", "at", "sender", "out", "why")
ACTION = ("kind", "a", "b", "c")
WIDE = {"time", "start", "busy", "offset", "rate", "inverse", "source", "at", "fingerprint"} | set(
    (*RUN, *DELAY)
)

# States of a node.
OFF = 0
ALIVE = 1
DEAD = 2

# Timers of a node: the protocol's own first, then the driver's source of samples.
SOURCE = 3
TIMER_SLOTS = 4


class Wheel(NamedTuple):
    """The event queue's tables (see wheel.py)."""

    clock: Any
    links: Any
    tails: Any
    words: Any
    events: Any
    pool: Any


class Sink(NamedTuple):
    """The PC's state: one record and a number per port."""

    own: Any
    size: Any


class Out(NamedTuple):
    """The outbox (see protocol/outbox.py)."""

    count: Any
    limit: Any
    overflow: Any
    action: Any
    frame: Any


class Watch(NamedTuple):
    """What the observer knows of every cell (see observer.py)."""

    port: Any  # parent port in force, -1 none
    routed: Any  # 1 = chain of parents reaches the PC over live cables
    had: Any  # 1 = it did so at some time
    joined: Any  # 1 = physically connected to the PC
    apart: Any  # since when it is on without being so, us; -1 = it is not
    ring: Any  # start of the forwarding loop the cell is in, -1 none
    before: Any  # `routed` as it was before the present command
    stack: Any
    low: Any  # range of every word of a cell's record
    high: Any
    words: Any  # the cells' records as rows of words


class World(NamedTuple):
    """All of it."""

    run: Any
    wheel: Wheel
    frames: Any
    queue: Any
    cells: Any
    pc: Sink
    params: Any
    clocks: Any
    starts: Any  # what else is fixed of every clock: its inverse rate, first sample, first tick
    alive: Any
    ends: Any  # what every frame needs of a cable's end
    buffers: Any  # what only waiting, loose or lost frames need
    epoch: Any
    out: Out
    sample: Any
    counters: Any
    watch: Watch
    commands: Any
    rows: Any
    deliveries: Any
    trail: Any
    taps: Any  # frames for a capture (see taps.py): what happened to them
    tapped: Any  # ... and they themselves
    delays: Any  # latencies of data by interface port, then of commands: count, sum, greatest
    due: Any  # per newest commands of the PC and cell: what is known (see orders.py)
    due_number: Any  # ... the commands' numbers, -1 none
    delay_counts: Any  # ... and how many in each class (see delays.py)
    touch_x: Any
    touch_y: Any
    touch_span: Any
    place: Any


class Tables:
    """Makes tables of one form: compiled (arrays) or plain (lists)."""

    def __init__(self, plain_form: bool, word: Any = np.int32) -> None:
        """`word` is what protocols' records consist of.

        32 bits save memory. 64 bits save compiling: functions that are not inlined are compiled
        for every mix of widths that they are called with.
        """
        self.plain = plain_form
        self.word = word

    def numbers(self, count: int, value: int = 0, kind: type = np.int32) -> Any:
        """`count` integers."""
        if self.plain:
            return [value] * count
        return np.full(count, value, kind) if value else np.zeros(count, kind)

    def records(
        self,
        names: tuple[str, ...],
        count: int,
        fresh: bool = False,
        wide: Collection[str] = frozenset(WIDE),
    ) -> Any:
        """`count` simulator records; with `fresh` their content is not initialised.

        Fields in `wide` have 64 bits, all others 32.
        """
        if self.plain:
            declaration = tuple((name, _length(name), 0, 0, "", "") for name in names)
            make = plain.make("Record", declaration)
            return [make() for _ in range(count)]
        dtype = row_dtype(names, wide)
        return np.empty(count, dtype) if fresh else np.zeros(count, dtype)

    def states(self, declaration: Any, count: int, itemsize: int = 0) -> Any:
        """`count` records of a protocol's declaration."""
        if self.plain:
            make = plain.make("State", declaration)
            return [make() for _ in range(count)]
        return records.zeros(declaration, count, itemsize, self.word)

    def words(self, states: Any, declaration: Any) -> Any:
        """The states as rows of words."""
        if self.plain:
            return [records.Words(state, declaration) for state in states]
        return states.view(self.word).reshape(len(states), -1)


def row_dtype(names: tuple[str, ...], wide: Collection[str] = frozenset(WIDE)) -> np.dtype[Any]:
    """The array form of simulator records with these fields."""
    return np.dtype([_column(name, wide) for name in names], align=True)


def _length(name: str) -> int:
    return 3 if name in ("force", "accel") else 0


def _column(name: str, wide: Collection[str]) -> tuple[Any, ...]:
    kind = np.int64 if name in wide else np.int32
    return (name, kind, (3,)) if _length(name) else (name, kind)
