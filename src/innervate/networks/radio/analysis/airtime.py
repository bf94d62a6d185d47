"""How much of a radio channel's time delivered packets fill."""

from typing import Any, NamedTuple

import numpy as np

from innervate.networks.radio.analysis.air import Numbers
from innervate.networks.radio.analysis.packets import first_offer_us, settled, successes, traffic_of
from innervate.networks.radio.analysis.state import pending


class Steps(NamedTuple):
    """A step function: `values[i]` from `time_us[i]` on, up to `time_us[i + 1]`."""

    time_us: Any
    values: Any


def observed_until_us(result: Any) -> int:
    """Until when packets could have been delivered: what shares of time are shares of.

    The end of the last success where nothing more was to come: a team that had so many packets to
    deliver, or a disaster in which nobody who is on waits any more. Else the end of the run.
    """
    found, plan = successes(result), result.plan
    goal = plan.wanted > 0 and result.counts["completed"] >= plan.wanted
    if traffic_of(plan) == "disaster":
        goal = goal or not pending(result.world, plan.stations)
    return int(found["end"][-1]) if goal and len(found) else int(result.ended_us)


def throughput(result: Any) -> float | None:
    """Airtime of successful packets over the time observed; None without successes."""
    found, steady = successes(result), settled(result)
    if len(found) == 0:
        return None
    left_out = len(found) - len(steady)
    begun = int(found["end"][left_out - 1]) if left_out else first_offer_us(result)
    steady = steady[steady["end"] > begun]  # packets of one frame end together
    elapsed = observed_until_us(result) - begun
    return float(_airtime_us(result, steady).sum() / elapsed) if elapsed > 0 else None


def airtime_steps(
    result: Any, bins: int = 60, from_us: int | None = None, to_us: int | None = None
) -> Steps:
    """Throughput over time: in each of `bins` equal times the share that successes filled.

    Without limits over the time observed, from the first offer on.
    """
    found = successes(result)
    low = first_offer_us(result) if from_us is None else from_us
    high = max(observed_until_us(result) if to_us is None else to_us, low + 1)
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


def _airtime_us(result: Any, packets: Any) -> Numbers:
    found: Numbers = packets["slots"].astype(np.int64) * int(result.plan.params["slot_us"])
    return found
