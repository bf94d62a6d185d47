"""python -m benchmarks.live.soak: nine sealed nodes as processes, hurt for minutes on purpose.

Messages between random nodes all the time, in order; cables cut and healed, node files reloaded,
keys changed; nodes killed and started again, their clocks put forward and back, their disk full
(as root). At the end: no node wrote an error, none has grown, no life of a node had a message
twice or after its turn, what was said to be delivered was handed up, every message of a living
node has an end, every frame is accounted for. Exit code 1 and a line for each that is not so.
"""

import argparse
import asyncio
import json
import math
import os
import random
import sys
import tempfile
import time
from collections import Counter
from contextlib import suppress
from pathlib import Path

from benchmarks.live.hurts import Clocks, Disk, Hurts, key_table
from benchmarks.live.shapes import grid
from benchmarks.live.sides import cpu_s, memory_mib
from innervate import scenario as scenarios
from innervate.live import status
from innervate.live.up import Processes

SENDERS = 2  # per node: each waits for its receipt
PAUSE_S = 0.1  # between a sender's messages: all nodes together take half a core
SAMPLE_S = 5.0
SETTLED_S = 60.0  # a life is as large as it gets
GROWTH_MIB = 2.0
HEARD_S = 5.0  # within that time listeners have been told of them
QUIET_S = 60.0  # within that time all messages have ended
NEAR_S = 1.0  # what was handed up may have died with its listener's connection
AGAIN_S = 0.05
FINAL = ("delivered", "expired", "refused")
GONE = "sender killed"


