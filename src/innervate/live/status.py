"""A node's Unix socket: a line of JSON asks, lines of JSON answer."""

import asyncio
import json
import os
import select
import socket
import tempfile
from collections import Counter
from collections.abc import AsyncIterator, Awaitable, Callable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any

from innervate.live import private
from innervate.live.admission import BoundedListener, Bounds
from innervate.live.errors import LiveError
from innervate.live.machine import ANSWER_S, machine
from innervate.live.machine import answers as answers
from innervate.live.machine import is_left as is_left

LOOK_S = 1.0  # between two looks whether a caller has gone
WHOLE_S = 30.0  # a request is whole so long after it began, a caller's first after they came
ASKED = 64  # nodes are asked at once
LINE_MAX = 163_840  # a request to send 64 KiB, in hexadecimal digits
AT_ONCE = ("status", "revoke")  # a node that is well answers so
UP = "up."  # in a user's own folder, and a number: links to where each `live up` has its nodes
FULL = b'{"error": "64 are connected to this node already; end a listen or a capture"}\n'
BOUNDS = Bounds(most=64, burst=64, full=FULL, limit=LINE_MAX)

# Answers a request; gets the means to write more lines.
Handler = Callable[[dict[str, Any], "Writer"], Awaitable[None]]


def folder() -> Path:
    """Where sockets of running nodes are: INNERVATE_RUN, or a folder of the user's own.

    Raises:
        LiveError: the user's own folder was made by somebody else, or others may change it.
    """
    named = os.environ.get("INNERVATE_RUN")
    if named:
        return Path(named)
    runtime = os.environ.get("XDG_RUNTIME_DIR")
    if runtime:
        return Path(runtime) / "innervate"
    return private.checked(Path(tempfile.gettempdir()) / f"innervate-{os.getuid()}")


def where() -> Path:
    """The folder to look into for running nodes: that of `live up` if none runs in `folder`.

    Its errors are those of `folder`.
    """
    here = folder()
    if os.environ.get("INNERVATE_RUN") or _sockets(here):
        return here
    for note in _notes(here):
        with suppress(OSError):  # it has just ended
            if (there := note.readlink()).is_dir():
                return there
    return here


def _notes(here: Path) -> list[Path]:
    """The links that those `live up`s left that have not ended, the newest first."""
    found = [note for note in here.glob(f"{UP}*") if note.suffix[1:].isdecimal()]
    return sorted(found, key=lambda note: -int(note.suffix[1:]))


@contextmanager
def findable(run: Path) -> Iterator[None]:
    """Leave a note of where the nodes of a `live up` are, until it ends.

    The newest one's counts. When that ends, it is the newest's of which a node runs on.
    """
    if os.environ.get("INNERVATE_RUN"):
        yield  # who said where has their own way to find them
        return
    try:
        here = folder()
    except LiveError:  # somebody else's: nodes run all the same, and are found by their folder
        yield
        return
    own = here
    with suppress(OSError):  # then they are found by their folder alone
        here.mkdir(mode=private.FOLDER, parents=True, exist_ok=True)
        newest = next((int(note.suffix[1:]) for note in _notes(here)), 0)
        note = here / f"{UP}{newest + 1}"
        note.symlink_to(run)
        own = note
    try:
        yield
    finally:
        with suppress(OSError):
            _forget(here, own)


def _forget(here: Path, own: Path) -> None:
    """Take a note away; of older ones, if it was the newest, those of whom nobody runs any more."""
    notes = _notes(here)
    own.unlink()
    for older in notes[1:] if notes[0] == own else []:
        if any(map(answers, _sockets(older.readlink()))):
            break
        older.unlink()


class Request(dict[str, Any]):
    """What is asked of a node; what is looked for and is not there is the caller's mistake."""

    def __missing__(self, key: str) -> None:
        raise ValueError(f'this request needs "{key}"')


class Writer:
    """Writes answers of one connection.

    Attributes:
        is_last: True = what is answered now has no end of its own, nothing behind it is read.
    """

    def __init__(self, stream: asyncio.StreamWriter) -> None:
        self._stream = stream
        self.is_last = False

    def is_gone(self) -> bool:
        """True once both directions of the connection are closed."""
        sock = self._stream.get_extra_info("socket")
        if sock is None or sock.fileno() < 0:
            return True
        look = select.poll()
        look.register(sock.fileno(), 0)  # tells of both directions being closed, whatever is asked
        return bool(look.poll(0))

    async def line(self, answer: dict[str, Any]) -> None:
        """Write one answer as a line of JSON, and wait until there is room for more.

        Raises:
            ConnectionError: the caller has gone; what they asked for before can still be read.
        """
        if self.is_gone():
            raise ConnectionResetError
        self._stream.write(json.dumps(answer).encode() + b"\n")
        await self._stream.drain()


