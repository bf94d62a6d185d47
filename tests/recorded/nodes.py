"""What live nodes answer and tell at fixed times, kept line by line.

Whole nodes with their status sockets run in this process under simulated time, joined by cables
inside it. `python -m tests.recorded.nodes` writes what they say into `nodes/`.
"""

from __future__ import annotations

import asyncio
import json
import random
import re
import sys
import tempfile
from collections.abc import Awaitable, Callable
from pathlib import Path
from typing import Any
from unittest import mock

from innervate.live import local, main, metrics, state
from innervate.live.keys import Sealer, ring_of
from innervate.live.machine import on
from innervate.live.nodefile import load
from innervate.networks.mesh.live.node import MeshNode
from innervate.networks.mesh.live.parameters import fence_parameters, mesh_parameters
from innervate.networks.mesh.live.stack import MeshStack
from innervate.networks.radio.live.parameters import radio_parameters
from innervate.networks.skin.live.parameters import skin_parameters
from tests.live import time_by_hand
from tests.live.net import Skin
from tests.recorded.record import differences

FOLDER = Path(__file__).resolve().parent / "nodes"
FILE = """kind = "{kind}"
name = "{name}"
number = {number}
socket = "{folder}/{name}.sock"
{more}[[link]]
kind = "udp"
bind = "127.0.0.1:1"
peers = ["127.0.0.1:2"]
"""
KEY = bytes(range(32))


class Clocked(time_by_hand.Clocked):
    """Both clocks are the loop's, and chance is the same each time."""

    def __init__(self, loop: asyncio.AbstractEventLoop) -> None:
        super().__init__(loop)
        self.chance = random.Random(11)

    def time_ns(self) -> int:
        return round(self.loop.time() * 1e9)


class House:
    """Nodes as processes would have them: sockets, signals' work, notices; and what they say.

    Args:
        folder: where the sockets are.
        nodes: built, not started.
        more: what their files say besides number and link.
    """

    def __init__(self, folder: Path, nodes: dict[str, Any], more: dict[str, str]) -> None:
        self.folder, self.nodes = folder, nodes
        self.said: list[Any] = []
        self._running: list[asyncio.Task[Any]] = []
        self._more = more
        self._processes: list[main.Process] = []

    async def __aenter__(self) -> House:
        for number, (name, one) in enumerate(self.nodes.items()):
            path = self.folder / f"{name}.toml"
            more = self._more.get(name, self._more[""])
            path.write_text(FILE.format(kind=self._more["kind"], name=name, number=number,
                                        folder=self.folder, more=more))  # fmt: skip
            with mock.patch.object(main, "build", lambda *_asked, one=one: one):
                process = main.Process(load(path))
            process.notices._say = lambda text, name=name: self.said.append([name, text])
            self._processes.append(process)
            await process.server.start()
        for one in reversed(self.nodes.values()):
            await one.start()
        return self

    async def __aexit__(self, *_: object) -> None:
        for task in self._running:
            task.cancel()
        for process, one in zip(self._processes, self.nodes.values(), strict=True):
            await one.stop()
            await process.server.stop()

    async def ask(self, name: str, **request: Any) -> None:
        """Ask a node something, and note what it answers until it has no more to say."""
        reader, writer = await asyncio.open_unix_connection(self.folder / f"{name}.sock")
        writer.write(json.dumps(request).encode() + b"\n")
        writer.write_eof()
        lines: list[Any] = []
        while line := await reader.readline():
            lines.append(json.loads(line))
        writer.close()
        self.said.append([name, request, lines])

    def follow(self, name: str, **request: Any) -> None:
        """Ask a node for all that comes, and note it as it comes."""
        self._running.append(asyncio.ensure_future(self._follow(name, request)))

    async def _follow(self, name: str, request: dict[str, Any]) -> None:
        reader, writer = await asyncio.open_unix_connection(self.folder / f"{name}.sock")
        writer.write(json.dumps(request).encode() + b"\n")
        while line := await reader.readline():
            self.said.append([f"{name} tells", json.loads(line)])

    async def look(self, at_s: float) -> None:
        """Note every node's status and its page of metrics, `at_s` after the loop's 1000 s."""
        await asyncio.sleep(1000 + at_s - asyncio.get_running_loop().time())
        for name, one in self.nodes.items():
            self.said.append([f"{name} at {at_s:g} s", one.status()])
            self.said.append([f"{name} metrics at {at_s:g} s", list(metrics.lines(one))])


