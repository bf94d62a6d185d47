"""`make bench`: the simulator's speed, as ratios against baselines timed in the same run."""

import argparse
import json
import os
import platform
import shutil
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from benchmarks import (
    beacons,
    c_heap,
    explorer,
    mesh,
    own_network,
    page,
    radio,
    simpy_timeouts,
    sweeps,
)

NS3_BEST = {204: 0.64e6, 10_020: 0.13e6}  # beacons/s of ns-3 3.37, measured on another such machine
COMMAND_RUNS = 5


def main():
    """Run all benchmarks and print one table each."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks", description=__doc__)
    parser.add_argument("--quick", action="store_true", help="small sizes only")
    parser.add_argument("--json", type=Path, help="also write the figures to this file")
    options = parser.parse_args()
    sizes = [n for n in beacons.SIZES if n <= 10_000] if options.quick else beacons.SIZES
    figures = {"machine": f"{platform.machine()}, {os.cpu_count()} cores", "beacons": []}
    print(f"machine: {figures['machine']}, Python {platform.python_version()}")
    print(f"{'cells':>9} {'Mbeacons/s':>11} {'with checks':>12} {'periodic':>9} {'Mevents/s':>10} "
          f"{'C heap':>8} {'ratio':>6} {'SimPy':>7} {'ratio':>6} {'ns-3*':>6}")  # fmt: skip
    for cells in sizes:
        figures["beacons"].append(row(cells))
    print(
        "Mbeacons/s: updates = wave, the default, without checks; then with; then periodic, without"
    )
    print("Mevents/s = handler calls; C heap, SimPy = their events (M/s) with as many pending;")
    print("* beacons/s against ns-3's best build as measured elsewhere (no ns-3 here)")
    figures["explorer"] = explorer.measure()
    print(f"explorer, PC and triangle: {figures['explorer']['successors_per_s'] / 1e6:.2f} M "
          f"successors/s, {figures['explorer']['states']:,} states")  # fmt: skip
    figures["radio"] = [radio_row(stations) for stations in radio.STATIONS]
    sizes = mesh.NODES[:1] if options.quick else mesh.NODES
    figures["mesh"] = [mesh_row(nodes) for nodes in sizes]
    if not options.quick:
        figures["million"] = json.loads(beacons.million_apart())
        print("1,000,000 cells at 10 Hz, one second, warm:",
              ", ".join(f"{k} {v:.2f}" if isinstance(v, float) else f"{k} {v:,}"
                        for k, v in figures["million"].items()))  # fmt: skip
    figures["own_network"] = own_network.told()
    figures["sweeps"] = sweep_row()
    figures["page"] = [page_row(cells) for cells in page.CELLS]
    figures["commands"] = commands()
    if options.json:
        options.json.write_text(json.dumps(figures, indent=2) + "\n")


def row(cells):
    """One size: with and without checkers, beside the baselines at the same moment."""
    off = beacons.measure(cells)
    on = beacons.measure(cells, checks=True)
    periodic = beacons.measure(cells, updates="periodic")
    heap = c_heap.measure(off["cells"], 0.6)
    simpy = simpy_timeouts.measure(off["cells"], 0.6) if cells <= 10_000 else None
    events = off["handlers_per_s"]
    ratios = {
        "c_heap": events / heap["events_per_s"] if heap else None,
        "simpy": events / simpy["events_per_s"] if simpy else None,
        "ns3": off["beacons_per_s"] / NS3_BEST[off["cells"]] if off["cells"] in NS3_BEST else None,
    }
    cell = [f"{off['cells']:>9,}", f"{off['beacons_per_s'] / 1e6:>11.2f}",
            f"{on['beacons_per_s'] / 1e6:>12.2f}",
            f"{periodic['beacons_per_s'] / 1e6:>9.2f}", f"{events / 1e6:>10.2f}",
            million(heap, 8), ratio(ratios["c_heap"]), million(simpy, 7), ratio(ratios["simpy"]),
            ratio(ratios["ns3"])]  # fmt: skip
    print(*cell, flush=True)
    return {
        "off": off,
        "on": on,
        "periodic": periodic,
        "c_heap": heap,
        "simpy": simpy,
        "ratios": ratios,
    }


def radio_row(stations):
    """Saturated radio stations, with and without checkers."""
    off, on = radio.measure(stations), radio.measure(stations, checks=True)
    print(
        f"radio, {stations} saturated stations: {off['events_per_s'] / 1e6:.2f} Mevents/s, "
        f"{off['s_per_s']:,.0f} s simulated in one; with checks and rows "
        f"{on['events_per_s'] / 1e6:.2f}",
        flush=True,
    )
    return {"off": off, "on": on}


def mesh_row(nodes):
    """A mesh for a minute, with and without checkers; the whole run beside the bar."""
    off, on, whole = mesh.measure(nodes), mesh.measure(nodes, checks=True), mesh.whole_s(nodes)
    bar = f" (at most {mesh.BAR_S:g})" if nodes == mesh.NODES[0] else ""
    print(
        f"mesh, {nodes} nodes for {mesh.DURATION_S:g} s: {off['events_per_s'] / 1e6:.2f} "
        f"Mevents/s, {off['s_per_s']:,.0f} s simulated in one; "
        f"with checks and rows {on['events_per_s'] / 1e6:.2f}; innervate.run {whole:.2f} s{bar}",
        flush=True,
    )
    return {"off": off, "on": on, "whole_s": whole}


def sweep_row():
    """What a sweep costs beyond its runs, and how it scales."""
    overhead, scaling = sweeps.overhead(), sweeps.scaling()
    shown = ", ".join(f"{name} {1e3 * s:.2f} ms" for name, s in overhead.items())
    speed = f"{scaling['per_core']:.2f} per core on {scaling['cores']} cores"
    print(f"sweep, overhead of a small run: {shown}; {speed}", flush=True)
    return {"overhead_s": overhead, **scaling}


def page_row(cells):
    """The page of `watch` in a browser."""
    found = page.measure(cells)
    if found is None:
        print("page of watch: not measured, Chromium is missing")
        return None
    print(
        f"page of watch, {cells:,} cells: {found['frames_per_s']:.0f} frames/s, "
        f"{found['states_per_s']:.0f} states/s, slowest drawing {found['slowest_ms']:.1f} ms",
        flush=True,
    )
    return {"cells": cells, **found}


def million(baseline, width):
    """A baseline's rate in millions, or a dash."""
    return f"{baseline['events_per_s'] / 1e6:>{width}.2f}" if baseline else f"{'-':>{width}}"


def ratio(value):
    """A ratio, or a dash."""
    return f"{value:>6.2f}" if value and value < 10 else f"{value:>6.0f}" if value else f"{'-':>6}"


def commands():
    """Median wall time of `innervate --help` and of a warm `innervate run setup-1`."""
    tool = shutil.which("innervate", path=str(Path(sys.executable).parent))
    if tool is None:
        print("commands: the `innervate` command is not installed beside this Python")
        return None
    figures = {}
    with tempfile.TemporaryDirectory() as folder:
        for name, words in {
            "--help": ["--help"],
            "run setup-1": ["run", "setup-1", "--out", f"{folder}/run", "--json"],
        }.items():
            walls = []
            for _ in range(COMMAND_RUNS + 1):
                started = time.perf_counter()
                subprocess.run([tool, *words], capture_output=True, check=True)
                walls.append(time.perf_counter() - started)
            figures[name] = statistics.median(walls[1:])
            print(f"innervate {name}: {figures[name]:.2f} s (median of {COMMAND_RUNS}, warm)")
    return figures


if __name__ == "__main__":
    main()
