"""The skin on live cables: a cell with its four ports, and the PC that all touch comes to."""

from __future__ import annotations

import asyncio
import time
from collections import Counter
from collections.abc import AsyncGenerator, Callable, Sequence
from typing import Any

from innervate.live.keys import Sealer
from innervate.live.links import Link
from innervate.live.node import LiveNode
from innervate.live.skin_items import Command, Frame, Sent, Touch, put
from innervate.live.state import State
from innervate.live.streams import iterate
from innervate.protocol import plain, skin, skin_sink
from innervate.protocol import skin_fields as fields
from innervate.protocol.rng import seeded
from innervate.protocol.skin_words import (
    EVERYBODY,
    GIVE,
    NONE,
    ONE,
    PORTS,
    REPORT_PARENT,
    SAMPLE,
    TIMERS,
)
from innervate.wire import skin as wire

OUTBOX = 16

Params = plain.make("Params", fields.PARAMS)


class SkinStack:
    """What cells and the PC have in common.

    Args:
        params: the protocol's parameters by name (`skin_fields.PARAMS`).
        room: actions that an outbox must hold.
    """

    timers = TIMERS
    reasons: tuple[str, ...] = wire.REASONS

    def __init__(self, params: dict[str, int], room: int) -> None:
        self.params = Params()
        for name, value in params.items():
            setattr(self.params, name, value)
        self.silent_us = self.params.k * self.params.beacon_us
        self.out = plain.Outbox(Frame, room)
        self.inbox = Frame()
        self.port = 0  # on which the frame in the inbox came

    def encode(self, frame: Any) -> bytes:
        """The bytes of a frame."""
        return wire.encode(frame)

    def decode(self, data: bytes) -> int:
        """Read bytes into the inbox; 0, or why not."""
        return wire.decode(data, self.inbox)

    def objection(self, sender: int | None) -> str:
        """A beacon names nobody: it speaks for the far end of its cable, whoever that is."""
        return ""

    def ports_of(self, port: int, frame: Any, attempt: int) -> list[int] | None:
        """A port is a path."""
        return [port]


class CellStack(SkinStack):
    """A cell; free sockets are ports without a path.

    Args:
        number: in its data frames.
        params: see SkinStack.
        seed: any whole number; cells must have different ones.
        ports: the cell's port of each path, in order of the paths: W, E, up, down = 0..3.
    """

    def __init__(self, number: int, params: dict[str, int], seed: int, ports: list[int]) -> None:
        super().__init__(params, OUTBOX)
        self.cell = plain.make("Cell", fields.CELL)()
        self.cell.number, self.cell.rng, self.cell.choice = number, seeded(seed), -1
        self.port_of_path = ports
        self.path_of_port = {port: path for path, port in enumerate(ports)}
        self.moves = 0

    def start(self, now: int, cause: int) -> None:
        """Switch on."""
        skin.on_start(self.cell, self.params, now, cause, self.out)

    def frame(self, now: int, port: int) -> None:
        """The frame in the inbox was received on a path."""
        skin.on_frame(self.cell, self.params, now, self.port_of_path[port], self.inbox, self.out)

    def timer(self, now: int, timer: int) -> None:
        """A timer fires."""
        skin.on_timer(self.cell, self.params, now, timer, self.out)

    def input(self, now: int, kind: int, item: Any) -> None:
        """What the cell's sensors say."""
        skin.on_input(self.cell, self.params, now, kind, item, self.out)

    def ports_of(self, port: int, frame: Any, attempt: int) -> list[int] | None:
        """The path of a port; a free socket has none."""
        path = self.path_of_port.get(port)
        return [] if path is None else [path]

    def status(self, now: int) -> dict[str, Any]:
        """The way to the PC, and which ports are broken."""
        cell = self.cell
        ports = [
            {
                "port": port,
                "path": self.path_of_port.get(port),
                "cabled": port in self.path_of_port,
                "broken": cell.pf[port] >= ONE,
                "dist": cell.dist[port],
                "child": bool(cell.child[port]),
            }
            for port in range(PORTS)
        ]
        parent = cell.parent
        return {
            "kind": "skin",
            "number": cell.number,
            "role": "cell",
            "parent": None if parent == NONE else parent,
            "dist": None if parent == NONE else cell.dist[parent] + 1,
            "load": cell.own_load,
            "ports": ports,
        }


