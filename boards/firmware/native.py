"""A role's C, compiled here, and a node's twin in it: every call is made twice and compared."""

from __future__ import annotations

import ctypes
import shutil
import struct
import subprocess
from array import array
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Any

from boards.errors import BoardFailed, BoardMissing
from innervate.dialect import plain
from innervate.firmware.emit import Library
from innervate.firmware.packed import CODES, Packed
from innervate.firmware.records import Field

WARNINGS = ("-Wall", "-Wextra", "-Wconversion", "-Werror")
SANITIZED = ("-fsanitize=undefined,bounds", "-fno-sanitize-recover=all")


def compiler(name: str = "gcc") -> str:
    """A compiler that is there.

    Raises:
        BoardMissing: it is not.
    """
    found = shutil.which(name)
    if found is None:
        raise BoardMissing(f"{name} is missing; install it (Debian, Ubuntu: apt install {name})")
    return found


def run(command: Iterable[str | Path]) -> str:
    """What a tool says on its standard output.

    Raises:
        BoardFailed: it ended with an error; its first lines.
    """
    done = subprocess.run([str(c) for c in command], capture_output=True, text=True, check=False)
    if done.returncode:
        raise BoardFailed((done.stderr or done.stdout).strip()[:2000])
    return done.stdout


def write(library: Library, folder: Path) -> Path:
    """Header and source in a folder; the source's path."""
    for name, text in library.texts().items():
        (folder / name).write_text(text)
    return folder / library.own_files[1]


class Native:
    """A role's C as a shared library of this machine.

    Args:
        library: the role.
        folder: where it is made.
        sanitized: with a check of every sum, shift and index.
        level: of optimisation; "-O0" is compiled in half the time.

    Raises:
        BoardMissing, BoardFailed: there is no compiler, or it does not take the source.
    """

    def __init__(
        self, library: Library, folder: Path, sanitized: bool = False, level: str = "-O1"
    ) -> None:
        self.library = library
        source, made = write(library, folder), folder / f"{library.prefix}.so"
        checks = SANITIZED if sanitized else ()
        run([compiler(), "-std=c99", level, "-fPIC", "-shared", *WARNINGS, *checks,
             source, "-o", made])  # fmt: skip
        self.loaded = ctypes.CDLL(str(made))
        self.records = {name: Packed(fields) for name, fields in library.records.items()}
        self.outbox = _Outbox(self)
        self.script: Any = None  # what writes all calls down, if anything does

    def handler(self, name: str) -> Callable[..., None] | None:
        """One of the five functions; None if the role has no such handler."""
        if name not in {made.name for made in self.library.program.handlers}:
            return None
        found: Callable[..., None] = getattr(self.loaded, f"{self.library.prefix}_{name}")
        return found


class _Outbox:
    """Where things stand in an outbox of C."""

    def __init__(self, native: Native) -> None:
        role, outbox = native.library.role, native.library.outbox
        self.action = native.records["action"]
        self.frame = native.records.get("frame")
        size = self.frame.size if self.frame else 0
        # Behind count and overflow: by action where its frame lies, in bytes or in frames.
        self.place, self.step, head = ("<H", 1, 4) if outbox.is_behind else ("B", size, 3)
        self.places_at = head
        head += struct.calcsize(self.place) * role.room
        self.frames_at = _aligned(head, native.library.records.get("frame", {}))
        behind = self.frames_at + (outbox.bytes or outbox.frames * size) if self.frame else 2
        self.actions_at = _aligned(behind, native.library.records["action"])
        self.size = self.actions_at + role.room * self.action.size + 8

    def actions(self, out: bytes) -> list[tuple[int, ...]]:
        """Kind, a, b and c of every action."""
        names, found = [name for name, _ in self.action.arrays], []
        for i in range(out[0]):
            place = self.actions_at + i * self.action.size
            row = dict(zip(names, self.action.struct.unpack_from(out, place), strict=True))
            found.append((row["kind"], row["a"], row["b"], row["c"]))
        return found

    def frame_of(self, out: bytes, action: int) -> dict[str, Any] | None:
        """The frame of an action as values by name; None if it has none."""
        if self.frame is None:
            return None
        at = self.places_at + action * struct.calcsize(self.place)
        (known,) = struct.unpack_from(self.place, out, at)
        if known == 0:
            return None
        place = self.frames_at + (known - 1) * self.step
        values = self.frame.struct.unpack_from(out, place)
        return {name: list(array(code, value)) if code else value
                for (name, code), value in zip(self.frame.arrays, values, strict=True)}  # fmt: skip


