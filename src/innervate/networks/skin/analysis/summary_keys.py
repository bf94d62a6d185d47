"""The keys of a skin's summary."""

from typing import Literal, TypedDict, final

from innervate.analysis.summary_common import Common


class StartUp(TypedDict):
    """From switching on.

    Attributes:
        converged_ms: to the last change of a parent, those for balancing left out.
        routed_ms: to the moment when the last cell had a way to the PC.
    """

    converged_ms: float | None
    routed_ms: float | None


class Recovery(TypedDict):
    """What followed one event; all `_ms` count from it and look no further than the next one.

    Attributes:
        at_s: when it happened.
        action: "cut", "restore", "loose", "lose", "kill", "restart" or "revive".
        detected_ms: until the first end of the cable found it broken.
        converged_ms: until the last change of a parent, those for balancing left out.
        routed_ms: until every cell that is on had a way again; 0 if none lacked one; None while
            any cell is cut off: no cable joins it with the PC.
        others_ms: the same without the cells that are cut off; None if these are all there are.
        without_way: cells that had none at the end although cables join them with the PC.
        cut_off: cells that no cable joins with the PC since, those it switched on there included.
        cut_off_total: those, and whoever was so before.
        joined_again: cells that cables join with the PC again.
        cut_cells: cells whose way used the cable or the node.
    """

    at_s: float
    action: str
    detected_ms: float | None
    converged_ms: float | None
    routed_ms: float | None
    others_ms: float | None
    without_way: int
    cut_off: int
    cut_off_total: int
    joined_again: int
    cut_cells: int


class Loops(TypedDict):
    """Forwarding loops: how many, and how long the longest stood."""

    episodes: int
    longest_ms: float | None


class Latency(TypedDict):
    """In ms, of what was received; percentiles to 0.4 %, never too small."""

    mean: float | None
    p50: float | None
    p95: float | None
    p99: float | None
    max: float | None


class PortLatency(TypedDict):
    """The same at one interface port.

    Attributes:
        port: which, from 0.
        samples: received there.
        latency_ms: how long they took.
    """

    port: int
    samples: int
    latency_ms: Latency


class Data(TypedDict):
    """Tactile samples from cells to the PC.

    Attributes:
        sent: taken by cells.
        delivered: received by the PC.
        lost: not received, and on their way no more.
        loss_ratio: lost / sent.
        lost_by: lost by reason: cut, noise, off, queue_full, broken_link, no_route, loop.
        in_flight: still on their way at the end.
        latency_ms: of all that were received.
        latency_by_port: of every interface port.
    """

    sent: int
    delivered: int
    lost: int
    loss_ratio: float | None
    lost_by: dict[str, int]
    in_flight: int
    latency_ms: Latency
    latency_by_port: list[PortLatency]


class CommandFrames(TypedDict):
    """Copies of commands on the cables.

    Attributes:
        sent: handed to a port that has a cable.
        lost_by: lost by reason: cut, noise, off, queue_full, broken_link.
        duplicates: dropped by a cell because it had the command already.
        too_far: not handed on, after as many hops as a route can have.
    """

    sent: int
    lost_by: dict[str, int]
    duplicates: int
    too_far: int


class Commands(TypedDict):
    """Commands from the PC down to the cells; all but `sent` counts cells that one was for.

    Attributes:
        sent: commands.
        addressed: cells that they were for.
        delivered: those that got theirs.
        lost: those that did not.
        loss_ratio: lost / addressed; None if none were.
        lost_by: lost by the state of the cell as the command was given: off, no_route, or
            on_the_way: it had a way.
        in_flight: neither, at the end.
        repeated: deliveries beyond a cell's first: only to cells that lost their memory.
        latency_ms: from the PC to the cell, of those delivered.
        frames: copies on the cables.
    """

    sent: int
    addressed: int
    delivered: int
    lost: int
    loss_ratio: float | None
    lost_by: dict[str, int]
    in_flight: int
    repeated: int
    latency_ms: Latency
    frames: CommandFrames


class BrokenPort(TypedDict):
    """A port that a cell holds for broken at the end.

    Attributes:
        cell: its name, "p0 r16 c7".
        port: "W", "E", "up" or "down".
        since_s: when it was found broken.
        to: the far end of its cable.
    """

    cell: str
    port: str
    since_s: float | None
    to: str


class Apart(TypedDict):
    """Cells that have no way to the PC at the end: how many, and which (100 names at most)."""

    cells: int
    labels: list[str]


class CutOff(Apart):
    """Cells that are on and that no cable joins with the PC any more.

    Attributes:
        since_s: when the first of them was cut off.
        most: how many there were at the worst moment.
    """

    since_s: float | None
    most: int


class WithoutWay(Apart):
    """Cells that cables join with the PC, without a way to it; `never` of them never had one."""

    never: int


class Reach(TypedDict):
    """Who has no way to the PC at the end of a run; all None of one that nobody observed.

    Attributes:
        cut_off: cells that no cable joins with the PC any more.
        without_way: cells that cables join with it, but that have no way.
        switched_off: cells that are off.
        lost_at_start: samples lost before their cell had a way for the first time.
    """

    cut_off: CutOff | None
    without_way: WithoutWay | None
    switched_off: Apart | None
    lost_at_start: int | None


@final
class SkinSummary(Common, Reach):
    """The summary of a skin's run.

    Attributes:
        warnings: what makes the scenario weaker than it looks, as `check` says it; what of the
            proofs' assumptions the run left (docs/prove.md).
        cells: how many there are.
        depth_max: hops of the deepest cell to the PC, by breadth-first search.
        start_up: from switching on.
        recoveries: one for every event, in order of time.
        loops: forwarding loops.
        balance_factor: of the interface ports at the end, 1/n .. 1 (even) [skin III-A.2].
        port_loads: cells that each interface port serves at the end.
        data: samples.
        commands: of the PC, down to the cells.
        beacon_share: of the capacity of all cables, what beacons took.
        broken: ports found broken at the end.
    """

    kind: Literal["skin"]
    warnings: list[str]
    cells: int
    depth_max: int
    start_up: StartUp
    recoveries: list[Recovery]
    loops: Loops
    balance_factor: float | None
    port_loads: list[int]
    data: Data
    commands: Commands
    beacon_share: float | None
    broken: list[BrokenPort]
