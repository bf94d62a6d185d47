"""Where a scenario's values came from, so that an error can point at the line."""

import datetime
import json
import math
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field
from typing import Any

from innervate.scenario.errors import ScenarioError
from innervate.scenario.lines import Key
from innervate.topology.unseen import unseen

INTEGER_MAX = 2**63 - 1
DEPTH_MAX = 16
OPTION = "--set"


@dataclass(slots=True)
class Source:
    """A scenario's origin, for what errors say."""

    path: str = ""  # the file as the user named it; "" for a scenario made in code
    folder: str = ""  # where relative paths in it start; "" is the working folder
    lines: dict[Key, int] = field(default_factory=dict)  # line of every key (see lines.py)
    sets: dict[Key, str] = field(default_factory=dict)  # the `--set` text that gave a key its value
    # Every key that has a value of its own, in the file, a dict or by `--set`; a run may have no
    # use for it, though the value is that which it has by itself.
    given: frozenset[Key] = frozenset()
    override: str = OPTION  # what errors call an override

    def error(self, key: Key, message: str) -> ScenarioError:
        """The error for a key: placed at the nearest `--set` or line above it."""
        for length in range(len(key), -1, -1):
            part = key[:length]
            if part and part not in self.lines:
                below = [text for path, text in self.sets.items() if path[:length] == part]
                if below:
                    return ScenarioError(message, f"{self.override} {below[-1]}", 0, dotted(key))
            if part in self.sets:
                return ScenarioError(message, f"{self.override} {self.sets[part]}", 0, dotted(key))
            if part in self.lines:
                return ScenarioError(message, self.path, self.lines[part], dotted(key))
        return ScenarioError(message, self.path, 0, dotted(key))


def dotted(key: Key) -> str:
    """A key path as it is written after `--set`: "event.0.at_s"."""
    return ".".join(str(part) for part in key)


def keys_of(value: Any, key: Key = ()) -> Iterator[Key]:
    """The keys below a value that are given: tables, lists and what is in them; None is absent."""
    inner: Iterable[tuple[Any, Any]] = ()
    if isinstance(value, dict):
        inner = value.items()
    elif isinstance(value, list | tuple):
        inner = enumerate(value)
    for part, found in inner:
        if found is not None:
            yield (*key, part)
            yield from keys_of(found, (*key, part))


def table_name(key: Key) -> str:
    """A table in words: "[protocol]", "[[event]] 0", "event.0.cell"."""
    if len(key) == 1:
        return f"[{key[0]}]"
    if len(key) == 2 and isinstance(key[1], int):
        return f"[[{key[0]}]] {key[1]}"
    return dotted(key) if key else "a scenario"


def shown(value: Any) -> str:
    """A value as the user would have written it, at most some 60 characters."""
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, dict):
        return "a table"
    if isinstance(value, str):
        short = value if len(value) <= 48 else value[:45] + "..."
        return json.dumps(short, ensure_ascii=False)
    if isinstance(value, list | tuple):
        inside = ", ".join(shown(item) for item in value[:4]) + (", ..." if len(value) > 4 else "")
        return f"[{inside}]" if len(inside) <= 48 else "a list"
    if isinstance(value, int) and abs(value) > 10**20:
        return "a number that long"
    return str(value)[:60]


def check_plain(source: Source, value: Any, key: Key = ()) -> None:
    """Refuse what no scenario can hold: odd types, NaN, huge integers, deep nesting.

    Raises:
        ScenarioError: naming the key.
    """
    name = dotted(key) or "the scenario"
    if len(key) > DEPTH_MAX:
        raise source.error(key, f"{dotted(key[:3])}... is nested too deeply")
    if isinstance(value, dict):
        for part, inner in value.items():
            if not isinstance(part, str):
                raise source.error(key, f"{name} has a key that is no string: {shown(part)}")
            if wrong := unseen(part):
                raise source.error(key, f"a key of {name} {wrong}")
            check_plain(source, inner, (*key, part))
    elif isinstance(value, list | tuple):
        for index, inner in enumerate(value):
            check_plain(source, inner, (*key, index))
    elif isinstance(value, str):
        if any("\ud800" <= char <= "\udfff" for char in value):
            raise source.error(key, f"{name} holds half a character; write whole ones")
        if wrong := unseen(value):
            raise source.error(key, f"{name} {wrong}")
    elif isinstance(value, bool) or value is None:
        return
    elif isinstance(value, int):
        if abs(value) > INTEGER_MAX:
            raise source.error(key, f"{name} must be a number below 2^63")
    elif isinstance(value, float):
        if not math.isfinite(value):
            raise source.error(key, f"{name} must be a finite number, not {value}")
    elif not isinstance(value, datetime.date | datetime.time):
        kind = type(value).__name__
        raise source.error(key, f"{name} must be a number, string, list or table, not a {kind}")


def with_article(kind: str) -> str:
    """A kind's name as one says it of one: "an aloha"."""
    return f"{'an' if kind[0] in 'aeiou' else 'a'} {kind}"
