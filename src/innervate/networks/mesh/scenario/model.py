"""The keys of a mesh scenario, each with its range and meaning (see model.py).

Nodes are named by number (from 0, in the order of the file) or by name. What one key alone cannot
show is checked in mesh_rules.py; what needs the network, when it is planned.
"""

from __future__ import annotations

from typing import Annotated, Literal

from msgspec import Meta, Struct, field

from innervate.networks.mesh.scenario.settings import MeshProtocolTable
from innervate.networks.radio.scenario.model import MACS
from innervate.scenario.keys import SCHEMA

Node = Annotated[int | str, Meta(description='a node by number from 0, or by name, like "n3"')]
Metres = Annotated[
    float, Meta(ge=-100_000, le=100_000, description="a number of metres within +-100000")
]
Length = Annotated[float, Meta(gt=0, le=100_000, description="a number of metres > 0")]
Seconds = Annotated[float, Meta(ge=0, le=100_000, description="a number of seconds from 0")]
Decibels = Annotated[float, Meta(ge=0, le=30, description="a number of dB, 0 to 30")]
Power = Annotated[float, Meta(ge=-150, le=60, description="a number of dBm, -150 to 60")]
Quality = Annotated[float, Meta(ge=0, le=1, description="a share of received frames, 0 to 1")]
Point = Annotated[tuple[Metres, Metres], Meta(description="a point [x, y] in metres")]
MESH_MACS = ("csma", "none", *MACS)
MeshMac = Literal[
    "csma", "none", "csma-cd-r", "csma-cd-d1", "csma-cd-d2", "csma-cd-d2p", "slotted-aloha",
    "nonpersistent", "p-persistent", "dcf", "tree", "tdma",
]  # fmt: skip


