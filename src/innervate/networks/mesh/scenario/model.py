"""The keys of a mesh scenario, each with its range and meaning (see keys.py).

Nodes are named by number (from 0, in the order of the file) or by name. What one key alone cannot
show is checked in rules.py; what needs the network, when it is planned.
"""

from typing import TYPE_CHECKING, Annotated, Literal

from msgspec import Meta, field

from innervate.networks.mesh.scenario.settings import MeshProtocolTable
from innervate.networks.radio.scenario.model import MACS
from innervate.scenario import keys
from innervate.scenario.actions.field import ACTIONS
from innervate.scenario.robots import Metres, NodeId, Place, RobotTable, SampleHz, Seconds

Length = Annotated[float, keys.above_0("metres", limit=100_000)]
Decibels = Annotated[float, keys.number("dB", 0, 30)]
Power = Annotated[float, keys.number("dBm", -150, 60)]
Quality = Annotated[float, Meta(ge=0, le=1, description="a share of received frames, 0 to 1")]
NodeName = Annotated[
    str, Meta(min_length=1, max_length=40, description="a name of 1 to 40 characters")
]
File = Annotated[
    str, Meta(max_length=4096, description='a file, or "freifunk/leipzig" and the like')
]
Topohub = Annotated[
    str, Meta(max_length=200, description='a name of the package topohub, "sndlib/germany50"')
]
Degree = Annotated[
    float, Meta(gt=0, le=253, description="a mean number of neighbours > 0, at most 253")
]
Rate = Annotated[float, Meta(gt=0, le=10_000, description="messages per second > 0")]
Unit = Annotated[Literal[1, 10, 100], Meta(description="a unit of 1, 10 or 100 cm")]
MESH_MACS = ("csma", "none", *(mac for mac in MACS if mac not in ("token-ring", "polling")))
# Words that tables give a type, which a type checker cannot see.
if TYPE_CHECKING:
    MeshMac = str
    Action = str
else:
    MeshMac, Action = Literal[MESH_MACS], Literal[ACTIONS]


class NodeTable(keys.Table, frozen=True, kw_only=True):
    """[[node]]: a node, and where it is."""

    name: NodeName | None = None
    x_m: Metres | None = None
    y_m: Metres | None = None


class LinkedTable(keys.Table, frozen=True, kw_only=True):
    """[[link]]: two nodes that hear each other, and nobody else."""

    a: NodeId
    b: NodeId
    quality: Annotated[
        float | tuple[float, float],
        Meta(description="a share of received frames, 0 to 1, or two: [a to b, b to a]"),
    ] = 1.0


class PlacementTable(keys.Table, frozen=True, kw_only=True):
    """[placement]: where `nodes` are put [mesh 6]."""

    layout: Literal["random", "grid", "line"] = "random"
    side_m: Length = 100.0
    spacing_m: Length = 10.0
    columns: Annotated[int, keys.whole("columns", 1, 2_000)] | None = None


class ImportTable(keys.Table, frozen=True, kw_only=True):
    """[import]: a network that was measured, or is published."""

    file: File | None = None
    topohub: Topohub | None = None
    types: Annotated[
        list[str], Meta(description='a list of types of links, ["wifi"]; [] = all')
    ] = field(default_factory=lambda: ["wifi"])
    min_tq: Quality = 0.3
    largest_component: bool = True
    around: Annotated[int | str, Meta(description="a node as the file calls it")] | None = None
    nodes: Annotated[int, keys.whole("nodes", 2, 2_000)] | None = None


class ClustersTable(keys.Table, frozen=True, kw_only=True):
    """[clusters]: several meshes, each with a gateway and a channel of its own."""

    gateways: Annotated[
        int | list[NodeId],
        Meta(description="a number of gateways, 1 to 64, or a list of nodes"),
    ]
    nodes_max: Annotated[int, keys.whole("nodes", 1, 254)] = 254
    run: Annotated[int, keys.whole("cluster to be run, from 1 on", 1, 64)] = 1


class MeshRadioTable(keys.Table, frozen=True, kw_only=True):
    """[radio]: what the nodes hear of each other [mesh 6]."""

    profile: Literal["250k", "38k4", "ip", "ideal"] = "250k"
    mac: MeshMac | None = None
    mean_degree: Degree | None = None
    reach_m: Length | None = None
    tx_dbm: Power | None = None
    exponent: Annotated[float, Meta(ge=1, le=6, description="an exponent, 1 to 6")] = 3.0
    shadowing_db: Decibels | None = None
    direction_db: Decibels | None = None
    capture_db: Decibels = 6.0
    sense_db: Annotated[float, keys.number("dB", -30, 30)] = 3.0
    turnaround_us: Annotated[int, keys.whole("microseconds", 1, 100_000)] | None = None


