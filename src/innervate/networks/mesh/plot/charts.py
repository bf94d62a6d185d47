"""Charts of a mesh report: latency, delivery over time, alarms, airtime."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from innervate.networks.mesh.analysis.alarms import Crossing
from innervate.networks.mesh.analysis.messages import (
    DELIVERED,
    NEVER,
    counted,
    latencies_us,
    messages,
)
from innervate.networks.mesh.plot.words import fault_words
from innervate.plot import charts, words
from innervate.plot.page import figure

BINS = 40
STEPS_MAX = 1500
MARKS_MAX = 4
USES = {
    "discovery_s": "discovery",
    "tables_s": "tables",
    "messages_s": "messages",
    "alarms_s": "alarms",
    "beacons_s": "beacons",
}


def latency(result: Any, summary: Mapping[str, Any]) -> str:
    """How many messages were delivered within which time."""
    found = np.sort(latencies_us(messages(result))) / 1e3
    if len(found) == 0:
        return ""
    known = summary["latency_ms"]
    shares = 100.0 * np.arange(1, len(found) + 1) / len(found)
    every = max(1, len(found) // STEPS_MAX)
    at = np.concatenate([[0.0], found[::every], found[-1:]])
    shares = np.concatenate([[0.0], shares[::every], shares[-1:]])
    marks = [charts.Mark(known["p50"], "half"), charts.Mark(known["p99"], "99 %")]
    marks = marks if known["p99"] > 1.001 * known["p50"] else marks[:1]
    head = "Messages delivered within a time, in %"
    x = charts.Axis(0.0, 1.1 * max(float(found[-1]), 1.0), "ms from offer to delivery")
    text = f"Half within {words.ms_words(known['p50'])}, 99 % within {words.ms_words(known['p99'])}"
    drawing = charts.step_chart(at, shares, x, charts.Axis(0.0, 105.0), marks, head)
    return figure(drawing, head, f"{text}, all within {words.ms_words(known['max'])}.")


def over_time(result: Any) -> str:
    """Which share of the messages offered in each part of the run was delivered."""
    found = counted(messages(result))
    if len(found.state) == 0:
        return ""
    low, high = int(found.offered_us.min()), max(int(found.offered_us.max()), 1)
    bins = max(1, min(BINS, len(found.state) // 4))
    width = max((high - low + 1) / bins, 1.0)
    part = ((found.offered_us - low) / width).astype(np.int64).clip(0, bins - 1)
    asked = np.bincount(part, minlength=bins)
    came = np.bincount(part[found.state == DELIVERED], minlength=bins)
    some = np.flatnonzero(asked)
    share = 100.0 * came[some] / asked[some]
    x = charts.Axis(low / 1e6, (low + bins * width) / 1e6, "seconds")
    seen: dict[int, list[str]] = {}
    for fault in result.plan.faults:
        if x.low <= fault.at_us / 1e6 <= x.high:
            seen.setdefault(fault.at_us, []).append(fault_words(result.plan, fault))
    marks = [
        charts.Mark(at / 1e6, what[0] if len(what) == 1 else f"{len(what)} events")
        for at, what in list(seen.items())[:MARKS_MAX]
    ]
    head = "Messages delivered over time, in %"
    text = (
        f"Of those offered in each {words.ms_words(width / 1e3)}; "
        f"lowest {share.min():.3g} %, {len(found.state):,} messages in all."
    )
    drawing = charts.step_chart(
        (low + width * some) / 1e6, share, x, charts.Axis(0.0, 108.0), marks, head
    )
    return figure(drawing, head, text)


def alarms(plan: Any, crossings: Sequence[Crossing]) -> str:
    """When the monitor knew of each crossing."""
    raised = [crossing for crossing in crossings if not crossing.open]
    if not raised:
        return ""
    head = "From the alarm to the monitor, crossing by crossing"
    bars = []
    for crossing in raised:
        came = crossing.accepted_us != NEVER
        took = (crossing.accepted_us - crossing.raised_us) / 1e3 if came else 0.0
        said = f"{words.ms_words(took)}, {crossing.overrun_m:.2f} m" if came else "never"
        bars.append(charts.Bar(f"{crossings.index(crossing) + 1}: {plan.names[crossing.robot]}",
                               took, said))  # fmt: skip
    return figure(charts.bar_chart(bars, head), head, "Behind each bar how far the robot got.")


def airtime(summary: Mapping[str, Any]) -> str:
    """What the air was used for."""
    spent = summary["airtime"]
    whole = sum(spent[key] for key in USES)
    if not whole:
        return ""
    head = "Time on the air, by use"
    bars = [
        charts.Bar(name, spent[key], f"{spent[key]:.3g} s, {100 * spent[key] / whole:.2g} %")
        for key, name in USES.items()
    ]
    text = "Summed over all transmitters; acks of hops count for what they acknowledge."
    return figure(charts.bar_chart(bars, head), head, text)
