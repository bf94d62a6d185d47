"""The keys of a mesh's summary."""

from typing import Literal, NotRequired, TypedDict, final

from innervate.analysis.summary_common import Common, Percentiles


class Discovery(TypedDict):
    """The first discovery round; None in all of it if there was none.

    Attributes:
        recall: of the good links, the share that the gateway knew after it.
        complete_s: from the first request to the gateway's graph.
        tables_s: from the first request to the last node's first whole table.
        airtime_s: on the air, summed over transmitters, acks of hops included.
        rounds: rounds of the whole run.
        responses_s: from the first request to the last response in time.
        tables_airtime_s: on the air for tables.
        with_tables: nodes that got a whole table.
    """

    recall: float | None
    complete_s: float | None
    tables_s: float | None
    airtime_s: float | None
    rounds: int | None
    responses_s: float | None
    tables_airtime_s: float | None
    with_tables: int | None


class Alarms(TypedDict):
    """Crossings of the fence.

    Attributes:
        sent: crossings, whether anybody noticed or not.
        delivered: those that the monitor learned of.
        latency_ms: from the sample that raised the alarm to the monitor.
        overrun_m: greatest distance outside until then.
        noticed: crossings for which somebody raised an alarm.
        by_witness: raised by another node than the robot.
        by_flood: the flooded copy came first.
        warned: crossings that the monitor was told of before.
        warning_ms: how long before.
        after_ms: from the crossing to the monitor; below 0 if the alarm came before it.
        false: alarms of robots that were inside until they were taken back.
        false_delivered: those that the monitor had.
        false_per_hour: false alarms per hour of each robot; None without robots.
    """

    sent: int
    delivered: int
    latency_ms: Percentiles
    overrun_m: Percentiles
    noticed: int
    by_witness: int
    by_flood: int
    warned: int
    warning_ms: Percentiles
    after_ms: Percentiles
    false: int
    false_delivered: int
    false_per_hour: float | None


class Counts(TypedDict):
    """Messages to one node by what became of them.

    Attributes:
        offered: handed down.
        delivered: came to their recipient.
        in_flight: undecided when the run ended.
        lost: given up, or never came.
        refused: by their sender, for want of room or of a way.
        sender_off: offered to a node that was off.
        counted: what ratios are made of.
        broadcasts: messages to all, in none of the others.
        partial: broadcasts that did not reach every other node that was on.
    """

    offered: int
    delivered: int
    in_flight: int
    lost: int
    refused: int
    sender_off: int
    counted: int
    broadcasts: int
    partial: int


class Flow(Counts):
    """The same of one [[flow]] of the scenario, with its index, ratio and latency."""

    flow: int
    delivery_ratio: float | None
    latency_ms: Percentiles


class Connected(TypedDict):
    """Messages whose sender and recipient were joined by good links of nodes that were on."""

    sent: int
    delivered: int
    delivery_ratio: float | None


class AfterDeaths(TypedDict):
    """Connected messages after the last death: the first of every sender, and all."""

    first: Connected
    all: Connected


class Stretch(TypedDict):
    """Hops taken over hops of the shortest path, 1 or more; hops taken."""

    mean: float | None
    p99: float | None
    hops_mean: float | None


class Gateway(TypedDict):
    """A node that became gateway.

    Attributes:
        node: which.
        at_s: when.
        epoch: the number of its reign.
        tables_s: until the last node had tables of it.
    """

    node: int
    at_s: float
    epoch: int
    tables_s: float | None


class Airtime(TypedDict):
    """Seconds on the air by use; the busiest node, and its share of the run, 0 .. 1."""

    discovery_s: float
    tables_s: float
    messages_s: float
    alarms_s: float
    beacons_s: float
    busiest: int
    busiest_share: float


class InClusters(TypedDict):
    """Which of several clusters a run is of.

    Attributes:
        number: which, from 1 on.
        of: how many there are.
        nodes: of all of them.
        members: what the nodes of this one are called: summary and tables number them so, from 0.
    """

    number: int
    of: int
    nodes: int
    members: list[str]


class OfCluster(TypedDict):
    """What the summary of a part of a larger network has, and no other.

    Attributes:
        cluster: which part it is; missing if it is the whole.
    """

    cluster: NotRequired[InClusters]


class Suspects(TypedDict):
    """How often a node gave up on a neighbour; `wrong`: on one that was switched on."""

    raised: int
    wrong: int


@final
class MeshSummary(Common, OfCluster):
    """The summary of a mesh's run.

    Attributes:
        nodes: how many, robots included.
        links: good in both directions at the start.
        discovery: the first round.
        delivery_ratio: messages to one node that came, of those counted.
        latency_ms: of messages, from the offer to the first delivery.
        alarms: crossings of the fence.
        duplicates: deliveries of the same packet beyond the first.
        looped: packets that met a node twice on their way.
        control_bytes: bytes of discovery and tables on the air, without the PHY's.
        messages: by what became of them.
        connected: those whose ends were connected.
        after_deaths: the same after the last death; None if nobody died.
        flows: of every flow.
        stretch: how much longer than the shortest the ways were.
        alternates: share of the destinations in tables with an alternate next hop.
        gateways: who led, from when.
        takeover_s: from a gateway's death to its successor's tables everywhere.
        airtime: on the air, by use.
        give_ups: messages given up or refused, by reason.
        suspects: neighbours given up.
    """

    kind: Literal["mesh"]
    nodes: int
    links: int
    discovery: Discovery
    delivery_ratio: float | None
    latency_ms: Percentiles
    alarms: Alarms
    duplicates: int
    looped: int
    control_bytes: int
    messages: Counts
    connected: Connected
    after_deaths: AfterDeaths | None
    flows: list[Flow]
    stretch: Stretch
    alternates: float | None
    gateways: list[Gateway]
    takeover_s: float | None
    airtime: Airtime
    give_ups: dict[str, int]
    suspects: Suspects
