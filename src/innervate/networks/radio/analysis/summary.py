"""The summary of a radio run: what a person wants to know of it, as plain numbers and words.

A *success* is a packet that its sender takes for delivered and that somebody did receive. In
saturation the first tenth of the successes is left out of every mean: the channel settles there.
"""

from typing import Any

import numpy as np

from innervate.analysis.percentiles import percentiles
from innervate.analysis.summary_common import measured
from innervate.networks.radio.analysis import headline as radio_headline
from innervate.networks.radio.analysis import packets
from innervate.networks.radio.analysis import state as radio_state
from innervate.networks.radio.analysis.air import groups
from innervate.networks.radio.analysis.airtime import throughput
from innervate.networks.radio.analysis.summary_keys import BoundsNoticed, Delays, RadioSummary
from innervate.networks.radio.protocol.constants import REPORT_BOUNDS

ORDER_MAX = 1000
PAIRS_FROM = 20_000  # successes whose order is looked at


def summarize(result: Any, name: str | None = None) -> RadioSummary:
    """The summary of a run whose rows were kept; what never happened is None.

    `name` is what to call it, where its plan has no scenario.
    """
    plan, counts = result.plan, result.counts
    found, steady = packets.successes(result), packets.settled(result)
    spent = np.bincount(steady["node"], minlength=plan.stations)
    length, known = duration_us(result), facts(result)
    return {
        "kind": plan.kind,
        "name": name or getattr(plan.scenario, "name", None) or plan.protocol,
        "headline": radio_headline.headline(known).as_summary(),
        **measured(result, counts["handled"] + counts["decoded"]),
        "protocol": plan.protocol,
        "traffic": packets.traffic_of(plan),
        "stations": plan.stations,
        "throughput": throughput(result),
        "duration_slots": None if length is None else length / plan.params["slot_us"],
        "jain": jain(spent),
        "jain_round": jain_round(result),
        "delay_slots": delay_slots(result),
        "waited_off": len(steady) - len(packets.timed(result)),
        "collisions": int(np.count_nonzero(groups(result).collision)),
        "offered": counts["offers"],
        "delivered": len(found),
        "pending": known.pending,
        "abandoned": known.abandoned,
        "lost_silently": counts["silent"],
        "partial": counts["partial"],
        "dropped": counts["dropped"],
        "duplicates": counts["again"],
        "frame_errors": counts["garbled"],
        "fifo": fifo(result),
        "bounds_noticed": bounds_noticed(result),
        "order": order(result),
    }


def facts(result: Any) -> radio_headline.RadioFacts:
    """What the headline of a finished run is made of."""
    found = packets.successes(result)
    known = radio_state.facts(
        result.world,
        result.plan,
        result.ended_us,
        int(found["time"].max()) if len(found) else 0,
        ended=not result.interrupted,
    )
    noticed = bounds_noticed(result)["stations"]
    if not noticed:
        return known
    params = result.plan.params
    bounds = {"believed_us": [params["dmin_us"], params["dmax_us"]]}
    wrong = tuple(one["station"] for one in noticed)
    return known._replace(bounds=bounds, stations_wrong=wrong)


def duration_us(result: Any) -> int | None:
    """From the first offer to the end of the last success; None without one."""
    found = packets.successes(result)
    return int(found["end"][-1]) - packets.first_offer_us(result) if len(found) else None


def jain(counts: Any) -> float | None:
    """Jain's index of fairness, (sum x)^2 / (n sum x^2): 1 = even, 1/n = one has it all.

    None if nobody has anything. Jain, Chiu, Hawe 1984.
    """
    shares = np.asarray(counts, np.float64)
    squares = float((shares**2).sum())
    return float(shares.sum() ** 2 / (len(shares) * squares)) if squares else None


def jain_of_rounds(stations: Any, n: int) -> float | None:
    """Mean of Jain's index over windows of one round: as many turns in a row as stations, n.

    `stations` has whose each turn was. None with less than a round of turns.
    """
    rounds = len(stations) // n
    if rounds == 0:
        return None
    place = np.asarray(stations[: rounds * n], np.int64) + n * np.repeat(np.arange(rounds), n)
    each = np.bincount(place, minlength=rounds * n).reshape(rounds, n).astype(np.float64)
    return float(np.mean(n / (each**2).sum(axis=1)))


def jain_round(result: Any) -> float | None:
    """The same of a run; a turn is a frame, however many packets it carried."""
    steady = packets.settled(result)
    fresh = np.ones(len(steady), np.bool_)
    fresh[1:] = (np.diff(steady["end"]) != 0) | (np.diff(steady["node"]) != 0)
    return jain_of_rounds(steady["node"][fresh], result.plan.stations)


def delays(result: Any) -> Any:
    """Slots from offer to end of the successful frame, of every success of `timed`."""
    found = packets.timed(result)
    return (found["end"] - found["offered"]) / result.plan.params["slot_us"]


def delay_slots(result: Any) -> Delays:
    """Median, 95th and 99th percentile and maximum of the delays, in slots."""
    p50, p95, p99, most = percentiles(delays(result), (50, 95, 99, 100))
    return {"p50": p50, "p95": p95, "p99": p99, "max": most}


def order(result: Any) -> list[int]:
    """Stations in the order of success: all in a disaster, else the first thousand."""
    found = packets.successes(result)["node"]
    if packets.traffic_of(result.plan) != "disaster":
        found = found[:ORDER_MAX]
    stations: list[int] = found.tolist()
    return stations


def fifo(result: Any) -> float | None:
    """Share of pairs that were served in the order of their offers.

    Pairs are packets of different stations, offered at different times, that waited together: the
    one that was served later was there when the other one's frame ended. Looked for among packets
    with less than a round between them. None without pairs.
    """
    steady = packets.timed(result)[:PAIRS_FROM]
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

    `stations` has for each its number, how often, and the least and greatest of what it took for
    the delay; it is a guess: a CR-R that comes too early looks late in the minislot before its own.
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
