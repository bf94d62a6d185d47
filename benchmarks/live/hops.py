"""python -m benchmarks.live.hops: messages a second and their delay over a line of nodes.

Three processes on loopback, node 0 to node 2 over node 1, at a window of messages without an end
and at 50 a second; plain and sealed, in Python and as C, through bare sockets (`hop_bare.py`: what
asyncio costs at the least), and through Reticulum and Zenoh where `rns` and `eclipse-zenoh` are
installed, in turn. Those two are sent to as fast as they take it.
"""

import argparse
import json
import os
import socket
import statistics
import subprocess
import sys
import tempfile
from contextlib import nullcontext
from importlib.util import find_spec
from pathlib import Path

from innervate.live.machine import machine

ENDS = ("-m", "benchmarks.live.hop_ends")
OTHERS = "benchmarks.live.hop_others"
KEY = "ab" * 32
PACKAGES = {"rns": "RNS", "zenoh": "zenoh"}


def free_ports(count):
    """UDP ports that nobody has at this moment."""
    socks = [socket.socket(socket.AF_INET, socket.SOCK_DGRAM) for _ in range(count)]
    for sock in socks:
        sock.bind(("127.0.0.1", 0))
    ports = [sock.getsockname()[1] for sock in socks]
    for sock in socks:
        sock.close()
    return ports


def ours(folder, count, sealed=False, settings=None, engine="python", shape="line", warm=False):
    """Commands that start nodes of ours; node 1 is the gateway.

    `shape` is "line", "star" (all are neighbours of node 1 alone) or the address of a group.
    """
    ports, commands = free_ports(count), []
    for i in range(count):
        near = (i - 1, i + 1) if shape == "line" else [1] if i != 1 else range(count)
        peers = [f"127.0.0.1:{ports[k]}" for k in near if 0 <= k < count and k != i]
        link = (['kind = "multicast"', 'interface = "127.0.0.1"', f'group = "{shape}"']
                if ":" in shape
                else ['kind = "udp"', f'bind = "127.0.0.1:{ports[i]}"',
                      f"peers = {json.dumps(peers)}"])  # fmt: skip
        lines = ['kind = "mesh"', f"number = {i}", f"nodes = {count}",
                 f'role = "{"gateway" if i == 1 else "node"}"',
                 f'socket = "{folder / f"n{i}.sock"}"', f'engine = "{engine}"',
                 f"warm = {json.dumps(warm)}",
                 *(["[keys]", "use = 1", f'secret.1 = "{KEY}"'] if sealed else []),
                 "[protocol]", *(f"{k} = {v}" for k, v in (settings or {}).items()),
                 "[[link]]", *link]  # fmt: skip
        file = folder / f"n{i}.toml"
        file.write_text("\n".join(lines) + "\n")
        commands.append([*ENDS, str(file)])
    return commands


def bare():
    """Commands that start three nodes that do the least that any in Python can do."""
    ports = list(map(str, free_ports(3)))
    return [[*ENDS, "bare", str(i), *ports] for i in range(3)]


def others(which, folder):
    """Commands that start three nodes of another system, the one in the middle first."""
    (port,) = free_ports(1)
    return [["-m", OTHERS, which, str(i), str(port), str(folder)] for i in range(3)]


class Line:
    """Nodes 0 .. count - 1 as processes, each joined with the next.

    Args:
        commands: what starts each.
        log: a file for what they write as errors; None = where ours go.
    """

    def __init__(self, commands, log=None):
        self.nodes = [None] * len(commands)
        for i in sorted(range(len(commands)), key=lambda i: i != 1):  # others call the middle
            self.nodes[i] = subprocess.Popen(
                [sys.executable, *commands[i]],
                stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=log, text=True,
            )  # fmt: skip
            self.hear(i)

    def hear(self, i):
        """The next line that node i says."""
        return json.loads(self.nodes[i].stdout.readline())

    def ask(self, i, words):
        """What node i answers."""
        self.nodes[i].stdin.write(words + "\n")
        self.nodes[i].stdin.flush()
        return self.hear(i)

    def measure(self, size, seconds, plan):
        """Messages from the first to the last: a second, CPU of each node, delay p50 and p99."""
        last = len(self.nodes) - 1
        for i in range(1, last + 1):
            self.ask(i, "take")
        told = self.ask(0, f"send {last} {size} {seconds} {plan}")
        others = [self.ask(i, "take") for i in range(1, last + 1)]
        late_us = sorted(others[-1]["late_us"])
        count = max(min(told["delivered"], len(late_us)), 1)
        return {
            "per_s": min(told["delivered"], len(late_us)) / told["seconds"],
            "states": told["states"],
            "p50_us": statistics.median(late_us) if late_us else 0.0,
            "p99_us": late_us[int(0.99 * len(late_us))] if late_us else 0.0,
            "cpu_us": [1e6 * one["cpu_s"] / count for one in (told, *others)],
            "middle": others[0],
        }

    def stop(self):
        for node in self.nodes:
            node.stdin.close()
        for node in self.nodes:
            node.wait()


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--seconds", type=float, default=4.0)
    parser.add_argument("--size", type=int, default=64, help="bytes of a message")
    parser.add_argument("--hops", type=int, default=2)
    parser.add_argument("--set", action="append", default=[], metavar="KEY=VALUE")
    parser.add_argument("--engines", nargs="+", default=["python", "c"], metavar="ENGINE")
    parser.add_argument("--realtime", action="store_true", help="before other work (as root)")
    parser.add_argument("--awake", action="store_true", help="no processor sleeps (Linux, as root)")
    parser.add_argument("--warm", action="store_true", help="nodes of ours keep warm")
    args = parser.parse_args()
    awake = machine().keep_awake() if args.awake else nullcontext()
    with awake:
        compare(args)


def compare(args):
    """A table of all sides."""
    if args.realtime:
        os.sched_setscheduler(0, os.SCHED_FIFO, os.sched_param(20))
    settings = dict(one.split("=") for one in args.set)
    found = [name for name, package in PACKAGES.items() if find_spec(package)]
    own = [f"{side} {engine}" for side in ("plain", "sealed") for engine in args.engines]
    for side in (*own, *(("bare", *found) if args.hops == 2 else ())):
        with tempfile.TemporaryDirectory() as folder:
            if side in PACKAGES:
                line = Line(others(side, Path(folder)))
            elif side == "bare":
                line = Line(bare())
            else:
                how, engine = side.split()
                nodes = ours(Path(folder), args.hops + 1, how == "sealed", settings, engine,
                             warm=args.warm)  # fmt: skip
                line = Line(nodes)
            for plan in ("r50", "w64") if side in PACKAGES else ("r50", "w1", "w64"):
                tell(side, plan, line.measure(args.size, args.seconds, plan))
            line.stop()


def tell(side, plan, found):
    """A row of the table."""
    cpu = " / ".join(f"{us:.0f}" for us in found["cpu_us"])
    print(f"{side:13} {plan:4} {found['per_s']:7.0f} /s  p50 {found['p50_us']:7.0f} us  "
          f"p99 {found['p99_us']:7.0f} us  CPU us a message {cpu}  {found['states']}  "
          f"load {os.getloadavg()[0]:.1f}", flush=True)  # fmt: skip


if __name__ == "__main__":
    main()
