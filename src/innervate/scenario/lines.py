"""Which line of a TOML text each key stands on.

The standard parser gives values without places. This scan runs after it, over text known to be
valid, and only feeds error messages: where it gives up, keys just have no line.
"""

from __future__ import annotations

import contextlib
import json
import re

Key = tuple[str | int, ...]

_BARE = re.compile(r"[A-Za-z0-9_-]+")
_SPACE = re.compile(r"[ \t]*")
_BLANK = re.compile(r"(?:[ \t\r\n]|#[^\n]*)*")
_SCALAR = re.compile(r"[^,\]}#\r\n]*")


def key_lines(text: str) -> dict[Key, int]:
    """Line (from 1) of every key path; arrays of tables and arrays by index from 0."""
    scan = _Scan(text)
    with contextlib.suppress(IndexError, ValueError, RecursionError):
        scan.document()
    return scan.lines


class _Scan:
    def __init__(self, text: str) -> None:
        self.text = text
        self.at = 0
        self.lines: dict[Key, int] = {}
        self.counts: dict[Key, int] = {}
        self._seen_at, self._seen_line = 0, 1

    def document(self) -> None:
        """Go through the whole text."""
        table: Key = ()
        while True:
            self._skip(_BLANK)
            if self.at >= len(self.text):
                return
            if self.text[self.at] == "[":
                table = self._header()
            else:
                self._pair(table)

    def _header(self) -> Key:
        line = self._line()
        array = self.text.startswith("[[", self.at)
        self.at += 2 if array else 1
        parts = self._dotted("]")
        self.at += 2 if array else 1
        path: Key = ()
        for part in parts[:-1]:
            path = self._into((*path, part))
        path = (*path, parts[-1])
        self.lines.setdefault(path, line)
        if array:
            self.counts[path] = self.counts.get(path, 0) + 1
            path = (*path, self.counts[path] - 1)
        self.lines.setdefault(path, line)
        return path

    def _into(self, path: Key) -> Key:
        """A table's path, or that of the newest element if it is an array of tables."""
        return (*path, self.counts[path] - 1) if path in self.counts else path

    def _pair(self, table: Key) -> None:
        line = self._line()
        path = table
        for part in self._dotted("="):
            path = (*path, part)
            self.lines.setdefault(path, line)
        self.at += 1
        self._value(path)

    def _dotted(self, end: str) -> list[str]:
        parts: list[str] = []
        while True:
            self._skip(_SPACE)
            char = self.text[self.at]
            if char == end:
                return parts
            if char == ".":
                self.at += 1
            elif char in "\"'":
                parts.append(self._string())
            else:
                match = _BARE.match(self.text, self.at)
                if match is None:
                    raise ValueError
                parts.append(match.group())
                self.at = match.end()

    def _value(self, path: Key) -> None:
        self._skip(_SPACE)
        char = self.text[self.at]
        if char in "\"'":
            self._string()
        elif char == "[":
            self._array(path)
        elif char == "{":
            self._inline(path)
        else:
            self._skip(_SCALAR)

    def _array(self, path: Key) -> None:
        self.at += 1
        index = 0
        while True:
            self._skip(_BLANK)
            if self.text[self.at] == "]":
                self.at += 1
                return
            if self.text[self.at] == ",":
                self.at += 1
                continue
            self.lines.setdefault((*path, index), self._line())
            self._value((*path, index))
            index += 1

    def _inline(self, path: Key) -> None:
        self.at += 1
        while True:
            self._skip(_BLANK)
            if self.text[self.at] == "}":
                self.at += 1
                return
            if self.text[self.at] == ",":
                self.at += 1
                continue
            self._pair(path)

    def _string(self) -> str:
        """Move past a string of any of the four forms; its value for one-line ones."""
        quote = self.text[self.at]
        start = self.at
        if self.text.startswith(3 * quote, start):
            end = self._closing(start + 3, 3 * quote)
            while self.text.startswith(quote, end + 3):
                end += 1
            self.at = end + 3
            return ""
        end = self._closing(start + 1, quote)
        self.at = end + 1
        inside = self.text[start + 1 : end]
        if quote == "'" or "\\" not in inside:
            return inside
        try:
            return str(json.loads(f'"{inside}"'))
        except ValueError:
            return inside

    def _closing(self, at: int, quote: str) -> int:
        escapes = quote[0] == '"'
        while not self.text.startswith(quote, at):
            if at >= len(self.text):
                raise IndexError
            at += 2 if escapes and self.text[at] == "\\" else 1
        return at

    def _skip(self, pattern: re.Pattern[str]) -> None:
        match = pattern.match(self.text, self.at)
        if match is not None:
            self.at = match.end()

    def _line(self) -> int:
        self._seen_line += self.text.count("\n", self._seen_at, self.at)
        self._seen_at = self.at
        return self._seen_line
