"""The plan of a network over cables: what `sim/cables` runs and `live` sets up."""

from collections.abc import Iterable
from dataclasses import dataclass, field
from typing import Any, NamedTuple

from innervate.scenario.actions.cables import ACTIONS, LOOSE
from innervate.scenario.events import opening, told
from innervate.topology.graph import Graph

LOSS_ONE = 32_768


@dataclass(frozen=True, slots=True)
class Fault:
    """One event of a run."""

    at_us: int  # when, true time, us
    action: int  # CUT, RESTORE, KILL, REVIVE, LOOSE, RESTART or LOSE
    end: int = -1  # one end of the cable it happens to; -1 for kill, revive and restart
    node: int = -1  # the node it happens to; -1 for cables
    loss_q15: int = 0  # for LOOSE the loss on both directions in 1/32768; else 0
    frames: int = 0  # for LOSE how many frames are lost on the cable; else 0
    index: int = 0  # the event's place in the scenario file


class Input(NamedTuple):
    """What a node is given by its user at a time: a kind, and fields of its item (a frame)."""

    at_us: int
    node: int
    kind: int
    item: dict[str, int]


class Happening(Input):
    """What happens to a node, in a word of its network's own: no message of anybody."""

    __slots__ = ()


@dataclass(slots=True)
class CablesPlan:
    """Everything a run over cables needs, as whole numbers."""

    scenario: Any  # whose plan it is
    graph: Graph  # nodes with up to four ports each, and their cables
    kind: str  # name of the network
    seed: int  # root of all random numbers
    duration_us: int  # simulated time
    params: dict[str, int]  # the protocol's parameters, by name
    start_us: int = 1_000  # nodes are switched on within so long
    drift_ppm: int = 0  # clocks run up to this much fast or slow
    # Least and greatest hop latency, wire time included, us.
    latency_us: tuple[int, int] = (80, 160)
    latency_per_frame: bool = False  # drawn for every frame; else once for each link and direction
    # Time a frame occupies the wire.
    wire_us: int = 60  # a frame of 240 bit at 4 Mbit/s
    queue_frames: int = 8  # frames a port can hold that are not urgent
    loss_q15: int = 0  # share of the frames that every cable loses, in 1/32768
    data_period_us: int = 0  # between a node's inputs of kind SAMPLE; 0 = none
    faults: list[Fault] = field(default_factory=list)  # in order of time, then of the file
    # What nodes are given besides, in order of time.
    inputs: list[Input] = field(default_factory=list)


def describe(
    plan: Any,
    warnings: Iterable[str] = (),
    more: Iterable[str] = (),
    own: Iterable[tuple[int, str]] = (),
) -> str:
    """A plan in words, several lines (`more` of them), without a newline at the end."""
    graph = plan.graph
    params = ", ".join(f"{name} {value}" for name, value in plan.params.items())
    lines = [
        opening(plan),
        f"  nodes      {graph.cells:,}, {sum(1 for _ in graph.links()):,} cables",
        f"  protocol   {params}",
    ]
    return "\n".join([*lines, *more, *told(plan, fault_words, warnings, own)])


def fault_words(plan: Any, fault: Any) -> str:
    """A fault in words: "at 2 s cut pc.1 - p0 r16 c7 down"."""
    graph = plan.graph
    if fault.end >= 0:
        what = f"{graph.label_end(fault.end)} - {graph.label_end(graph.peer[fault.end])}"
    else:
        what = graph.label(fault.node)
    more = f", loss {fault.loss_q15 / LOSS_ONE:.3g}" if fault.action == LOOSE else ""
    if fault.frames:
        more += f", {fault.frames} frame{'s' if fault.frames > 1 else ''}"
    return f"at {fault.at_us / 1e6:g} s {ACTIONS[fault.action]} {what}{more}"
