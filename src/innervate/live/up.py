"""A whole scenario as processes, on loopback or in network namespaces."""

import asyncio
import signal
import socket
import subprocess
import sys
import time
from collections.abc import Mapping
from contextlib import ExitStack
from pathlib import Path
from typing import Any

from innervate.live import files, hangup, private, status
from innervate.live.deployment import Deployment, Table, ask
from innervate.live.errors import LiveError
from innervate.live.links import NEAR, REACH
from innervate.live.netns import UDP_PORT, Lab
from innervate.live.serial_cables import Cables
from innervate.network import networks

NodeTables = tuple[Table, dict[str, Table], list[Table]]
START_S = 30.0
START_EACH_S = 2.0  # besides, of each node: all start at once, beside whatever else there is to do
SAY_S = 10.0  # between two lines on nodes that are waited for
STOP_S = 5.0


class Processes:
    """Node files and processes of a scenario.

    Args:
        plan: a scenario's plan.
        folder: where files, logs and sockets go.
        cables: "udp" (loopback), "pty" or "netns" (as root).
        keys: a [keys] table for all nodes, "{number}" in its identity is each one's; None = frames
            go in the clear.
        images: by name, what runs a node's protocol on an emulated board.

    Attributes:
        deployment: what it knows of the plan's nodes.
        names: every node's name, by number.
        links: cables: pairs of nodes.
        absent: who is not started until an event says so.
        engine: what runs the nodes' protocols; "" = as their files have it.
    """

    def __init__(
        self,
        plan: Any,
        folder: Path,
        cables: str,
        keys: dict[str, Any] | None = None,
        images: Mapping[str, Path] | None = None,
    ) -> None:
        self.plan = plan
        self.folder = folder
        self.cables = cables
        self.keys = keys
        self.images = dict(images or {})
        self.engine = ""
        self.processes: dict[str, subprocess.Popen[bytes]] = {}
        self.lab: Lab | None = None
        self.relay: Cables | None = None
        self.deployment: Deployment = networks()[plan.kind].deployment(plan)
        self.deployment.check(cables, keys is not None)
        self.names, self.links = self.deployment.names, self.deployment.links
        away = getattr(plan, "absent", ())
        self.absent = {name for name, gone in zip(self.names, away, strict=False) if gone}
        self._ports: list[list[int]] = []  # per node: the cables of its paths
        # By cable and what it is about, reach or harm: apart, cut or loose.
        self._hurt: dict[tuple[int, bool], tuple[str, float]] = {}
        self._changing = asyncio.Lock()  # or two at once would leave a cable cut at one end
        self._medium = ""  # its address
        self._tables: dict[str, NodeTables] = {}

    def take_folder(self) -> None:
        """Make the folder, or take it over: sockets of nodes that were killed go.

        Raises:
            LiveError: it cannot be made, or a node runs there, whatever its name is.
        """
        try:
            self.folder.mkdir(mode=private.FOLDER, parents=True, exist_ok=True)
        except OSError as error:
            why = "is a file" if self.folder.is_file() else f"cannot be made: {error.strerror}"
            raise LiveError(f"{self.folder} {why}; name another --folder") from None
        for path in sorted(self.folder.glob("*.sock")):
            if status.answers(path):
                raise LiveError(
                    f"{self.folder}: {path.stem} of another network runs here; end it, or name "
                    "another --folder"
                )
            if path.is_socket() and status.is_left(path):
                path.unlink(missing_ok=True)

    async def up(self) -> None:
        """Write the files, start the processes, wait until all of them answer.

        Raises:
            LiveError: something is missing, or a node does not come up; its own line is in it.
        """
        self.take_folder()
        if self.cables == "netns":
            self.lab = Lab("iv", len(self.names), self.links)
            self.lab.up()
        elif self.cables == "pty":
            self.relay = Cables(len(self.links))
            self.relay.start()
        if self.deployment.has_channel:
            await self._start_medium()
        paths = self._paths()
        for number, name in enumerate(self.names):
            self._tables[name] = self._file(number, paths[number])
            self.write_file(name)
        there = [name for name in self.names if name not in self.absent]
        for name in there:
            self.start_node(name)
        await self._ready(there)

    async def _start_medium(self) -> None:
        """The channel that the nodes share, a process of its own."""
        self._medium = f"127.0.0.1:{free_ports(1)[0]}"
        slot_us, turnaround_us = self.deployment.channel()
        command = [sys.executable, "-m", "innervate.cli", "live", "medium", self._medium]
        command += ["--slot-us", str(slot_us), "--turnaround-us", str(turnaround_us)]
        process = subprocess.Popen(command, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE)
        self.processes["medium"] = process
        assert process.stdout is not None
        said = await asyncio.to_thread(process.stdout.readline)
        if not said:
            raise LiveError("the channel (innervate live medium) did not start; see the line above")

    def start_node(self, name: str) -> None:
        """Start a node's process, or start it again."""
        command = [sys.executable, "-m", "innervate.cli", "live", "node", f"{name}.toml"]
        if name in self.images:
            command += ["--firmware", str(self.images[name])]
        elif self.engine:
            command += ["--engine", self.engine]
        if self.lab is not None:
            command = self.lab.inside(self.names.index(name), command)
        with (self.folder / f"{name}.log").open("a") as log, hangup.held():
            self.processes[name] = subprocess.Popen(
                command, cwd=self.folder, stdin=subprocess.DEVNULL, stdout=log, stderr=log
            )

    async def begin_node(self, name: str) -> None:
        """Start a node, or start it again; its cut cables stay cut."""
        if name in self.processes and self.processes[name].poll() is None:
            return
        self.start_node(name)
        await self._ready([name])
        number = self.names.index(name)
        async with self._changing:
            for (cable, _), (what, loss) in self._hurt.items():
                if number in self.links[cable]:
                    await self._change_end(number, cable, what, loss)

    async def end_node(self, name: str, gently: bool) -> None:
        """End a node: SIGKILL, or gently SIGTERM."""
        process = self.processes.get(name)
        if process is not None and process.poll() is None:
            process.send_signal(signal.SIGTERM if gently else signal.SIGKILL)
            await asyncio.to_thread(process.wait)

    async def change(self, cable: int, what: str, loss: float = 0.0) -> None:
        """Cut, restore or loosen a cable at both its ends, or say who is in reach."""
        about = (cable, what in REACH)
        async with self._changing:
            self._hurt[about] = (what, loss)
            if what in ("restore", NEAR):
                self._hurt.pop(about, None)
            for number in self.links[cable]:
                await self._change_end(number, cable, what, loss)

    async def _change_end(self, number: int, cable: int, what: str, loss: float) -> None:
        request = {"do": what, "port": self._ports[number].index(cable), "loss": loss}
        await ask(self.socket(self.names[number]), request)

    def socket(self, name: str) -> Path:
        """Where a node's status socket lies."""
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

    async def _ready(self, names: list[str]) -> None:
        """Wait until all of them answer, and say now and then for whom."""
        limit_s = START_S + START_EACH_S * len(self.names)
        began, said_s, waiting = time.monotonic(), 0.0, list(names)
        while waiting := [name for name in waiting if not status.answers(self.socket(name))]:
            for name in waiting:
                if self.processes[name].poll() is not None:
                    raise LiveError(f"{name} ended: {self._last_words(name)}")
            took_s, more = time.monotonic() - began, len(waiting) - 1
            first = waiting[0] + f" and {more} more" * bool(more)
            if took_s > limit_s:
                raise LiveError(f"{first} did not answer within {limit_s:g} s")
            if took_s > said_s + SAY_S:
                said_s += SAY_S
                said = f"{first} did not answer within {said_s:g} s; waiting up to {limit_s:g} s"
                print(said, file=sys.stderr, flush=True)
            await asyncio.sleep(0.02)

    def failed(self) -> dict[str, str]:
        """Nodes that ended by themselves, and what they said last."""
        codes = {name: process.poll() for name, process in self.processes.items()}
        return {name: self._last_words(name) for name, code in codes.items() if (code or 0) > 0}

    def _last_words(self, name: str) -> str:
        log = (self.folder / f"{name}.log").read_text().strip().splitlines()
        return log[-1].removeprefix(f"{name}: ") if log else "no message"

    def _paths(self) -> list[dict[int, Table]]:
        """Per node: the link table of each of its cables, in order of its paths."""
        found: list[dict[int, Table]] = [{} for _ in self.names]
        ports = free_ports(2 * len(self.links)) if self.cables == "udp" else []
        for k, ends in enumerate(self.links):
            for side, node in enumerate(ends):
                table: Table
                if self.lab is not None:
                    own = self.lab.address(k, node)
                    other = self.lab.address(k, ends[1 - side])
                    table = _udp(f"{own}:{UDP_PORT}", f"{other}:{UDP_PORT}")
                elif self.relay is not None:
                    own, other = (self.relay.devices[2 * k + i] for i in (side, 1 - side))
                    table = {"kind": "serial", "device": own, "far": other, "baud": 4_000_000}
                else:
                    own, other = (f"127.0.0.1:{ports[2 * k + i]}" for i in (side, 1 - side))
                    table = _udp(own, other)
                found[node][k] = table
        for number, tables in enumerate(found):
            order = self.deployment.in_order(number, list(tables))
            found[number] = {k: tables[k] for k in order}
        self._ports = [list(tables) for tables in found]
        return found

    def write_file(self, name: str) -> None:
        """Write a node's file, with the keys as they are now."""
        head, tables, links = self._tables[name]
        if self.keys is not None:
            keys = {**self.keys}
            if "identity" in keys:
                keys["identity"] = keys["identity"].format(number=head["number"])
            tables = {**tables, "keys": keys}
        path = self.folder / f"{name}.toml"
        private.write(path, files.text(head, tables, links))  # keys may stand in it

    def _file(self, number: int, paths: dict[int, Table]) -> NodeTables:
        """What a node's file says: its own keys, tables, links."""
        name = self.names[number]
        head, tables = self.deployment.file(number, list(paths))
        links = list(paths.values())
        if self.deployment.has_channel:
            links = [{"kind": "medium", "address": self._medium}]
        common = {"kind": self.plan.kind, "name": name, "number": number}
        common["socket"] = str(self.socket(name))
        return {**common, **head}, tables, links


def _udp(own: str, other: str) -> Table:
    """The link table of a cable over UDP."""
    return {"kind": "udp", "bind": own, "peers": [other]}


def free_ports(count: int) -> list[int]:
    """UDP ports on loopback that nobody uses now."""
    with ExitStack() as stack:
        socks = [stack.enter_context(socket.socket(type=socket.SOCK_DGRAM)) for _ in range(count)]
        for sock in socks:
            sock.bind(("127.0.0.1", 0))
        return [sock.getsockname()[1] for sock in socks]
