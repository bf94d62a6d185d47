"""`innervate demo`: one chapter for each kind of network."""

from __future__ import annotations

import webbrowser
from collections.abc import Callable
from dataclasses import dataclass
from itertools import groupby
from pathlib import Path
from typing import TYPE_CHECKING

from innervate.cli import errors, show
from innervate.cli.running import simulate
from innervate.plot import mesh_words, words

if TYPE_CHECKING:
    from innervate.analysis.mesh_alarms import Crossing
    from innervate.analysis.skin_summary import Recovery
    from innervate.running import Run


@dataclass(frozen=True, slots=True)
class Told:
    """A chapter that was run: its report, and whether it was ended early."""

    report: Path
    interrupted: bool


def demo(seed: int | None, out: Path | None, open_report: bool) -> int:
    """Run all chapters; print what happened and where the reports are."""
    for chapter in CHAPTERS:
        told = chapter(seed, out)
        if open_report:
            webbrowser.open(told.report.resolve().as_uri())
        if told.interrupted:
            return errors.INTERRUPTED
    print()
    print("Next:")
    for command, what in _NEXT:
        print(f"  {command:<57}{what}")
    return 0


_NEXT = (
    ("innervate run demo --set protocol.updates=periodic", "as published, slower to recover"),
    ("innervate run radio-disaster --set protocol.mode=paper", "as published: order for four"),
    ("innervate run mesh-document", "a mesh read to the letter: many messages get lost"),
    ("innervate new skin my-skin.toml", "a scenario of your own, with comments; also: radio, mesh"),
    ("innervate scenarios", "what else is here"),
)


def _part(out: Path | None, chapter: str) -> Path | None:
    return None if out is None else out / chapter


def _skin(seed: int | None, out: Path | None) -> Told:
    """The skin: a cable is cut, the network mends itself."""
    print("A robot's skin: cells wired to their neighbours, a few of them to the PC.")
    print("Every cell sends what it feels from cell to cell. Now a cable to the PC is cut.")
    print(flush=True)
    run = simulate("demo", [], seed, _part(out, "skin"))
    folder = run.write(_part(out, "skin"))
    summary, plan = run.skin, run.plan
    graph = plan.graph
    print(
        f"  {graph.cells} cells, {graph.interfaces} cables to the PC, "
        f"{plan.params['beacon_us'] / 1000:g} ms between a cell's beacons"
    )
    for fault, recovery in zip(plan.faults, summary["recoveries"], strict=False):
        print()
        what = words.fault_words(graph, fault)
        print(f"  {recovery['at_s']:.3f} s   {what}")
        for when, then in _steps(recovery, graph.cells):
            print(f"  {when:>10}   {then}")
    print()
    for line in show.state_lines(summary):
        print(f"  {line}")
    print()
    print(f"  {summary['duration_s']:g} s were simulated in {summary['wall_s']:.2f} s.")
    print(f"  Look at it in a browser: {folder / 'report.html'}")
    return Told(folder / "report.html", run.interrupted)


def _steps(recovery: Recovery, cells: int) -> list[tuple[str, str]]:
    """What followed an event, in order of time."""
    cut, settled = recovery["cut_cells"], recovery["converged_ms"]
    steps: list[tuple[float, str]] = []
    if cut:
        steps.append((0.0, f"{cut} of {cells} cells have lost their way to the PC"))
    if recovery["detected_ms"]:
        steps.append((recovery["detected_ms"], "the cell at the cable has noticed"))
    gone, routed = recovery["cut_off"], recovery["others_ms"]
    if gone:
        steps.append((0.0, f"{gone} of {cells} cells are cut off: no cable joins them any more"))
    if routed:
        whom = "every other cell" if recovery["cut_off_total"] else "every cell"
        steps.append((routed, f"{whom} has a way again"))
    elif settled and recovery["routed_ms"] == 0:
        steps.append((settled, "the cells share both cables again; none lost its way meanwhile"))
    return [
        ("at once" if ms == 0 else f"+{words.ms_words(ms)}", what) for ms, what in sorted(steps)
    ]


