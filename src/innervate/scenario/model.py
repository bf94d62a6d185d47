"""The keys of a skin scenario, each with its range and meaning, as msgspec structs.

A field's `description` completes the sentence "<key> must be ..." in error messages and stands in
the published JSON Schema. What one key alone cannot show is checked in rules.py; what needs the
network, in build.py and targets.py.
"""

from __future__ import annotations

from typing import Annotated, Literal

from msgspec import Meta, Struct

SCHEMA = 1

Count = Annotated[int, Meta(ge=0, le=4_000_000, description="a whole number from 0")]
Side = Annotated[int, Meta(ge=1, le=4_000_000, description="a whole number from 1")]
Fraction = Annotated[float, Meta(ge=0, le=1, description="a fraction from 0 to 1")]
Penalty = Annotated[float, Meta(gt=0, le=2, description="a fraction > 0, at most 2")]
Port = Annotated[int | str, Meta(description='a port: "W", "E", "up", "down" or 0 to 3')]
Micros = Annotated[
    int, Meta(ge=0, le=1_000_000, description="a whole number of microseconds, 0 to 1000000")
]
Coordinate = Annotated[
    float, Meta(ge=-1_000_000, le=1_000_000, description="a number of mm within +-1000000")
]
At = Annotated[float, Meta(ge=0, le=1_000_000, description="a number of seconds from 0")]
Number = Annotated[int, Meta(ge=0, le=4_000_000, description="a whole number from 0")]


