"""A live node whose protocol runs as C on an emulated board (QEMU, `mps2-an385`).

To its links, its status socket and its taps it is the node that it would be without: only what
runs the handlers lies elsewhere. Frames that come in on a path go to the board's UART of that port,
what the board sends leaves on the path; a fifth UART tells state, reports and deliveries
(c/bare/role_main.c).
"""

import asyncio
import ctypes
import os
import signal
import struct
import subprocess
import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

from innervate.firmware.packed import Packed
from innervate.firmware.records import records_of
from innervate.firmware.tools import find
from innervate.live.board import Role
from innervate.live.engine import Engine, clock_us
from innervate.wire import cobs

UARTS, LOOK = 5, 4
LINE_MAX = 512
ASK_S = 0.1  # between two looks at the state
DEATH_SIGNAL = 1  # of prctl
QEMU = "qemu-system-arm"


class Emulated(Engine):
    """Runs a stack's handlers, those of `role` in an image, on an emulated board.

    Behind image and role it is given what an `Engine` is given.

    Raises:
        FirmwareError: there is no QEMU.
    """

    def __init__(self, image: Path, role: Role, *given: Any) -> None:
        super().__init__(*given)
        self.image = image
        self.packed = {name: Packed(fields) for name, fields in records_of(role).items()}
        self.emulator = find(QEMU)
        self._process: subprocess.Popen[bytes] | None = None
        self._folder: tempfile.TemporaryDirectory[str] | None = None
        self._lines: list[asyncio.StreamWriter | None] = [None] * UARTS
        self._tasks: list[asyncio.Task[None]] = []
        self._state = bytearray(self.packed["state"].size)
        self._begun: tuple[int, int, int] | None = None
        self._watch = -1  # becomes readable when the emulator ends

    def start(self, cause: int = 0) -> None:
        """Switch the board on; the node starts as soon as its lines are there."""
        node = self.stack.node  # type: ignore[attr-defined]
        self._begun = (getattr(node, "number", 0), getattr(node, "rng", 1), cause)
        self._tasks.append(self._loop.create_task(self._run()))

    def stop(self) -> None:
        """Switch the board off, and forget it."""
        super().stop()
        for task in self._tasks:
            task.cancel()
        self._unwatch()
        if self._process is not None:
            self._process.kill()
            self._process.wait()
        if self._folder is not None:
            self._folder.cleanup()

    def receive(self, port: int, at: int | None = None) -> None:
        """The frame in the inbox came in on a path: the board's UART has it."""
        self.counters["frames"] += 1
        uart = self.stack.port_of_path[port]  # type: ignore[attr-defined]
        self._send(uart, self.stack.encode(self.stack.inbox))

    def input(self, kind: int, item: Any) -> None:
        """Hand something down to the board's node."""
        record = self.packed.get("item", self.packed["frame"])
        self._send(LOOK, bytes((ord("I"), kind)) + record.of(item))

    def call(self, handler: Callable[[int], None], at: int) -> None:
        """Handlers are called on the board alone."""

    async def _run(self) -> None:
        """The board and its lines, until it is switched off."""
        self._folder = tempfile.TemporaryDirectory(prefix="innervate-board-")
        there = asyncio.Event()
        servers, words = [], []
        for uart in range(UARTS):
            path = f"{self._folder.name}/{uart}"

            def opened(
                reader: asyncio.StreamReader, writer: asyncio.StreamWriter, uart: int = uart
            ) -> None:
                self._lines[uart] = writer
                self._tasks.append(self._loop.create_task(self._read(uart, reader)))
                if None not in self._lines:
                    there.set()

            servers.append(await asyncio.start_unix_server(opened, path))
            words += ["-serial", f"unix:{path}"]
        self._process = subprocess.Popen(
            [self.emulator, "-M", "mps2-an385", "-display", "none", "-monitor", "none",
             "-kernel", str(self.image), *words], stdin=subprocess.DEVNULL, preexec_fn=_end_with_us,
        )  # fmt: skip
        self._watch = os.pidfd_open(self._process.pid)
        self._loop.add_reader(self._watch, self._gone)
        await there.wait()
        assert self._begun is not None
        number, seed, cause = self._begun
        self._send(LOOK, b"S" + struct.pack("<HiB", number, seed, cause))
        self.counters["board started"] += 1
        while True:
            self._send(LOOK, b"?")
            await asyncio.sleep(ASK_S)

    def _gone(self) -> None:
        """The emulator has ended, and nobody asked it to."""
        self._unwatch()
        assert self._process is not None
        code = self._process.wait()
        how = signal.Signals(-code).name if code < 0 else f"exit code {code}"
        self.ended(f"its board is gone: {self.emulator} ended ({how})")

    def _unwatch(self) -> None:
        if self._watch >= 0:
            self._loop.remove_reader(self._watch)
            os.close(self._watch)
            self._watch = -1

    def _send(self, uart: int, data: bytes) -> None:
        line = self._lines[uart]
        if line is not None and not self._stopped:
            line.write(cobs.encode(data))

    async def _read(self, uart: int, reader: asyncio.StreamReader) -> None:
        """Take the frames that come from a UART."""
        decoder = cobs.Decoder(LINE_MAX)
        while data := await reader.read(LINE_MAX):
            for piece in decoder.feed(data):
                if uart == LOOK:
                    self._told(piece)
                elif not self.stack.decode(piece):
                    self.now = clock_us()
                    self._transmit(uart, self.stack.inbox, 0, 0)

    def _told(self, said: bytes) -> None:
        """The board says something of itself."""
        kind, rest = said[:1], said[1:]
        if kind == b"s":
            at = int.from_bytes(rest[:2], "little")
            self._state[at : at + len(rest) - 2] = rest[2:]
            if at + len(rest) - 2 == len(self._state):
                node = self.stack.node  # type: ignore[attr-defined]
                self.packed["state"].put(bytes(self._state), node)
        elif kind == b"r":
            self._report(rest[0], *struct.unpack("<ii", rest[1:9]))
        elif kind == b"d":
            self.packed["frame"].put(rest[1:], self.stack.inbox)
            self._deliver(rest[0], self.stack.inbox)
        self._settled()


def _end_with_us() -> None:
    """In the new process: be killed when the node's process is, however it ends (Linux)."""
    ctypes.CDLL(None).prctl(DEATH_SIGNAL, signal.SIGKILL)