class FlowTable(keys.Table, frozen=True, kw_only=True):
    """[[flow]]: messages from one node to another."""

    from_: Annotated[int | str, Meta(description='a node, "all" (every one) or "random"')] = field(
        name="from"
    )
    to: Annotated[
        int | str,
        Meta(description='a node, "monitor", "gateway", "random" or "all" (a broadcast)'),
    ]
    pairs: Annotated[int, keys.whole("drawn pairs", 1, 1000)] = 1
    every_s: Annotated[float, keys.number("seconds", 0.0001, limit=100_000)] | None = None
    rate_hz: Rate | None = None
    jitter_s: Seconds = 0.0
    count: Annotated[int, keys.whole("messages", 1, 2_000_000)] | None = None
    bytes: Annotated[int, keys.whole("bytes", 0, 1163)] = 16
    start_s: Seconds | None = None
    stop_s: Seconds | None = None
    reliable: bool | None = None
    priority: bool = False


class FenceTable(keys.Table, frozen=True, kw_only=True):
    """[fence]: the polygon that robots must not leave."""

    polygon: Annotated[list[Place], Meta(description="a list of corners [x, y] in metres")]
    holes: Annotated[
        list[list[Place]], Meta(description="a list of polygons, each a list of corners [x, y]")
    ] = []
    number: Annotated[int, keys.whole("", 0, 255)] = 0
    unit_cm: Unit | None = None
    sample_hz: SampleHz = 50.0
    predict_s: Annotated[float, keys.number("seconds", 0, 10)] = 0.5
    clear_m: Annotated[float, keys.number("metres", 0, 100)] = 0.2
    lost_beacons: Annotated[int, keys.whole("beacons", 1, 253)] = 3
    watch: bool = True
    flood: Literal["never", "crossings", "all"] = "crossings"
    floods: Annotated[int, keys.whole("floods", 0, 3)] = 3


class MeshEventTable(keys.Table, frozen=True, kw_only=True):
    """[[event]]: what happens, when, and to whom (exactly one of node, link, random)."""

    at_s: keys.When
    action: Action
    node: Annotated[
        int | str | None, Meta(description='a node by number or name, "gateway" or "monitor"')
    ] = None
    link: Annotated[
        tuple[int | str, int | str] | None, Meta(description='two nodes, ["n1", "n2"]')
    ] = None
    random: Annotated[
        int | None, Meta(description="a whole number, 1 to 254, of nodes or links to draw")
    ] = None
    noise_dbm: Power | None = None


class MeshScenario(keys.Scenario, frozen=True, kw_only=True):
    """A scenario of kind "mesh"; its tables are built as Mesh.Node, Mesh.Flow and so on."""

    Node = NodeTable
    Link = LinkedTable
    Placement = PlacementTable
    Import = ImportTable
    Clusters = ClustersTable
    Radio = MeshRadioTable
    Protocol = MeshProtocolTable
    Flow = FlowTable
    Fence = FenceTable
    Robot = RobotTable
    Event = MeshEventTable

    kind: Literal["mesh"] = "mesh"
    duration_s: Annotated[float, keys.above_0("seconds", limit=100_000)] = 60.0
    # Its range is checked in rules.py, where the reason is known.
    nodes: Annotated[int | None, Meta(description="a whole number of nodes")] = None
    gateway: NodeId | None = None
    standby: Annotated[list[NodeId], Meta(description="a list of nodes, in order of rank")] = []
    monitor: Annotated[int | str, Meta(description='a node, or "gateway"')] = "gateway"
    placement: PlacementTable = PlacementTable()
    import_: ImportTable | None = field(name="import", default=None)
    clusters: ClustersTable | None = None
    radio: MeshRadioTable = MeshRadioTable()
    protocol: MeshProtocolTable = MeshProtocolTable()
    fence: FenceTable | None = None
    node: list[NodeTable] = []
    link: list[LinkedTable] = []
    flow: list[FlowTable] = []
    robot: list[RobotTable] = []
    event: list[MeshEventTable] = []
