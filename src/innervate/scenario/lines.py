"""Which line of a TOML text each key stands on.

The standard parser gives values without places. This scan runs after it, over text known to be
valid, and only feeds error messages: where it gives up, keys just have no line.
"""

import contextlib
import json
import re
from collections.abc import Iterator
from itertools import count

Key = tuple[str | int, ...]

_BARE = re.compile(r"[A-Za-z0-9_-]+")
_SPACE = re.compile(r"[ \t]*")
_BLANK = re.compile(r"(?:[ \t\r\n]|#[^\n]*)*")
_BETWEEN = re.compile(r"(?:[ \t\r\n,]|#[^\n]*)*")
_SCALAR = re.compile(r"[^,\]}#\r\n]*")
_STRING = re.compile(
    r'"""(?:\\.|[^\\])*?"{3,5}|\'\'\'.*?\'{3,5}|"((?:\\.|[^"\\])*)"|\'([^\']*)\'', re.DOTALL
)


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
        for index in self._elements("]"):
            self.lines.setdefault((*path, index), self._line())
            self._value((*path, index))

    def _inline(self, path: Key) -> None:
        for _ in self._elements("}"):
            self._pair(path)

    def _elements(self, end: str) -> Iterator[int]:
        """The places of what is between brackets; whoever takes one moves past it."""
        self.at += 1
        for index in count():
            self._skip(_BETWEEN)
            if self.text[self.at] == end:
                self.at += 1
                return
            yield index

    def _string(self) -> str:
        """Move past a string of any of the four forms; its value for one-line ones."""
        match = _STRING.match(self.text, self.at)
        if match is None:
            raise ValueError
        self.at = match.end()
        basic, literal = match.groups()
        try:
            return literal or str(json.loads(f'"{basic or ""}"'))
        except ValueError:
            return str(basic)

    def _skip(self, pattern: re.Pattern[str]) -> None:
        match = pattern.match(self.text, self.at)
        if match is not None:
            self.at = match.end()

    def _line(self) -> int:
        self._seen_line += self.text.count("\n", self._seen_at, self.at)
        self._seen_at = self.at
        return self._seen_line