class Server:
    """Listens on a Unix socket.

    Args:
        path: the socket; its folder is made, an old socket is replaced.
        handle: answers requests.
        counts: callers that could not be let in.
        is_ours: the folder is to be nobody else's.
    """

    def __init__(
        self, path: Path, handle: Handler, counts: Counter[str] | None = None, is_ours: bool = False
    ) -> None:
        self.path = path
        self.is_ours = is_ours
        self._counts = Counter() if counts is None else counts
        self._handle = handle
        self.listener: BoundedListener | None = None
        self._inode = 0

    async def start(self) -> None:
        """Listen; LiveError if the socket cannot be made, or a running node has it."""
        try:
            sock = self._bind()
            self.listener = BoundedListener("status", sock, self._serve, BOUNDS, self._counts)
            try:
                self.listener.open()
            except OSError:
                await self.stop()
                raise
        except OSError as error:
            raise self._none_here(error) from None

    def _bind(self) -> socket.socket:
        if self.is_ours:  # somebody else can have been quicker to make it
            self.path.parent.mkdir(mode=private.FOLDER, parents=True, exist_ok=True)
            private.checked(self.path.parent)
        sock = machine().listen_at(self.path)
        self._inode = machine().inode(self.path)
        return sock

    def _none_here(self, error: OSError) -> LiveError:
        return LiveError(f"{self.path}: no socket here: {error.strerror or error}")

    def look(self) -> None:
        """Make the socket anew if somebody took it away; LiveError as of `start`."""
        if self.listener is None or machine().inode(self.path) == self._inode:
            return
        try:
            self.listener.move(self._bind())
        except OSError as error:
            self._inode = 0  # where it was bound nobody listens: the next look makes another
            raise self._none_here(error) from None

    async def stop(self) -> None:
        """Close the socket and every connection."""
        listener, self.listener = self.listener, None
        if listener is not None:
            listener.close()
            if machine().inode(self.path) == self._inode:  # else it is another's by now
                with suppress(OSError):
                    machine().remove(self.path)

    async def _serve(self, reader: asyncio.StreamReader, stream: asyncio.StreamWriter) -> None:
        writer, serving = Writer(stream), asyncio.current_task()
        assert serving is not None
        watching = asyncio.ensure_future(_wait_no_more(writer, serving))
        try:
            async for line in _requests(reader, writer):
                await self._do(line, writer, serving)
                if writer.is_last:
                    break
        finally:
            watching.cancel()

    async def _do(self, line: bytes, writer: Writer, serving: asyncio.Task[Any]) -> None:
        """Answer a request; of a caller who has gone it is done all the same."""
        try:
            with suppress(ConnectionError):
                await answer(line, self._handle, writer)
            await asyncio.sleep(0)  # frames have their turn
        except asyncio.CancelledError:
            if not writer.is_gone():
                raise
            serving.uncancel()


async def _requests(reader: asyncio.StreamReader, writer: Writer) -> AsyncIterator[bytes]:
    """The lines of a caller, until one is not whole in time, or longer than any request."""
    begun = b""
    with suppress(ConnectionError, ValueError):
        try:
            while True:
                async with asyncio.timeout(WHOLE_S):
                    line = begun if begun == b"\n" else begun + await reader.readline()
                if line:
                    yield line
                begun = await reader.read(1)
                if not begun:
                    return
        except TimeoutError:
            await writer.line({"error": f"no whole request came within {WHOLE_S:g} s"})


async def _wait_no_more(writer: Writer, serving: asyncio.Task[Any]) -> None:
    """Once a caller has gone, end what waits there: it may never come."""
    while True:
        await asyncio.sleep(LOOK_S)
        if writer.is_gone():
            serving.cancel()


async def answer(line: bytes, handle: Handler, writer: Writer) -> None:
    """Answer a line; what cannot be done is said."""
    try:
        request = json.loads(line)
        if not isinstance(request, dict):
            raise ValueError("a request is a JSON object")
        await handle(Request(request), writer)
    except (ValueError, TypeError, OverflowError, RecursionError) as error:
        await writer.line({"error": str(error)})
    except (ArithmeticError, LookupError) as error:
        why = f"this node cannot answer, by a mistake of its own: {error!r}"
        await writer.line({"error": why})
        raise


def ask(path: Path, request: dict[str, Any]) -> Iterator[dict[str, Any]]:
    """The answers of a running node to a request, as they come.

    Raises:
        LiveError: no node answers there, or it refuses.
    """
    with socket.socket(socket.AF_UNIX) as sock:
        sock.settimeout(ANSWER_S)
        try:
            sock.connect(str(path))
            with suppress(BrokenPipeError):  # who was turned away can read why
                sock.sendall(json.dumps(request).encode() + b"\n")
            if request.get("do") not in AT_ONCE:
                sock.settimeout(None)
            with sock.makefile("rb") as lines:
                for line in lines:
                    answer: dict[str, Any] = json.loads(line)
                    if "error" in answer:
                        raise LiveError(f"{path.stem}: {answer['error']}")
                    yield answer
        except OSError as error:
            raise LiveError(f"{path}: no node answers here: {error.strerror or error}") from None


def ask_one(path: Path, request: dict[str, Any]) -> dict[str, Any]:
    """The first answer, or a LiveError as of `ask`."""
    for answer in ask(path, request):
        return answer
    raise LiveError(f"{path}: the node went away; is it still running?")


def ask_all(paths: list[Path], request: dict[str, Any]) -> list[dict[str, Any] | LiveError]:
    """The first answer of each, or why there is none; all are asked at once."""
    from concurrent.futures import ThreadPoolExecutor  # a node has no use for it

    def answer_of(path: Path) -> dict[str, Any] | LiveError:
        try:
            return ask_one(path, request)
        except LiveError as error:
            return error

    with ThreadPoolExecutor(ASKED) as asking:
        return list(asking.map(answer_of, paths))


def find(name: str) -> Path:
    """The socket of a node by name or path; LiveError if there is none."""
    path = Path(name)
    if path.is_socket():
        return path
    for found in sockets():
        if found.stem == name:
            return found
    names = ", ".join(found.stem for found in sockets()) or "none"
    raise LiveError(f'no node "{name}" runs here; running: {names} (folder {where()})')


def sockets() -> list[Path]:
    """Sockets of this user's running nodes, by name."""
    return _sockets(where())


def _sockets(here: Path) -> list[Path]:
    if not here.is_dir():
        return []
    return sorted((path for path in here.glob("*.sock") if path.is_socket()), key=in_order)


def in_order(path: Path) -> tuple[str, int]:
    """A key by which n2 comes before n10."""
    letters = path.stem.rstrip("0123456789")
    return letters, int(path.stem[len(letters) :] or -1)
