"""A skin's run for a terminal, in plain words."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

from innervate.kernel.words import number_of
from innervate.networks.skin.plot import words as skin_words
from innervate.plot import words

if TYPE_CHECKING:
    from innervate.networks.skin.analysis.summary_keys import Commands, Latency, SkinSummary
    from innervate.running import Run

EVENTS_MAX = 8
BROKEN_MAX = 5


def summary_lines(run: Run) -> list[str]:
    """What a person wants to know first."""
    summary = run.skin
    said = words.headline_line(summary["headline"])
    warned = [f"Warning: {text}." for text in summary["warnings"]]
    state = [*_broken(summary), *state_lines(summary), *skin_words.unkept(run.result)]
    return [_first(run), said, *warned, *event_lines(run), *state]


def _first(run: Run) -> str:
    summary, graph = run.skin, run.plan.graph
    length = f"{summary['duration_s']:g} s"
    if "interrupted_at_s" in summary:
        length = f"{words.figure_words(summary['interrupted_at_s'])} of {length}"
    return (
        f"{summary['name']}: {number_of(graph.cells, 'cell')}, "
        f"{number_of(graph.interfaces, 'interface port')}, "
        f"at most {number_of(summary['depth_max'], 'hop')} deep; "
        f"{length} simulated in {words.wall_words(summary['wall_s'])}, "
        f"seed {summary['seed']}"
    )


def event_lines(run: Run) -> list[str]:
    """A sentence for every event of the scenario."""
    summary, plan = run.skin, run.plan
    pairs = list(zip(plan.faults, summary["recoveries"], strict=False))
    lines = [skin_words.headline(plan.graph, *pair) for pair in pairs[:EVENTS_MAX]]
    if len(pairs) > EVENTS_MAX:
        lines.append(f"... and {number_of(len(pairs) - EVENTS_MAX, 'more event')}.")
    return lines + words.interrupted(summary)


def state_lines(summary: SkinSummary) -> list[str]:
    """Lines on samples, interface ports and loops of a run."""
    lines = []
    data, loads = summary["data"], summary["port_loads"]
    if data["loss_ratio"] is not None:
        share = words.share_words(data["loss_ratio"])
        early = skin_words.early_words(data["lost"], summary["lost_at_start"] or 0)
        why = _why(data["lost_by"], skin_words.LOST)
        lines.append(
            f"Samples: {data['sent']:,} sent, {data['lost']:,} lost ({share}){why}"
            f"{early and f'; {early}'}."
        )
        lines += latency_lines(data["latency_ms"])
    lines += command_lines(summary["commands"])
    if len(loads) > 1 and summary["balance_factor"] is not None:
        shown = ", ".join(f"{load:,}" for load in loads[:8]) + (", ..." if len(loads) > 8 else "")
        factor = f"balance factor {summary['balance_factor']:.3f}"
        lines.append(f"Cells behind each interface port: {shown} ({factor}).")
    loops = summary["loops"]
    if loops["longest_ms"] is not None:
        longest = words.stood_words(loops["longest_ms"])
        count = number_of(loops["episodes"], "forwarding loop")
        lines.append(f"{count}, the longest for {longest}.")
    else:
        lines.append("No forwarding loop.")
    return lines


def latency_lines(latency: Latency) -> list[str]:
    """How long samples took; nothing without one."""
    half, nearly, most = latency["p50"], latency["p99"], latency["max"]
    if half is None or nearly is None or most is None:
        return []
    shown = tuple(words.ms_words(value) for value in (half, nearly, most))
    return [
        f"From sensor to PC: half within {shown[0]}, 99 % within {shown[1]}, the slowest "
        f"{shown[2]} (samples received)."
    ]


def command_lines(commands: Commands) -> list[str]:
    """What became of the PC's commands; nothing without one."""
    ratio = commands["loss_ratio"]
    if ratio is None:
        return []
    share, why = words.share_words(ratio), _why(commands["lost_by"], skin_words.MISSED)
    line = (
        f"Commands: {commands['sent']:,} sent, for {commands['addressed']:,} cells in all, "
        f"{commands['lost']:,} not reached ({share}){why}"
    )
    half, most = commands["latency_ms"]["p50"], commands["latency_ms"]["max"]
    if half is None or most is None:
        return [f"{line}."]
    took = f"half within {words.ms_words(half)}, the slowest {words.ms_words(most)}"
    return [f"{line}; {took}."]


def _why(lost_by: Mapping[str, int], words: Mapping[str, str]) -> str:
    """The reasons of what was lost, the greatest first."""
    lost = sorted(((n, why) for why, n in lost_by.items() if n), reverse=True)
    return "".join(f", {n:,} {words.get(why, why)}" for n, why in lost)


def _broken(summary: SkinSummary) -> list[str]:
    cables = skin_words.broken_cables(summary["broken"])
    if not cables:
        return ["No cable is broken at the end."]
    lines = [f"Broken at the end: {cable}." for cable in cables[:BROKEN_MAX]]
    if len(cables) > BROKEN_MAX:
        lines.append(f"... and {len(cables) - BROKEN_MAX} more.")
    return lines
