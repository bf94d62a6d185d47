"""Charts of a radio run: throughput over time, delays, what each station got."""

from collections.abc import Mapping
from typing import Any

import numpy as np

from innervate.networks.radio.analysis import airtime, packets
from innervate.networks.radio.analysis import summary as radio
from innervate.networks.radio.plot.words import fault_words, slots_words
from innervate.plot import words
from innervate.plot.charts import Axis, Bar, Bars, Mark, Steps, distribution

MARKS_MAX = 8
BINS = 60
NOTHING = "No packet was delivered."  # why a chart is empty


def came(result: Any) -> Steps:
    """The packets delivered, so far."""
    begin, slot = packets.first_offer_us(result), result.plan.params["slot_us"]
    ends = (packets.successes(result)["end"] - begin) / slot
    x = Axis(0.0, 1.02 * float(ends[-1]), "slots after the first start")
    y = Axis(0.0, 1.08 * len(ends))
    head = "Packets delivered over time"
    return Steps(np.append(0.0, ends), np.arange(len(ends) + 1), x, y, head)


def filled(result: Any, bins: int = BINS) -> Steps:
    """Which share of the time delivered packets filled, over the run."""
    steps = airtime.airtime_steps(result, bins)
    seconds = steps.time_us / 1e6
    width = float(seconds[1] - seconds[0]) if bins > 1 else 1e-6
    share = 100.0 * steps.values
    x = Axis(float(seconds[0]), float(seconds[-1]) + width, "seconds")
    y = Axis(0.0, 1.08 * max(100.0, float(share.max())))
    marks = [
        Mark(fault.at_us / 1e6, fault_words(fault))
        for fault in result.plan.faults[:MARKS_MAX]
        if x.low <= fault.at_us / 1e6 <= x.high
    ]
    text = f"In % of the time, in steps of {words.ms_words(1e3 * width)}."
    if not share.any():
        text = NOTHING
    return Steps(seconds, share, x, y, "The channel, filled with delivered packets", text, marks)


def delays(result: Any, summary: Mapping[str, Any]) -> Steps | None:
    """How many packets were delivered within which delay."""
    delay = summary["delay_slots"]
    if delay["p50"] is None:
        return None
    found = np.sort(radio.delays(result))
    named = (("p50", "half"), ("p95", "95 %"), ("p99", "99 %"))
    marks = [Mark(delay[key], name) for key, name in named]
    # Quantiles that coincide get one mark: two labels would name the same line.
    marks = [mark for i, mark in enumerate(marks) if i == 0 or mark.at > 1.001 * marks[i - 1].at]
    x = Axis(0.0, 1.15 * max(float(found[-1]), 1.0), "slots from offer to end of frame")
    half, most, nearly = (slots_words(delay[key]) for key, _ in named)
    text = f"Half of them within {half}, 95 % within {most}, 99 % within {nearly}."
    return distribution(found, x, "Packets delivered within a delay, in %", text, marks)


def waits(result: Any) -> Bars:
    """When each station's packet was delivered, in a disaster."""
    who = packets.timed(result)["node"].tolist()
    found = dict(zip(who, radio.delays(result).tolist(), strict=True))
    bars = [
        Bar(f"station {i}", found.get(i, 0.0), slots_words(found[i]) if i in found else "never")
        for i in range(result.plan.stations)
    ]
    text = "Slots from the offer to the end of the frame."
    return Bars(bars, "When each station's packet was delivered", text)


def shares(result: Any, summary: Mapping[str, Any]) -> Bars:
    """Packets that each station got through, against the even share."""
    n = result.plan.stations
    counts = np.bincount(packets.settled(result)["node"], minlength=n).tolist()
    text = "" if summary["jain"] is None else f"Jain's index {summary['jain']:.4f}; 1 is even."
    if summary["jain_round"] is not None:
        text += f" Over one round of {n} turns: {summary['jain_round']:.3f}."
    if result.plan.saturated:
        text = f"{text} Without the first tenth of all packets.".strip()
    if not any(counts):
        return Bars(stations(counts), "Packets delivered, station by station", NOTHING)
    even = sum(counts) / n if n > 1 else None
    return Bars(stations(counts), "Packets delivered, station by station", text, even)


def stations(counts: list[int]) -> list[Bar]:
    """A bar for every station."""
    return [Bar(f"station {i}", count, f"{count:,}") for i, count in enumerate(counts)]