def _aligned(at: int, fields: dict[str, Field]) -> int:
    widest = max((struct.calcsize(CODES[field.type]) for field in fields.values()), default=1)
    return (at + widest - 1) // widest * widest


class Twin:
    """A node's state in C beside that in Python."""

    def __init__(self, native: Native, state: Any, gate: Any = None, slot: int = 0) -> None:
        self.native, self.state, self.gate, self.slot = native, state, gate, slot
        records = native.records
        self.memory = ctypes.create_string_buffer(records["state"].size)
        self.gate_memory = None
        if gate is not None and "gate" in records:
            self.gate_memory = ctypes.create_string_buffer(records["gate"].size)
        self.out = ctypes.create_string_buffer(native.outbox.size)
        self.sync()

    def sync(self) -> None:
        """Take over what the driver has set in Python's state."""
        self.memory.raw = self.native.records["state"].of(self.state)
        if self.gate_memory is not None:
            self.gate_memory.raw = self.native.records["gate"].of(self.gate)
        if self.native.script is not None:
            gate = None if self.gate_memory is None else self.gate_memory.raw
            self.native.script.sync(self.slot, self.memory.raw, gate)

    def call(self, name: str, params: bytes, now: int, given: tuple[Any, ...]) -> None:
        """The same call in C; records in `given` are bytes already."""
        handler = self.native.handler(name)
        assert handler is not None, f"C has no {name}"
        if self.native.script is not None:
            self.native.script.call(self.slot, name, params, int(now), given)
        gate = (self.gate_memory,) if self.native.library.role.has_gate else ()
        ctypes.memset(self.out, 0, self.native.outbox.size)
        handler(self.memory, *gate, params, int(now), *given, self.out)

    def compare(self, out: Any) -> list[str]:
        """What differs from Python's state and outbox; [] = nothing."""
        packed = self.native.records["state"]
        mine = packed.of(self.state)
        found = packed.differences(mine, self.memory.raw) if mine != self.memory.raw else []
        if self.gate_memory is not None:
            packed = self.native.records["gate"]
            mine = packed.of(self.gate)
            if mine != self.gate_memory.raw:
                found += packed.differences(mine, self.gate_memory.raw)
        return found + self._compare_out(out)

    def _compare_out(self, out: Any) -> list[str]:
        mine = self.out.raw
        native, kinds = self.native, self.native.library.role.kinds
        actions = native.outbox.actions(mine)
        wanted = [(a.kind, a.a, a.b, a.c) for a in out.action[: out.count[0]]]
        if mine[1] != out.overflow[0] or [tuple(map(int, row)) for row in wanted] != actions:
            return [f"outbox: {wanted} but in C {actions}, overflow {mine[1]}"]
        found = []
        for i, row in enumerate(actions):
            if not kinds or row[0] not in (1, 3):
                continue
            frame, other = out.frame[i], native.outbox.frame_of(mine, i)
            if other is None:
                found.append(f"action {i}: C has no frame")
                continue
            for name, many in (("kind", 0), *kinds[frame.kind]):
                value, its = getattr(frame, name), other[name]
                if many:
                    count = getattr(frame, many) if isinstance(many, str) else many
                    value, its = [int(v) for v in value[:count]], its[:count]
                if value != its:
                    found.append(f"action {i}, frame.{name}: {value} but in C {its}")
        return found


def fresh(library: Library, number: int, seed: int) -> Any:
    """A state in Python as `init` of C makes it."""
    state = plain.make("State", library.role.state)()
    for name, value in (("number", number), ("rng", seed), ("choice", -1)):
        if name in library.records["state"]:
            setattr(state, name, value)
    return state