async def mesh(folder: Path) -> list[Any]:
    """A gateway, a relay, a standby and a robot in a fence: messages, orders, alarms, cuts."""
    fence = fence_parameters([[(0, 0), (1000, 0), (1000, 1000), (0, 1000)]])
    params = mesh_parameters(4, {"ack_us": 30_000, "e2e_us": 300_000, "suspect_us": 500_000})
    params |= fence | {"fence": 1}
    links: list[list[Any]] = [[], [], [], []]
    for a, b in ((0, 1), (1, 2), (1, 3), (0, 2)):
        here, there = local.pair(f"{a}-{b}", (len(links[a]), len(links[b])))
        links[a].append(here)
        links[b].append(there)
    ranks = (0, -1, 1, -1)
    nodes = {}
    for i, rank in enumerate(ranks):
        stack = MeshStack(i, rank, params, 7919 * (i + 1) ** 3, i == 3)
        sealer = Sealer(ring_of("mesh", {1: KEY}, 1), i, state.State(None))
        nodes[f"n{i}"] = MeshNode(f"n{i}", stack, links[i], sealer)
    more = {"kind": "mesh", "": "nodes = 4\n", "n3": "nodes = 4\nrobot = true\n"}
    async with House(folder, nodes, more) as house:
        house.follow("n0", do="listen", alarms=True)
        house.follow("n1", do="listen", in_order=True)
        house.follow("n2", do="listen")
        await house.look(0.4)
        await house.look(6.0)
        for request in (
            {"to": 1, "payload": "6869"}, {"to": 2, "payload": "00", "priority": True},
            {"to": 255, "payload": "ff", "wait": False}, {"to": 9, "payload": ""},
            {"to": 0, "payload": "aa" * 91},
            {"to": 254, "payload": "0102", "reliable": False, "wait": False},
            {"to": 1, "payload": "0a", "in_order": True}, {"to": 1, "payload": "0b" * 89,
            "in_order": True}, {"to": 3, "payload": "03"}, {"to": 3}, {"payload": "zz", "to": 1},
        ):  # fmt: skip
            await house.ask("n3", do="send", **request)
        for at in ([500, 500], [900, 500], [990, 500], [1010, 500], [2000, 500], [500, 500]):
            await house.ask("n3", do="locate", at_cm=at, speed_cm_s=[50, 0])
            await asyncio.sleep(0.2)
        await house.ask("n1", do="locate", at_cm=[1, 1])
        await house.look(12.0)
        await house.ask("n1", do="cut", port=2)
        await house.ask("n1", do="cut", port=3)
        await house.ask("n1", do="loose", port=0, loss=1.5)
        await house.ask("n1", do="loose", port=0, loss=1)
        await house.ask("n0", do="send", to=3, payload="0c")
        await house.ask("n1", do="send", to=2, payload="0d")
        await house.look(20.0)
        await house.ask("n1", do="restore", port=2)
        await house.ask("n1", do="restore", port=0)
        await house.ask("n1", do="command", code=1)
        await house.ask("n1", do="nothing")
        await house.ask("n1", to=3)
        await house.look(40.0)
        return house.said


async def skin(folder: Path) -> list[Any]:
    """Four cells and a PC: samples, commands, cuts."""
    made = Skin(2, 2, [(0, 0)], rate_hz=0.5)
    nodes = {one.name: one for one in (*made.cells, made.pc)}
    more = {"kind": "skin", "": 'role = "cell"\nports = [0]\n', "pc": 'role = "sink"\n'}
    async with House(folder, nodes, more) as house:
        house.follow("pc", do="listen")
        house.follow("c3", do="listen")
        await house.look(0.3)
        for request in ({"code": 7, "value": 300}, {"code": 8, "cell": 3}, {"code": 256},
                        {"code": 1, "cell": 65535}, {"code": 1.5}, {"value": 3}):  # fmt: skip
            await house.ask("pc", do="command", **request)
            await asyncio.sleep(0.1)
        await house.ask("c0", do="command", code=1)
        await house.ask("c0", do="send", to=1, payload="00")
        await house.look(2.5)
        await house.ask("c0", do="cut", port=9)
        await house.ask("c0", do="cut", port=3)
        await house.ask("c0", do="cut", port=-1)
        await house.ask("c0", do="cut", port=0)
        await house.look(3.5)
        await house.ask("c0", do="restore", port=0)
        await house.ask("c3", do="loose", port=0, loss=0)
        await house.look(5.0)
        return house.said


async def parameters(_folder: Path) -> list[Any]:
    """What nodes go by whose files say nothing of it."""
    made = {"skin": skin_parameters({}), "mesh": mesh_parameters(3, {}),
            "radio": radio_parameters({})}  # fmt: skip
    return [[kind, name, value] for kind, found in made.items() for name, value in found.items()]


SCRIPTS: dict[str, Callable[[Path], Awaitable[list[Any]]]] = {
    "mesh": mesh,
    "skin": skin,
    "parameters": parameters,
}


def said(name: str) -> list[Any]:
    """What is said in a script."""

    async def all_of_it() -> list[Any]:
        with tempfile.TemporaryDirectory() as folder, on(Clocked(asyncio.get_running_loop())):
            return await SCRIPTS[name](Path(folder))

    found: list[Any] = time_by_hand.run(all_of_it())
    return found


def lines(found: list[Any]) -> str:
    """As it is kept, a line for each."""
    text = "".join(json.dumps(one, separators=(",", ":")) + "\n" for one in found)
    return re.sub(r'"/tmp/[^"]*"', '"-"', text)


def changes(name: str) -> list[str]:
    """Where nodes say something else than was kept, one line each."""
    kept = (FOLDER / f"{name}.jsonl").read_text(encoding="utf-8").splitlines()
    now = lines(said(name)).splitlines()

    def numbered(all_lines: list[str]) -> dict[str, Any]:
        return {str(at): dict(enumerate(json.loads(one))) for at, one in enumerate(all_lines)}

    return differences(name, numbered(kept), numbered(now))


def write() -> int:
    """Write what nodes say."""
    FOLDER.mkdir(exist_ok=True)
    for name in SCRIPTS:
        (FOLDER / f"{name}.jsonl").write_text(lines(said(name)), encoding="utf-8")
        print(f"nodes {name}", flush=True)
    return 0


if __name__ == "__main__":
    sys.exit(write())
