"""Everything a running simulation holds, as tuples of tables.

Compiled, a table is an array of numbers or records; plain, it is a list of numbers or objects.
Records are declared like the protocols' (see `protocol/skin_fields.py`), with 64-bit fields where
the simulator keeps true time.
"""

from __future__ import annotations

from typing import Any, NamedTuple

from innervate.sim import tables
from innervate.sim.tables import Out

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
WIDE = frozenset({*tables.WIDE, *RUN, *DELAY})

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
