"""`innervate live up`: a whole scenario as processes, on loopback or in network namespaces."""

from __future__ import annotations

import asyncio
import contextlib
import json
import os
import signal
import socket
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from typing import Any

from innervate.live import status
from innervate.live.errors import LiveError
from innervate.live.netns import UDP_PORT, Lab
from innervate.live.serial_cables import Cables

START_S = 30.0
STOP_S = 5.0
PORTS = 4


class Network:
    """Node files and processes of a scenario.

    Args:
        plan: a plan of kind mesh or skin.
        folder: where files, logs and sockets go.
        cables: "udp" (loopback), "pty" (skins only) or "netns" (as root).

    Attributes:
        names: every node's name, by number; the PC of a skin is the last.
    """

    def __init__(self, plan: Any, folder: Path, cables: str) -> None:
        self.plan = plan
        self.folder = folder
        self.cables = cables
        self.processes: dict[str, subprocess.Popen[bytes]] = {}
        self.lab: Lab | None = None
        self.relay: Cables | None = None
        if plan.kind == "mesh":
            self.names = [f"n{i}" for i in range(plan.nodes)]
            self.links = list(plan.good)
        elif plan.kind == "skin":
            self.names = [*(f"c{i}" for i in range(plan.graph.cells)), "pc"]
            self.links, self._ends = _cables(plan.graph)
        else:
            how = "innervate live medium, then innervate live node for each station"
            raise LiveError(f"a radio team is brought up by hand: {how}")
        if cables == "pty" and plan.kind != "skin":
            raise LiveError("--pty joins the cells of a skin; mesh nodes take --netns or UDP")

    async def up(self) -> None:
        """Write the files, start the processes, wait until all of them answer.

        Raises:
            LiveError: something is missing, or a node does not come up; its own line is in it.
        """
        self.folder.mkdir(parents=True, exist_ok=True)
        if self.cables == "netns":
            self.lab = Lab("iv", len(self.names), self.links)
            self.lab.up()
        elif self.cables == "pty":
            self.relay = Cables(len(self.links))
            self.relay.start()
        paths = self._paths()
        for number, name in enumerate(self.names):
            text = self._file(number, paths[number])
            (self.folder / f"{name}.toml").write_text(text)
        for name in self.names:
            self.start_node(name)
        await self._ready()

    def start_node(self, name: str) -> None:
        """Start a node's process, or start it again."""
        command = [sys.executable, "-m", "innervate.cli", "live", "node", f"{name}.toml"]
        if self.lab is not None:
            command = self.lab.inside(self.names.index(name), command)
        with (self.folder / f"{name}.log").open("a") as log:
            self.processes[name] = subprocess.Popen(
                command, cwd=self.folder, stdin=subprocess.DEVNULL, stdout=log, stderr=log
            )

    def socket(self, name: str) -> Path:
        """A node's status socket."""
        return self.folder / f"{name}.sock"

    async def down(self) -> None:
        """SIGTERM to all, and wait; whoever does not end is killed."""
        for process in self.processes.values():
            if process.poll() is None:
                process.send_signal(signal.SIGTERM)
        until = time.monotonic() + STOP_S
        for process in self.processes.values():
            while process.poll() is None and time.monotonic() < until:
                await asyncio.sleep(0.02)
            if process.poll() is None:
                process.kill()
            process.wait()
        if self.relay is not None:
            self.relay.stop()
        if self.lab is not None:
            self.lab.down()

    async def _ready(self) -> None:
        until = time.monotonic() + START_S
        for name in self.names:
            while not status.answers(self.socket(name)):
                if self.processes[name].poll() is not None:
                    log = (self.folder / f"{name}.log").read_text().strip().splitlines()
                    raise LiveError(f"{name} ended: {log[-1] if log else 'no message'}")
                if time.monotonic() > until:
                    raise LiveError(f"{name} does not answer after {START_S:g} s")
                await asyncio.sleep(0.02)

    def _paths(self) -> list[list[tuple[int, dict[str, Any]]]]:
        """Per node: (cable, link table) for each of its cables, in order."""
        found: list[list[tuple[int, dict[str, Any]]]] = [[] for _ in self.names]
        ports = _free_ports(2 * len(self.links)) if self.cables == "udp" else []
        for k, ends in enumerate(self.links):
            for side, node in enumerate(ends):
                table: dict[str, Any]
                if self.lab is not None:
                    own = self.lab.address(k, node)
                    other = self.lab.address(k, ends[1 - side])
                    table = {"bind": f"{own}:{UDP_PORT}", "peers": [f"{other}:{UDP_PORT}"]}
                elif self.relay is not None:
                    table = {"device": self.relay.devices[2 * k + side], "baud": 4_000_000}
                else:
                    own_port, other_port = ports[2 * k + side], ports[2 * k + 1 - side]
                    table = {
                        "bind": f"127.0.0.1:{own_port}",
                        "peers": [f"127.0.0.1:{other_port}"],
                    }
                found[node].append((k, table))
        return found

    def _file(self, number: int, paths: list[tuple[int, dict[str, Any]]]) -> str:
        """A node file."""
        head: dict[str, Any] = {"kind": self.plan.kind, "name": self.names[number]}
        head["number"] = number
        head["socket"] = str(self.socket(self.names[number]))
        if self.plan.kind == "mesh":
            rank = self.plan.ranks[number]
            head["nodes"] = self.plan.nodes
            head["role"] = "node" if rank < 0 else "gateway" if rank == 0 else "standby"
            if rank > 0:
                head["rank"] = rank
            params = {k: v for k, v in self.plan.params.items() if k not in NOT_IN_FILES}
        else:
            params = dict(self.plan.params)
            if number == len(self.names) - 1:
                head["role"] = "sink"
                paths = sorted(paths, key=lambda path: self._ends[path[0]][1])
            else:
                head["role"] = "cell"
                head["ports"] = [self._ends[k][self.links[k].index(number)] for k, _ in paths]
                period_us = self.plan.data_period_us
                head["rate_hz"] = 1e6 / period_us if period_us else 0.0
        lines = [f"{key} = {json.dumps(value)}" for key, value in head.items()]
        lines += ["", "[protocol]", *(f"{key} = {value}" for key, value in params.items())]
        kind = "serial" if self.relay is not None else "udp"
        for _, table in paths:
            lines += ["", "[[link]]", f'kind = "{kind}"']
            lines += [f"{key} = {json.dumps(value)}" for key, value in table.items()]
        return "\n".join(lines) + "\n"


