"""python -m benchmarks.live.soak: nine sealed nodes as processes, hurt for minutes on purpose.

Messages between random nodes all the time, in order; cables cut and healed, node files reloaded,
keys changed. At the end: no node wrote an error, none has grown, every message and every frame is
accounted for. Exit code 1 and a line for each thing that is not so.
"""

import argparse
import asyncio
import json
import random
import secrets
import signal
import sys
import tempfile
import time
from collections import Counter
from pathlib import Path

from benchmarks.live.shapes import grid
from benchmarks.live.sides import cpu_s, memory_mib
from innervate import scenario as scenarios
from innervate.live import status
from innervate.live.up import Processes

SENDERS = 2  # per node: each waits for its receipt
PAUSE_S = 0.1  # between a sender's messages: all nodes together take half a core
HURT_S = (0.2, 1.5)  # a cable is cut, then whole, for a time between these
ROTATE_S = 20.0
GRACE_S = 2.0
SAMPLE_S = 5.0
GROWTH_MIB = 2.0
HEARD_S = 5.0  # within that time listeners have been told of them
QUIET_S = 60.0  # within that time all messages have ended
FINAL = ("delivered", "expired", "refused")


class Soak:
    """A network under fire, and what came of its messages."""

    def __init__(self, network, seed):
        self.network = network
        self.chance = random.Random(seed)
        self.states = Counter()
        self.heard = Counter()
        self.last = {}
        self.disordered = 0
        self.listening = 0
        self.number = 0
        self.events = Counter()
        self.sizes = []
        self.ending = asyncio.Event()

    async def connect(self, name, request):
        reader, writer = await asyncio.open_unix_connection(str(self.network.socket(name)))
        writer.write(json.dumps(request).encode() + b"\n")
        return reader, writer

    async def listen(self, name):
        reader, writer = await self.connect(name, {"do": "listen", "in_order": True})
        while line := await reader.readline():
            told = json.loads(line)
            self.listening += "listening" in told
            if "payload" in told:
                number, stream = (int(x, 16) for x in (told["payload"][:8], told["payload"][8:10]))
                self.heard[number] += 1
                key = (name, told["from"], stream)
                self.disordered += number < self.last.get(key, -1)
                self.last[key] = number
        writer.close()

    async def send(self, name, stream):
        """One message after the other, each to its end."""
        reader, writer = await asyncio.open_unix_connection(str(self.network.socket(name)))
        others = [i for i, other in enumerate(self.network.names) if other != name]
        while not self.ending.is_set():
            self.number += 1
            payload = self.number.to_bytes(4, "big") + bytes([stream])
            request = {"do": "send", "to": self.chance.choice(others), "in_order": True,
                       "payload": payload.hex()}  # fmt: skip
            writer.write(json.dumps(request).encode() + b"\n")
            state = ""
            while state not in FINAL:
                told = json.loads(await reader.readline())
                state = told["state"]
            self.states[f"{state}: {told['reason']}" if told["reason"] else state] += 1
            await asyncio.sleep(PAUSE_S)
        writer.close()

    async def hurt(self):
        while True:
            cable = self.chance.randrange(len(self.network.links))
            await self.network.change(cable, "cut")
            self.events["cuts"] += 1
            await asyncio.sleep(self.chance.uniform(*HURT_S))
            await self.network.change(cable, "restore")
            await asyncio.sleep(self.chance.uniform(*HURT_S))

    async def rotate(self):
        use = 1
        while True:
            await asyncio.sleep(ROTATE_S)
            use = 3 - use
            self.network.keys = key_table(use)
            for name in self.network.names:
                self.network.write_file(name)
                self.network.processes[name].send_signal(signal.SIGHUP)
                await asyncio.sleep(self.chance.uniform(0, GRACE_S / 10))
            self.events["changes of keys"] += 1

    async def sample(self):
        while True:
            processes = self.network.processes.values()
            self.sizes.append([memory_mib(process.pid) for process in processes])
            await asyncio.sleep(SAMPLE_S)

    async def run(self, seconds):
        names = self.network.names
        others = [self.hurt(), self.rotate(), self.sample(), *map(self.listen, names)]
        others = [asyncio.create_task(other) for other in others]
        for task in others:
            task.add_done_callback(_complain)
        while self.listening < len(names):
            await asyncio.sleep(0.01)
        senders = [self.send(name, k) for name in names for k in range(SENDERS)]
        senders = [asyncio.create_task(sender) for sender in senders]
        await asyncio.sleep(seconds)
        others[0].cancel()
        for cable in range(len(self.network.links)):
            await self.network.change(cable, "cut")
            await self.network.change(cable, "restore")
        self.ending.set()
        await asyncio.wait_for(asyncio.gather(*senders), QUIET_S)
        until = time.monotonic() + HEARD_S
        while len(self.heard) < self.number and time.monotonic() < until:
            await asyncio.sleep(0.05)
        self.sizes.append([memory_mib(process.pid) for process in self.network.processes.values()])
        found = [status.ask_one(self.network.socket(name), {"do": "status"}) for name in names]
        for task in others:
            task.cancel()
        await asyncio.gather(*others, return_exceptions=True)
        return found


