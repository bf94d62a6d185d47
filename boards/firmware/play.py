"""What is written down as a script, played in plain Python; beside it C, if that is wanted."""

from __future__ import annotations

from collections.abc import Iterator
from importlib import import_module
from typing import Any

from boards.errors import BoardFailed
from boards.firmware import script
from boards.firmware.marks import Mark
from boards.firmware.native import Native, Twin
from innervate.dialect import plain
from innervate.dialect.arith import MASK30
from innervate.firmware.emit import Library
from innervate.firmware.packed import Packed
from innervate.live.board import Declaration

SET_TIMER = 2
# What record follows a row.
RECORDS = {
    script.WHAT.index("on_frame"): "frame", script.WHAT.index("on_input"): "item",
    script.STATE: "state", script.PARAMS: "params", script.GATE: "gate",
    **{number: name for name, number in script.KEPT.items()},
}  # fmt: skip
LONGEST_US = 50_000  # from one drawn call to the next


class Chance:
    """Small random numbers, the same in C (xorshift)."""

    def __init__(self, seed: int) -> None:
        self.state = seed * 2_654_435_761 & 0xFFFF_FFFF

    def below(self, count: int) -> int:
        """One of 0 .. count-1."""
        x = self.state
        x ^= x << 13 & 0xFFFF_FFFF
        x ^= x >> 17
        self.state = x = x ^ (x << 5 & 0xFFFF_FFFF)
        return x % count


class Player:
    """Plays scripts of a library's role.

    Args:
        library: the role.
        native: its C, to make every call in as well and to compare.

    Attributes:
        calls: how many were made.
    """

    def __init__(self, library: Library, native: Native | None = None) -> None:
        self.role, self.native = library.role, native
        self.module = import_module(self.role.entry)
        self.has_carrier = hasattr(self.module, "on_carrier")
        self.packed = {name: Packed(fields) for name, fields in library.records.items()}
        if "item" not in self.packed:
            self.packed["item"] = self.packed["frame"]
        noted: Declaration = tuple((name, 0, 0, 0, "", "") for name in sorted(self.role.noted))
        frame = plain.make("Frame", self.role.frame, noted)
        self.made = {"state": plain.make("State", self.role.state),
                     "params": plain.make("Params", self.role.params),
                     "gate": plain.make("Gate", self.role.gate), "frame": frame,
                     "item": plain.make("Item", self.role.item, noted)}  # fmt: skip
        self.out = plain.Outbox(frame, self.role.room)
        self.mark = Mark(library)
        self.kept: dict[str, list[tuple[int, bytes]]] = {name: [] for name in script.KEPT}
        self.nodes: dict[int, list[Any]] = {}
        self.params: tuple[bytes, Any] = (b"", None)
        self.calls = 0

    def rows(self, data: bytes) -> Iterator[tuple[int, int, int, int, int, str, bytes]]:
        """Rows of a script: what, node, clock, two numbers; what record follows, and its bytes."""
        at = 0
        while at < len(data):
            row = script.ROW.unpack_from(data, at)
            at += script.ROW.size
            name = RECORDS.get(row[0], "")
            size = self.packed[name].size if name in self.packed else 0
            yield *row, name, data[at : at + size]
            at += size

    def parts(self, data: bytes) -> Iterator[bytes]:
        """A script, cut where something new begins."""
        at = begun = 0
        for what, *_, record in self.rows(data):
            if what == script.BEGIN and at > begun:
                yield data[begun:at]
                begun = at
            at += script.ROW.size + len(record)
        yield data[begun:at]

    def play(self, data: bytes) -> Iterator[int]:
        """The hashes, where the script wants them said.

        Raises:
            BoardFailed: Python and C disagree, or Python does not get through.
        """
        for what, slot, now, a, b, name, record in self.rows(data):
            if what < len(script.WHAT):
                self._call(slot, script.WHAT[what], now, (a, record if name else b))
            elif what in script.KEPT.values():
                self.kept[name].append((a, record))
            elif what == script.SAY:
                yield self.mark.value
            elif what == script.BEGIN:
                self.mark.value, self.nodes = 1, {}
            elif what == script.LIFE:
                self._live(a, b)
            elif what != script.END:
                self._set(name, slot, record)

    def _record(self, name: str, data: bytes) -> Any:
        """The record that bytes of C are; None = no bytes, the role looks into no frame."""
        if not data:
            return None
        record = self.made[name]()
        self.packed[name].put(data, record)
        return record

    def _set(self, name: str, slot: int, data: bytes) -> None:
        """A node's state, its second record, or all nodes' parameters."""
        record = self._record(name, data)
        if name == "params":
            self.params = (data, record)
            return
        node = self.nodes.setdefault(slot, [None, None, None])
        node[name == "gate"] = record
        if name == "state":
            node[1] = None
        if self.native:
            node[2] = Twin(self.native, node[0], node[1])

    def _call(self, slot: int, name: str, now: int, given: tuple[int, Any]) -> None:
        state, gate, twin = self.nodes[slot]
        self.out.count[0] = self.out.overflow[0] = 0
        told: tuple[Any, ...] = given[: 2 if name in ("on_frame", "on_input", "on_carrier") else 1]
        mine = told
        if isinstance(given[1], bytes):
            told = (given[0], given[1] or None)
            mine = (given[0], self._record("item" if name == "on_input" else "frame", given[1]))
        front = (gate,) if self.role.has_gate else ()
        where = f"call {self.calls + 1}, {name}"
        try:
            getattr(self.module, name)(state, *front, self.params[1], now, *mine, self.out)
            self.mark.add(state, gate, self.out)
        except Exception as error:
            raise BoardFailed(f"{where}: Python: {type(error).__name__}: {error}") from error
        if twin is not None:
            twin.call(name, self.params[0], now, told)
            found = twin.compare(self.out)
            if found:
                raise BoardFailed(f"{where}: {'; '.join(found)}"[:2000])
        self.calls += 1

    def _live(self, seed: int, calls: int) -> None:
        """A node from its start on, told what others were told."""
        chance, kept = Chance(seed), self.kept
        for name in ("state", "params", "gate"):
            if kept[name]:
                self._set(name, 0, kept[name][chance.below(len(kept[name]))][1])
        now, due = chance.below(MASK30), {}
        what, given = "on_start", (chance.below(2), 0)
        for _ in range(calls):
            self._call(0, what, now, given)
            for act in self.out.action[: self.out.count[0]]:
                if act.kind == SET_TIMER:
                    due[act.a] = act.b
            now, what, given = self._next(chance, now, due)

    def _next(
        self, chance: Chance, now: int, due: dict[int, int]
    ) -> tuple[int, str, tuple[int, Any]]:
        """What happens next, and when: a timer that is due, or something before it."""
        wait, timer = min(((at - now) & MASK30, t) for t, at in due.items()) if due else (0, -1)
        if wait > MASK30 >> 1:
            wait = 0  # overdue
        if due and chance.below(100) < 35:
            del due[timer]
            return (now + wait) & MASK30, "on_timer", (timer, 0)
        until = min(wait, LONGEST_US) if due else LONGEST_US
        now, what = (now + chance.below(until + 1)) & MASK30, chance.below(1000)
        if what < 4:
            due.clear()
            return now, "on_start", (chance.below(2), 0)
        if what < 300 and self.has_carrier:
            first = chance.below(2)
            return now, "on_carrier", (first, chance.below(2))
        items, frames = self.kept["item"], self.kept["frame"]
        if items and (what < 500 or not frames):
            return now, "on_input", items[chance.below(len(items))]
        return now, "on_frame", frames[chance.below(len(frames))]
