"""The keys of a skin scenario, each with its range and meaning, as msgspec structs (see keys.py).

What one key alone cannot show is checked in rules.py; what needs the network, in build.py and
targets.py.
"""

from typing import TYPE_CHECKING, Annotated, Literal

from msgspec import Meta

from innervate.scenario import keys
from innervate.scenario.actions.cables import ACTIONS

MANY = 4_000_000
Side = Annotated[int, keys.whole("", 1, limit=MANY)]
Number = Annotated[int, keys.whole("", 0, limit=MANY)]
Penalty = Annotated[float, Meta(gt=0, le=2, description="a fraction > 0, at most 2")]
Port = Annotated[int | str, Meta(description='a port: "W", "E", "up", "down" or 0 to 3')]
Coordinate = Annotated[
    float, Meta(ge=-1_000_000, le=1_000_000, description="a number of mm within +-1000000")
]
At = Annotated[float, keys.number("seconds", 0, limit=1_000_000)]
K_MAX = 94  # of 1 to 100 the greatest that can be counted in parts of 840 (see rules.py)
Hop = Annotated[int, keys.whole("microseconds", 1, 100_000)]
CellName = Annotated[str | None, Meta(description='a name like "n1"')]
LinkEnd = Annotated[str, Meta(max_length=200, description='an end like "n1.2", "n1" or "pc.0"')]
MicrosPair = Annotated[
    tuple[keys.Micros, keys.Micros], Meta(description="two numbers of microseconds, [least, most]")
]


class PatchTable(keys.Table, frozen=True, kw_only=True):
    """[[patch]]: a rectangle of cells; with `count` several alike."""

    columns: Side
    rows: Side
    wiring: Literal["Z", "S"] = "Z"
    count: Side = 1
    interfaces_every: Annotated[
        int, Meta(ge=0, le=MANY, description="a whole number from 0 (0 = none)")
    ] = 0
    joined: bool = True


class CellTable(keys.Table, frozen=True, kw_only=True):
    """A cell of a patch: { patch, row, column }, and `port` where it matters."""

    patch: Number = 0
    row: Number
    column: Number
    port: Port | None = None


CellOrName = Annotated[
    CellTable | str, Meta(description='a cell like { patch = 0, row = 1, column = 2 } or "n1"')
]


class InterfaceTable(CellTable, frozen=True, kw_only=True):
    """[[interface]]: one interface port of the PC, cabled to a cell."""


class CableTable(keys.Table, frozen=True, kw_only=True):
    """[[cable]]: a cable between cells of two patches, or to the PC."""

    a: CellOrName
    b: CellOrName


class LinkTable(keys.Table, frozen=True, kw_only=True):
    """[[link]]: a cable of a free graph."""

    a: LinkEnd
    b: LinkEnd


class BodyTable(keys.Table, frozen=True, kw_only=True):
    """[body]: cells of a robot description."""

    urdf: Annotated[str, Meta(description='a file, or "package:icub-models/iCubGenova02"')]
    links: Annotated[str, Meta(description='a pattern for link names, like "r_forearm_skin_*"')]
    pitch_mm: (
        Annotated[float, Meta(ge=0.5, le=100_000, description="a number of mm, 0.5 or more")] | None
    ) = None
    reach_mm: Annotated[float, keys.above_0("mm", limit=100_000)] = 40.0
    interfaces: Annotated[
        Annotated[int, Meta(ge=1, le=4096)] | list[str],
        Meta(description="a whole number from 1, or a list of link names"),
    ] = 2


class ProtocolTable(keys.Table, frozen=True, kw_only=True):
    """[protocol] of a skin: rule, updates, supervision, balancing [skin 5]."""

    rule: Literal["feasible", "strict", "paper", "paper-lax", "static"] = "feasible"
    updates: Literal["periodic", "triggered", "wave"] = "wave"
    beacon_hz: Annotated[float, keys.number("beacons per second", 1, 1000)] = 250.0
    # Which of these can be counted, rules.py says.
    k: Annotated[int, keys.whole("missed beacons", 1, K_MAX)] | None = None
    r_f: Penalty | None = None
    r_r: Penalty | None = None
    m: Annotated[int, keys.whole("periods", 1, 255)] | None = None
    balancing: bool = True
    balance_periods: Annotated[int, keys.whole("periods", 1, 65_535)] | None = None
    balance_rule: Literal["even", "paper"] = "even"
    max_depth: Annotated[int, keys.whole("hops", 1, 254)] = 64
    gap_us: keys.Micros = 500
    restart_s: Annotated[float, keys.number("seconds", 0, 200)] = 2.0
    forward_us: MicrosPair = (0, 2000)


