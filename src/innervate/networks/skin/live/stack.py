"""The skin on live cables: a cell with its four ports, and the PC, as an engine runs them."""

from __future__ import annotations

from typing import Any

from innervate.dialect import plain
from innervate.dialect.rng import seeded
from innervate.networks.skin import frames as wire
from innervate.networks.skin.live.items import Frame
from innervate.networks.skin.protocol import cell as skin
from innervate.networks.skin.protocol import fields as fields
from innervate.networks.skin.protocol import sink as skin_sink
from innervate.networks.skin.protocol.constants import NONE, ONE, PORTS, TIMERS

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
        self.coder: Any = wire
        self.port = 0  # on which the frame in the inbox came

    def encode(self, frame: Any) -> bytes:
        """The bytes of a frame."""
        data: bytes = self.coder.encode(frame)
        return data

    def decode(self, data: bytes) -> int:
        """Read bytes into the inbox; 0, or why not."""
        reason: int = self.coder.decode(data, self.inbox)
        return reason

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
        self.do: Any = skin
        self.node = plain.make("Cell", fields.CELL)()
        self.node.number, self.node.rng, self.node.choice = number, seeded(seed), -1
        self.port_of_path = ports
        self.path_of_port = {port: path for path, port in enumerate(ports)}
        self.moves = 0

    def on_start(self, now: int, cause: int) -> None:
        """Switch the cell on at `now`, us; `cause` 0 is the first time."""
        self.do.on_start(self.node, self.params, now, cause, self.out)

    def on_frame(self, now: int, port: int) -> None:
        """The frame in the inbox was received on a path."""
        self.do.on_frame(self.node, self.params, now, self.port_of_path[port], self.inbox, self.out)

    def on_timer(self, now: int, timer: int) -> None:
        """A timer of the cell's protocol fires at `now`, us."""
        self.do.on_timer(self.node, self.params, now, timer, self.out)

    def on_input(self, now: int, kind: int, item: Any) -> None:
        """What the cell's sensors say."""
        self.do.on_input(self.node, self.params, now, kind, item, self.out)

    def ports_of(self, port: int, frame: Any, attempt: int) -> list[int] | None:
        """The path of a port; a free socket has none."""
        path = self.path_of_port.get(port)
        return [] if path is None else [path]

    def status(self, now: int) -> dict[str, Any]:
        """The way to the PC, and which ports are broken."""
        cell = self.node
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
        self.do: Any = skin_sink
        self.pc = plain.make("Pc", (("own", 1, 0, 0, "", ""),), fields.SINK_PORT, ports=ports)()
        self.pc.own = [plain.make("Sink", fields.SINK)()]
        self.pc.own[0].ports = ports

    def on_start(self, now: int, cause: int) -> None:
        """Switch the PC on at `now`, us; `cause` 0 is the first time."""
        self.do.on_start(self.pc, self.params, now, cause, self.out)

    def on_frame(self, now: int, port: int) -> None:
        """The frame in the inbox was received on an interface port."""
        self.port = port
        self.do.on_frame(self.pc, self.params, now, port, self.inbox, self.out)

    def on_timer(self, now: int, timer: int) -> None:
        """A timer of the PC's protocol fires at `now`, us."""
        self.do.on_timer(self.pc, self.params, now, timer, self.out)

    def on_input(self, now: int, kind: int, item: Any) -> None:
        """A command, to be sent down."""
        self.do.on_input(self.pc, self.params, now, kind, item, self.out)

    def status(self, now: int) -> dict[str, Any]:
        """How many cells each interface port serves."""
        own = self.pc.own[0]
        return {"kind": "skin", "role": "sink", "sq": own.sq, "cells": list(self.pc.size)}
