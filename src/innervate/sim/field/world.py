"""Everything a simulated field of declared protocols holds (see sim/tables.py)."""

from typing import Any, NamedTuple

from innervate.sim.came import Came
from innervate.sim.channel.world import Heap
from innervate.sim.tables import Out

RUN = (
    "nodes", "timers", "own_timers",
    "mac", "collisions", "turnaround", "byte_ns", "phy_bytes", "sense", "capture",
    "rng", "sample", "origin_x", "origin_y", "unit", "moving", "rssi50", "told",
    "on_air", "free", "next_command", "commands", "next_offer", "offers", "room",
    "checks", "watchful", "status", "fingerprint", "now", "handled", "arrived", "transmissions",
    "received", "gave_up", "blocked", "rows", "row_limit", "deliveries", "delivery_limit",
    "trail", "trail_limit", "taps", "tap_limit", "broken", "broken_node",
)  # fmt: skip
# What the medium knows of a node; `first`, `waiting`: of its ring of frames to be sent.
RADIO = ("state", "deaf", "on_air", "held", "hot", "told", "tell_at", "boots", "offset", "noise",
         "first", "waiting", "x", "y")  # fmt: skip
AIR = ("node", "state", "start", "end", "digest", "receivers")
COMMAND = ("time", "action", "node", "other", "value")
OFFER = ("time", "node", "kind")
# A robot on its way, and how it errs about its place (see topology/astray.py): `noise` in um,
# errors in SIGMA; where it believes to be and how fast it is, as it is told.
WALK = ("node", "point", "last", "phase", "placed", "noise", "keep", "fresh", "rng", "off_x",
        "off_y", "told_x", "told_y", "vx", "vy")  # fmt: skip
POINT = ("time", "x", "y")

# All fields have 32 bits, these and all of RUN 64.
WIDE = frozenset({"time", "start", "end", "phase", "offset", "noise", "x", "y", "value", "digest",
                  "fingerprint", "tell_at", *RUN})  # fmt: skip


class World(NamedTuple):
    """All tables of a field, as the loop takes them."""

    run: Any
    heap: Heap
    stations: Any  # the nodes' records; one more, as one is before its start
    words: Any  # these as rows of words
    low: Any
    high: Any
    spans: Any  # words that are checked in one go
    params: Any
    macs: Any  # medium access: a record a node
    mac_params: Any
    mac_item: Any
    radios: Any
    below: Any  # () : no channel with events of its own
    due: Any  # per node and timer: when it fires, -1 never
    rssi: Any  # per sender and receiver: 0.01 dBm
    prob: Any  # ... chance of reception in 1/32768
    cut: Any  # ... 1 = no signal for now
    base: Any  # ... 0.01 dBm at 1 m, where somebody moves
    power: Any  # ... linear, see powers.py
    sums: Any  # per node: power of all signals and of the noise there
    strengths: Any  # power per 0.1 dBm
    losses: Any  # path loss by squared distance
    chances: Any  # chance of reception per 0.1 dB
    normals: Any  # normal numbers by how rare they are
    air: Any  # per place: a transmission
    frames: Any  # its frame
    worst: Any  # per place and receiver: the strongest interference it met
    on_air: Any  # places that are on the air
    free: Any  # places that are free
    got: Any  # who receives the frame that ends
    ring: Any  # per node: frames that wait for those before them
    acts: Any  # ... with what each was sent
    walks: Any  # robots on their ways
    points: Any  # ... between which they go
    commands: Any
    offers: Any  # what nodes are handed, in order of time
    items: Any  # ... the items
    item: Any
    came: Came  # what of that was delivered
    out: Out
    mac_out: Out
    counters: Any  # frames by what became of them (see sim/heard.py)
    rows: Any
    deliveries: Any
    trail: Any
    taps: Any  # frames for a capture (see sim/taps.py): what happened to them
    tapped: Any  # ... and they themselves
