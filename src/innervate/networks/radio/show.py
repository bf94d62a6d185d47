"""A radio run's summary for a terminal, in plain words."""

from __future__ import annotations

from typing import TYPE_CHECKING

from innervate.kernel.words import number_of
from innervate.networks.radio.plot.words import off_words, slots_words
from innervate.networks.radio.scenario.rules import outside
from innervate.networks.radio.scenario.words import warnings
from innervate.plot import words

if TYPE_CHECKING:
    from innervate.networks.radio.analysis.summary_keys import RadioSummary, SlottedSummary
    from innervate.running import Run


def summary_lines(run: Run) -> list[str]:
    """What a person wants to know first."""
    return [
        _first(run),
        words.headline_line(_summary(run)["headline"]),
        *result_lines(run),
        *_noticed(run),
    ]


def _summary(run: Run) -> RadioSummary | SlottedSummary:
    return run.slotted if "level" in run.summary else run.radio


def _first(run: Run) -> str:
    summary, plan = _summary(run), run.plan
    return (
        f"{summary['name']}: {number_of(plan.stations, 'station')} on one channel, "
        f"{summary['protocol']}, packets of at most {plan.params['packet_slots']} slots; "
        f"{words.simulated(run.result, summary)}, seed {summary['seed']}"
    )


def result_lines(run: Run) -> list[str]:
    """Lines on a run: packets delivered, delays, fairness, and what is amiss."""
    summary = _summary(run)
    lines = [_delivered(run), *off_words(summary), *warnings(run.plan)]
    delay = summary["delay_slots"]
    half, most, longest = delay["p50"], delay["p99"], delay["max"]
    if half is not None and most is not None and longest is not None:
        lines.append(
            f"Delay from offer to the end of the frame: half within {slots_words(half)}, "
            f"99 % within {slots_words(most)}, all within {slots_words(longest)}."
        )
    if summary["throughput"] is not None:
        share = words.share_words(summary["throughput"])
        jain = "" if summary["jain"] is None else f"; fairness (Jain) {summary['jain']:.3f}"
        lines.append(f"Packets fill {share} of the channel's time{jain}.")
    lines.append(
        f"{number_of(summary['collisions'], 'collision')}; "
        f"{number_of(summary['lost_silently'], 'packet')} lost without the sender knowing."
    )
    return lines + words.interrupted(summary)


def _delivered(run: Run) -> str:
    summary, plan = _summary(run), run.plan
    slots = summary["duration_slots"]
    after = ""
    if slots is not None:
        ms = slots * plan.params["slot_us"] / 1000
        after = f", the last {slots_words(slots)} ({words.ms_words(ms)}) after the first offer"
    return f"{number_of(summary['delivered'], 'packet')} delivered{after}."


def _noticed(run: Run) -> list[str]:
    summary = _summary(run)
    if "level" in summary or not summary["bounds_noticed"]["count"] or run.plan.pairs.hidden:
        return []
    if outside(run.plan.scenario.model):  # said already
        return []
    return [
        "Delays between stations lie outside the configured bounds; set protocol.tau_bounds_us "
        "to what is true."
    ]
