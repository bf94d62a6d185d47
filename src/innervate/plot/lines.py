"""A run of any network for a terminal, in plain words."""

from collections.abc import Mapping
from typing import Any

from innervate.kernel.words import number_of
from innervate.plot.words import figure_words, headline_line, ms_words, wall_words


def summary_lines(run: Any) -> list[str]:
    """What a person wants to know first."""
    summary = run.summary
    simulated = figure_words(run.result.ended_us / 1e6, 4)
    took = f"{simulated} s simulated in {wall_words(summary['wall_s'])}"
    first = f"{summary['name']}: {number_of(summary['nodes'], 'node')}; {took}, "
    lines = [f"{first}seed {summary['seed']}", headline_line(summary["headline"])]
    is_shared = run.result.counts.is_shared
    lines += [f"{line}." for line in traffic_lines(summary, is_shared)]
    if "interrupted_at_s" in summary:
        lines.append(f"Interrupted at {summary['interrupted_at_s']:.3f} s of simulated time.")
    return lines


def traffic_lines(summary: Mapping[str, Any], is_shared: bool = False) -> list[str]:
    """Frames, messages and latencies, a sentence each, without full stops.

    `is_shared`: on the air, where a frame counts as a reception for each that could hear it.
    """
    frames, messages = summary["frames"], summary["messages"]
    counted, sent = ("Receptions", "due") if is_shared else ("Frames", "sent")
    lines = [
        f"{counted}: {frames['sent']:,} {sent}, {frames['arrived']:,} arrived, "
        f"{frames['lost']:,} lost{_reasons(frames['lost_by']).replace(', ', ': ', 1)}"
    ]
    if messages["sent"] or messages["delivered"]:
        # A protocol that hands up what no user gave (a token, say) delivers without being sent.
        offered, came = messages["sent"], messages["delivered"]
        given = f"{offered:,} sent, " if offered else ""
        told = f"delivered {came:,} times" if came > offered > 0 else f"{came:,} delivered"
        lines.append(f"Messages: {given}{told}{_reasons(messages['dropped_by'])}")
    latency = messages["latency_ms"]
    if latency["p50"] is not None:
        shown = [ms_words(latency[name]) for name in ("p50", "p99", "max")]
        lines.append(f"Latency: half within {shown[0]}, 99 % within {shown[1]}, all within "
                     f"{shown[2]}")  # fmt: skip
    lines += [f"{name}: {measured(value)}" for name, value in summary.get("measures", {}).items()]
    return lines


def measured(value: float | None) -> str:
    """A figure of a network's own."""
    if value is None:
        return "none"
    return f"{value:,}" if isinstance(value, int) else f"{value:,.4g}"


def _reasons(lost_by: Mapping[str, int]) -> str:
    """The greatest first: ", 12 cut, 3 noise"."""
    found = sorted(((count, why) for why, count in lost_by.items() if count), reverse=True)
    return "".join(f", {count:,} {why.replace('_', ' ')}" for count, why in found)
