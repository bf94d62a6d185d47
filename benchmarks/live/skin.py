"""python -m benchmarks.live.skin: 20 cells as processes over UDP and over ptys, hurt on purpose.

Cells sample at 50 Hz, beacons at 50 Hz. From what comes in at the PC: how long any cell that can
still reach it was not heard, less its period, after a cut cable, a killed cell, a restarted PC.
"""

import argparse
import asyncio
import signal
import statistics
import tempfile
import threading
import time
from pathlib import Path

from innervate import scenario as scenarios
from innervate.live import status
from innervate.live.up import Network

PERIOD_S = 0.02
SETTLE_S = 3.0
AFTER_S = 3.0
CELLS = 20
SCENARIO = {
    "kind": "skin",
    "patch": [{"columns": 4, "rows": 5}],
    "interface": [{"row": 0, "column": 1}, {"row": 4, "column": 2}],
    "protocol": {"beacon_hz": 50, "k": 5},
    "data": {"rate_hz": 50},
}


class Ear(threading.Thread):
    """Listens at the PC: per cell, when samples came in."""

    def __init__(self, network):
        super().__init__(daemon=True)
        self.where = network.socket("pc")
        self.heard = [[] for _ in range(CELLS)]
        self.start()

    def run(self):
        try:
            for answer in status.ask(self.where, {"do": "listen"}):
                if "from" in answer:
                    self.heard[answer["from"]].append(time.monotonic())
        except status.LiveError:  # the PC was restarted
            return

    def longest_gap_ms(self, since, but=()):
        gaps = []
        for cell, times in enumerate(self.heard):
            if cell not in but:
                late = [t for t in times if t >= since - PERIOD_S]
                pairs = zip([since, *late], [*late, time.monotonic()], strict=True)
                gaps.append(max(b - a for a, b in pairs))
        return max(0.0, max(gaps) - PERIOD_S) * 1000


async def settled(network):
    began = time.monotonic()
    while sum(status.ask_one(network.socket("pc"), {"do": "status"})["cells"]) < CELLS:
        if time.monotonic() - began > 30:
            raise SystemExit("the skin did not settle")
        await asyncio.sleep(0.05)
    await asyncio.sleep(SETTLE_S)


def cut(network, restore=False):
    """The cable between the PC and its interface 0."""
    what = "restore" if restore else "cut"
    status.ask_one(network.socket("pc"), {"do": what, "port": 0})


async def one(network, fault):
    await settled(network)
    ear, but = Ear(network), ()
    await asyncio.sleep(0.5)
    since = time.monotonic()
    if fault == "cut":
        cut(network)
    elif fault == "kill":
        but = (6,)
        network.processes["c6"].send_signal(signal.SIGKILL)
    else:
        network.processes["pc"].send_signal(signal.SIGKILL)
        network.processes["pc"].wait()
        network.start_node("pc")
        while not status.answers(network.socket("pc")):
            await asyncio.sleep(0.005)
        ear = Ear(network)
    await asyncio.sleep(AFTER_S)
    found = ear.longest_gap_ms(since, but)
    if fault == "cut":
        cut(network, restore=True)
    elif fault == "kill":
        network.processes["c6"].wait()
        network.start_node("c6")
    return found


async def measure(cables, runs):
    plan = scenarios.plan(scenarios.from_dict(SCENARIO))
    with tempfile.TemporaryDirectory() as folder:
        network = Network(plan, Path(folder), cables)
        try:
            await network.up()
            for fault in ("cut", "kill", "restart"):
                found = sorted([await one(network, fault) for _ in range(runs)])
                texts = " ".join(f"{x:.0f}" for x in found)
                print(f"{cables:6}{fault:9}{statistics.median(found):8.0f} ms  ({texts})")
        finally:
            await network.down()


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--runs", type=int, default=5)
    parser.add_argument("--cables", default="udp,pty")
    args = parser.parse_args()
    for cables in args.cables.split(","):
        asyncio.run(measure(cables, args.runs))


if __name__ == "__main__":
    main()
