"""The plan of a mesh run: whole numbers only. Floats end here."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

CLASSES = (32, 64, 254)  # capacity classes: nodes that a record has room for
ONE = 32_768
HEADER_SLOTS = 2  # what medium access protocols of radio teams put in front of a frame, bytes


@dataclass(frozen=True, slots=True)
class MeshFault:
    """One event of a mesh run.

    Attributes:
        at_us: when, true time, us.
        action: KILL, REVIVE (with its memory lost), CUT or RESTORE a pair (both ways), JAM or
            QUIET: a noise at a node, RESTART.
        node: the node it happens to.
        other: CUT and RESTORE: the other node.
        value: JAM: the noise there, 0.01 dBm.
        index: the event's place in the scenario file.
    """

    at_us: int
    action: int
    node: int
    other: int = 0
    value: int = 0
    index: int = 0


@dataclass(frozen=True, slots=True)
class Offer:
    """A message handed to a node.

    Attributes:
        at_us: when, us.
        node: who sends.
        dest: recipient; 255 all, 254 the monitor.
        flags: END_TO_END (2), PRIORITY (32).
        length: bytes of payload, 0 .. 90.
        flow: which [[flow]] it belongs to.
    """

    at_us: int
    node: int
    dest: int
    flags: int
    length: int
    flow: int


@dataclass(frozen=True, slots=True)
class Walk:
    """How a robot moves: straight between points, then it stays.

    Attributes:
        node: the robot.
        points: (time us, x cm, y cm), ascending in time; before the first it stands there.
    """

    node: int
    points: tuple[tuple[int, int, int], ...]


@dataclass(slots=True)
class MeshRadio:
    """The medium [mesh 6].

    Attributes:
        byte_ns: airtime of a byte, ns; airtime_us = (phy_bytes + frame bytes) * byte_ns // 1000.
        phy_bytes: preamble and the like, in front of every frame.
        turnaround_us: from deciding to send to being on the air.
        collisions: False = ideal: frames never disturb each other and nobody is deaf.
        sense_cdb: carrier sense threshold, 0.01 dBm; carriers weaker than that are not noticed.
        capture_cdb: a frame survives interference weaker by so much, 0.01 dB.
        rssi50_cdb: 0.01 dBm at which half the frames are received.
        rssi_cdb: per sender and receiver (row-major), 0.01 dBm, UNHEARD = not at all.
        prob_q15: per sender and receiver: chance of reception in 1/32768, if undisturbed.
        base_cdb: per sender and receiver: rssi at 1 m, shadowing and direction included, 0.01 dBm;
            robots' rssi is base - loss of the distance; empty where nobody moves.
        exponent_c: path loss exponent x 100.
    """

    byte_ns: int
    phy_bytes: int
    turnaround_us: int
    collisions: bool
    sense_cdb: int
    capture_cdb: int
    rssi50_cdb: int
    rssi_cdb: list[int]
    prob_q15: list[int]
    base_cdb: list[int] = field(default_factory=list)
    exponent_c: int = 300


@dataclass(slots=True)
class MeshPlan:
    """Everything a mesh run needs, as whole numbers.

    Attributes:
        nodes: how many, 1 .. 254.
        capacity: their class, 32, 64 or 254 (see `protocol/fields.py`).
        names: what each is called, as in the file.
        params: the protocol's parameters (`mesh_fields.PARAMS`); arrays as lists.
        ranks: per node 0 gateway, 1.. standby, -1 neither.
        robots: per node 1 = it is a robot.
        absent: per node 1 = switched off until it is revived.
        starts_us: per node, when it is switched on, us (the gateway last).
        mac: "csma", "none" (ideal, and drivers that need none) or one of the radio's.
        mac_params: parameters of the medium access protocol.
        positions_cm: per node (x, y) at the start; empty where none are given.
        good: links (a < b) that are good both ways at the start.
        walks: how robots move.
        sample_us: robots learn their position so often.
        origin_cm: the fence's corner: x and y in the protocol are (position - origin) / unit_cm.
        offers: messages in order of time.
        faults: events in order of time.
        cluster: which part of a larger network this is (`clusters.Cluster`), None if it is whole.
    """

    scenario: Any
    kind: str
    seed: int
    duration_us: int
    nodes: int
    capacity: int
    names: list[str]
    params: dict[str, Any]
    ranks: list[int]
    robots: list[int]
    absent: list[int]
    starts_us: list[int]
    mac: str
    mac_params: dict[str, int]
    radio: MeshRadio
    positions_cm: list[tuple[int, int]]
    good: list[tuple[int, int]]
    walks: list[Walk] = field(default_factory=list)
    sample_us: int = 20_000
    origin_cm: tuple[int, int] = (0, 0)
    offers: list[Offer] = field(default_factory=list)
    faults: list[MeshFault] = field(default_factory=list)
    cluster: Any = None