class SinkStack(SkinStack):
    """The PC.

    Args:
        params: see SkinStack.
        ports: how many interface ports it has.
    """

    def __init__(self, params: dict[str, int], ports: int) -> None:
        super().__init__(params, ports + OUTBOX)
        self.pc = plain.make("Pc", (("own", 1, 0, 0, "", ""),), fields.SINK_PORT, ports=ports)()
        self.pc.own = [plain.make("Sink", fields.SINK)()]
        self.pc.own[0].ports = ports

    def start(self, now: int, cause: int) -> None:
        """Switch on."""
        skin_sink.on_start(self.pc, self.params, now, cause, self.out)

    def frame(self, now: int, port: int) -> None:
        """The frame in the inbox was received on an interface port."""
        self.port = port
        skin_sink.on_frame(self.pc, self.params, now, port, self.inbox, self.out)

    def timer(self, now: int, timer: int) -> None:
        """A timer fires."""
        skin_sink.on_timer(self.pc, self.params, now, timer, self.out)

    def input(self, now: int, kind: int, item: Any) -> None:
        """A command, to be sent down."""
        skin_sink.on_input(self.pc, self.params, now, kind, item, self.out)

    def status(self, now: int) -> dict[str, Any]:
        """How many cells each interface port serves."""
        own = self.pc.own[0]
        return {"kind": "skin", "role": "sink", "sq": own.sq, "cells": list(self.pc.size)}


class CellNode(LiveNode):
    """A cell: hands its samples to the skin, gives commands of the PC.

    Args:
        name: as shown to people.
        stack: the cell.
        links: its cables.
        sealer: seals and opens frames.
        state: what is kept over a restart.
        rate_hz: a sample made up by the cell itself so often; 0 = only what `sample` is given.
    """

    stack: CellStack

    def __init__(
        self,
        name: str,
        stack: CellStack,
        links: list[Link],
        sealer: Sealer | None = None,
        state: State | None = None,
        rate_hz: float = 0.0,
    ) -> None:
        super().__init__(name, stack, links, sealer, state)
        self.moves = 0
        self._period_s = 1 / rate_hz if rate_hz else 0.0
        self._due = 0.0
        self._beat: asyncio.TimerHandle | None = None
        self._item = Frame()
        self.outcomes: Counter[str] = Counter()
        self._inbox: list[Command] = []
        self._callbacks: list[Callable[[Command], None]] = []

    def receive_commands(
        self, callback: Callable[[Command], None] | None = None
    ) -> AsyncGenerator[Command, None]:
        """Commands for this cell, each once: to a callback, and as an async iterator."""
        queue: asyncio.Queue[Command] = asyncio.Queue()
        if callback is None:
            callback = queue.put_nowait
        self._callbacks.append(callback)
        return iterate(queue, self._callbacks, callback)

    def counters(self) -> Counter[str]:
        """Handler calls, frames dropped by reason, commands received."""
        return super().counters() + self.outcomes

    async def start(self) -> None:
        """Switch on."""
        await super().start()
        if self._period_s:
            self._due = asyncio.get_running_loop().time()
            self._sample_again()

    async def stop(self) -> None:
        """Switch off."""
        if self._beat is not None:
            self._beat.cancel()
        await super().stop()

    def sample(
        self,
        proximity: int = 0,
        force: tuple[int, int, int] = (0, 0, 0),
        temperature: int = 0,
        accel: tuple[int, int, int] = (0, 0, 0),
    ) -> None:
        """Send what the sensors say to the PC; units and ranges as in Touch.

        Raises:
            ValueError: a value leaves its range.
        """
        assert self.engine is not None
        values = {"proximity": (proximity,), "force": force,
                  "temperature": (temperature,), "accel": accel}  # fmt: skip
        for name, given in values.items():
            put(self._item, name, given)
        self.engine.input(SAMPLE, self._item)

    def _reported(self, code: int, a: int, b: int) -> None:
        if code == REPORT_PARENT:
            self.moves += 1

    def _deliver(self, kind: int, frame: Any) -> None:
        self.outcomes["commands received"] += 1
        to_all, at_us = frame.cell == EVERYBODY, time.time_ns() // 1000
        found = Command(frame.sq, frame.dist, frame.proximity, to_all, frame.hops, at_us)
        self._inbox.append(found)

    def _settled(self) -> None:
        if self._inbox:
            inbox, self._inbox = self._inbox, []
            tell(self._callbacks, inbox)

    def _sample_again(self) -> None:
        self.sample(force=(self.stack.cell.number, self.stack.cell.seq, 0))
        loop = asyncio.get_running_loop()
        self._due = max(self._due + self._period_s, loop.time())
        self._beat = loop.call_at(self._due, self._sample_again)


