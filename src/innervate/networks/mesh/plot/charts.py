"""Charts of a mesh: latency, delivery over time, alarms, airtime."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from innervate.kernel.words import number_of
from innervate.networks.mesh.analysis import messages as sent
from innervate.networks.mesh.analysis.alarms import Crossing
from innervate.networks.mesh.plot.words import fault_words
from innervate.plot import words
from innervate.plot.charts import Axis, Bar, Bars, Mark, Steps, distribution, marked

BINS = 40
MARKS_MAX = 4
USES = ("discovery", "tables", "messages", "alarms", "beacons")


def latency(result: Any, summary: Mapping[str, Any]) -> Steps | None:
    """How many messages were delivered within which time."""
    found = np.sort(sent.latencies_us(sent.messages(result))) / 1e3
    if len(found) == 0:
        return None
    known = summary["latency_ms"]
    marks = [Mark(known["p50"], "half"), Mark(known["p99"], "99 %")]
    x = Axis(0.0, 1.1 * max(float(found[-1]), 1.0), "ms from offer to delivery")
    half, most, whole = (words.ms_words(known[key]) for key in ("p50", "p99", "max"))
    return distribution(
        found, x, "Messages delivered within a time, in %",
        f"Half within {half}, 99 % within {most}, all within {whole}.",
        marks if known["p99"] > 1.001 * known["p50"] else marks[:1],
    )  # fmt: skip


def over_time(result: Any, bins: int = BINS) -> Steps | None:
    """Which share of the messages offered in each part of the run was delivered."""
    found = sent.counted(sent.messages(result))
    if len(found.state) == 0:
        return None
    low, high = int(found.offered_us.min()), max(int(found.offered_us.max()), 1)
    bins = max(1, min(bins, len(found.state) // 4))
    width = max((high - low + 1) / bins, 1.0)
    part = ((found.offered_us - low) / width).astype(np.int64).clip(0, bins - 1)
    asked = np.bincount(part, minlength=bins)
    came = np.bincount(part[found.state == sent.DELIVERED], minlength=bins)
    some = np.flatnonzero(asked)
    share = 100.0 * came[some] / asked[some]
    x = Axis(low / 1e6, (low + bins * width) / 1e6, "seconds")
    lowest = words.share_words(share.min() / 100)
    whole = number_of(len(found.state), "message")
    text = f"{lowest} of {whole}."
    if bins > 1:
        each = words.ms_words(width / 1e3)
        text = f"Of those offered in each {each}; lowest {lowest}, {whole} in all."
    head = "Messages delivered over time, in %"
    at = (low + width * some) / 1e6
    return Steps(at, share, x, Axis(0.0, 108.0), head, text, _marks(result.plan, x))


def _marks(plan: Any, x: Axis) -> list[Mark]:
    inside = [fault for fault in plan.faults if x.low <= fault.at_us / 1e6 <= x.high]
    return marked(((fault.at_us, fault_words(plan, fault)) for fault in inside), MARKS_MAX)


def alarms(plan: Any, crossings: Sequence[Crossing]) -> Bars | None:
    """When the monitor knew of each crossing."""
    bars = []
    for i, crossing in enumerate(crossings, 1):
        if crossing.open:
            continue
        came = crossing.accepted_us != sent.NEVER
        took = (crossing.accepted_us - crossing.raised_us) / 1e3 if came else 0.0
        out = words.figure_words(crossing.overrun_m, 2)
        said = f"{words.ms_words(took)}, {out} m" if came else "never"
        bars.append(Bar(f"{i}: {plan.names[crossing.robot]}", took, said))
    head = "From the alarm to the monitor, crossing by crossing"
    return Bars(bars, head, "Behind each bar how far the robot got.") if bars else None


def airtime(summary: Mapping[str, Any]) -> Bars | None:
    """What the air was used for."""
    spent = {name: summary["airtime"][f"{name}_s"] for name in USES}
    whole = sum(spent.values())
    if not whole:
        return None
    bars = []
    for name, some in spent.items():
        share = words.figure_words(100 * some / whole, 2)
        bars.append(Bar(name, some, f"{words.figure_words(some)} s, {share} %"))
    text = "Summed over all transmitters; acks of hops count for what they acknowledge."
    return Bars(bars, "Time on the air, by use", text)
