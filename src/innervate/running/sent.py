"""What a watched plain run sees of frames: who set what in them, and what nobody did."""

import sys
from collections.abc import Callable
from functools import partial
from pathlib import Path
from types import FrameType
from typing import Any

from innervate.dialect import outbox
from innervate.dialect.folder import MEASURED
from innervate.dialect.outbox import DELIVER, SEND, SET_TIMER
from innervate.folders import NetworkError, shown
from innervate.network import Network
from innervate.running.timers import Timers
from innervate.sim.sent import FRAME_BROKEN, KIND_BROKEN
from innervate.verify.frames import frames_of

Here = Callable[[], tuple[str, int]]


class Told(list[int]):
    """A list that tells a place and a value before it is set there."""

    def __init__(self, values: list[int], tell: Callable[[int, int], None]) -> None:
        super().__init__(values)
        self.tell = tell

    def __setitem__(self, place: Any, value: Any) -> None:
        self.tell(place, value)
        super().__setitem__(place, value)


def telling(record: Any, tell: Callable[[Any, str, Any], None]) -> type:
    """A class like a record's, that tells record, field and value before it is set."""

    def set_field(record: Any, name: str, value: Any) -> None:
        tell(record, name, value)
        object.__setattr__(record, name, value)

    made = type(record)
    return type(made.__name__, (made,), {"__slots__": (), "__setattr__": set_field})


class Sent:
    """Watches the frames of the outbox of a plain run, not yet begun.

    `here` says the innermost line of the network's files that is being run.

    Attributes:
        words: what is wrong with the frame that broke the run, and where it was set; "" nothing.
        count: to be the outbox's, in place of its own.
    """

    def __init__(self, world: Any, network: Network, here: Here) -> None:
        self.words, self.here, self.out = "", here, world.out
        self.frames, self.timers = frames_of(network), Timers()
        self.put_at: dict[int, tuple[str, int, str]] = {}  # by action: file, line, handler
        # By frame and field, of this call: where a value was set that cannot be.
        self.set_at: dict[tuple[int, str], tuple[str, int] | None] = {}
        self.ranges = {name: (low, high) for name, _, low, high, *_ in self.frames.declared}
        self.count = Told([0], self._count_set)
        kind = telling(world.out.frame[0], self._field_set)
        for place, frame in enumerate(world.out.frame):
            for name, length, *_ in network.fields.FRAME:
                if length:
                    told = partial(self._in_row_set, (place, name))
                    setattr(frame, name, Told(getattr(frame, name), told))
            frame.__class__ = kind
        self.place = {id(frame): place for place, frame in enumerate(world.out.frame)}
        world.run[0].__class__ = telling(world.run[0], self._run_set)

    def _field_set(self, frame: Any, name: str, value: Any) -> None:
        self.note((self.place[id(frame)], name), value)

    def _in_row_set(self, what: tuple[int, str], _place: int, value: int) -> None:
        self.note(what, value)

    def _run_set(self, _run: Any, name: str, value: Any) -> None:
        """Say what was set where, at the moment that a frame breaks the run."""
        if name == "broken" and value in (FRAME_BROKEN, KIND_BROKEN) and not self.words:
            self.words = self.first_wrong()

    def _count_set(self, _place: int, value: int) -> None:
        """How many actions there are."""
        if value:
            path, line, handler = _putter()
            self.put_at[value - 1] = path, line, handler.f_code.co_name
            act = self.out.action[value - 1]
            if act.kind == SET_TIMER:
                self.timers.look(handler, f"{shown(Path(path))}:{line}", act.b)
        elif self.count[0]:
            self.drained(self.count[0])

    def note(self, what: tuple[int, str], value: Any) -> None:
        """A field of a frame is set."""
        name, laid = what[1], self.frames.laid
        low, high = self.ranges.get(name, (value, value))
        can_be = low <= value <= high and (name != "kind" or not laid or value in laid)
        self.set_at[what] = None if can_be else self.here()

    def first_wrong(self) -> str:
        """The first value of what the present call sends and delivers that cannot be."""
        for place in range(self.out.count[0]):
            act, frame = self.out.action[place], self.out.frame[place]
            if act.kind not in (SEND, DELIVER):
                continue
            for name, length, low, high, *_ in self.frames.declared:
                value = getattr(frame, name)
                for one in value if length else [value]:
                    if name not in MEASURED and not low <= one <= high:
                        return self._said(place, name, f"is {one}, declared {low} to {high}")
            if act.kind == SEND and self.frames.laid and frame.kind not in self.frames.laid:
                return self._said(place, "kind", f"is {frame.kind}, which has no layout")
        return ""

    def drained(self, count: int) -> None:
        """So many actions of a call are carried out.

        Raises:
            NetworkError: a frame had a field that the call did not set.
        """
        for place in range(count):
            act, frame = self.out.action[place], self.out.frame[place]
            if act.kind in (SEND, DELIVER):
                for name in self.frames.wanted(getattr(frame, "kind", None), act.kind):
                    if (place, name) not in self.set_at:
                        raise NetworkError(self._said(place, name, "is not set: it would be what "
                                                      "an earlier frame had there"))  # fmt: skip
        self.set_at.clear()

    def _said(self, place: int, name: str, what: str) -> str:
        file, line, handler = self.put_at[place]
        path = shown(Path(file))
        path, line = self.set_at.get((place, name)) or (path, line)
        does = "sends" if self.out.action[place].kind == SEND else "delivers"
        return f"{path}:{line}: {name} of a frame that {handler} {does} {what}"


def _putter() -> tuple[str, int, FrameType]:
    """File and line that put an action into the outbox, and the handler's call that it is of."""
    frame: Any = sys._getframe(3)
    while frame.f_code.co_filename == outbox.__file__:
        frame = frame.f_back
    place = frame.f_code.co_filename, frame.f_lineno
    while frame.f_back is not None and not frame.f_code.co_name.startswith("on_"):
        frame = frame.f_back
    return (*place, frame)
