"""What a node finds on its machine: clocks, chance, files, sockets, serial ports.

Whatever runs live asks `machine()` for them. A test hands in another machine (`on`), and whole
networks run in one process under simulated time; the loop is asyncio's, and can be replaced too.
"""

import errno
import io
import os
import random
import select
import socket
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from contextvars import ContextVar
from pathlib import Path
from typing import IO, Any, Protocol

from innervate.live import private
from innervate.live.errors import LiveError

ANSWER_S = 5.0
BOOT = Path("/proc/sys/kernel/random/boot_id")  # Linux
AWAKE_OR_NOT = getattr(time, "CLOCK_BOOTTIME", time.CLOCK_MONOTONIC)  # Linux has both
IDLE_STATES = Path("/dev/cpu_dma_latency")  # Linux: the longest that a wake-up may take, us

Socket = socket.socket


class SerialPort(Protocol):
    """An open serial port, raw; it never waits."""

    def fileno(self) -> int:
        """What a loop knows it by."""

    def read(self, count: int) -> bytes:
        """At most so many bytes; none = hung up.

        Raises:
            OSError: nothing is there yet (BlockingIOError), or it was unplugged.
        """

    def write(self, data: bytes | bytearray) -> int:
        """How many of these bytes went.

        Raises:
            OSError: there is no room now (BlockingIOError), or it was unplugged.
        """

    def close(self) -> None:
        """Give the port back to the system."""


def _has_room(stream: Any) -> bool:
    """False if a line would have to wait: a pipe is full, and who should read it does not."""
    try:
        return bool(select.select((), (stream,), (), 0)[1])
    except (OSError, ValueError, TypeError):  # not a file of the system
        return True


class Machine:
    """The machine that this process runs on; what it cannot do is an OSError that says so.

    Attributes:
        chance: random numbers: seeds of protocols, loose plugs.
    """

    chance: random.Random = random.SystemRandom()

    def monotonic_ns(self) -> int:
        """A clock that never jumps, and goes on while the machine is suspended."""
        return time.clock_gettime_ns(AWAKE_OR_NOT)

    def boot(self) -> str:
        """Which start of the machine this is, no other has the same; "" = the system says none."""
        with suppress(OSError):
            return BOOT.read_text(encoding="ascii").strip()
        return ""

    def time_ns(self) -> int:
        """The machine's idea of the time, since 1970 (UTC)."""
        return time.time_ns()

    def say(self, text: str) -> None:
        """A line for whoever reads the node's log; where none can be written, the node goes on."""
        with suppress(OSError, ValueError):
            self.log(text)

    def log(self, text: str) -> None:
        """Write a line of the log, but never wait for whoever reads it.

        Raises:
            OSError: the disk is full, or nobody reads the pipe, or not any more.
            ValueError: the log is closed.
        """
        if not _has_room(sys.stderr):
            raise BlockingIOError(errno.EAGAIN, "the log is full")
        print(text, file=sys.stderr, flush=True)

    def socket(self, family: int, kind: int) -> Socket:
        """A socket, not yet bound."""
        return socket.socket(family, kind)

    async def addresses(self, host: str, port: int, family: int) -> list[tuple[Any, ...]]:
        """The addresses of a name, as sockets of a family have them; an OSError says why none."""
        from innervate.live.addresses import look_up

        return await look_up(host, port, family)

    def open_serial(self, device: str, baud: int) -> SerialPort:
        """A serial port of the machine, raw."""
        from innervate.live.serial_port import Port

        return Port(device, baud)

    def listen_at(self, path: Path) -> Socket:
        """A Unix socket for callers of this user; its folder is made, an old socket replaced.

        Raises:
            LiveError: a running node has it.
            OSError: it cannot be made.
        """
        path.parent.mkdir(mode=private.FOLDER, parents=True, exist_ok=True)
        if path.exists():
            if not path.is_socket():
                raise LiveError(f"{path} is a file, and no node's socket; name another")
            if answers(path):
                raise LiveError(f"{path}: a node with this name runs already; stop it")
            path.unlink()
        sock = socket.socket(socket.AF_UNIX)
        before = os.umask(0o177)
        try:
            sock.bind(str(path))
        except OSError:
            sock.close()
            raise
        finally:
            os.umask(before)
        return sock

    def exists(self, path: Path) -> bool:
        """True if there is such a file."""
        return path.exists()

    def inode(self, path: Path) -> int:
        """Which file bears this name; 0 = none does."""
        with suppress(OSError):
            return path.lstat().st_ino
        return 0

    def read_text(self, path: Path) -> str:
        """What stands in a file; UnicodeDecodeError if that is no text."""
        return path.read_text(encoding="utf-8")

    def create(self, path: Path) -> IO[str]:
        """An empty file to write into, which only its owner reads; one that is there is emptied."""
        return io.TextIOWrapper(private.create(path), encoding="utf-8")

    def sync(self, file: IO[str]) -> None:
        """What was written into a file is on the disk, whatever happens to the machine."""
        file.flush()
        os.fsync(file.fileno())

    def replace(self, old: Path, new: Path) -> None:
        """A file has another name from now on, whatever happens to the machine."""
        os.replace(old, new)
        with suppress(OSError):  # not every system can: it is as safe as it was
            folder = os.open(new.parent, os.O_RDONLY)
            try:
                os.fsync(folder)
            finally:
                os.close(folder)

    def remove(self, path: Path) -> None:
        """A file, or a socket's name, is no more."""
        path.unlink()

    def keep_awake(self) -> IO[bytes]:
        """Processors that have nothing to do wait without sleeping, until this file is closed."""
        file = open(IDLE_STATES, "r+b", buffering=0)  # noqa: SIM115 - open is what keeps it so
        file.write((0).to_bytes(4, sys.byteorder))
        return file


_THIS = Machine()
_MACHINE: ContextVar[Machine] = ContextVar("machine", default=_THIS)
machine: Callable[[], Machine] = _MACHINE.get


@contextmanager
def on(other: Machine) -> Iterator[None]:
    """What is called or scheduled within runs on another machine."""
    token = _MACHINE.set(other)
    try:
        yield
    finally:
        _MACHINE.reset(token)


def is_left(path: Path) -> bool:
    """True if whoever listened on this Unix socket is gone; who is only busy is not."""
    return isinstance(_refusal(path), ConnectionRefusedError)


def answers(path: Path) -> bool:
    """True if somebody listens on this Unix socket."""
    return _refusal(path) is None


def _refusal(path: Path) -> OSError | None:
    """Why this Unix socket takes no connection; None if it takes one."""
    with socket.socket(socket.AF_UNIX) as sock:
        sock.settimeout(ANSWER_S)
        try:
            sock.connect(str(path))
        except OSError as error:
            return error
    return None
