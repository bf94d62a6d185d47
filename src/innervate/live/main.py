"""`innervate live node FILE`: one node as a process."""

import asyncio
import os
import signal
from collections import Counter
from collections.abc import AsyncGenerator, Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from innervate import folders
from innervate.live import hangup, status, tap
from innervate.live.build import build, keys_of, open_keys
from innervate.live.engine import Engine
from innervate.live.errors import LiveError
from innervate.live.links import REACH
from innervate.live.machine import machine
from innervate.live.metrics import MetricsPage
from innervate.live.node import LiveNode
from innervate.live.nodefile import PYTHON, Loaded, address, load
from innervate.live.notices import Notices
from innervate.live.pending import Pending
from innervate.live.receipts import FINAL
from innervate.live.rotation import Rotation
from innervate.live.streams import Form
from innervate.network import networks

DRAIN_S = 2.0
SAVE_S = 10.0
HEARD_MAX = 4096  # lines that wait for a listener that reads slowly, or not at all ...
HEARD_CHARS = 1024  # ... a message counts once more for each so many of its line
REQUESTS = ("status", "send", "listen", "cut", "restore", "loose", "capture", "revoke", "stop")


def run(path: Path, engine_of: Callable[..., Engine] | None = None, engine: str = "") -> int:
    """Run the node of a file until SIGTERM or Ctrl-C; 0, or 1 if it ended by itself.

    `engine_of` makes what runs its protocol; None = it runs here, by `engine` if that is given.

    Raises:
        LiveError: it cannot run as written.
    """
    process = Process(load(path), engine)
    if engine_of is not None:
        process.node.engine_of = engine_of
    asyncio.run(process.run())
    return int(process.failed)


