"""Everything a running simulation holds, as tuples of tables.

Compiled, a table is an array of numbers or records; plain, it is a list of numbers or objects.
Records are declared like the protocols' (see the `fields.py` of a network's protocol), with 64-bit
fields where the simulator keeps true time.
"""

from typing import Any, NamedTuple

from innervate.sim import tables
from innervate.sim.tables import Out

# All fields have 32 bits, those named in WIDE and all of RUN 64.
EVENT = ("time", "bucket", "kind", "target", "epoch")
END = ("busy", "peer", "latency", "impaired", "waiting")
BUFFER = ("loss", "lose", "queued", "first", "life")
CLOCK = ("offset", "rate")
START = ("inverse", "source", "phase")
RUN = (
    "cells", "nodes", "tx_slots", "pool_slots",
    "wire_us", "latency_low", "latency_high", "latency_per_frame", "queue_frames", "source_us",
    "checks", "observe", "watchful", "status", "fingerprint", "handled", "rng",
    "commands", "next_command", "rows", "row_limit", "deliveries", "delivery_limit",
    "trail", "trail_limit", "taps", "tap_limit",
    "broken", "broken_at", "broken_node", "broken_other",
)  # fmt: skip
COMMAND = ("at", "action", "end", "node", "value", "index")
DELAY = ("count", "sum", "high")
WIDE = frozenset({*tables.WIDE, *RUN, *DELAY})

# States of a node.
OFF = 0
ALIVE = 1
DEAD = 2

# What is broken; a network's recorder may have more, below these.
BROKEN_RANGE = 3
BROKEN_OUTBOX = 4
BROKEN_PORT = 5

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
    """State of the node that has a port per interface: one record and a number per port."""

    own: Any
    size: Any


class World(NamedTuple):
    """All tables of a network over cables, as the loop takes them."""

    run: Any
    wheel: Wheel
    frames: Any
    queue: Any
    cells: Any
    words: Any  # their records as rows of words
    low: Any  # range of every such word
    high: Any
    pc: Any  # a Sink; () where all nodes are equal
    params: Any
    clocks: Any
    starts: Any  # what else is fixed of every clock: its inverse rate, first sample, first tick
    alive: Any
    ends: Any  # what every frame needs of a cable's end
    buffers: Any  # what only waiting, loose or lost frames need
    epoch: Any
    out: Out
    sample: Any  # what is handed to a node as input
    counters: Any
    watch: Any  # the network's recorder's own tables; () = none
    carrier: Any  # what its nodes sense, as tables; () = nothing
    commands: Any
    rows: Any
    deliveries: Any
    trail: Any
    taps: Any  # frames for a capture (see taps.py): what happened to them
    tapped: Any  # ... and they themselves
    delays: Any  # latencies by way, as the network numbers them: count, sum, greatest
    delay_counts: Any  # ... and how many in each class (see sim/delays.py)
