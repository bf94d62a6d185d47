"""`innervate live capture`: frames of running nodes to a capture, while they run."""

import asyncio
import json
import signal
import sys
import time
from contextlib import closing, suppress
from pathlib import Path
from typing import Annotated, Any, BinaryIO

from cyclopts import Parameter

import innervate
from innervate.cli import live_status
from innervate.cli.errors import UserError, check_seconds, say
from innervate.export import links, pcapng
from innervate.export.errors import ExportError
from innervate.kernel.words import number_of
from innervate.live import private
from innervate.live.machine import ANSWER_S
from innervate.network import known

# Nodes tell of their frames a little later, each when it gets to it: time to put them in order.
HOLD_S = 0.25
LOOK_S = 0.02  # so often it is looked whether a node that went away is back
LINE_MAX = 1 << 22
EVENT = "event: "  # what happened, without a frame


def capture(
    *nodes: str, out: Path | None = None, for_: Annotated[float, Parameter(name=["--for"])] = 0.0
) -> int:
    """Capture until Ctrl-C, until `for_` seconds are over, or until all nodes are gone.

    Args:
        nodes: Names or sockets; all nodes of this user if left out.
        out: The capture; it can be read while it grows. Standard output if left out.
        for_: End after so many seconds; 0 = never.
    """
    check_seconds("--for", for_)
    sockets = live_status.sockets(nodes)
    if out is None:
        if sys.stdout.isatty():
            raise UserError("a capture is no text; name a file with --out, or pipe it to: "
                            "wireshark -k -i -")  # fmt: skip
        return asyncio.run(Recorder(sockets, sys.stdout.buffer, bool(nodes)).run(for_))
    try:
        with private.create(out) as file:
            return asyncio.run(Recorder(sockets, file, bool(nodes)).run(for_))
    except OSError as error:
        raise ExportError(f"{out} cannot be written: {error.strerror}") from None


