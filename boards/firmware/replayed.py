"""Plain simulations in which every call of every node is made in C as well."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager, suppress
from dataclasses import dataclass, field
from importlib import import_module
from typing import Any
from unittest import mock

from boards.errors import BoardFailed
from boards.firmware.native import Native, Twin
from boards.parity.record import HANDLERS, part, simulation
from innervate.dialect.arith import MASK30
from innervate.sim import clocks

KEPT = 2000  # records that are kept for calls that are drawn


class Enough(Exception):
    """As many calls were made as were wanted."""


@dataclass
class Heard:
    """What nodes were told: what calls that are drawn are made from.

    Attributes:
        params: packed parameters, and the record.
        frames, items: (port or kind, packed record, record's values) of some.
    """

    params: tuple[bytes, Any] | None = None
    frames: list[tuple[int, Any]] = field(default_factory=list)
    items: list[tuple[int, Any]] = field(default_factory=list)


class Shadow:
    """Stands between a plain simulation and the handlers of a role's nodes.

    Attributes:
        calls: how many were made in both ways.
    """

    def __init__(self, native: Native, most: int) -> None:
        self.native, self.role, self.most = native, native.library.role, most
        self.twins: dict[int, Twin] = {}
        self.params: dict[int, bytes] = {}
        self.calls = 0
        self.heard = Heard()
        self.world: Any = None

    def around(self, name: str, call: Callable[..., None]) -> Callable[..., None]:
        """A handler that is called in C, too."""
        arguments = HANDLERS[name]

        def both(state: Any, *rest: Any) -> None:
            *front, now = rest[: -arguments - 1]
            gate = front[0] if self.role.has_gate else None
            with self._beside(name, state, gate, front[-1], now, rest[-arguments - 1 :]):
                call(state, *rest)

        return both

    def in_place(self, hear: Callable[..., None]) -> Callable[..., None]:
        """What a run calls for the protocol's on_frame; it reads the clock itself."""

        def both(world: Any, node: int, time: int, port: int, frame: Any) -> None:
            states = getattr(world, self.role.watched.table)
            if node >= len(states):
                hear(world, node, time, port, frame)
                return
            now = clocks.reading(world.clocks[node], time) & MASK30
            given = (port, frame, world.out)
            with self._beside("on_frame", states[node], None, world.params[0], now, given):
                hear(world, node, time, port, frame)

        return both

    @contextmanager
    def _beside(
        self, name: str, state: Any, gate: Any, params: Any, now: int, rest: tuple[Any, ...]
    ) -> Iterator[None]:
        """What is called within is called in C, and compared."""
        *given, out = rest
        twin = self.twins.get(id(state))
        if twin is None:
            twin = self.twins[id(state)] = Twin(
                self.native, state, self._own(gate), len(self.twins)
            )
        elif name == "on_start":
            twin.sync()
        packed = self.packed(params)
        twin.call(name, packed, now, self._given(name, given))
        yield
        found = twin.compare(out)
        if found:
            raise BoardFailed(f"call {self.calls + 1}, {name}: {'; '.join(found)}"[:2000])
        self.calls += 1
        if self.calls >= self.most:
            raise Enough

    def _own(self, gate: Any) -> Any:
        """A node's second record, if it is one."""
        return gate if gate is not None and hasattr(gate, self.role.gate[0][0]) else None

    def packed(self, params: Any) -> bytes:
        """Parameters as C has them."""
        found = self.params.get(id(params))
        if found is None:
            found = self.params[id(params)] = self.native.records["params"].of(params)
            self.heard.params = (found, params)
        return found

    def _given(self, name: str, given: list[Any]) -> tuple[Any, ...]:
        """What a handler is given, as C takes it."""
        if name not in ("on_frame", "on_input"):
            return tuple(int(value) for value in given)
        number, record = given
        is_item = name == "on_input" and "item" in self.native.records
        packed = self.native.records.get("item" if is_item else "frame")
        if packed is None:
            return int(number), None
        data = packed.of(record)
        kept = self.heard.items if name == "on_input" else self.heard.frames
        if len(kept) < KEPT:
            kept.append((int(number), data))
        return int(number), data

    def run(self, plan: Any) -> None:
        """Simulate, both ways.

        Raises:
            BoardFailed: the two disagree.
        """
        role = self.role
        protocol, hears = import_module(role.entry), role.watched.on_frame
        with ExitStack() as stack:
            for name in HANDLERS:
                if hasattr(protocol, name) and not (hears and name == "on_frame"):
                    made = self.around(name, getattr(protocol, name))
                    stack.enter_context(mock.patch.object(protocol, name, made))
            if hears:
                made = self.in_place(part(hears))
                stack.enter_context(mock.patch(hears.replace(":", "."), made))
            running = simulation(role, plan, plain=True)
            self.world = running.world
            with suppress(Enough):
                running.finish()
