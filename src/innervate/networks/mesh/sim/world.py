"""Everything a running mesh simulation holds, as tuples of tables (see sim/tables.py)."""

from typing import Any, NamedTuple

from innervate.networks.mesh.protocol import constants as mesh_const
from innervate.networks.mesh.protocol import csma
from innervate.sim.channel.world import Heap
from innervate.sim.tables import Out

RUN = (
    "nodes", "timers", "own_timers",
    "mac", "collisions", "turnaround", "byte_ns", "phy_bytes", "sense", "capture",
    "rng", "sample", "origin_x", "origin_y", "unit", "moving", "rssi50", "told", "row", "good",
    "on_air", "free", "gate_words", "next_command", "commands", "next_offer", "offers",
    "duplicates", "duplicate_limit", "forget", "checks", "watchful", "status", "fingerprint", "now",
    "handled", "arrived", "transmissions", "received", "gave_up", "blocked", "unasked",
    "rows", "row_limit", "sent", "sent_limit", "delivered", "delivered_limit",
    "rounds", "round_limit", "trail", "trail_limit", "taps", "tap_limit",
    "broken", "broken_node",
)  # fmt: skip
# What the medium knows of a node.
RADIO = ("state", "deaf", "on_air", "held", "hot", "told", "tell_at", "boots", "gate", "offset",
         "noise", "x", "y")  # fmt: skip
OFFER = ("time", "node", "dest", "flags", "length")

SENT = ("time", "end", "node", "kind", "flags", "link_dst", "origin", "dest", "seq", "path_len",
        "bytes", "receivers")  # fmt: skip
DELIVERED = ("time", "node", "kind", "flags", "origin", "dest", "seq", "path_len", "looped",
             "body0", "body1", "body2", "body3")  # fmt: skip
ROUND = ("time", "node", "round", "links", "good", "both")

# All fields have 32 bits, these and all of RUN 64.
WIDE = frozenset({"time", "start", "end", "phase", "offset", "noise", "x", "y", "value", "digest",
                  "fingerprint", "tell_at", *RUN})  # fmt: skip

# Timers of a node: the router's, then those of the medium access below it.
TIMERS = mesh_const.TIMERS + csma.TIMERS


class World(NamedTuple):
    """All tables of a simulated mesh, as the loop takes them."""

    run: Any
    heap: Heap
    nodes: Any  # the routers' records; one more, as one is before its start
    words: Any  # these as rows of words
    low: Any
    high: Any
    spans: Any  # words that are checked in one go
    gates: Any  # what gateways and standbys have besides; one more, untouched
    gate_words: Any
    params: Any
    macs: Any  # medium access: a record a node
    mac_params: Any
    mac_item: Any
    radios: Any
    below: Any  # a channel that all share: a radio.world.World; () where there is none
    due: Any  # per node and timer: when it fires, -1 never
    rssi: Any  # per sender and receiver: 0.01 dBm
    base: Any  # ... at 1 m, where somebody moves
    prob: Any  # ... chance of reception in 1/32768
    cut: Any  # ... 1 = no signal for now
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
    good: Any  # per pair: 1 = a good link at the start
    walks: Any
    points: Any
    commands: Any
    offers: Any
    item: Any
    out: Out
    mac_out: Out
    duplicate_key: Any  # what was delivered lately: a hash table
    duplicate_at: Any
    rows: Any
    sent: Any
    delivered: Any
    rounds: Any
    trail: Any
    taps: Any  # frames for a capture (see sim/taps.py): what happened to them
    tapped: Any  # ... and they themselves
