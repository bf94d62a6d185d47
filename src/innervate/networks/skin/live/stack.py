"""The skin on live cables: a cell with its four ports, and the PC, as an engine runs them."""

from typing import Any

from innervate.dialect import plain
from innervate.dialect.rng import seeded
from innervate.live.stack import CabledStack, filled
from innervate.networks.skin import frames as wire
from innervate.networks.skin.live.items import Frame
from innervate.networks.skin.protocol import cell as skin
from innervate.networks.skin.protocol import fields as fields
from innervate.networks.skin.protocol import sink as skin_sink
from innervate.networks.skin.protocol.constants import NONE, ONE, PORTS, TIMERS

OUTBOX = 16

Params = plain.make("Params", fields.PARAMS)


class SkinStack(CabledStack):
    """What cells and the PC have in common.

    Args as of CabledStack, but:
        params: the protocol's parameters by name (`skin_fields.PARAMS`).
    """

    timers = TIMERS
    reasons: tuple[str, ...] = wire.REASONS
    coder: Any = wire

    def __init__(
        self, do: Any, node: Any, params: dict[str, int], room: int, ports: list[int]
    ) -> None:
        super().__init__(do, node, filled(Params(), params), Frame, room, ports)
        self.silent_us = self.params.k * self.params.beacon_us


class CellStack(SkinStack):
    """A cell; free sockets are ports without a path.

    Args:
        number: in its data frames.
        params: see SkinStack.
        seed: any whole number; cells must have different ones.
        ports: the cell's port of each path, in order of the paths: W, E, up, down = 0..3.
    """

    def __init__(self, number: int, params: dict[str, int], seed: int, ports: list[int]) -> None:
        node = plain.make("Cell", fields.CELL)()
        node.number, node.rng, node.choice = number, seeded(seed), -1
        super().__init__(skin, node, params, OUTBOX, ports)

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

    Attributes:
        port: on which the frame in the inbox came.
    """

    port = 0

    def __init__(self, params: dict[str, int], ports: int) -> None:
        pc = plain.make("Pc", (("own", 1, 0, 0, "", ""),), fields.SINK_PORT, ports=ports)()
        pc.own = [plain.make("Sink", fields.SINK)()]
        pc.own[0].ports = ports
        super().__init__(skin_sink, pc, params, ports + OUTBOX, list(range(ports)))

    def on_frame(self, now: int, port: int) -> None:
        """The frame in the inbox was received on an interface port."""
        self.port = port
        super().on_frame(now, port)

    def status(self, now: int) -> dict[str, Any]:
        """How many cells each interface port serves."""
        own = self.node.own[0]
        return {"kind": "skin", "role": "sink", "sq": own.sq, "cells": list(self.node.size)}