class PatchTable(Struct, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """[[patch]]: a rectangle of cells; with `count` several alike."""

    columns: Side
    rows: Side
    wiring: Annotated[Literal["Z", "S"], Meta(description='"Z" or "S"')] = "Z"
    count: Side = 1
    interfaces_every: Annotated[
        int, Meta(ge=0, le=4_000_000, description="a whole number from 0 (0 = none)")
    ] = 0
    joined: Annotated[bool, Meta(description="true or false")] = True


class CellTable(Struct, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """A cell of a patch: { patch, row, column }, and `port` where it matters."""

    patch: Number = 0
    row: Number
    column: Number
    port: Port | None = None


CellOrName = Annotated[
    CellTable | str, Meta(description='a cell like { patch = 0, row = 1, column = 2 } or "n1"')
]


class InterfaceTable(Struct, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """[[interface]]: one interface port of the PC, cabled to a cell."""

    patch: Number = 0
    row: Number
    column: Number
    port: Port | None = None


class CableTable(Struct, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """[[cable]]: joins two patches."""

    a: CellOrName
    b: CellOrName


class LinkTable(Struct, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """[[link]]: a cable of a free graph."""

    a: Annotated[str, Meta(max_length=200, description='an end like "n1.2", "n1" or "pc.0"')]
    b: Annotated[str, Meta(max_length=200, description='an end like "n1.2", "n1" or "pc.0"')]


class BodyTable(Struct, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """[body]: cells of a robot description."""

    urdf: Annotated[str, Meta(description='a file, or "package:icub-models/iCubGenova02"')]
    links: Annotated[str, Meta(description='a pattern for link names, like "r_forearm_skin_*"')]
    pitch_mm: (
        Annotated[float, Meta(ge=0.5, le=100_000, description="a number of mm, 0.5 or more")] | None
    ) = None
    reach_mm: Annotated[float, Meta(gt=0, le=100_000, description="a number of mm > 0")] = 40.0
    interfaces: Annotated[
        Annotated[int, Meta(ge=1, le=4096)] | list[str],
        Meta(description="a whole number from 1, or a list of link names"),
    ] = 2


class ProtocolTable(Struct, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """[protocol] [skin 5]."""

    rule: Annotated[
        Literal["feasible", "strict", "paper", "paper-lax", "static"],
        Meta(description='"feasible", "strict", "paper", "paper-lax" or "static"'),
    ] = "feasible"
    updates: Annotated[
        Literal["periodic", "triggered", "wave"],
        Meta(description='"periodic", "triggered" or "wave"'),
    ] = "wave"
    beacon_hz: Annotated[
        float, Meta(ge=1, le=1000, description="a number of beacons per second, 1 to 1000")
    ] = 250.0
    # Which of these can be kept, rules.py says.
    k: (
        Annotated[int, Meta(ge=1, le=100, description="a whole number of missed beacons, 1 to 100")]
        | None
    ) = None
    r_f: Penalty | None = None
    r_r: Penalty | None = None
    m: (
        Annotated[int, Meta(ge=1, le=255, description="a whole number of periods, 1 to 255")] | None
    ) = None
    balancing: Annotated[bool, Meta(description="true or false")] = True
    balance_periods: (
        Annotated[int, Meta(ge=1, le=65535, description="a whole number of periods, 1 to 65535")]
        | None
    ) = None
    balance_rule: Annotated[Literal["even", "paper"], Meta(description='"even" or "paper"')] = (
        "even"
    )
    max_depth: Annotated[
        int, Meta(ge=1, le=254, description="a whole number of hops, 1 to 254")
    ] = 64
    gap_us: Micros = 500
    restart_s: Annotated[float, Meta(ge=0, le=200, description="a number of seconds, 0 to 200")] = (
        2.0
    )
    forward_us: Annotated[
        tuple[Micros, Micros], Meta(description="two numbers of microseconds, [least, most]")
    ] = (0, 2000)


Hop = Annotated[
    int, Meta(ge=1, le=100_000, description="a whole number of microseconds, 1 to 100000")
]


class TimingTable(Struct, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """[timing]: clocks and cables."""

    drift_ppm: Annotated[
        int, Meta(ge=0, le=50_000, description="a whole number from 0 to 50000")
    ] = 1000
    hop_latency_us: Annotated[
        tuple[Hop, Hop], Meta(description="two numbers of microseconds from 1, [least, most]")
    ] = (80, 160)
    latency: Annotated[
        Literal["per_link", "per_frame"], Meta(description='"per_link" or "per_frame"')
    ] = "per_link"
    lock_step: Annotated[bool, Meta(description="true or false")] = False
    loss: Annotated[float, Meta(ge=0, le=1, description="a share of lost frames, 0 to 1")] = 0.0


class DataTable(Struct, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """[data]: the cells' samples."""

    rate_hz: Annotated[
        float, Meta(ge=0, le=10_000, description="a number of samples per second, 0 (off) to 10000")
    ] = 0.0
    queue: Annotated[
        int, Meta(ge=1, le=4096, description="a whole number of frames, 1 to 4096")
    ] = 8


class TouchTable(Struct, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """[touch]: a synthetic touch that moves over the skin, in the coordinates of the layout."""

    path: Annotated[
        list[tuple[At, Coordinate, Coordinate]],
        Meta(max_length=100_000, description="a list of points [t_s, x_mm, y_mm]"),
    ] = []
    radius_mm: Annotated[float, Meta(gt=0, le=10_000, description="a number of mm > 0")] = 30.0
    force_n: Annotated[float, Meta(ge=0, le=65, description="a number of newtons, 0 to 65")] = 5.0


Frames = Annotated[
    int, Meta(ge=1, le=1_000_000, description="a whole number of frames, 1 to 1000000")
]
Action = Literal["cut", "restore", "kill", "revive", "loose", "restart", "lose"]


class EventTable(Struct, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """[[event]]: what happens, when, and to whom (exactly one target)."""

    # Its range is checked in rules.py: msgspec 0.22 crashes on limits in a union with a tuple.
    at_s: Annotated[
        float | tuple[float, float],
        Meta(description="a number of seconds from 0, or a range [from, to]"),
    ]
    action: Annotated[
        Action,
        Meta(
            description='"cut", "restore", "kill", "revive", "loose", "restart" or "lose"',
        ),
    ]
    interface: Number | None = None
    cell: CellTable | None = None
    port: Port | None = None
    link: Annotated[
        tuple[CellOrName, CellOrName] | None, Meta(description="two cells, [{...}, {...}]")
    ] = None
    node: Annotated[str | None, Meta(description='a name like "n1"')] = None
    pc: Annotated[bool, Meta(description="true or left out")] = False
    random: Annotated[
        Literal["link", "cell", "interface"] | None,
        Meta(description='"link", "cell" or "interface"'),
    ] = None
    loss: Fraction | None = None
    frames: Frames | None = None


class CommandTable(Struct, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """[[command]]: what the PC sends down to a cell, or to all; once, or again and again."""

    at_s: At
    rate_hz: Annotated[
        float, Meta(ge=0, le=1000, description="a number of commands per second, 0 (once) to 1000")
    ] = 0.0
    cell: CellTable | None = None
    node: Annotated[str | None, Meta(description='a name like "n1"')] = None
    random: Annotated[bool, Meta(description="true or left out")] = False
    code: Annotated[int, Meta(ge=0, le=255, description="a whole number, 0 to 255")] = 0
    value: Annotated[int, Meta(ge=0, le=65_535, description="a whole number, 0 to 65535")] = 0


class ScriptTable(Struct, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """[script]: steps that replace the clock."""

    steps: Annotated[
        list[str], Meta(max_length=100_000, description='a list of steps like "tick n1"')
    ]
    keepalive: Annotated[bool, Meta(description="true or false")] = False


class SkinScenario(Struct, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """A scenario of kind "skin"."""

    kind: Annotated[Literal["skin"], Meta(description='"skin"')]
    schema: Annotated[int, Meta(ge=1, description="a whole number from 1")] = SCHEMA
    name: Annotated[str, Meta(max_length=200, description="a string of at most 200 characters")] = (
        ""
    )
    duration_s: Annotated[
        float, Meta(gt=0, le=1_000_000, description="a number of seconds > 0")
    ] = 4.0
    seed: Annotated[int, Meta(ge=0, description="a whole number from 0")] = 1
    patch: Annotated[list[PatchTable], Meta(description="tables [[patch]]")] = []
    interface: Annotated[list[InterfaceTable], Meta(description="tables [[interface]]")] = []
    cable: Annotated[list[CableTable], Meta(description="tables [[cable]]")] = []
    link: Annotated[list[LinkTable], Meta(description="tables [[link]]")] = []
    body: Annotated[BodyTable | None, Meta(description="a table [body]")] = None
    protocol: Annotated[ProtocolTable, Meta(description="a table [protocol]")] = ProtocolTable()
    timing: Annotated[TimingTable, Meta(description="a table [timing]")] = TimingTable()
    data: Annotated[DataTable, Meta(description="a table [data]")] = DataTable()
    touch: Annotated[TouchTable | None, Meta(description="a table [touch]")] = None
    event: Annotated[list[EventTable], Meta(description="tables [[event]]")] = []
    command: Annotated[list[CommandTable], Meta(description="tables [[command]]")] = []
    script: Annotated[ScriptTable | None, Meta(description="a table [script]")] = None