def _radio(seed: int | None, out: Path | None) -> Told:
    """The radio: ten robots start at once, and put themselves in order."""
    print()
    print("A team of robots on one radio channel, without a central station. All ten of them start")
    print("to send at the same moment. Whoever sends hears nothing: nobody received anything.")
    print(flush=True)
    run = simulate("radio-disaster", [], seed, _part(out, "radio"))
    folder = run.write(_part(out, "radio"))
    plan, packets = run.plan, run.result.packets
    start_us = int(packets["offered"].min())
    order = ", ".join(str(i) for i in run.radio["order"])
    firsts = (int(packets["end"].min()), "the first packet has arrived, everybody knows the order")
    for at_us, what in (firsts, (int(packets["end"].max()), "all ten packets have arrived")):
        print(f"  {'+' + words.ms_words((at_us - start_us) / 1e3):>10}   {what}")
    print()
    print(f"  Order: {order}. {run.radio['lost_silently']} packets lost without their sender "
          "knowing.")  # fmt: skip
    times = (plan.params["packet_slots"] * plan.params["slot_us"] * plan.stations) / 1e3
    print(f"  The packets alone take {words.ms_words(times)}.")
    print(f"  Look at it in a browser: {folder / 'report.html'}")
    return Told(folder / "report.html", run.interrupted)


def _mesh(seed: int | None, out: Path | None) -> Told:
    """The mesh: nodes die unnoticed, a robot leaves its fence, the alarm finds a way."""
    print()
    print("A fenced field, nodes that pass on each other's messages, and a robot. One node, the")
    print("gateway, finds out who hears whom and tells everybody the way to everybody. Then some")
    print("nodes die, which nobody knows, and the robot walks out.")
    print(flush=True)
    run = simulate("mesh-field", [], seed, _part(out, "mesh"))
    folder = run.write(_part(out, "mesh"))
    summary, plan = run.mesh, run.plan
    reach = 2 * summary["links"] / plan.nodes
    print(f"  {plan.nodes} nodes, each with about {reach:.0f} others in good reach")
    print()
    for when, then in _mesh_steps(run):
        print(f"  {when:>10}   {then}")
    print()
    told = mesh_words.sentences(run.result, summary)
    for line in told[1:] if summary["alarms"]["sent"] else told:  # the steps have the alarms
        print(f"  {line}")
    print()
    print(f"  {summary['duration_s']:g} s were simulated in {summary['wall_s']:.2f} s.")
    print(f"  Look at it in a browser, with the alarm in slow motion: {folder / 'report.html'}")
    return Told(folder / "report.html", run.interrupted)


def _mesh_steps(run: Run) -> list[tuple[str, str]]:
    """What happened in the field, in order of time; after a crossing counted from it."""
    from innervate.analysis.mesh_alarms import all_crossings
    from innervate.analysis.mesh_messages import NEVER

    summary, plan = run.mesh, run.plan
    steps: list[tuple[float, str, str]] = []
    if summary["discovery"]["tables_s"] is not None:
        at = summary["gateways"][0]["at_s"] + summary["discovery"]["tables_s"]
        steps.append((at, f"{at:.3f} s", "every node knows the way to every other"))
    for at_us, faults in groupby(plan.faults, key=lambda fault: fault.at_us):
        count = len(list(faults))
        what = f"{words.number_of(count, 'node')} switched off; nobody is told"
        steps.append((at_us / 1e6, f"{at_us / 1e6:.3f} s", what))
    for crossing in all_crossings(run.result):
        out_us = crossing.crossed_us
        steps.append((out_us / 1e6, f"{out_us / 1e6:.3f} s", "the robot is outside the fence"))
        for at, what in (
            (crossing.raised_us, "it notices, and raises the alarm"),
            (crossing.accepted_us, _knows(crossing)),
        ):
            if at != NEVER:
                steps.append((at / 1e6, f"+{words.ms_words((at - out_us) / 1e3)}", what))
    return [(when, what) for _at, when, what in sorted(steps, key=lambda step: step[0])]


def _knows(crossing: Crossing) -> str:
    hops = words.number_of(crossing.hops, "hop")
    return f"the monitor has it, over {hops}; the robot got {crossing.overrun_m * 100:.1f} cm out"


CHAPTERS: tuple[Callable[[int | None, Path | None], Told], ...] = (_skin, _radio, _mesh)
