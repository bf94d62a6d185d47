"""The keys of a radio team's summary, on the event level and on the slotted one."""

from typing import Literal, TypedDict, final

from innervate.analysis.summary_common import Common


class Delays(TypedDict):
    """From the offer of a packet to the end of its successful frame, slots."""

    p50: float | None
    p95: float | None
    p99: float | None
    max: float | None


class Span(TypedDict):
    """Least and greatest delay measured, us."""

    min: float
    max: float


class Noticing(TypedDict):
    """A station that measured delays outside the bounds; how often."""

    station: int
    count: int
    delay_us: Span


class BoundsNoticed(TypedDict):
    """Delays outside the configured bounds, and who measured them."""

    count: int
    stations: list[Noticing]


class Channel(Common):
    """What both levels have.

    Attributes:
        protocol: the medium access.
        stations: how many robots.
        throughput: share of the time that delivered packets fill, 0 .. 1.
        duration_slots: from the first offer to the end of the last packet.
        jain: fairness index over all packets, 1/n .. 1 (even).
        jain_round: its mean over rounds of as many turns as stations.
        delay_slots: how long packets took.
        collisions: groups of overlapping transmissions.
        delivered: packets taken for delivered that somebody received.
        lost_silently: packets taken for delivered by their sender, received by nobody.
        order: stations in the order of their success.
    """

    kind: Literal["radio"]
    protocol: str
    stations: int
    throughput: float | None
    duration_slots: float | None
    jain: float | None
    jain_round: float | None
    delay_slots: Delays
    collisions: int
    delivered: int
    lost_silently: int
    order: list[int]


@final
class SlottedSummary(Channel):
    """The summary of a run of the reference model, which has slots and no events."""

    level: Literal["slotted"]


@final
class RadioSummary(Channel):
    """The summary of a radio team's run.

    Attributes:
        traffic: "saturated", "disaster" or "poisson".
        waited_off: delivered packets that waited while their robot was off, and have no delay.
        offered: packets handed down, the sum of those delivered, lost silently, pending, abandoned
            and dropped.
        pending: packets that wait at the end in robots that are on.
        abandoned: packets of robots that are off, or have left, at the end.
        partial: delivered, but not to everybody in reach.
        dropped: refused because too many waited.
        duplicates: packets received again.
        frame_errors: frames that a receiver could not read.
        fifo: share of pairs of packets that went in the order of their offers.
        bounds_noticed: delays outside the configured bounds.
    """

    traffic: str
    waited_off: int
    offered: int
    pending: int
    abandoned: int
    partial: int
    dropped: int
    duplicates: int
    frame_errors: int
    fifo: float | None
    bounds_noticed: BoundsNoticed
