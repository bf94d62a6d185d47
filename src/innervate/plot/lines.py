"""A run of any network for a terminal, in plain words."""

from collections.abc import Mapping
from typing import Any

from innervate.analysis.summary import times_words
from innervate.kernel.words import number_of
from innervate.plot.words import headline_line, interrupted, ms_words, simulated
from innervate.sim.counts import Counts


def summary_lines(run: Any) -> list[str]:
    """What a person wants to know first."""
    summary = run.summary
    took = simulated(run.result, summary)
    first = f"{summary['name']}: {number_of(summary['nodes'], 'node')}; {took}, "
    lines = [f"{first}seed {summary['seed']}", headline_line(summary["headline"])]
    lines += [f"{line}." for line in traffic_lines(summary, run.result.counts)]
    return lines + interrupted(summary)


def traffic_lines(summary: Mapping[str, Any], counts: Counts) -> list[str]:
    """Frames, messages and latencies, a sentence each, without full stops.

    On the air a frame counts as a reception for each that could hear it.
    """
    frames, messages = summary["frames"], summary["messages"]
    counted, sent = ("Receptions", "due") if counts.is_shared else ("Frames", "sent")
    lines = [
        f"{counted}: {frames['sent']:,} {sent}, {frames['arrived']:,} arrived, "
        f"{frames['lost']:,} lost{_reasons(frames['lost_by']).replace(', ', ': ', 1)}"
    ]
    if messages["sent"] or messages["delivered"]:
        # A protocol that hands up what no user gave (a token, say) delivers without being sent.
        given = f"{messages['sent']:,} sent, " if messages["sent"] else ""
        lines.append(f"Messages: {given}{_delivered(counts)}{_reasons(messages['dropped_by'])}")
    latency = messages["latency_ms"]
    if latency["p50"] is not None:
        shown = [ms_words(latency[name]) for name in ("p50", "p99", "max")]
        lines.append(f"Latency: half within {shown[0]}, 99 % within {shown[1]}, all within "
                     f"{shown[2]}")  # fmt: skip
    lines += [f"{name}: {measured(value)}" for name, value in summary.get("measures", {}).items()]
    return lines


def _delivered(counts: Counts) -> str:
    """How many messages were delivered, and how often, where these differ."""
    heard = counts.offered - counts.unheard
    if counts.unheard and 0 < heard < counts.delivered:
        return f"{heard:,} of them {times_words(counts)}"
    return times_words(counts) if counts.delivered > counts.offered > 0 else (
        f"{counts.delivered:,} delivered")  # fmt: skip


def measured(value: float | None) -> str:
    """A figure of a network's own."""
    if value is None:
        return "none"
    return f"{value:,}" if isinstance(value, int) else f"{value:,.4g}"


def _reasons(lost_by: Mapping[str, int]) -> str:
    """The greatest first: ", 12 cut, 3 noise"."""
    found = sorted(((count, why) for why, count in lost_by.items() if count), reverse=True)
    return "".join(f", {count:,} {why.replace('_', ' ')}" for count, why in found)