class Recorder:
    """Follows nodes and writes what they tell, in order of time.

    Args:
        sockets: of the nodes.
        file: the capture; whole blocks are written, and none is held back for long.
        are_named: they were asked for one by one, and all of them have to answer.
    """

    def __init__(self, sockets: list[Path], file: BinaryIO, are_named: bool = True) -> None:
        self.sockets = sockets
        self.file = file
        self.are_named = are_named
        self.frames = self.missed = 0
        self.silent = len(sockets)  # nodes that have neither answered yet nor failed to
        self.followed: set[Path] = set()
        self.here = 0  # nodes that are followed now
        self.numbers: dict[tuple[str, str], int] = {}  # interfaces by name and description
        self.heads: dict[int, bytes] = {}  # what stands in front of all packets of an interface
        self.since_ns = 0
        self.waiting: list[tuple[int, int, bool, bytes, str]] = []
        self.sealed: list[str] = []

    async def run(self, for_s: float) -> int:
        """Capture until a signal comes or `for_s` seconds are over; the exit code, 0."""
        ending = asyncio.Event()
        loop = asyncio.get_running_loop()
        for number in (signal.SIGTERM, signal.SIGINT):
            loop.add_signal_handler(number, ending.set)
        comment = "innervate, live" + f" from {', '.join(path.stem for path in self.sockets)}"
        self.file.write(pcapng.section(comment, f"innervate {innervate.__version__}"))
        following = asyncio.gather(*(self._follow(path) for path in self.sockets))
        parts: list[asyncio.Future[Any]] = [asyncio.ensure_future(ending.wait()), following]
        writing = asyncio.create_task(self._write_on())
        try:
            await asyncio.wait(
                [*parts, writing], timeout=for_s or None, return_when=asyncio.FIRST_COMPLETED
            )  # fmt: skip
            if following.done():
                following.result()  # a node that refused
                if not self.followed:
                    raise UserError(f"no node answers here (folder {self.sockets[0].parent})")
            if writing.done():
                writing.result()  # the disk is full
        finally:
            for number in (signal.SIGTERM, signal.SIGINT):
                loop.remove_signal_handler(number)
            for part in (*parts, writing):
                part.cancel()
                with suppress(asyncio.CancelledError, Exception):
                    await part
            self._write(None)
        lost = f"; {self.missed} more came too fast" if self.missed else ""
        opened = f"; opened: sealed ones of {', '.join(self.sealed)}" if self.sealed else ""
        frames, nodes = number_of(self.frames, "frame"), number_of(len(self.followed), "node")
        say(f"{frames} of {nodes}{lost}{opened}")
        return 0

    async def _follow(self, path: Path) -> None:
        """Take what a node tells, also when it comes back, until all are gone."""
        again = False
        while self.here or self.silent or not again:
            try:
                async with asyncio.timeout(ANSWER_S):
                    reader, writer, about = await _asked(path)
            except (OSError, ValueError) as error:
                if not again:
                    self._does_not_answer(path, error)
            else:
                with closing(writer):
                    await self._take(path, reader, about, again)
            again = True
            await asyncio.sleep(LOOK_S)

    def _does_not_answer(self, path: Path, error: Exception) -> None:
        """Of all nodes that there are some may have been killed: the others are followed."""
        if self.are_named:
            raise UserError(f"{path}: no node answers here: {str(error) or 'timed out'}")
        say(f"{path.stem}: does not answer; its process was killed, or hangs")
        self.silent -= 1

    async def _take(
        self, path: Path, reader: asyncio.StreamReader, about: dict[str, Any], again: bool
    ) -> None:
        if "error" in about:
            raise UserError(f"{path.stem}: {about['error']}; start the node anew to capture it")
        numbers = self._announce(about)
        first = min(numbers.values())
        self.here += 1
        self.followed.add(path)
        if again:
            self.waiting.append((time.time_ns(), first, False, b"", EVENT + "node back"))
        else:
            self.silent -= 1
            self.since_ns = time.time_ns()
        with suppress(ConnectionError):  # killed
            await self._take_frames(reader, numbers)
        self.here -= 1
        self.waiting.append((time.time_ns(), first, False, b"", EVENT + "node gone"))

    async def _take_frames(self, reader: asyncio.StreamReader, numbers: dict[int, int]) -> None:
        while (line := await reader.readline()).endswith(b"\n"):
            told = json.loads(line)
            self.missed += told["missed"]
            for at_ns, port, is_out, text, why in told["frames"]:
                # Before all were followed, what left would seem to come in nowhere.
                if not self.silent and at_ns >= self.since_ns:
                    data = bytes.fromhex(text)
                    self.waiting.append((at_ns, numbers[port], is_out, data, why))

    def _announce(self, about: dict[str, Any]) -> dict[int, int]:
        """Write those of a node's interfaces that are new; their numbers by port."""
        if about["sealed"] and about["capturing"] not in self.sealed:
            self.sealed.append(about["capturing"])
        network = known(about["kind"])
        what = network.interface_words.get(about["role"], "node")
        link_type, head = network.link_type, b""
        reader = getattr(network.packets, "wireshark", None) if network.has("packets") else None
        if reader:
            link_type, head = pcapng.UPPER_PDU, pcapng.for_dissector(*reader)
        numbers = {}
        for path, port, here, there in about["paths"]:
            several = len(about["paths"]) > 1
            name = about["capturing"] + (f" port {port}" if several else "")
            text = links.describe(what, about["number"], port, (here, there))
            if (name, text) not in self.numbers:
                self.numbers[name, text] = len(self.numbers)
                self.file.write(pcapng.interface(link_type, name, text))
                self.heads[self.numbers[name, text]] = head
            numbers[path] = self.numbers[name, text]
        self.file.flush()
        return numbers

    async def _write_on(self) -> None:
        while True:
            await asyncio.sleep(HOLD_S)
            self._write(time.time_ns() - int(1e9 * HOLD_S))

    def _write(self, until_ns: int | None) -> None:
        """Write what happened up to a time; None = all."""
        self.waiting.sort(key=lambda frame: frame[0])
        count = len(self.waiting)
        if until_ns is not None:
            count = sum(frame[0] <= until_ns for frame in self.waiting)
        for at_ns, number, is_out, data, why in self.waiting[:count]:
            flags = pcapng.OUTBOUND if is_out else pcapng.INBOUND
            comment = f"dropped: {why}" if why and not why.startswith(EVENT) else why
            whole = self.heads[number] + data if data else data
            self.file.write(pcapng.packet(number, at_ns, whole, flags, comment.encode()))
            self.frames += bool(data)
        del self.waiting[:count]
        self.file.flush()


async def _asked(path: Path) -> tuple[asyncio.StreamReader, asyncio.StreamWriter, dict[str, Any]]:
    """A node that was asked for its frames, and who it says it is.

    Raises:
        OSError: nobody listens there, or not any more.
        ValueError: it went away before it had answered.
    """
    reader, writer = await asyncio.open_unix_connection(path, limit=LINE_MAX)
    try:
        writer.write(json.dumps({"do": "capture"}).encode() + b"\n")
        return reader, writer, json.loads(await reader.readline())
    except BaseException:
        writer.close()
        raise
