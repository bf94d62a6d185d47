"""The summary of a radio run: what a person wants to know of it, as plain numbers and words.

A *success* is a packet that its sender takes for delivered and that somebody did receive. In
saturation the first tenth of the successes is left out of every mean: the channel settles there.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from innervate.analysis import radio_headline, radio_state
from innervate.analysis.radio_air import Air, Groups, Heard, Numbers, air, groups, signals
from innervate.analysis.radio_summary import BoundsNoticed, Delays, RadioSummary
from innervate.protocol.radio_words import REPORT_BOUNDS

__all__ = [
    "Air",
    "Groups",
    "Heard",
    "Steps",
    "air",
    "airtime_steps",
    "bounds_noticed",
    "delay_slots",
    "delays",
    "duration_us",
    "fifo",
    "first_offer_us",
    "groups",
    "jain",
    "jain_round",
    "order",
    "settled",
    "signals",
    "successes",
    "summarize",
    "throughput",
    "traffic_of",
]

ORDER_MAX = 1000
PAIRS_FROM = 20_000  # successes whose order is looked at
WARM_UP = 10  # in saturation one in so many successes is left out


class Steps(NamedTuple):
    """A step function: `values[i]` from `time_us[i]` on, up to `time_us[i + 1]`."""

    time_us: Any
    values: Any


def summarize(result: Any, name: str | None = None) -> RadioSummary:
    """The summary of a run; what never happened is None.

    Args:
        result: of `sim.radio.simulate`, with its rows kept.
        name: what to call it, where its plan has no scenario.
    """
    plan, counts = result.plan, result.counts
    events = counts["handled"] + counts["decoded"]
    found, steady = successes(result), settled(result)
    spent = np.bincount(steady["node"], minlength=plan.stations)
    length = duration_us(result)
    summary: RadioSummary = {
        "kind": plan.kind,
        "name": name or getattr(plan.scenario, "name", None) or plan.protocol,
        "headline": radio_headline.headline(facts(result)).as_summary(),
        "seed": plan.seed,
        "duration_s": plan.duration_us / 1e6,
        "events": events,
        "events_per_s": round(events / result.wall_s) if result.wall_s > 0 else None,
        "wall_s": round(result.wall_s, 6),
        "fingerprint": result.fingerprint,
        "protocol": plan.protocol,
        "traffic": traffic_of(plan),
        "stations": plan.stations,
        "throughput": throughput(result),
        "duration_slots": None if length is None else length / plan.params["slot_us"],
        "jain": jain(spent),
        "jain_round": jain_round(result),
        "delay_slots": delay_slots(result),
        "collisions": int(np.count_nonzero(groups(result).collision)),
        "offered": counts["offers"],
        "delivered": len(found),
        "lost_silently": counts["silent"],
        "partial": counts["partial"],
        "dropped": counts["dropped"],
        "duplicates": counts["again"],
        "frame_errors": counts["garbled"],
        "fifo": fifo(result),
        "bounds_noticed": bounds_noticed(result),
        "order": order(result),
    }
    if result.interrupted:
        summary["interrupted_at_s"] = result.ended_us / 1e6
    return summary


def facts(result: Any) -> radio_headline.RadioFacts:
    """What the headline of a finished run is made of."""
    found = successes(result)
    noticed = bounds_noticed(result)
    return radio_state.facts(
        result.world,
        result.plan,
        result.ended_us,
        int(found["time"].max()) if len(found) else 0,
        ended=not result.interrupted,
    )._replace(
        bounds=noticed if noticed["count"] else None,
        stations_wrong=tuple(one["station"] for one in noticed["stations"]),
    )


def traffic_of(plan: Any) -> str:
    """What stations had to send: "saturated", "disaster" (one packet each) or "poisson"."""
    if plan.saturated:
        return "saturated"
    return "disaster" if max(map(len, plan.arrivals), default=0) <= 1 else "poisson"


def successes(result: Any) -> Any:
    """Packets that were delivered, in the order in which their frames ended."""
    packets = result.packets[result.packets["receivers"] > 0]
    return packets[np.argsort(packets["end"], kind="stable")]


def settled(result: Any) -> Any:
    """The successes that means are made of: in saturation without the first tenth."""
    found = successes(result)
    return found[len(found) // WARM_UP :] if result.plan.saturated else found


def first_offer_us(result: Any) -> int:
    """When the first packet was offered."""
    offers = [times[0] for times in result.plan.arrivals if len(times)]
    return min(offers, default=0)


def duration_us(result: Any) -> int | None:
    """From the first offer to the end of the last success; None without one."""
    found = successes(result)
    return int(found["end"][-1]) - first_offer_us(result) if len(found) else None


def throughput(result: Any) -> float | None:
    """Airtime of successful packets over the time elapsed; None without successes."""
    found, steady = successes(result), settled(result)
    if len(found) == 0:
        return None
    left_out = len(found) - len(steady)
    begun = int(found["end"][left_out - 1]) if left_out else first_offer_us(result)
    steady = steady[steady["end"] > begun]  # packets of one frame end together
    elapsed = int(found["end"][-1]) - begun
    return float(_airtime_us(result, steady).sum() / elapsed) if elapsed > 0 else None


def _airtime_us(result: Any, packets: Any) -> Numbers:
    found: Numbers = packets["slots"].astype(np.int64) * int(result.plan.params["slot_us"])
    return found


def jain(counts: Any) -> float | None:
    """Jain's index of fairness, (sum x)^2 / (n sum x^2): 1 = even, 1/n = one has it all.

    None if nobody has anything.
    """
    shares = np.asarray(counts, np.float64)
    squares = float((shares**2).sum())
    return float(shares.sum() ** 2 / (len(shares) * squares)) if squares else None


def jain_round(result: Any) -> float | None:
    """Mean of Jain's index over windows of one round: as many turns in a row as stations.

    A turn is a frame, however many packets it carried. None with less than a round of turns.
    """
    steady, n = settled(result), result.plan.stations
    if len(steady) == 0:
        return None
    fresh = np.ones(len(steady), np.bool_)
    fresh[1:] = (np.diff(steady["end"]) != 0) | (np.diff(steady["node"]) != 0)
    turns = steady["node"][fresh].astype(np.int64)
    rounds = len(turns) // n
    if rounds == 0:
        return None
    place = turns[: rounds * n] + n * np.repeat(np.arange(rounds), n)
    each = np.bincount(place, minlength=rounds * n).reshape(rounds, n).astype(np.float64)
    return float(np.mean(n / (each**2).sum(axis=1)))


def delays(result: Any) -> Any:
    """Slots from offer to end of the successful frame, of every settled success."""
    steady = settled(result)
    return (steady["end"] - steady["offered"]) / result.plan.params["slot_us"]


def delay_slots(result: Any) -> Delays:
    """Median, 95th and 99th percentile and maximum of the delays, in slots."""
    found = delays(result)
    if len(found) == 0:
        return {"p50": None, "p95": None, "p99": None, "max": None}
    p50, p95, p99 = np.percentile(found, (50, 95, 99)).tolist()
    return {"p50": p50, "p95": p95, "p99": p99, "max": float(found.max())}


def order(result: Any) -> list[int]:
    """Stations in the order of success: all in a disaster, else the first thousand."""
    found = successes(result)["node"]
    if traffic_of(result.plan) != "disaster":
        found = found[:ORDER_MAX]
    stations: list[int] = found.tolist()
    return stations


def fifo(result: Any) -> float | None:
    """Share of pairs that were served in the order of their offers.

    Pairs are packets of different stations, offered at different times, that waited together: the
    one that was served later was there when the other one's frame ended. Looked for among packets
    with less than a round between them. None without pairs.
    """
    steady = settled(result)[:PAIRS_FROM]
    offered, end, node = steady["offered"], steady["end"], steady["node"]
    pairs = kept = 0
    for apart in range(1, min(result.plan.stations, len(steady))):
        early, late = slice(None, -apart), slice(apart, None)
        waited = (node[early] != node[late]) & (offered[late] < end[early])
        waited &= offered[early] != offered[late]
        pairs += int(np.count_nonzero(waited))
        kept += int(np.count_nonzero(waited & (offered[early] < offered[late])))
    return kept / pairs if pairs else None


def bounds_noticed(result: Any) -> BoundsNoticed:
    """How often stations noticed a pair delay outside the configured bounds; who, and how long.

    `stations` has for each its number, how often, and the least and greatest delay it measured.
    """
    rows = result.rows[result.rows["code"] == REPORT_BOUNDS]
    measured = rows["a"].astype(np.float64)
    return {
        "count": len(rows),
        "stations": [
            {
                "station": node,
                "count": int(np.count_nonzero(rows["node"] == node)),
                "delay_us": {
                    "min": float(measured[rows["node"] == node].min()),
                    "max": float(measured[rows["node"] == node].max()),
                },
            }
            for node in np.unique(rows["node"]).tolist()
        ],
    }


def airtime_steps(
    result: Any, bins: int = 60, from_us: int | None = None, to_us: int | None = None
) -> Steps:
    """Throughput over time: in each of `bins` equal times the share that successes filled.

    Without limits from the first offer to the end of the last success.
    """
    found = successes(result)
    low = first_offer_us(result) if from_us is None else from_us
    last = int(found["end"][-1]) if len(found) else result.ended_us
    high = max(last if to_us is None else to_us, low + 1)
    edges = np.linspace(low, high, bins + 1)
    start, end = _spans(result, found)
    # Time filled up to a moment: what had begun by then, less what of it was yet to come.
    filled = _elapsed(edges, start) - _elapsed(edges, end)
    return Steps(edges[:-1], np.diff(filled) * bins / (high - low))


def _spans(result: Any, found: Any) -> tuple[Numbers, Numbers]:
    """When each success was on the air; packets of one frame stand one behind the other."""
    airtime = _airtime_us(result, found)
    total = np.cumsum(airtime)
    same = np.zeros(len(found), np.bool_)
    same[1:] = (np.diff(found["end"]) == 0) & (np.diff(found["node"]) == 0)
    # The last packet of every frame, for each packet: what of the frame is still behind it.
    last = np.flatnonzero(~np.append(same[1:], False)) if len(found) else np.zeros(0, np.int64)
    mine = np.searchsorted(last, np.arange(len(found)))
    end = found["end"] - (total[last[mine]] - total) if len(found) else found["end"]
    return end - airtime, end


def _elapsed(times: Any, since: Numbers) -> Any:
    """Sum over all `since` of the time elapsed since then, at each of the times."""
    ordered = np.sort(since).astype(np.float64)
    sums = np.concatenate([[0.0], np.cumsum(ordered)])
    begun = np.searchsorted(ordered, times, "right")
    return begun * times - sums[begun]