def _complain(task):
    if not task.cancelled() and task.exception() is not None:
        print(f"soak: {task.exception()!r}", file=sys.stderr)


def key_table(use):
    return {"use": use, f"secret.{use}": secrets.token_hex(32), "grace_s": GRACE_S}


def faults(soak, found):
    """A line for everything that is not as it must be."""
    if soak.states.keys() - {"delivered"}:
        yield f"not all messages were delivered: {dict(soak.states)}"
    if len(soak.heard) != soak.number:
        yield f"{soak.number} messages were sent, {len(soak.heard)} heard"
    if sum(soak.heard.values()) != len(soak.heard):
        yield f"{sum(soak.heard.values()) - len(soak.heard)} messages came twice"
    if soak.disordered:
        yield f"{soak.disordered} messages came out of order"
    for told in found:
        counted = told["counters"]
        ended = sum(counted.get(f"messages {state}", 0) for state in FINAL)
        if counted.get("messages accepted", 0) != ended:
            yield f"{told['name']}: messages accepted and ended differ: {counted}"
        received = sum(path["counters"].get("received", 0) for path in told["paths"])
        late = counted.get("dropped: after its turn", 0)
        dropped = sum(n for what, n in counted.items() if what.startswith("dropped")) - late
        if received != counted["frames"] + dropped:
            yield f"{told['name']}: {received} frames received, not all accounted for: {counted}"
    for name in soak.network.names:
        for line in (soak.network.folder / f"{name}.log").read_text().splitlines():
            if not line.startswith((f"{name}: ready", f"{name}: keys reloaded")):
                yield f"{name} wrote: {line}"
    settled = soak.sizes[len(soak.sizes) // 3]
    for name, before, after in zip(soak.network.names, settled, soak.sizes[-1], strict=True):
        if after - before > GROWTH_MIB:
            yield f"{name} has grown from {before:.1f} to {after:.1f} MiB"


async def soaked(seconds, seed, folder):
    shape = grid()
    plan = scenarios.plan(scenarios.from_dict({
        "kind": "mesh", "nodes": shape.count, "radio": {"profile": "ip"},
        "link": [{"a": a, "b": b} for a, b in shape.links],
    }))  # fmt: skip
    network = Processes(plan, folder, "udp", key_table(1))
    await network.up()
    soak = Soak(network, seed)
    try:
        while not all(
            status.ask_one(network.socket(name), {"do": "status"})["table"]
            for name in network.names
        ):
            await asyncio.sleep(0.1)
        before = sum(cpu_s(process.pid) for process in network.processes.values())
        began = time.monotonic()
        found = await soak.run(seconds)
        used = sum(cpu_s(process.pid) for process in network.processes.values()) - before
        cpu = 100 * used / (time.monotonic() - began) / shape.count
    finally:
        await network.down()
    return soak, found, cpu


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--minutes", type=float, default=10.0)
    parser.add_argument("--seed", type=int, default=1)
    args = parser.parse_args()
    with tempfile.TemporaryDirectory(prefix="innervate-") as folder:
        soak, found, cpu = asyncio.run(soaked(60 * args.minutes, args.seed, Path(folder)))
        wrong = list(faults(soak, found))
    dropped = Counter()
    for told in found:
        for what, count in told["counters"].items():
            if what.startswith("dropped"):
                dropped[what] += count
    first, last = (max(sizes) for sizes in (soak.sizes[len(soak.sizes) // 3], soak.sizes[-1]))
    print(f"{soak.number} messages: {dict(soak.states)}; {dict(soak.events)}; "
          f"frames dropped: {dict(dropped) or 'none'}")  # fmt: skip
    print(f"largest node {first:.1f} MiB after a third, {last:.1f} MiB at the end; "
          f"CPU of a node {cpu:.1f} %")  # fmt: skip
    for line in wrong:
        print(line)
    sys.exit(bool(wrong))


if __name__ == "__main__":
    main()