class Process:
    """A node, its status socket, its Prometheus page, its signals."""

    def __init__(self, loaded: Loaded, engine: str = "") -> None:
        self.loaded = loaded
        self.engine = engine or loaded.table.engine
        self.node: LiveNode = build(loaded, engine)
        sealer = self.node.sealer
        self.rotation = None if sealer is None else Rotation(sealer)
        named = loaded.table.socket
        where = Path(named) if named else status.folder() / f"{loaded.name}.sock"
        is_ours = not named and not os.environ.get("INNERVATE_RUN")
        self.server = status.Server(where, self._answer, self.node.callers, is_ours)
        self.page: MetricsPage | None = None
        if loaded.table.metrics is not None:
            at = address(loaded.table.metrics, f"{loaded.path}: metrics")
            self.page = MetricsPage(at, self.node)
        self.file = str(loaded.path.absolute())
        self.ending = asyncio.Event()
        self.failed = False
        self.node.ended = self._ended
        self.notices = Notices(self._say)
        if sealer is not None:
            sealer.said = self.notices.tell
        self._callers: Counter[str] = Counter()  # as they were told last
        self._troubles: set[str] = set()

    async def run(self) -> None:
        """Until a signal says stop."""
        loop = asyncio.get_running_loop()
        for number in (signal.SIGTERM, signal.SIGINT):
            loop.add_signal_handler(number, self.ending.set)
        loop.add_signal_handler(signal.SIGHUP, self.reload)
        if networks()[self.loaded.table.kind].folder is not None:
            loop.set_exception_handler(self._went_wrong)
        hangup.let_in()
        with self._named():
            await self.server.start()
        try:
            with self._named():
                if self.page is not None:
                    await self.page.start()
                if not await self._start():
                    return
            self._say(self._ready())
            for path in open_keys(self.loaded):
                self._say(f"{path}: other users can read this key; chmod 600 it, or draw another")
            self._look()
            while not self.ending.is_set():
                await self._sleep(SAVE_S)
                if self.node.state.trouble:
                    self.node.save()
                self._look()
            if not await self.node.drain(DRAIN_S):
                self._say("stopped; messages were still under way")
        finally:
            await self.node.stop()
            await asyncio.sleep(0)  # who waits for the end of a message is told that we stop
            if self.page is not None:
                await self.page.stop()
            await self.server.stop()
        self._look()

    def _went_wrong(self, loop: asyncio.AbstractEventLoop, context: dict[str, Any]) -> None:
        """Something broke that nobody waits for."""
        if not self._is_blamed(context.get("exception")):
            loop.default_exception_handler(context)

    def _is_blamed(self, error: BaseException | None) -> bool:
        """True if a folder's code broke: its node ends, and says at which line."""
        folder = networks()[self.loaded.table.kind].folder
        why = folders.blamed(error, folder) if error and folder else ""
        if why:
            self.node.ended(why)
        return bool(why)

    async def _start(self) -> bool:
        """Start the node; False if we are to stop before it has found out what it needs."""
        starting = asyncio.ensure_future(self.node.start())
        ending = asyncio.ensure_future(self.ending.wait())
        await asyncio.wait((starting, ending), return_when=asyncio.FIRST_COMPLETED)
        ending.cancel()
        if self.ending.is_set() and starting.cancel():
            await asyncio.wait((starting,))
            return False
        await starting
        return True

    @contextmanager
    def _named(self) -> Iterator[None]:
        """What cannot be done as a node's file says names the file."""
        try:
            yield
        except LiveError as error:
            where = f"{self.loaded.path}: "
            raise LiveError(where + str(error).removeprefix(where)) from None

    def _ended(self, why: str) -> None:
        """What runs the protocol is gone: so is the node, for all to see."""
        self._say(why)
        self.failed = True
        self.ending.set()

    def reload(self) -> None:
        """SIGHUP: read the file again; keys may be others, all else needs a restart."""
        try:
            fresh = load(self.loaded.path)
            keys = fresh.table.keys
            if keys is not None and keys.identity is not None:
                raise LiveError(f"{fresh.path}: an identity is taken over by a restart only")
            if self.rotation is None or keys is None:
                raise LiveError(f"{fresh.path}: only other keys can be taken over without restart")
            self.rotation.begin(keys_of(keys, fresh), keys.use, keys.grace_s)
        except LiveError as error:
            self._say(f"not reloaded: {error}")
            return
        names = fresh.table.__struct_fields__
        others = [name for name in names if name != "keys"
                  and getattr(fresh.table, name) != getattr(self.loaded.table, name)]  # fmt: skip
        restart = f"; restart it for what else has changed: {', '.join(others)}" if others else ""
        self._say(f"keys reloaded: {keys.use} seals after {keys.grace_s:g} s{restart}")

    def _look(self) -> None:
        """Say what is the matter with files, callers and network, once in a while."""
        try:
            self.server.look()
        except LiveError as error:
            self.notices.tell("socket", f"{error}; going on, trying again")
        else:
            if self.server.listener is not None:
                self.notices.over("socket", f"{self.server.path}: there again")
        state = self.node.state
        if state.trouble:
            text = f"{state.path}: cannot be written: {state.trouble}; going on, trying again"
            self.notices.tell("state", text)
        else:
            self.notices.over("state", f"{state.path}: written again")
        if self.node.callers != self._callers:
            self._callers = Counter(self.node.callers)
            counts = ", ".join(f"{what} {count}" for what, count in self._callers.items())
            self.notices.tell("callers", f"too many callers: {counts} (since the start)")
        troubles = self.node.troubles()
        for name, text in troubles.items():
            self.notices.tell(name, text)
        again = {path.name: path.again for path in self.node.paths}
        for name in self._troubles - troubles.keys():
            self.notices.over(name, f"{name}: {again.get(name) or 'there again'}")
        self._troubles = set(troubles)

    async def _sleep(self, seconds: float) -> None:
        try:
            async with asyncio.timeout(seconds):
                await self.ending.wait()
        except TimeoutError:
            pass

    def _ready(self) -> str:
        table = self.loaded.table
        of = f" of {table.nodes}" if table.nodes else ""
        text = f"ready: {table.kind} {table.role or 'node'} {table.number}{of}, "
        count = len(self.node.paths)
        text += f"{count} path" if count == 1 else f"{count} paths"
        if self.engine != PYTHON:
            why = self.node.not_in_c
            text += f", not in C: {why}" if why else ", in C"
        if self.node.is_awake:
            text += ", keeps processors awake"
        if self.node.is_warm:
            text += ", keeps warm"
        if self.node.sealer is None:
            text += "; no key: frames can be read and forged by anybody in reach"
        return text

    def _say(self, text: str) -> None:
        machine().say(f"{self.loaded.name}: {text}")

    async def _answer(self, request: dict[str, Any], writer: status.Writer) -> None:
        what = str(request["do"])
        if what == "status":
            await writer.line({**self.node.status(), "file": self.file})
        elif what == "capture":
            await tap.serve(self.node, writer)
        elif what == "send":
            await self._send(request, writer)
        elif what == "listen":
            await self._listen(request, writer)
        elif what in ("cut", "restore", "loose", *REACH):
            port, loss = request["port"], request["loss"] if what == "loose" else 0.0
            if type(port) is not int or type(loss) not in (int, float):
                raise ValueError("port is a whole number, loss a share from 0 to 1")
            path = self.node.change(port, what, float(loss))
            await writer.line({"path": path.name, "cut": path.cut, "loss": path.loss})
        elif what in self.node.requests:
            try:
                await writer.line(self.node.requests[what](request))
            except Exception as error:
                self._is_blamed(error)
                raise
        elif what == "revoke":
            await writer.line(self._revoke(bytes.fromhex(request["list"])))
        elif what == "stop":
            self.ending.set()
            await writer.line({"ok": True})
        else:
            known = ", ".join((*REQUESTS, *self.node.requests))
            kind = self.loaded.table.kind
            raise ValueError(f'a {kind} node cannot do "{what}"; it can: {known}')

    def _revoke(self, data: bytes) -> dict[str, Any]:
        sealer = self.node.sealer
        if sealer is None or sealer.ring.identity is None:
            raise ValueError("this node has no identity, and knows nobody's")
        is_new = sealer.revoke(data)
        if not is_new and data != sealer.ring.revoked.data:
            raise ValueError("not signed by this network's authority, or older than what is known")
        return {"version": sealer.ring.revoked.version, "new": is_new}

    async def _send(self, request: dict[str, Any], writer: status.Writer) -> None:
        receipt = self.node.send_request(request)
        if receipt is None:
            raise ValueError(f"a {self.loaded.table.kind} has no messages")
        await writer.line({"state": receipt.state, "reason": receipt.reason})
        told = receipt.state
        while told not in FINAL and request.get("wait", True):
            await receipt.change()
            if told != receipt.state:  # it may have moved twice since
                told = receipt.state
                await writer.line({"state": told, "reason": receipt.reason})

    async def _listen(self, request: dict[str, Any], writer: status.Writer) -> None:
        writer.is_last = True
        heard: Pending[dict[str, Any]] = Pending(HEARD_MAX, _weight)
        streams = self.node.streams(request)
        pumps = [asyncio.ensure_future(_pump(stream, form, heard)) for stream, form in streams]
        try:
            await asyncio.sleep(0)  # they have begun: only then is what they took given back
            await writer.line({"listening": self.loaded.name})
            pumps.append(asyncio.ensure_future(_tell(heard, writer)))
            done, _ = await asyncio.wait(pumps, return_when=asyncio.FIRST_COMPLETED)
            for pump in done:
                pump.result()
        finally:
            for pump in pumps:
                pump.cancel()


async def _pump(
    stream: AsyncGenerator[Any, None], form: Form, heard: Pending[dict[str, Any]]
) -> None:
    try:
        async for item in stream:
            heard.put(form(item))
    finally:
        await stream.aclose()


def _weight(line: dict[str, Any]) -> int:
    return 1 + len(str(line.get("payload", ""))) // HEARD_CHARS


async def _tell(heard: Pending[dict[str, Any]], writer: status.Writer) -> None:
    while True:
        items, missed = await heard.take()
        for item in items:
            await writer.line(item)
        if missed:
            await writer.line({"missed": missed})
