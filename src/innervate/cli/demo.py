"""`innervate demo`: one chapter for each kind of network."""

from __future__ import annotations

import webbrowser
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from innervate.cli import errors, show
from innervate.cli.running import simulate
from innervate.plot import words


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
    ("innervate new skin my-skin.toml", "a scenario of your own, with comments"),
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
    summary, plan = run.summary, run.plan
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


def _steps(recovery: dict[str, float | None], cells: int) -> list[tuple[str, str]]:
    """What followed an event, in order of time."""
    cut, settled = recovery["cut_cells"], recovery["converged_ms"]
    steps: list[tuple[float, str]] = []
    if cut:
        steps.append((0.0, f"{cut} of {cells} cells have lost their way to the PC"))
    if recovery["detected_ms"]:
        steps.append((recovery["detected_ms"], "the cell at the cable has noticed"))
    if recovery["routed_ms"]:
        steps.append((recovery["routed_ms"], "every cell has a way again"))
    elif settled:
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
    order = ", ".join(str(i) for i in run.summary["order"])
    firsts = (int(packets["end"].min()), "the first packet has arrived, everybody knows the order")
    for at_us, what in (firsts, (int(packets["end"].max()), "all ten packets have arrived")):
        print(f"  {'+' + words.ms_words((at_us - start_us) / 1e3):>10}   {what}")
    print()
    print(f"  Order: {order}. {run.summary['lost_silently']} packets lost without their sender "
          "knowing.")  # fmt: skip
    times = (plan.params["packet_slots"] * plan.params["slot_us"] * plan.stations) / 1e3
    print(f"  The packets alone take {words.ms_words(times)}.")
    print(f"  Look at it in a browser: {folder / 'report.html'}")
    return Told(folder / "report.html", run.interrupted)


# The mesh follows as a chapter of its own.
CHAPTERS: tuple[Callable[[int | None, Path | None], Told], ...] = (_skin, _radio)
