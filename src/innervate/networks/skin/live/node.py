"""The skin on live cables: a cell that senses, and the PC that all touch comes to."""

import asyncio
from collections.abc import AsyncGenerator, Callable
from typing import Any

from innervate.live.engine import clock_us
from innervate.live.machine import machine
from innervate.live.node import Answerer, LiveNode, is_broken
from innervate.live.streams import Stream
from innervate.networks.skin.live.items import Command, Frame, Sent, Touch, put
from innervate.networks.skin.live.stack import CellStack, SinkStack
from innervate.networks.skin.protocol.constants import EVERYBODY, GIVE, REPORT_PARENT, SAMPLE


class CellNode(LiveNode):
    """A cell: hands its samples to the skin, gives commands of the PC.

    Attributes:
        rate_hz: a sample made up by the cell itself so often; 0 = only what `sample` is given.
        moves: how often it took another parent.
        command: the number of the newest command for it; None = there was none.
    """

    stack: CellStack
    rate_hz = 0.0
    moves = 0
    command: int | None = None
    _due = 0.0
    _beat: asyncio.TimerHandle | None = None

    def own_requests(self) -> dict[str, Answerer]:
        """It says that it sends no commands."""
        return {"command": refuse_command}

    def streams(self, request: dict[str, Any]) -> list[Stream]:
        """Commands for this cell, for those who follow them by the status socket."""
        return [(self.receive_commands(), lambda one: {"from": "pc", "command": one._asdict()})]

    def receive_commands(
        self, callback: Callable[[Command], None] | None = None
    ) -> AsyncGenerator[Command, None]:
        """Commands for this cell, each once: to a callback, and as an async iterator."""
        return self.arrivals.receive(callback)

    async def _switch_on(self) -> None:
        await super()._switch_on()
        if self.rate_hz:
            self._due = asyncio.get_running_loop().time()
            self._sample_again()

    async def stop(self) -> None:
        """Stop sampling, then switch the node off."""
        if self._beat is not None:
            self._beat.cancel()
            self._beat = None
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
            ValueError: a value leaves its range, or the cell does not run.
        """
        engine, item = self.running(), Frame()
        values = {"proximity": (proximity,), "force": force,
                  "temperature": (temperature,), "accel": accel}  # fmt: skip
        for name, given in values.items():
            put(item, name, given)
        engine.input(SAMPLE, item)

    def _reported(self, code: int, a: int, b: int) -> None:
        if code == REPORT_PARENT:
            self.moves += 1

    def status(self) -> dict[str, Any]:
        """As of all nodes, and the number of the newest command that came for this cell."""
        return {**super().status(), "command": self.command}

    def _deliver(self, kind: int, frame: Any) -> None:
        self.outcomes["commands received"] += 1
        self.command = frame.sq
        to_all, at_us = frame.cell == EVERYBODY, machine().time_ns() // 1000
        found = Command(frame.sq, frame.dist, frame.proximity, to_all, frame.hops, at_us)
        self.arrivals.put(found)

    def _sample_again(self) -> None:
        self.sample(force=(self.stack.node.number, self.stack.node.seq, 0))
        loop = asyncio.get_running_loop()
        self._due = max(self._due + 1 / self.rate_hz, loop.time())
        self._beat = loop.call_at(self._due, self._sample_again)


class SinkNode(LiveNode):
    """The PC end of a skin: gives tactile frames, sends commands down.

    Its links are the interface ports, in order.

    Attributes:
        cell_max: the greatest number of a cell, as far as its file says it.
        knows_cells: it says it.
    """

    stack: SinkStack
    cell_max = EVERYBODY - 1
    knows_cells = False

    def own_requests(self) -> dict[str, Answerer]:
        """It may be asked to send a command."""
        return {"command": self._asked_for_command}

    def streams(self, request: dict[str, Any]) -> list[Stream]:
        """Samples of all cells, for those who follow them by the status socket."""
        return [(self.receive_touch(), lambda one: {"from": one.cell, "touch": one._asdict()})]

    def receive_touch(
        self, callback: Callable[[Touch], None] | None = None
    ) -> AsyncGenerator[Touch, None]:
        """Tactile frames as they come: to a callback, and as an async iterator."""
        return self.arrivals.receive(callback)

    def send_command(self, code: int, value: int = 0, cell: int | None = None) -> Sent:
        """Send a command down to a cell, or (None) to all; what it means is the user's.

        Raises:
            ValueError: a value leaves its range; see Command. Cells are 0 to `cell_max`. Or the
                PC does not run.
        """
        engine = self.running()
        if cell is not None and not 0 <= cell <= self.cell_max:
            raise ValueError(f"cell must be 0 to {self.cell_max}, not {cell}; leave it out for all")
        item = Frame()
        whom = EVERYBODY if cell is None else cell
        for name, called, given in (
            ("dist", "code", code), ("proximity", "value", value), ("cell", "cell", whom),
        ):  # fmt: skip
            put(item, name, (given,), called)
        pc = self.stack.node
        engine.input(GIVE, item)
        self.outcomes["commands sent"] += 1
        ports = sum(size > 0 for size in self._served())
        return Sent(pc.own[0].command, ports, cell is None or self.knows_cells)

    def _served(self) -> list[int]:
        """How many cells each interface port serves: none behind a broken cable."""
        sizes, now = list(self.stack.node.size), clock_us()
        for path in self.paths:
            if is_broken(path, now, self.stack.silent_us):
                sizes[path.port] = 0
        return sizes

    def status(self) -> dict[str, Any]:
        """As of all nodes, how many cells each interface port serves, and how many there are."""
        cells = self.cell_max + 1 if self.knows_cells else None
        return {**super().status(), "cells": self._served(), "of_cells": cells}

    def _asked_for_command(self, request: dict[str, Any]) -> dict[str, Any]:
        cell = request.get("cell")
        numbers = (request["code"], request.get("value", 0), 0 if cell is None else cell)
        if not all(isinstance(number, int) for number in numbers):
            raise ValueError("code, value and cell are whole numbers")
        return self.send_command(numbers[0], numbers[1], cell)._asdict()

    def _deliver(self, kind: int, frame: Any) -> None:
        self.outcomes["samples received"] += 1
        self.arrivals.put(Touch(
            frame.cell, frame.seq, frame.hops, self.stack.port, frame.proximity,
            (frame.force[0], frame.force[1], frame.force[2]), frame.temperature,
            (frame.accel[0], frame.accel[1], frame.accel[2]), machine().time_ns() // 1000,
        ))  # fmt: skip


def refuse_command(request: dict[str, Any]) -> dict[str, Any]:
    """Cells send no commands: always a ValueError."""
    raise ValueError("only the PC of a skin sends commands")