class NodeTable(Struct, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """[[node]]: a node, and where it is."""

    name: (
        Annotated[
            str, Meta(min_length=1, max_length=40, description="a name of 1 to 40 characters")
        ]
        | None
    ) = None
    x_m: Metres | None = None
    y_m: Metres | None = None


class LinkedTable(Struct, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """[[link]]: two nodes that hear each other, and nobody else."""

    a: Node
    b: Node
    quality: Annotated[
        float | tuple[float, float],
        Meta(description="a share of received frames, 0 to 1, or two: [a to b, b to a]"),
    ] = 1.0


class PlacementTable(Struct, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """[placement]: where `nodes` are put [mesh 6]."""

    layout: Annotated[
        Literal["random", "grid", "line"], Meta(description='"random", "grid" or "line"')
    ] = "random"
    side_m: Length = 100.0
    spacing_m: Length = 10.0
    columns: (
        Annotated[int, Meta(ge=1, le=254, description="a whole number of columns, 1 to 254")] | None
    ) = None


class ImportTable(Struct, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """[import]: a network that was measured, or is published."""

    file: (
        Annotated[
            str, Meta(max_length=4096, description='a file, or "freifunk/leipzig" and the like')
        ]
        | None
    ) = None
    topohub: (
        Annotated[
            str,
            Meta(max_length=200, description='a name of the package topohub, "sndlib/germany50"'),
        ]
        | None
    ) = None
    types: Annotated[
        list[str], Meta(description='a list of types of links, ["wifi"]; [] = all')
    ] = field(default_factory=lambda: ["wifi"])
    min_tq: Quality = 0.3
    largest_component: Annotated[bool, Meta(description="true or false")] = True


class MeshRadioTable(Struct, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """[radio]: what the nodes hear of each other [mesh 6]."""

    profile: Annotated[
        Literal["250k", "38k4", "ip", "ideal"],
        Meta(description='"250k", "38k4", "ip" or "ideal"'),
    ] = "250k"
    mac: (
        Annotated[
            MeshMac,
            Meta(description=", ".join(f'"{m}"' for m in MESH_MACS[:-1]) + f' or "{MACS[-1]}"'),
        ]
        | None
    ) = None
    mean_degree: (
        Annotated[
            float, Meta(gt=0, le=253, description="a mean number of neighbours > 0, at most 253")
        ]
        | None
    ) = None
    reach_m: Length | None = None
    tx_dbm: Power | None = None
    exponent: Annotated[float, Meta(ge=1, le=6, description="an exponent, 1 to 6")] = 3.0
    shadowing_db: Decibels | None = None
    direction_db: Decibels | None = None
    capture_db: Decibels = 6.0
    sense_db: Annotated[float, Meta(ge=-30, le=30, description="a number of dB, -30 to 30")] = 3.0
    turnaround_us: (
        Annotated[
            int, Meta(ge=1, le=100_000, description="a whole number of microseconds, 1 to 100000")
        ]
        | None
    ) = None


class FlowTable(Struct, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """[[flow]]: messages from one node to another."""

    from_: Annotated[int | str, Meta(description='a node, "all" (every one) or "random"')] = field(
        name="from"
    )
    to: Annotated[
        int | str,
        Meta(description='a node, "monitor", "gateway", "random" or "all" (a broadcast)'),
    ]
    pairs: Annotated[
        int, Meta(ge=1, le=1000, description="a whole number of drawn pairs, 1 to 1000")
    ] = 1
    every_s: (
        Annotated[float, Meta(ge=0.0001, le=100_000, description="a number of seconds from 0.0001")]
        | None
    ) = None
    rate_hz: (
        Annotated[float, Meta(gt=0, le=10_000, description="messages per second > 0")] | None
    ) = None
    jitter_s: Seconds = 0.0
    count: (
        Annotated[
            int, Meta(ge=1, le=2_000_000, description="a whole number of messages, 1 to 2000000")
        ]
        | None
    ) = None
    bytes: Annotated[int, Meta(ge=0, le=90, description="a whole number of bytes, 0 to 90")] = 16
    start_s: Seconds | None = None
    stop_s: Seconds | None = None
    reliable: Annotated[bool, Meta(description="true or false")] | None = None
    priority: Annotated[bool, Meta(description="true or false")] = False


class FenceTable(Struct, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """[fence]: the polygon that robots must not leave."""

    polygon: Annotated[list[Point], Meta(description="a list of corners [x, y] in metres")]
    holes: Annotated[
        list[list[Point]], Meta(description="a list of polygons, each a list of corners [x, y]")
    ] = []
    number: Annotated[int, Meta(ge=0, le=255, description="a whole number, 0 to 255")] = 0
    unit_cm: (
        Annotated[Literal[1, 10, 100], Meta(description="a unit of 1, 10 or 100 cm")] | None
    ) = None
    sample_hz: Annotated[
        float, Meta(ge=1, le=1000, description="positions per second, 1 to 1000")
    ] = 50.0
    predict_s: Annotated[float, Meta(ge=0, le=10, description="a number of seconds, 0 to 10")] = 0.5
    clear_m: Annotated[float, Meta(ge=0, le=100, description="a number of metres, 0 to 100")] = 0.2
    lost_beacons: Annotated[
        int, Meta(ge=1, le=253, description="a whole number of beacons, 1 to 253")
    ] = 3
    watch: Annotated[bool, Meta(description="true or false")] = True
    flood: Annotated[
        Literal["never", "crossings", "all"], Meta(description='"never", "crossings" or "all"')
    ] = "crossings"
    floods: Annotated[int, Meta(ge=0, le=3, description="a whole number of floods, 0 to 3")] = 3


class RobotTable(Struct, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """[[robot]]: a node that moves."""

    node: Node
    waypoints: Annotated[
        list[Point], Meta(max_length=10_000, description="a list of points [x, y] in metres")
    ] = []
    random: Annotated[bool, Meta(description="true or false")] = False
    area: Annotated[
        tuple[Metres, Metres, Metres, Metres] | None,
        Meta(description="a rectangle [x, y, x, y] in metres, two opposite corners"),
    ] = None
    speed_mps: Annotated[
        float, Meta(ge=0.001, le=100, description="a number of m/s, 0.001 to 100")
    ] = 1.0
    start_s: Seconds = 0.0
    pause_s: Seconds = 0.0


MeshAction = Literal["kill", "revive", "cut", "restore", "jam", "quiet", "restart"]


class MeshEventTable(Struct, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """[[event]]: what happens, when, and to whom (exactly one of node, link, random)."""

    # Its range is checked in mesh_rules.py: see model.EventTable.
    at_s: Annotated[
        float | tuple[float, float],
        Meta(description="a number of seconds from 0, or a range [from, to]"),
    ]
    action: Annotated[
        MeshAction,
        Meta(description='"kill", "revive", "cut", "restore", "jam", "quiet" or "restart"'),
    ]
    node: Annotated[
        int | str | None, Meta(description='a node by number or name, "gateway" or "monitor"')
    ] = None
    link: Annotated[
        tuple[int | str, int | str] | None, Meta(description='two nodes, ["n1", "n2"]')
    ] = None
    random: Annotated[
        int | None,
        Meta(description="a whole number, 1 to 254, of nodes or links to draw"),
    ] = None
    noise_dbm: Power | None = None


class MeshScenario(Struct, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """A scenario of kind "mesh"."""

    kind: Annotated[Literal["mesh"], Meta(description='"mesh"')]
    schema: Annotated[int, Meta(ge=1, description="a whole number from 1")] = SCHEMA
    name: Annotated[str, Meta(max_length=200, description="a string of at most 200 characters")] = (
        ""
    )
    duration_s: Annotated[float, Meta(gt=0, le=100_000, description="a number of seconds > 0")] = (
        60.0
    )
    seed: Annotated[int, Meta(ge=0, description="a whole number from 0")] = 1
    # Its range is checked in mesh_rules.py, where the reason is known.
    nodes: Annotated[int | None, Meta(description="a whole number of nodes, 1 to 254")] = None
    gateway: Node | None = None
    standby: Annotated[list[Node], Meta(description="a list of nodes, in order of rank")] = []
    monitor: Annotated[int | str, Meta(description='a node, or "gateway"')] = "gateway"
    placement: Annotated[PlacementTable, Meta(description="a table [placement]")] = PlacementTable()
    import_: Annotated[ImportTable | None, Meta(description="a table [import]")] = field(
        name="import", default=None
    )
    radio: Annotated[MeshRadioTable, Meta(description="a table [radio]")] = MeshRadioTable()
    protocol: Annotated[MeshProtocolTable, Meta(description="a table [protocol]")] = (
        MeshProtocolTable()
    )
    fence: Annotated[FenceTable | None, Meta(description="a table [fence]")] = None
    node: Annotated[list[NodeTable], Meta(description="tables [[node]]")] = []
    link: Annotated[list[LinkedTable], Meta(description="tables [[link]]")] = []
    flow: Annotated[list[FlowTable], Meta(description="tables [[flow]]")] = []
    robot: Annotated[list[RobotTable], Meta(description="tables [[robot]]")] = []
    event: Annotated[list[MeshEventTable], Meta(description="tables [[event]]")] = []
