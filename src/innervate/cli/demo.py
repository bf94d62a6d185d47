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
        print(f"  {command:<52}{what}")
    return 0


_NEXT = (
    ("innervate run demo --set protocol.updates=periodic", "as published, slower to recover"),
    ("innervate new skin my-skin.toml", "a scenario of your own, with comments"),
    ("innervate scenarios", "what else is here"),
)


def _skin(seed: int | None, out: Path | None) -> Told:
    """The skin: a cable is cut, the network mends itself."""
    print("A robot's skin: cells wired to their neighbours, a few of them to the PC.")
    print("Every cell sends what it feels from cell to cell. Now a cable to the PC is cut.")
    print(flush=True)
    run = simulate("demo", [], seed, out)
    folder = run.write(out)
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


# The radio and the mesh follow as chapters of their own.
CHAPTERS: tuple[Callable[[int | None, Path | None], Told], ...] = (_skin,)
