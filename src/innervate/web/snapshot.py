"""A network's state at one moment, and what of it a page has not been told yet."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import msgspec
import numpy as np

from innervate.web.history import BACK, LOG, SERIES, TIMELINE, History

DELTA_MAX = 4_000  # items of a stream in one message; the rest follows in the next
LINES_MAX = 200
_encode = msgspec.json.Encoder(decimal_format="number").encode


class Part:
    """The value of one field; written as JSON once, for all pages, when the first one needs it."""

    __slots__ = ("_json", "value")

    def __init__(self, value: Any) -> None:
        self.value = value
        self._json: msgspec.Raw | None = None

    def is_same(self, value: Any) -> bool:
        """True if that is the value that is here."""
        if isinstance(value, np.ndarray):
            return isinstance(self.value, np.ndarray) and np.array_equal(self.value, value)
        return type(value) is type(self.value) and bool(self.value == value)

    @property
    def json(self) -> msgspec.Raw:
        """The value as JSON, encoded once for all pages."""
        if self._json is None:
            value = self.value
            plain = value.tolist() if isinstance(value, np.ndarray) else value
            self._json = msgspec.Raw(_encode(plain))
        return self._json


class Snapshot:
    """The state of a network at one moment."""

    scene: Part  # the scene that it belongs to
    # Its fields by name; a field that did not change is the same object as before.
    parts: dict[str, Part]
    newest: int  # number of the newest item in the history at that moment

    def __init__(
        self, scene: Part, fields: dict[str, Any], newest: int, before: Snapshot | None
    ) -> None:
        old: dict[str, Part] = before.parts if before is not None and before.scene is scene else {}
        self.scene = scene
        self.newest = newest
        self.parts = {
            name: old[name] if name in old and old[name].is_same(value) else Part(value)
            for name, value in fields.items()
        }

    def same_as(self, other: Snapshot | None) -> bool:
        """True if there is nothing to tell to who knows the other."""
        return (
            other is not None
            and self.scene is other.scene
            and self.newest == other.newest
            and self.parts.keys() == other.parts.keys()
            and all(part is other.parts[name] for name, part in self.parts.items())
        )


class DeltaEncoder:
    """What one page has been told."""

    def __init__(self, history: History) -> None:
        self._history = history
        self._scene: Part | None = None
        self._told: dict[str, Part] = {}
        self._numbers: dict[str, int] = {}

    def messages(self, snapshot: Snapshot) -> Iterable[bytes]:
        """The messages that bring the page up to a snapshot; none if it knows it all."""
        if snapshot.scene is not self._scene:
            # The page begins anew, too: it is told all that is kept.
            self._scene, self._told = snapshot.scene, {}
            self._numbers = {LOG: 0, SERIES: 0, TIMELINE: 0, BACK: snapshot.newest}
            yield bytes(snapshot.scene.json)
        fields: dict[str, Any] = {
            name: part.json
            for name, part in snapshot.parts.items()
            if self._told.get(name) is not part
        }
        self._told = dict(snapshot.parts)
        gone_back = self._fresh(BACK, snapshot)
        if gone_back:
            fields["back_s"] = min(item.at_us for item in gone_back) / 1e6
        lines = self._fresh(LOG, snapshot, LINES_MAX)
        timeline = self._fresh(TIMELINE, snapshot)
        if timeline:
            fields["timeline"] = [item.what for item in timeline]
        series: dict[str, list[Any]] = {}
        for item in self._fresh(SERIES, snapshot):
            for name, value in item.what.items():
                series.setdefault(name, []).append((item.at_us / 1e6, value))
        if series:
            fields["series"] = series
        if fields:
            yield _encode({"type": "state", **fields})
        for item in lines:
            yield _encode(item.what)

    def is_behind(self, snapshot: Snapshot) -> bool:
        """True if there is more to tell than fitted into the last messages."""
        return any(
            self._history.after(stream, number, snapshot.newest, 1)
            for stream, number in self._numbers.items()
        )

    def _fresh(self, stream: str, snapshot: Snapshot, most: int = DELTA_MAX) -> Any:
        items = self._history.after(stream, self._numbers[stream], snapshot.newest, most)
        if items:
            self._numbers[stream] = items[-1].number
        return items
