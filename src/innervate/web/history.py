"""What pages are told once: log lines, points of plots, frames on the air; and who was told what.

Every item has a number that is never used again, so that a page is told what is new by the number
it was told last, however slow it is.
"""

import threading
from bisect import bisect_right
from typing import Any, NamedTuple

LOSS, RETURN = "loss", "return"  # something was taken from the network, or given back to it
LOG, SERIES, TIMELINE, BACK = "log", "series", "timeline", "back"
# How many items of a stream are kept; who comes later, or falls behind that far, misses the oldest.
MOST = {LOG: 2_000, SERIES: 40_000, TIMELINE: 20_000, BACK: 1_000}


class Item(NamedTuple):
    """Something that happened at a moment of the network's time."""

    number: int
    at_us: int
    what: Any


class History:
    """The streams of a source; one thread adds, others look."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._streams: dict[str, list[Item]] = {name: [] for name in MOST}
        self._number = 0

    @property
    def newest(self) -> int:
        """Number of the newest item; 0 = there is none."""
        return self._number

    def add(self, stream: str, at_us: int, what: Any) -> None:
        """Add an item to a stream."""
        with self._lock:
            self._number += 1
            items = self._streams[stream]
            items.append(Item(self._number, at_us, what))
            if len(items) > 2 * MOST[stream]:
                del items[: -MOST[stream]]

    def go_back(self, to_us: int) -> None:
        """The network went back: what happened from that time on has not happened."""
        with self._lock:
            for name, items in self._streams.items():
                if name != BACK:
                    # A point of a plot stands for what was before its moment.
                    until_us = to_us + 1 if name == SERIES else to_us
                    self._streams[name] = [item for item in items if item.at_us < until_us]
        self.add(BACK, to_us, None)

    def after(self, stream: str, number: int, upto: int, most: int) -> list[Item]:
        """At most so many items of a stream, behind one number and up to another, oldest first."""
        with self._lock:
            items = self._streams[stream]
            first = bisect_right(items, number, key=lambda item: item.number)
            behind = bisect_right(items, upto, key=lambda item: item.number)
            return items[first : min(behind, first + most)]


class Logbook:
    """Writes log lines of a view; of a flood of lines of one kind only the first are written."""

    FLOOD = 8

    def __init__(self, history: History, calm_us: int | None = None) -> None:
        """`calm_us`: a kind without a line for so long is no flood any more; None = until calm."""
        self._history = history
        self._calm_us = calm_us
        self._written: dict[str, int] = {}
        self._newest_us: dict[str, int] = {}

    def say(self, at_us: int, text: str, level: str = "info", mark: str = "") -> None:
        """A line; `level` is info, good or bad; `mark`, LOSS or RETURN, is shown in plots."""
        line = {"type": "log", "t_s": at_us / 1e6, "text": text, "level": level}
        if mark:
            line["mark"] = mark
        self._history.add(LOG, at_us, line)

    def often(self, kind: str, at_us: int, text: str, level: str = "info", mark: str = "") -> None:
        """One of many lines of a kind."""
        before_us, self._newest_us[kind] = self._newest_us.get(kind, at_us), at_us
        if self._calm_us is not None and at_us - before_us > self._calm_us:
            self._written[kind] = 0
        self._written[kind] = self._written.get(kind, 0) + 1
        if self._written[kind] <= self.FLOOD:
            self.say(at_us, text, level, mark)
        elif self._written[kind] == self.FLOOD + 1:
            self.say(at_us, "... and more of that", level, mark)

    def calm(self) -> None:
        """Lines of all kinds are written again."""
        self._written.clear()
