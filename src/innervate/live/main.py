"""`innervate live node FILE`: one node as a process."""

from __future__ import annotations

import asyncio
import signal
import sys
from pathlib import Path
from typing import Any

from innervate.live import status, tap
from innervate.live.build import build, keys_of
from innervate.live.errors import LiveError
from innervate.live.messages import MeshNode
from innervate.live.metrics import MetricsPage
from innervate.live.node import LiveNode
from innervate.live.nodefile import Loaded, address, load
from innervate.live.skin import SinkNode

DRAIN_S = 2.0
SAVE_S = 10.0


def run(path: Path) -> int:
    """Run the node of a file until SIGTERM or Ctrl-C; 0.

    Raises:
        LiveError: it cannot run as written.
    """
    asyncio.run(Process(load(path)).run())
    return 0


class Process:
    """A node, its status socket, its Prometheus page, its signals."""

    def __init__(self, loaded: Loaded) -> None:
        self.loaded = loaded
        self.node: LiveNode = build(loaded)
        named = loaded.table.socket
        where = Path(named) if named else status.folder() / f"{loaded.name}.sock"
        self.server = status.Server(where, self._answer)
        self.page: MetricsPage | None = None
        if loaded.table.metrics is not None:
            self.page = MetricsPage(address(loaded.table.metrics, str(loaded.path)), self.node)
        self.ending = asyncio.Event()

    async def run(self) -> None:
        """Until a signal says stop."""
        loop = asyncio.get_running_loop()
        for number in (signal.SIGTERM, signal.SIGINT):
            loop.add_signal_handler(number, self.ending.set)
        loop.add_signal_handler(signal.SIGHUP, self.reload)
        await self.server.start()
        try:
            if self.page is not None:
                await self.page.start()
            await self.node.start()
            self._say(self._ready())
            while not self.ending.is_set():
                await self._sleep(SAVE_S)
                if self.node.sealer is not None:
                    self.node.save(False)
            if not await self.node.drain(DRAIN_S):
                self._say("stopped; messages were still under way")
        finally:
            await self.node.stop()
            if self.page is not None:
                await self.page.stop()
            await self.server.stop()

    def reload(self) -> None:
        """SIGHUP: read the file again; keys may be others, all else needs a restart."""
        try:
            fresh = load(self.loaded.path)
            if self.node.sealer is None or fresh.table.keys is None:
                raise LiveError(f"{fresh.path}: only other keys can be taken over without restart")
            self.node.sealer.load_keys(keys_of(fresh.table.keys, fresh), fresh.table.keys.use)
        except LiveError as error:
            self._say(f"not reloaded: {error}")
        else:
            self._say("keys reloaded")

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
        text += f"{len(self.node.paths)} paths"
        if self.node.sealer is None:
            text += "; no key: frames can be read and forged by anybody in reach"
        return text

    def _say(self, text: str) -> None:
        print(f"{self.loaded.name}: {text}", file=sys.stderr, flush=True)

    async def _answer(self, request: dict[str, Any], writer: status.Writer) -> None:
        what = request.get("do")
        if what == "status":
            await writer.line(self.node.status())
        elif what == "capture":
            await tap.serve(self.node, writer)
        elif what == "send":
            await self._send(request, writer)
        elif what == "listen":
            await self._listen(writer)
        elif what in ("cut", "restore"):
            path = self.node.path_at(int(request["port"]))
            path.cut = what == "cut"
            await writer.line({"path": path.name, "cut": path.cut})
        elif what == "stop":
            self.ending.set()
            await writer.line({"ok": True})
        else:
            raise ValueError('a request has "do": status, send, listen, cut, restore or stop')

    async def _send(self, request: dict[str, Any], writer: status.Writer) -> None:
        node, payload = self.node, bytes.fromhex(request["payload"])
        if isinstance(node, MeshNode):
            receipt = node.send_message(
                int(request["to"]),
                payload,
                reliable=bool(request.get("reliable", True)),
                priority=bool(request.get("priority", False)),
            )
        else:
            send_packet = getattr(node, "send_packet", None)
            if send_packet is None:
                raise ValueError("a skin has no messages")
            receipt = send_packet(payload)
        await writer.line({"state": receipt.state, "reason": receipt.reason})
        told = receipt.state
        while told not in ("delivered", "expired", "refused") and request.get("wait", True):
            told = await receipt.change()
            await writer.line({"state": receipt.state, "reason": receipt.reason})

    async def _listen(self, writer: status.Writer) -> None:
        node = self.node
        if isinstance(node, MeshNode):
            messages = node.receive_messages()
            try:
                await writer.line({"listening": self.loaded.name})
                async for sender, payload in messages:
                    await writer.line({"from": sender, "payload": payload.hex()})
            finally:
                await messages.aclose()
        elif isinstance(node, SinkNode):
            touches = node.receive_touch()
            try:
                await writer.line({"listening": self.loaded.name})
                async for touch in touches:
                    await writer.line({"from": touch.cell, "touch": touch._asdict()})
            finally:
                await touches.aclose()
        else:
            raise ValueError("only mesh nodes and the PC of a skin can be listened to")
