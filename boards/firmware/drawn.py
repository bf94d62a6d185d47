"""Calls that are drawn: nodes that are told what others were told, with fields changed at will."""

from __future__ import annotations

import copy
import random
from array import array
from importlib import import_module
from typing import Any

from boards.errors import BoardFailed
from boards.firmware.native import Native, Packed, Twin, fresh
from boards.firmware.replayed import Heard
from boards.roles import kind_of
from innervate.dialect import plain
from innervate.dialect.arith import MASK30
from innervate.firmware.records import Field
from innervate.network import networks
from innervate.wire.frames import Codec

LIFE = 400  # calls of a node, then comes another one
CHOICES = ("choice", "flag", "mode", "reading", "when")  # units of parameters that are drawn anew
SET_TIMER = 2
SEED_MAX = 1_072_496_638


class Drawn:
    """Draws calls of a role, and makes each in Python and in C.

    Args:
        native: the role's C.
        heard: what nodes were told in simulations.
        seed: the same seed, the same calls.

    Attributes:
        calls: how many were made.
    """

    def __init__(self, native: Native, heard: Heard, seed: int) -> None:
        self.native, self.role, self.heard = native, native.library.role, heard
        self.random = random.Random(seed)
        self.module = import_module(self.role.entry)
        self.calls = 0
        self.codec = self._codec()
        self.noted = tuple((name, 0, 0, 0, "", "") for name in sorted(self.role.noted))
        frame = plain.make("Frame", self.role.frame, self.noted)
        self.out = plain.Outbox(frame, self.role.room)

    def _codec(self) -> Any:
        """What says which frames can come in; None = the role looks into no frame."""
        frames = networks()[kind_of(self.role)].frames
        if not self.role.frame:
            return None
        return frames if hasattr(frames, "encode") else Codec(frames.LAYOUTS, frames.KIND_BITS)

    def run(self, calls: int) -> None:
        """Make so many.

        Raises:
            BoardFailed: Python and C disagree, or Python does not get through.
        """
        while self.calls < calls:
            self._live(min(LIFE, calls - self.calls))

    def _live(self, calls: int) -> None:
        """A node, from its start on."""
        draw, role = self.random, self.role
        state = fresh(self.native.library, draw.randrange(4), draw.randrange(1, SEED_MAX))
        gate = plain.make("Gate", role.gate)() if role.has_gate else None
        for name in ("rank", "robot"):
            if hasattr(state, name):
                setattr(state, name, draw.choice((0, 1) if name == "robot" else (-1, 0, 1)))
        params = self._params()
        packed = self.native.records["params"].of(params)
        twin = Twin(self.native, state, gate)
        now, timers = draw.randrange(MASK30), {}
        told = ("on_start", (draw.randrange(2),))
        for _ in range(calls):
            name, given = told
            self._call(twin, name, params, packed, now, given)
            for act in self.out.action[: self.out.count[0]]:
                if act.kind == SET_TIMER:
                    timers[act.a] = act.b
            now, told = self._next(now, timers)

    def _params(self) -> Any:
        """The parameters of a simulation, some choices drawn anew."""
        assert self.heard.params is not None
        params = copy.copy(self.heard.params[1])
        for field in self.native.library.records["params"].values():
            if field.unit in CHOICES and not field.length and self.random.random() < 0.2:
                setattr(params, field.name, self.random.randint(field.low, field.high))
        return params

    def _next(self, now: int, timers: dict[int, int]) -> tuple[int, tuple[str, tuple[Any, ...]]]:
        """What happens next, and when: a timer that is due, or something before it."""
        draw = self.random
        wait, timer = (
            min(((at - now) & MASK30, t) for t, at in timers.items()) if timers else (0, 0)
        )
        if wait > MASK30 >> 1:
            wait = 0  # overdue
        if timers and draw.random() < 0.35:
            del timers[timer]
            return (now + wait) & MASK30, ("on_timer", (timer,))
        until = min(wait, 50_000) if timers else 50_000
        now = (now + draw.randint(0, until)) & MASK30
        what = draw.random()
        if what < 0.004:
            timers.clear()
            return now, ("on_start", (draw.randrange(2),))
        if what < 0.3 and hasattr(self.module, "on_carrier"):
            return now, ("on_carrier", (draw.randrange(2), draw.randrange(2)))
        if what < 0.5 and self.heard.items:
            return now, ("on_input", self._input())
        if self.role.frame:
            return now, ("on_frame", self._frame())
        return now, ("on_input", self._input())

    def _input(self) -> tuple[int, Any]:
        kind, data = self.random.choice(self.heard.items)
        records = self.native.records
        packed = records.get("item", records.get("frame"))
        return kind, self._changed(packed, data)

    def _frame(self) -> tuple[int, Any]:
        """A frame that the coder lets through, on the port where its like came in, or another."""
        port, data = self.random.choice(self.heard.frames)
        packed = self.native.records["frame"]
        for _ in range(8):
            frame, read = self._changed(packed, data), self._changed(packed, data)
            try:
                if self.codec.decode(self.codec.encode(frame), read) == 0:
                    return port, read
            except ValueError:
                continue
        return port, self._record(packed, data)

    def _changed(self, packed: Packed | None, data: bytes) -> Any:
        """A record with some of its fields drawn anew, within their ranges."""
        assert packed is not None
        record = self._record(packed, data)
        for field in self.random.sample(list(packed.fields.values()), min(2, len(packed.fields))):
            if self.random.random() < 0.6:
                self._redraw(record, field)
        return record

    def _redraw(self, record: Any, field: Field) -> None:
        draw = self.random
        near = (field.low, field.high, draw.randint(field.low, min(field.high, field.low + 5)))
        value = draw.choice((*near, draw.randint(field.low, field.high)))
        if field.length:
            getattr(record, field.name)[draw.randrange(field.length)] = value
        else:
            setattr(record, field.name, value)

    def _record(self, packed: Packed, data: bytes) -> Any:
        """The record that bytes of C are."""
        names = [(f.name, f.length, f.low, f.high, "", "") for f in packed.fields.values()]
        record = plain.make("Record", tuple(names), self.noted)()
        values = packed.struct.unpack(data)
        for (name, code), value in zip(packed.arrays, values, strict=True):
            setattr(record, name, list(array(code, value)) if code else value)
        return record

    def _call(
        self, twin: Twin, name: str, params: Any, packed: bytes, now: int, given: tuple[Any, ...]
    ) -> None:
        self.out.count[0] = self.out.overflow[0] = 0
        gate = (twin.gate,) if self.role.has_gate else ()
        where = f"drawn call {self.calls + 1}, {name}"
        data = given
        if name in ("on_frame", "on_input"):
            records = self.native.records
            kind = "item" if name == "on_input" and "item" in records else "frame"
            data = (given[0], records[kind].of(given[1]))
        try:
            getattr(self.module, name)(twin.state, *gate, params, now, *given, self.out)
        except Exception as error:
            raise BoardFailed(f"{where}: Python: {type(error).__name__}: {error}") from error
        twin.call(name, packed, now, data)
        try:
            found = twin.compare(self.out)
        except (OverflowError, ValueError, TypeError) as error:
            raise BoardFailed(f"{where}: out of its declared range: {error}") from error
        if found:
            raise BoardFailed(f"{where}: {'; '.join(found)}"[:2000])
        self.calls += 1
