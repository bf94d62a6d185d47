"""Everything a running radio simulation holds, as tuples of tables (see sim/tables.py)."""

from typing import Any, NamedTuple

from innervate.sim.tables import Out

RUN = (
    "stations", "slot_us", "ta_us", "loss", "rng", "saturated", "forced", "per_turn", "wanted",
    "completed", "checks", "watchful", "status", "fingerprint", "handled", "decoded",
    "garbled", "now", "rows", "row_limit", "sent", "sent_limit", "packets", "packet_limit", "trail",
    "trail_limit", "taps", "tap_limit",
    "offers", "dropped", "silent", "partial", "again",
    "exclusive", "data_until", "oracle", "full_duplex", "period",
    "broken", "broken_at", "broken_node",
)  # fmt: skip
# What the medium knows of a station.
RADIO = (
    "alive", "deaf", "present", "candidate", "noted", "cd", "voc", "air", "offset",
    "first_offer", "next_offer", "backlog", "fresh", "data_end", "garble", "fade", "leaving",
    "ready_at", "told_at", "told",
)  # fmt: skip
AIR = ("start", "end", "spoilt", "at_start", "at_end")
COMMAND = ("action", "node", "value", "index")
SENT = ("time", "end", "node", "kind", "slots", "pos", "next", "handle", "count", "more")
PACKET = ("offered", "end", "time", "node", "handle", "slots", "receivers", "listeners", "tries")

# All fields have 32 bits, these and all of RUN 64.
WIDE = frozenset({"time", "start", "end", "offered", "data_end", "offset", "fingerprint",
                  "ready_at", "told_at", *RUN})  # fmt: skip

TIMERS = 2
RING = 1024  # packets of a station whose fate is remembered


class Heap(NamedTuple):
    """The event queue's tables (see heap.py)."""

    keys: Any
    size: Any


class World(NamedTuple):
    """All tables of a radio channel, as the loop takes them."""

    run: Any
    heap: Heap
    above: Any  # event queue of the protocol whose frames the packets are; () = none
    stations: Any
    words: Any  # their records as rows of words
    low: Any
    high: Any
    params: Any
    radios: Any
    due: Any  # per station and timer: when it fires, -1 never
    told: Any  # how many stations to tell of their carrier at this moment, and which
    air: Any  # per station and place: a transmission under way
    frames: Any  # its frame
    degree: Any  # per station: how many hear it
    order: Any  # per station: who, the nearest first
    delay: Any  # ... and after how many us
    arrivals: Any  # moments at which packets are offered, station by station
    sizes: Any  # per station: length of the packets to come, a ring
    offered: Any  # per station and packet: when it was offered
    got: Any  # ... how many received it
    tries: Any  # ... how often it was sent
    last: Any  # per receiver and sender: the newest packet received, -1 none
    item: Any  # the packet that is being handed down
    out: Out
    commands: Any
    rows: Any
    sent: Any
    packets: Any
    trail: Any
    taps: Any  # frames for a capture (see sim/taps.py): what happened to them
    tapped: Any  # ... and they themselves
