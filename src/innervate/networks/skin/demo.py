"""The skin's chapter of `innervate demo`: a cable is cut, the network mends itself."""

from __future__ import annotations

from typing import TYPE_CHECKING

from innervate.networks.skin import show
from innervate.networks.skin.plot.words import fault_words
from innervate.plot.words import ms_words, wall_words

if TYPE_CHECKING:
    from innervate.networks.skin.analysis.summary_keys import Recovery
    from innervate.running import Run

SCENARIO = "demo"
INTRODUCTION = (
    "A robot's skin: cells wired to their neighbours, a few of them to the PC.",
    "Every cell sends what it feels from cell to cell. Now a cable to the PC is cut.",
)
LOOK = "Look at it in a browser"
NEXT = (("innervate run demo --set protocol.updates=periodic", "as published, slower to recover"),)


def lines(run: Run) -> list[str]:
    """What happened, line by line."""
    summary, plan = run.skin, run.plan
    graph = plan.graph
    found = [
        f"{graph.cells} cells, {graph.interfaces} cables to the PC, "
        f"{plan.params['beacon_us'] / 1000:g} ms between a cell's beacons"
    ]
    for fault, recovery in zip(plan.faults, summary["recoveries"], strict=False):
        found += ["", f"{recovery['at_s']:.3f} s   {fault_words(graph, fault)}"]
        found += [f"{when:>10}   {then}" for when, then in _steps(recovery, graph.cells)]
    took = f"{summary['duration_s']:g} s were simulated in {wall_words(summary['wall_s'])}."
    return [*found, "", *show.state_lines(summary), "", took]


def _steps(recovery: Recovery, cells: int) -> list[tuple[str, str]]:
    """What followed an event, in order of time."""
    cut, settled = recovery["cut_cells"], recovery["converged_ms"]
    steps: list[tuple[float, str]] = []
    if cut:
        have = "has lost its" if cut == 1 else "have lost their"
        steps.append((0.0, f"{cut} of {cells} cells {have} way to the PC"))
    if recovery["detected_ms"]:
        steps.append((recovery["detected_ms"], "the cell at the cable has noticed"))
    gone, routed = recovery["cut_off"], recovery["others_ms"]
    if gone:
        are, whom = ("is", "it") if gone == 1 else ("are", "them")
        steps.append(
            (0.0, f"{gone} of {cells} cells {are} cut off: no cable joins {whom} any more")
        )
    if routed:
        whom = "every other cell" if recovery["cut_off_total"] else "every cell"
        steps.append((routed, f"{whom} has a way again"))
    elif settled and recovery["routed_ms"] == 0:
        steps.append((settled, "the cells share both cables again; none lost its way meanwhile"))
    return [("at once" if ms == 0 else f"+{ms_words(ms)}", what) for ms, what in sorted(steps)]
