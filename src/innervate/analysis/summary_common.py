"""What the summaries of all kinds of networks have in common.

A key's unit is the end of its name: `_s` seconds, `_ms` milliseconds, `_slots` slots of the
channel, `_m` metres; `ratio`, `share` and `recall` are 0 .. 1. What never happened is None.
"""

from typing import Any, NotRequired, TypedDict

from innervate.analysis.headline import HeadlineEntry


class Measured(TypedDict):
    """What is said of how a run went.

    Attributes:
        seed: the root seed, 0 .. 2^63-1.
        duration_s: simulated time that was asked for.
        events: handler calls and frames that arrived.
        events_per_s: events per second of wall time; None if it took no time.
        wall_s: how long the simulation took.
        fingerprint: 16 hexadecimal digits, the same only for the same run, event by event.
        interrupted_at_s: simulated time at which it was ended early; missing if it was not.
    """

    seed: int
    duration_s: float
    events: int
    events_per_s: int | None
    wall_s: float
    fingerprint: str
    interrupted_at_s: NotRequired[float]


class Common(Measured):
    """The keys that every run's summary has.

    Attributes:
        name: the scenario's.
        headline: is all well, in a sentence.
    """

    name: str
    headline: HeadlineEntry


def measured(result: Any, events: int) -> Measured:
    """How a run of any network went."""
    made: Measured = {
        "seed": result.plan.seed,
        "duration_s": result.plan.duration_us / 1e6,
        "events": events,
        "events_per_s": round(events / result.wall_s) if result.wall_s > 0 else None,
        "wall_s": round(result.wall_s, 6),
        "fingerprint": result.fingerprint,
    }
    if result.interrupted:
        made["interrupted_at_s"] = result.ended_us / 1e6
    return made


class Percentiles(TypedDict):
    """Median, 99th percentile and maximum, in the unit of the key that holds them."""

    p50: float | None
    p99: float | None
    max: float | None