class TimingTable(keys.Table, frozen=True, kw_only=True):
    """[timing]: drift of clocks, latency and losses of cables."""

    drift_ppm: Annotated[int, keys.whole("", 0, 50_000)] = 1000
    hop_latency_us: Annotated[
        tuple[Hop, Hop], Meta(description="two numbers of microseconds from 1, [least, most]")
    ] = (80, 160)
    latency: Literal["per_link", "per_frame"] = "per_link"
    lock_step: bool = False
    loss: Annotated[float, Meta(ge=0, le=1, description="a share of lost frames, 0 to 1")] = 0.0


class DataTable(keys.Table, frozen=True, kw_only=True):
    """[data]: how often cells send samples, and how many wait at a port."""

    rate_hz: Annotated[
        float, Meta(ge=0, le=10_000, description="a number of samples per second, 0 (off) to 10000")
    ] = 0.0
    queue: Annotated[int, keys.whole("frames", 1, 4096)] = 8


class TouchTable(keys.Table, frozen=True, kw_only=True):
    """[touch]: a synthetic touch that moves over the skin, in the coordinates of the layout."""

    path: Annotated[
        list[tuple[At, Coordinate, Coordinate]],
        Meta(max_length=100_000, description="a list of points [t_s, x_mm, y_mm]"),
    ] = []
    radius_mm: Annotated[float, keys.above_0("mm", limit=10_000)] = 30.0
    force_n: Annotated[float, keys.number("newtons", 0, 65)] = 5.0


if TYPE_CHECKING:
    Action = str
else:
    Action = Literal[ACTIONS]


class EventTable(keys.Table, frozen=True, kw_only=True):
    """[[event]]: what happens, when, and to whom (exactly one target)."""

    at_s: keys.When
    action: Action
    interface: Number | None = None
    cell: CellTable | None = None
    port: Port | None = None
    link: Annotated[
        tuple[CellOrName, CellOrName] | None, Meta(description="two cells, [{...}, {...}]")
    ] = None
    node: CellName = None
    pc: Annotated[bool, Meta(description="true or left out")] = False
    random: Literal["link", "cell", "interface"] | None = None
    loss: Annotated[float, Meta(ge=0, le=1, description="a fraction from 0 to 1")] | None = None
    frames: Annotated[int, keys.whole("frames", 1, 1_000_000)] | None = None


class CommandTable(keys.Table, frozen=True, kw_only=True):
    """[[command]]: what the PC sends down to a cell, or to all; once, or again and again."""

    at_s: At
    rate_hz: Annotated[
        float, Meta(ge=0, le=1000, description="a number of commands per second, 0 (once) to 1000")
    ] = 0.0
    cell: CellTable | None = None
    node: CellName = None
    random: Annotated[bool, Meta(description="true or left out")] = False
    code: Annotated[int, keys.whole("", 0, 255)] = 0
    value: Annotated[int, keys.whole("", 0, 65_535)] = 0


class ScriptTable(keys.Table, frozen=True, kw_only=True):
    """[script]: steps that replace the clock."""

    steps: Annotated[
        list[str], Meta(max_length=100_000, description='a list of steps like "tick n1"')
    ]
    keepalive: bool = False


class SkinScenario(keys.Scenario, frozen=True, kw_only=True):
    """A scenario of kind "skin"; its tables are built as Skin.Patch, Skin.Event and so on."""

    Patch = PatchTable
    Cell = CellTable
    Interface = InterfaceTable
    Cable = CableTable
    Link = LinkTable
    Body = BodyTable
    Protocol = ProtocolTable
    Timing = TimingTable
    Data = DataTable
    Touch = TouchTable
    Event = EventTable
    Command = CommandTable
    Script = ScriptTable

    kind: Literal["skin"] = "skin"
    duration_s: Annotated[float, keys.above_0("seconds", limit=1_000_000)] = 4.0
    patch: list[PatchTable] = []
    interface: list[InterfaceTable] = []
    cable: list[CableTable] = []
    link: list[LinkTable] = []
    body: BodyTable | None = None
    protocol: ProtocolTable = ProtocolTable()
    timing: TimingTable = TimingTable()
    data: DataTable = DataTable()
    touch: TouchTable | None = None
    event: list[EventTable] = []
    command: list[CommandTable] = []
    script: ScriptTable | None = None