class SinkNode(LiveNode):
    """The PC end of a skin: gives tactile frames, sends commands down.

    Args:
        name: as shown to people.
        stack: the PC.
        links: its interface ports, in order.
        sealer: seals and opens frames.
        state: what is kept over a restart.
    """

    stack: SinkStack

    def __init__(
        self,
        name: str,
        stack: SinkStack,
        links: list[Link],
        sealer: Sealer | None = None,
        state: State | None = None,
    ) -> None:
        super().__init__(name, stack, links, sealer, state)
        self.outcomes: Counter[str] = Counter()
        self._inbox: list[Touch] = []
        self._callbacks: list[Callable[[Touch], None]] = []

    def receive_touch(
        self, callback: Callable[[Touch], None] | None = None
    ) -> AsyncGenerator[Touch, None]:
        """Tactile frames as they come: to a callback, and as an async iterator."""
        queue: asyncio.Queue[Touch] = asyncio.Queue()
        if callback is None:
            callback = queue.put_nowait
        self._callbacks.append(callback)
        return iterate(queue, self._callbacks, callback)

    def send_command(self, code: int, value: int = 0, cell: int | None = None) -> Sent:
        """Send a command down to a cell, or (None) to all; what it means is the user's.

        Raises:
            ValueError: a value leaves its range; see Command. Cells are 0 to 65534.
        """
        assert self.engine is not None
        if cell == EVERYBODY:
            raise ValueError(f"cell must be 0 to {EVERYBODY - 1}; leave it out for all")
        item = Frame()
        whom = EVERYBODY if cell is None else cell
        for name, called, given in (
            ("dist", "code", code), ("proximity", "value", value), ("cell", "cell", whom),
        ):  # fmt: skip
            put(item, name, (given,), called)
        pc = self.stack.pc
        self.engine.input(GIVE, item)
        self.outcomes["commands sent"] += 1
        return Sent(pc.own[0].command, sum(size > 0 for size in pc.size))

    def counters(self) -> Counter[str]:
        """Handler calls, frames dropped by reason, samples received, commands sent."""
        return super().counters() + self.outcomes

    def _deliver(self, kind: int, frame: Any) -> None:
        self.outcomes["samples received"] += 1
        self._inbox.append(Touch(
            frame.cell, frame.seq, frame.hops, self.stack.port, frame.proximity,
            (frame.force[0], frame.force[1], frame.force[2]), frame.temperature,
            (frame.accel[0], frame.accel[1], frame.accel[2]), time.time_ns() // 1000,
        ))  # fmt: skip

    def _settled(self) -> None:
        if self._inbox:
            inbox, self._inbox = self._inbox, []
            tell(self._callbacks, inbox)


def tell(callbacks: Sequence[Callable[[Any], None]], items: Sequence[Any]) -> None:
    """Call everybody with every item."""
    for item in items:
        for callback in callbacks:
            callback(item)