# They follow from the file itself, or belong to the fence, which live nodes do not have yet.
NOT_IN_FILES = ("nodes", "width", "row", "told", "places", "px", "py", "after")


def _cables(graph: Any) -> tuple[list[tuple[int, int]], list[tuple[int, int]]]:
    """Cables of a skin: pairs of nodes, and the port at either end."""
    links, ends = [], []
    sockets = PORTS * graph.cells
    for end, other in enumerate(graph.peer):
        if end < other:
            here = (end // PORTS, end % PORTS)
            there = (other // PORTS, other % PORTS)
            if other >= sockets:
                there = (graph.cells, other - sockets)
            links.append((here[0], there[0]))
            ends.append((here[1], there[1]))
    return links, ends


def _free_ports(count: int) -> list[int]:
    """UDP ports on loopback that nobody uses now."""
    found, socks = [], []
    with contextlib.ExitStack() as stack:
        for _ in range(count):
            sock = stack.enter_context(socket.socket(socket.AF_INET, socket.SOCK_DGRAM))
            sock.bind(("127.0.0.1", 0))
            socks.append(sock)
            found.append(sock.getsockname()[1])
    return found


async def run(plan: Any, folder: Path | None, cables: str, for_s: float, as_json: bool) -> int:
    """Bring a scenario up and keep it until Ctrl-C, SIGTERM or the time is over; 0."""
    own = folder is None
    folder = Path(tempfile.mkdtemp(prefix="innervate-")) if folder is None else folder.absolute()
    network = Network(plan, folder, cables)
    ending = asyncio.Event()
    loop = asyncio.get_running_loop()
    for number in (signal.SIGTERM, signal.SIGINT):
        loop.add_signal_handler(number, ending.set)
    began = time.monotonic()
    try:
        await network.up()
        _announce(network, time.monotonic() - began, as_json)
        with contextlib.suppress(TimeoutError):
            async with asyncio.timeout(for_s or None):
                await ending.wait()
    finally:
        await network.down()
        if own and os.path.isdir(folder):
            import shutil

            shutil.rmtree(folder, ignore_errors=True)
    return 0


def _announce(network: Network, took_s: float, as_json: bool) -> None:
    if as_json:
        nodes = {
            name: {"pid": network.processes[name].pid, "socket": str(network.socket(name))}
            for name in network.names
        }
        told = {"folder": str(network.folder), "up_s": round(took_s, 3), "nodes": nodes}
        print(json.dumps(told), flush=True)
        return
    count, cables = len(network.names), len(network.links)
    print(f"{count} nodes and {cables} cables are up after {took_s:.1f} s; Ctrl-C ends them.")
    print(f"Look: INNERVATE_RUN={network.folder} innervate live status", flush=True)
