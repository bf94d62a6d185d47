"""The mesh's chapter of `innervate demo`: nodes die unnoticed, the alarm finds a way."""

from __future__ import annotations

from itertools import groupby
from typing import TYPE_CHECKING

from innervate.kernel.words import number_of
from innervate.networks.mesh.analysis.alarms import Crossing, all_crossings
from innervate.networks.mesh.analysis.messages import NEVER
from innervate.networks.mesh.plot.words import sentences
from innervate.plot.words import ms_words, wall_words

if TYPE_CHECKING:
    from innervate.running import Run

SCENARIO = "mesh-field"
INTRODUCTION = (
    "A fenced field, nodes that pass on each other's messages, and a robot. One node, the",
    "gateway, finds out who hears whom and tells everybody the way to everybody. Then some",
    "nodes die, which nobody knows, and the robot walks out.",
)
LOOK = "Look at it in a browser, with the alarm in slow motion"
NEXT = (("innervate run mesh-document", "a mesh read to the letter: many messages get lost"),)


def lines(run: Run) -> list[str]:
    """What happened, line by line."""
    summary, plan = run.mesh, run.plan
    reach = 2 * summary["links"] / plan.nodes
    told = sentences(run.result, summary)
    return [
        f"{plan.nodes} nodes, each with about {reach:.0f} others in good reach",
        "",
        *(f"{when:>10}   {then}" for when, then in _steps(run)),
        "",
        *(told[1:] if summary["alarms"]["sent"] else told),  # the steps have the alarms
        "",
        f"{summary['duration_s']:g} s were simulated in {wall_words(summary['wall_s'])}.",
    ]


def _steps(run: Run) -> list[tuple[str, str]]:
    """What happened in the field, in order of time; after a crossing counted from it."""
    summary, plan = run.mesh, run.plan
    steps: list[tuple[float, str, str]] = []
    if summary["discovery"]["tables_s"] is not None:
        at = summary["gateways"][0]["at_s"] + summary["discovery"]["tables_s"]
        steps.append((at, f"{at:.3f} s", "every node knows the way to every other"))
    for at_us, faults in groupby(plan.faults, key=lambda fault: fault.at_us):
        count = len(list(faults))
        what = f"{number_of(count, 'node')} switched off; nobody is told"
        steps.append((at_us / 1e6, f"{at_us / 1e6:.3f} s", what))
    for crossing in all_crossings(run.result):
        out_us = crossing.crossed_us
        steps.append((out_us / 1e6, f"{out_us / 1e6:.3f} s", "the robot is outside the fence"))
        for at, what in (
            (crossing.raised_us, "it notices, and raises the alarm"),
            (crossing.accepted_us, _knows(crossing)),
        ):
            if at != NEVER:
                steps.append((at / 1e6, f"+{ms_words((at - out_us) / 1e3)}", what))
    return [(when, what) for _at, when, what in sorted(steps, key=lambda step: step[0])]


def _knows(crossing: Crossing) -> str:
    hops = number_of(crossing.hops, "hop")
    return f"the monitor has it, over {hops}; the robot got {crossing.overrun_m * 100:.1f} cm out"