class Soak:
    """A network under fire, and what came of its messages."""

    def __init__(self, network, seed, clocks, disk):
        self.network = network
        self.chance = random.Random(seed)
        self.states = Counter()
        self.delivered = {}  # number: for whom, when it was sent, when its sender was told
        self.heard = Counter()  # (number, which life of its recipient)
        self.last = {}
        self.back = {name: [] for name in network.names}  # when its listener was there (again)
        self.disordered = 0
        self.listening = 0
        self.number = 0
        self.events = Counter()
        self.sizes = {}  # by process: [(when, MiB)]
        self.ending = asyncio.Event()
        self.hurts = Hurts(network, random.Random(seed + 1), self.events, clocks, disk)

    async def connect(self, name):
        """A connection to a node, as soon as it answers."""
        while True:
            with suppress(OSError):
                return await asyncio.open_unix_connection(str(self.network.socket(name)))
            await asyncio.sleep(AGAIN_S)

    async def listen(self, name):
        """Whatever a node hands up, in each of its lives."""
        for life in range(1_000_000):
            reader, writer = await self.connect(name)
            with suppress(ConnectionError):
                writer.write(json.dumps({"do": "listen", "in_order": True}).encode() + b"\n")
                while line := await reader.readline():
                    self.hear(name, life, json.loads(line))
            writer.close()
            await asyncio.sleep(AGAIN_S)

    def hear(self, name, life, told):
        if "listening" in told:
            self.listening += 1
            self.back[name].append(time.monotonic())
        if "payload" not in told:
            return
        number, stream = (int(x, 16) for x in (told["payload"][:8], told["payload"][8:10]))
        self.heard[number, life] += 1
        key = (name, life, told["from"], stream)
        self.disordered += number < self.last.get(key, -1)
        self.last[key] = number

    async def send(self, name, stream):
        """One message after the other, each to its end."""
        reader, writer = await self.connect(name)
        while not self.ending.is_set():
            self.number += 1
            number = self.number
            dest = self.chance.choice([n for n in self.network.names if n != name])
            payload = number.to_bytes(4, "big") + bytes([stream])
            request = {"do": "send", "to": self.network.names.index(dest), "in_order": True,
                       "payload": payload.hex()}  # fmt: skip
            sent = time.monotonic()
            told = await self.ended(reader, writer, request)
            self.states[
                f"{told['state']}: {told['reason']}" if told["reason"] else told["state"]
            ] += 1
            if told["state"] == "delivered":
                self.delivered[number] = dest, sent, time.monotonic()
            if told["state"] == GONE:
                writer.close()
                reader, writer = await self.connect(name)
            await asyncio.sleep(PAUSE_S)
        writer.close()

    async def ended(self, reader, writer, request):
        """What a node says last of a message."""
        try:
            writer.write(json.dumps(request).encode() + b"\n")
            while line := await reader.readline():
                told = json.loads(line)
                if told["state"] in FINAL:
                    return told
        except ConnectionError:
            pass
        return {"state": GONE, "reason": ""}

    async def sample(self):
        while True:
            self.measure()
            await asyncio.sleep(SAMPLE_S)

    def measure(self):
        for name, process in self.network.processes.items():
            with suppress(OSError):
                size = memory_mib(process.pid)
                if size:
                    mine = self.sizes.setdefault((name, process.pid), [])
                    mine.append((time.monotonic(), size))

    async def run(self, seconds, restarts):
        names = self.network.names
        others = [asyncio.create_task(x) for x in (self.sample(), *map(self.listen, names))]
        for task in others:
            task.add_done_callback(_complain)
        while self.listening < len(names):
            await asyncio.sleep(0.01)
        hurts = [asyncio.create_task(hurt) for hurt in self.hurts.all(restarts)]
        for task in hurts:
            task.add_done_callback(_complain)
        senders = [self.send(name, k) for name in names for k in range(SENDERS)]
        senders = [asyncio.create_task(sender) for sender in senders]
        await asyncio.sleep(seconds)
        await self.hurts.stop(hurts)
        self.ending.set()
        await asyncio.wait_for(asyncio.gather(*senders), QUIET_S)
        until = time.monotonic() + HEARD_S
        while self.unheard() and time.monotonic() < until:
            await asyncio.sleep(0.05)
        self.measure()
        found = [status.ask_one(self.network.socket(name), {"do": "status"}) for name in names]
        for task in others:
            task.cancel()
        await asyncio.gather(*others, return_exceptions=True)
        return found

    def unheard(self):
        """Messages said to be delivered that no listener had: (number, their node was killed)."""
        heard = {number for number, _ in self.heard}
        return [(n, self.was_away(*self.delivered[n])) for n in self.delivered.keys() - heard]

    def was_away(self, name, sent, told):
        """True if a node, or its listener, was not there in between, or nearly so.

        It was handed up at some moment in between: where acks were lost, long before they are told.
        """
        for at in self.hurts.killed[name]:
            back = min((b for b in self.back[name] if b > at), default=math.inf)
            if at - NEAR_S < told and sent < back + NEAR_S:
                return True
        return False

    def about(self, number):
        """When a message was delivered, by what had happened to its recipient, and was to."""
        name, sent, when = self.delivered[number]
        moments = [(at, "killed") for at in self.hurts.killed[name]]
        moments += [(at, "listened to") for at in self.back[name]]
        near = [f"{what} {at - when:+.1f} s" for at, what in sorted(moments) if abs(at - when) < 30]
        return f"{number} to {name} (sent {sent - when:+.1f} s, {', '.join(near)})"

    def grown(self):
        """(name, MiB when it had settled, MiB at its end) of each life that was long enough."""
        for (name, _), sizes in self.sizes.items():
            settled = [size for at, size in sizes if at - sizes[0][0] >= SETTLED_S]
            if settled:
                yield name, settled[0], sizes[-1][1]


def _complain(task):
    if not task.cancelled() and task.exception() is not None:
        print(f"soak: {task.exception()!r}", file=sys.stderr)


# What a node may write, behind its name.
SAID = (
    "ready",
    "keys reloaded",
    "stopped; messages were still under way",
    "{}.state: cannot be written: No space left",
    "{}.state: written again",
)


