"""python -m benchmarks.live.skin: 20 cells as processes over UDP and over ptys, hurt on purpose.

Cells sample at 50 Hz, beacons at 50 Hz. A cable to the PC is cut, a cell killed, the PC killed and
started again; all frames are captured, and what the skin did is read from the capture.
"""

import argparse
import asyncio
import os
import re
import signal
import statistics
import sys
import tempfile
from pathlib import Path

from innervate import scenario as scenarios
from innervate.live import status
from innervate.live.up import Processes
from innervate.networks.skin.export.recovery import recoveries

AFTER_S = 2.5
CELLS = 20
INTERFACE = (1, CELLS)  # the cable between cell 1 and the PC
SETTLE_S = 30.0
STOP_S = 10.0
SCENARIO = {
    "kind": "skin",
    "patch": [{"columns": 4, "rows": 5}],
    "interface": [{"row": 0, "column": 1}, {"row": 4, "column": 2}],
    "protocol": {"beacon_hz": 50},
    "data": {"rate_hz": 50},
}
FAULTS = {"cut": "cut c", "kill": "c[0-9]+ gone", "restart": "pc back"}
COLUMNS = ("first_ms", "wrong_ms", "routed_ms", "heard_ms", "heard_median_ms", "lost")


async def settled(network):
    """Until all cells have a way, and have had it for a while."""
    pc = network.socket("pc")
    async with asyncio.timeout(SETTLE_S):
        while sum(status.ask_one(pc, {"do": "status"})["cells"]) < CELLS:
            await asyncio.sleep(0.05)
    await asyncio.sleep(AFTER_S)


def busiest(network):
    """The cell that most others' samples pass, of those without a cable to the PC."""
    near = {cell for cell, other in network.links if other == CELLS}
    names = [name for i, name in enumerate(network.names[:CELLS]) if i not in near]
    asked = {name: status.ask_one(network.socket(name), {"do": "status"}) for name in names}
    return max(names, key=lambda name: asked[name]["load"])


async def begun(network, name):
    """Start a node again; its start, a fifth of a second of work, does not hold up the others."""
    policy, ours = os.sched_getscheduler(0), os.sched_getparam(0)
    os.sched_setscheduler(0, os.SCHED_OTHER, os.sched_param(0))
    await network.begin_node(name)
    for pid in (0, network.processes[name].pid):
        os.sched_setscheduler(pid, policy, ours)


async def hurt(network, runs):
    """Everything once a run, with time to heal before and after."""
    cable = network.links.index(INTERFACE)
    for _ in range(runs):
        await settled(network)
        await network.change(cable, "cut")
        await asyncio.sleep(AFTER_S)
        await network.change(cable, "restore")
        for who in (busiest, lambda _: "pc"):
            await settled(network)
            name = who(network)
            await network.end_node(name, gently=False)
            await asyncio.sleep(0 if name == "pc" else AFTER_S)
            await begun(network, name)
    await settled(network)


async def captured(cables, k, runs, folder):
    """What a capture of a network that was hurt says."""
    told = {**SCENARIO, "protocol": {**SCENARIO["protocol"], "k": k}}
    network = Processes(scenarios.plan(scenarios.from_dict(told)), folder, cables)
    out = folder / "skin.pcapng"
    try:
        await network.up()
        capture = await asyncio.create_subprocess_exec(
            sys.executable, "-m", "innervate.cli", "live", "capture", "--out", str(out),
            env={**os.environ, "INNERVATE_RUN": str(folder)},
        )  # fmt: skip
        await hurt(network, runs)
        capture.send_signal(signal.SIGINT)
        await asyncio.wait_for(capture.wait(), STOP_S)
    finally:
        await network.down()
    return recoveries(out)


def show(cables, k, found):
    """A line for each kind of fault: medians, and all of one column."""
    for name, begins in FAULTS.items():
        rows = [one for one in found if re.match(begins, one.what) and one.cells]
        line = f"{cables:5}{k:>3}  {name:9}{len(rows):>4}"
        for column in COLUMNS:
            values = [getattr(row, column) for row in rows]
            ends = [value for value in values if value is not None]
            text = f"{statistics.median(ends):.0f}" if len(ends) == len(values) > 0 else "never"
            line += f"{text:>13}"
        heard = " ".join("never" if row.heard_ms is None else f"{row.heard_ms:.0f}" for row in rows)
        print(f"{line}   ({heard})", flush=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--runs", type=int, default=5, help="about 17 s each")
    parser.add_argument("--cables", default="udp,pty")
    parser.add_argument("--k", default="5,3", help="missed beacons until a port is broken")
    parser.add_argument("--realtime", action="store_true", help="all nodes before other work; root")
    args = parser.parse_args()
    if args.realtime:  # processes that are started inherit it
        os.sched_setscheduler(0, os.SCHED_FIFO, os.sched_param(20))
    heads = "".join(f"{column.removesuffix('_ms'):>13}" for column in COLUMNS)
    print(f"{'':5}{'k':>3}  {'fault':9}{'runs':>4}{heads}   (heard)")
    for cables in args.cables.split(","):
        for k in map(int, args.k.split(",")):
            with tempfile.TemporaryDirectory(prefix="innervate-") as folder:
                found = asyncio.run(captured(cables, k, args.runs, Path(folder)))
            show(cables, k, found)


if __name__ == "__main__":
    main()
