"""What drawn calls are made of: records that nodes were told in simulations, changed at will."""

from __future__ import annotations

import copy
import random
from array import array
from typing import Any

from boards.firmware.native import Packed, fresh
from boards.firmware.replayed import Heard
from boards.firmware.script import KEPT_MOST, Script
from boards.roles import kind_of
from innervate.dialect import plain
from innervate.firmware.emit import Library
from innervate.firmware.records import Field
from innervate.network import networks
from innervate.wire.frames import Codec

LIFE = 400  # calls of a node, then comes another one
CHOICES = ("choice", "flag", "mode", "reading", "when")  # units of parameters that are drawn anew
SEED_MAX = 1_072_496_638


def lives(script: Script, first: int, calls: int) -> None:
    """Nodes of their own, the next one when one was called LIFE times; `first` is their seed."""
    for done in range(0, calls, LIFE):
        script.life(first + done // LIFE, min(LIFE, calls - done))


class Drawn:
    """Draws records of a role.

    Args:
        library: the role.
        heard: what nodes were told in simulations.
        seed: the same seed, the same records.
    """

    def __init__(self, library: Library, heard: Heard, seed: int) -> None:
        self.library, self.role, self.heard = library, library.role, heard
        self.packed = {name: Packed(fields) for name, fields in library.records.items()}
        self.random = random.Random(seed)
        self.codec = self._codec()
        self.noted = tuple((name, 0, 0, 0, "", "") for name in sorted(self.role.noted))

    def _codec(self) -> Any:
        """What says which frames can come in; None = the role looks into no frame."""
        frames = networks()[kind_of(self.role)].frames
        if not self.role.frame:
            return None
        return frames if hasattr(frames, "encode") else Codec(frames.LAYOUTS, frames.KIND_BITS)

    def keep(self, script: Script) -> None:
        """Write down what lives are made of."""
        for _ in range(KEPT_MOST["state"]):
            script.keep("state", 0, self.packed["state"].of(self._state()))
            script.keep("params", 0, self.packed["params"].of(self._params()))
        if "gate" in self.packed:
            gate = plain.make("Gate", self.role.gate)()
            script.keep("gate", 0, self.packed["gate"].of(gate))
        if self.heard.frames:
            for _ in range(KEPT_MOST["frame"]):
                port, frame = self._frame()
                script.keep("frame", port, self.packed["frame"].of(frame))
        if self.heard.items:
            packed = self.packed.get("item", self.packed.get("frame"))
            assert packed is not None
            for _ in range(KEPT_MOST["item"]):
                kind, data = self.random.choice(self.heard.items)
                script.keep("item", kind, packed.of(self._changed(packed, data)))

    def _state(self) -> Any:
        """What a node begins with."""
        draw = self.random
        state = fresh(self.library, draw.randrange(4), draw.randrange(1, SEED_MAX))
        for name in ("rank", "robot"):
            if field := self.library.records["state"].get(name):
                setattr(state, name, draw.choice(range(max(field.low, -1), 2)))
        return state

    def _params(self) -> Any:
        """The parameters of a simulation, some choices drawn anew."""
        assert self.heard.params is not None
        params = copy.copy(self.heard.params[1])
        for field in self.library.records["params"].values():
            if field.unit in CHOICES and not field.length and self.random.random() < 0.2:
                setattr(params, field.name, self.random.randint(field.low, field.high))
        return params

    def _frame(self) -> tuple[int, Any]:
        """A frame that the coder lets through, and the port where its like came in."""
        port, data = self.random.choice(self.heard.frames)
        packed = self.packed["frame"]
        for _ in range(8):
            frame, read = self._changed(packed, data), self._changed(packed, data)
            try:
                if self.codec.decode(self.codec.encode(frame), read) == 0:
                    return port, read
            except ValueError:
                continue
        return port, self._record(packed, data)

    def _changed(self, packed: Packed, data: bytes) -> Any:
        """A record with some of its fields drawn anew, within their ranges."""
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