def faults(soak, found):
    """A line for everything that is not as it must be."""
    if soak.states["refused"]:
        yield f"messages were refused: {dict(soak.states)}"
    if not soak.events["restarts"] and soak.states.keys() - {"delivered"}:
        yield f"not all messages were delivered: {dict(soak.states)}"
    if sum(soak.states.values()) != soak.number:
        yield f"{soak.number} messages were sent, {sum(soak.states.values())} have an end"
    lost = [number for number, was_away in soak.unheard() if not was_away]
    if lost:
        about = "; ".join(map(soak.about, lost[:5]))
        yield f"{len(lost)} messages are delivered, and nobody heard them: {about}"
    twice = sum(soak.heard.values()) - len(soak.heard)
    if twice:
        yield f"{twice} messages came twice"
    if soak.disordered:
        yield f"{soak.disordered} messages came out of order"
    for told in found:
        counted = told["counters"]
        ended = sum(counted.get(f"messages {state}", 0) for state in FINAL)
        if counted.get("messages accepted", 0) != ended:
            yield f"{told['name']}: messages accepted and ended differ: {counted}"
        received = sum(path["counters"].get("received", 0) for path in told["paths"])
        late = counted.get("dropped: after its turn", 0)
        dropped = sum(n for what, n in counted.items() if what.startswith("dropped:")) - late
        of_sessions = counted.get("handshake messages", 0) + counted.get("control frames", 0)
        if received != counted["frames"] + of_sessions + dropped:
            yield f"{told['name']}: {received} frames received, not all accounted for: {counted}"
    for name in soak.network.names:
        for line in (soak.network.folder / f"{name}.log").read_text(errors="replace").splitlines():
            line = line[line.rfind(f"{name}: ") :]  # a full disk tears lines
            if not line.startswith(tuple(f"{name}: {said.format(name)}" for said in SAID)):
                yield f"{name} wrote: {line}"
    for name, before, after in soak.grown():
        if after - before > GROWTH_MIB:
            yield f"{name} has grown from {before:.1f} to {after:.1f} MiB"


async def soaked(args, folder, disk):
    shape = grid()
    plan = scenarios.plan(scenarios.from_dict({
        "kind": "mesh", "nodes": shape.count, "radio": {"profile": "ip"},
        "link": [{"a": a, "b": b} for a, b in shape.links],
    }))  # fmt: skip
    network = Processes(plan, folder, "udp", key_table(1))
    clocks = None if args.gentle else Clocks(folder, network.names)
    if clocks is not None:
        os.environ["LD_PRELOAD"] = str(clocks.library)  # of the nodes' processes
    await network.up()
    soak = Soak(network, args.seed, clocks, disk)
    try:
        while not all(
            status.ask_one(network.socket(name), {"do": "status"})["table"]
            for name in network.names
        ):
            await asyncio.sleep(0.1)
        before = {p.pid: cpu_s(p.pid) for p in network.processes.values()}
        began = time.monotonic()
        found = await soak.run(60 * args.minutes, not args.gentle)
        stayed = [p.pid for p in network.processes.values() if p.pid in before]
        used = sum(cpu_s(pid) - before[pid] for pid in stayed)
        cpu = 100 * used / (time.monotonic() - began) / len(stayed) if stayed else math.nan
    finally:
        await network.down()
    return soak, found, cpu


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--minutes", type=float, default=10.0)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--gentle", action="store_true", help="cables and keys only")
    args = parser.parse_args()
    with tempfile.TemporaryDirectory(prefix="innervate-") as folder:
        place = Path(folder)
        disk = None
        if not args.gentle and os.geteuid() == 0:
            disk = Disk(place)
        elif not args.gentle:
            print("not root: the disk stays as it is")
        try:
            soak, found, cpu = asyncio.run(soaked(args, place, disk))
            wrong = list(faults(soak, found))
        finally:
            if disk is not None:
                disk.close()
    tell(soak, found, cpu)
    for line in wrong:
        print(line)
    sys.exit(bool(wrong))


def tell(soak, found, cpu):
    """What was done, and what came of it."""
    dropped = Counter()
    for told in found:
        for what, count in told["counters"].items():
            if what.startswith("dropped"):
                dropped[what] += count
    again = len(soak.heard) - len({number for number, _ in soak.heard})
    away = sum(was_away for _, was_away in soak.unheard())
    print(f"{soak.number} messages: {dict(soak.states)}; {dict(soak.events)}; "
          f"frames dropped: {dict(dropped) or 'none'}")  # fmt: skip
    print(f"{again} heard once more by another life of the recipient; {away} delivered to a node "
          "whose listener was killed with it, or not back yet")  # fmt: skip
    sizes = list(soak.grown())
    if sizes:
        first, last = max(size for _, size, _ in sizes), max(size for _, _, size in sizes)
        used = "no node ran all the time" if math.isnan(cpu) else f"CPU of a node {cpu:.1f} %"
        print(f"largest life of a node {first:.1f} MiB after {SETTLED_S:g} s, {last:.1f} MiB at "
              f"its end; {used}")  # fmt: skip


if __name__ == "__main__":
    main()
