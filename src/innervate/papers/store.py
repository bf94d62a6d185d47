"""Results of simulations, kept one by one as they come, so that an interrupt loses nothing."""

import json
import threading
from pathlib import Path
from typing import Any

from innervate.papers.errors import PapersError


class Store:
    """A file of one JSON object a line: {"key", "stamp", "value"}; later lines win.

    Args:
        path: the file; made when the first result comes.
        stamp: of the present sources.
        any_stamp: take results of other sources as well.
    """

    def __init__(self, path: Path, stamp: str, any_stamp: bool = False) -> None:
        self.path = path
        self.stamp = stamp
        self.any_stamp = any_stamp
        self.values: dict[str, Any] = {}
        self._lock = threading.Lock()
        self._whole = True
        if path.exists():
            self._read()

    def _read(self) -> None:
        text = self.path.read_text(encoding="utf-8", errors="replace")
        self._whole = text.endswith("\n") or not text
        for line in text.splitlines():
            try:
                entry = json.loads(line)
                key, mark, value = entry["key"], entry["stamp"], entry["value"]
            except (ValueError, KeyError, TypeError):
                continue  # a line that was cut off when the last run was killed
            if isinstance(key, str) and (self.any_stamp or mark == self.stamp):
                self.values[key] = value

    def put(self, key: str, value: Any) -> None:
        """Keep a result; safe to call from several threads.

        Raises:
            PapersError: it cannot be written.
        """
        line = json.dumps({"key": key, "stamp": self.stamp, "value": value})
        with self._lock:
            try:
                with self.path.open("a", encoding="utf-8") as file:
                    file.write(("" if self._whole else "\n") + line + "\n")
            except OSError as error:
                self._whole = False  # perhaps a part of the line is there
                raise PapersError(
                    f"{self.path}: {error.strerror or error}; give the same command again when "
                    "there is room, what is done is kept"
                ) from None
            self._whole = True
            # As it will be read back: lists for tuples, texts for keys.
            self.values[key] = json.loads(line)["value"]

    def missing(self, keys: list[str]) -> list[str]:
        """Which of these have no result yet."""
        return [key for key in keys if key not in self.values]
