"""The plan of a mesh run: whole numbers only. Floats end here."""

from dataclasses import dataclass, field
from typing import Any

from innervate.scenario.declared.field import Fault
from innervate.scenario.robots import Walk
from innervate.topology.placement import ONE_Q15

ONE: int = ONE_Q15
CLASSES = (32, 64, 254)  # capacity classes: nodes that a record has room for
MeshFault = Fault  # one event of a run: what happens in any field
HEADER_SLOTS = 2  # what medium access protocols of radio teams put in front of a frame, bytes


Point = tuple[float, float]


@dataclass(frozen=True, slots=True)
class Offer:
    """A message handed to a node."""

    at_us: int  # when, us
    node: int  # who sends
    dest: int  # recipient; 255 all, 254 the monitor
    flags: int  # END_TO_END (2), PRIORITY (32)
    length: int  # bytes of payload, 0 .. 90
    flow: int  # which [[flow]] it belongs to


@dataclass(slots=True)
class MeshRadio:
    """The medium: who hears whom [mesh 6]."""

    byte_ns: int  # airtime of a byte, ns; airtime_us = (phy_bytes + frame bytes) * byte_ns // 1000
    phy_bytes: int  # preamble and the like, in front of every frame
    turnaround_us: int  # from deciding to send to being on the air
    collisions: bool  # False = ideal: frames never disturb each other and nobody is deaf
    sense_cdb: int  # carrier sense threshold, 0.01 dBm; carriers weaker than that are not noticed
    capture_cdb: int  # a frame survives interference weaker by so much, 0.01 dB
    rssi50_cdb: int  # 0.01 dBm at which half the frames are received
    rssi_cdb: list[int]  # per sender and receiver (row-major), 0.01 dBm, UNHEARD = not at all
    prob_q15: list[int]  # per sender and receiver: chance of reception in 1/32768, if undisturbed
    # Per sender and receiver: rssi at 1 m, shadowing and direction included, 0.01 dBm; robots' rssi
    # is base - loss of the distance; empty where nobody moves.
    base_cdb: list[int] = field(default_factory=list)
    exponent_c: int = 300  # path loss exponent x 100


@dataclass(slots=True)
class MeshPlan:
    """Everything a mesh run needs, as whole numbers."""

    scenario: Any
    kind: str
    seed: int
    duration_us: int
    nodes: int  # how many, 1 .. 254
    capacity: int  # their class, 32, 64 or 254 (see `protocol/fields.py`)
    names: list[str]  # what each is called, as in the file
    params: dict[str, Any]  # the protocol's parameters (`mesh_fields.PARAMS`); arrays as lists
    ranks: list[int]  # per node 0 gateway, 1.. standby, -1 neither
    robots: list[int]  # per node 1 = it is a robot
    absent: list[int]  # per node 1 = switched off until it is revived
    starts_us: list[int]  # per node, when it is switched on, us (the gateway last)
    mac: str  # "csma", "none" (ideal, and drivers that need none) or one of the radio's
    mac_params: dict[str, int]  # parameters of the medium access protocol
    radio: MeshRadio
    positions_cm: list[tuple[int, int]]  # per node (x, y) at the start; empty where none are given
    good: list[tuple[int, int]]  # links (a < b) that are good both ways at the start
    walks: list[Walk] = field(default_factory=list)  # how robots move
    sample_us: int = 20_000  # robots learn their position so often
    # The fence's corner: x and y in the protocol are (position - origin) / unit_cm.
    origin_cm: tuple[int, int] = (0, 0)
    offers: list[Offer] = field(default_factory=list)  # messages in order of time
    faults: list[MeshFault] = field(default_factory=list)  # events in order of time
    # Which part of a larger network this is (`clusters.Cluster`), None if it is whole.
    cluster: Any = None

    @property
    def gateway(self) -> int:
        """The node that leads, before any standby does."""
        return self.ranks.index(0)
