"""What is varied: an axis is a list of steps, each a value for one key or for several together.

`protocol.k=2..8` is an axis of seven steps, `protocol.k,protocol.m=3:3,5:2` one of two steps in
which both keys change together.
"""

import json
import re
from collections.abc import Iterable
from dataclasses import dataclass
from decimal import Decimal
from typing import Any

from innervate.scenario import inline
from innervate.scenario.overrides import parse_value
from innervate.sweeping.errors import SweepError

STEPS_MAX = 1_000_000
COLUMNS = ("point", "repeat", "seed", "status", "reason", "command")  # of every row, besides keys
_NUMBER = r"[+-]?\d+(?:\.\d+)?"
_RANGE = re.compile(rf"({_NUMBER})\.\.({_NUMBER})(?:\.\.({_NUMBER}))?")
_KEY = re.compile(r"[A-Za-z0-9_-]+(\.[A-Za-z0-9_-]+)*")
_OPENING, _CLOSING = "[{(", "]})"


@dataclass(frozen=True, slots=True)
class Named:
    """A value too long for a table, and what tables and figures call it."""

    name: str
    value: Any


@dataclass(frozen=True, slots=True)
class Axis:
    """One direction of a sweep."""

    keys: tuple[str, ...]  # dotted scenario keys that change together
    # for every step a value of each key; Named where it goes by a name
    steps: tuple[tuple[Any, ...], ...]


def parse(text: str) -> Axis:
    """The axis of a `--vary` text.

    Values are separated by commas, a range is FIRST..LAST or FIRST..LAST..STEP with both ends
    included. Several keys before the "=" take as many values, joined by ":", in every step.
    """
    name, equals, rest = text.partition("=")
    where = f"--vary {text[:80]}"
    if not equals:
        raise SweepError(f"{where}: write it as key=values, like protocol.k=2..8 or name=a,b")
    keys = tuple(word.strip() for word in name.split(","))
    parts = [part.strip() for part in split(rest, ",")]
    if "" in parts:
        raise SweepError(f"{where}: a value is missing; write it as key=values, like k=3,5,8")
    if len(keys) == 1:
        steps = [(value,) for part in parts for value in values_of(part, where)]
    else:
        steps = [_together(part, keys, where) for part in parts]
    return axis(keys, steps, where)


def axis(keys: tuple[str, ...], steps: Iterable[tuple[Any, ...]], where: str) -> Axis:
    """An axis of keys that are some, and of steps, no two equal; `where` begins a SweepError."""
    for key in keys:
        check_key(key, where)
    if len(set(keys)) < len(keys):
        raise SweepError(f"{where}: a key stands there twice")
    made = Axis(keys, tuple(tuple(step) for step in steps))
    if not made.steps:
        raise SweepError(f"{where}: there are no values")
    if len(made.steps) > STEPS_MAX:
        raise SweepError(f"{where}: more than {STEPS_MAX:,} values; a sweep takes no more")
    seen: set[str] = set()
    for step in made.steps:  # by their values and by what tables and figures call them
        called = [v if isinstance(v, str) else canonical(v) for v in map(column, step)]
        texts = {canonical([plain(value) for value in step]), f"called {called}"}
        if seen & texts:
            raise SweepError(f"{where}: {' : '.join(map(shown, step))} stands there twice")
        seen |= texts
    return made


def check_key(key: str, where: str) -> None:
    """Raise a SweepError if a key is none, or called as another column of the results."""
    if not _KEY.fullmatch(key):
        raise SweepError(f'{where}: "{key}" is no key; keys are names with dots between')
    if key == "seed":
        raise SweepError(
            f"{where}: every run has a seed of its own; say how many with --repeat, and "
            "where they start with --seed"
        )
    if key in COLUMNS:
        raise SweepError(
            f'{where}: "{key}" is a column of the results already; vary what is in it, like '
            f"{key}.0.at_s"
        )


def values_of(text: str, where: str) -> list[Any]:
    """The values of one part of a list: of a range, which has to lead somewhere, or the one."""
    match = _RANGE.fullmatch(text)
    if match is None:
        return [parse_value(text)]
    first, last = Decimal(match[1]), Decimal(match[2])
    whole = "." not in f"{match[1]}{match[2]}{match[3] or ''}"
    if match[3] is None and not whole:
        raise SweepError(f"{where}: {text} needs a step, like {text}..0.1")
    step = Decimal(match[3] or 1)
    if step == 0 or (last - first) / step < 0:
        raise SweepError(f"{where}: {text} leads nowhere; write FIRST..LAST..STEP")
    count = int((last - first) / step) + 1
    if count > STEPS_MAX:
        raise SweepError(f"{where}: more than {STEPS_MAX:,} values; a sweep takes no more")
    exact = [first + step * i for i in range(count)]
    return [int(value) if whole else float(value) for value in exact]


def split(text: str, mark: str) -> list[str]:
    """The parts between marks that stand outside of brackets and quotes."""
    parts, depth, quote, begin = [], 0, "", 0
    for i, char in enumerate(text):
        if quote:
            if char == quote and text[i - 1] != "\\":
                quote = ""
        elif char in "\"'":
            quote = char
        elif char in _OPENING:
            depth += 1
        elif char in _CLOSING:
            depth -= 1
        elif char == mark and depth <= 0:
            parts.append(text[begin:i])
            begin = i + 1
    return [*parts, text[begin:]]


def plain(value: Any) -> Any:
    """What the scenario gets of a value."""
    return value.value if isinstance(value, Named) else value


def column(value: Any) -> Any:
    """What a table's column says of a value: a number, a truth, a text."""
    if isinstance(value, Named):
        return value.name
    return value if isinstance(value, bool | int | float | str) else inline(value)


def shown(value: Any) -> str:
    """A value as people read it: numbers short, true and false as in a file."""
    text = column(value)
    if isinstance(text, bool):
        return str(text).lower()
    return f"{text:g}" if isinstance(text, float) else str(text)


def canonical(value: Any) -> str:
    """One text for equal values: 3 and 3.0 are equal, the order of keys does not matter."""
    return json.dumps(_normal(value), sort_keys=True, separators=(",", ":"))


def _normal(value: Any) -> Any:
    if isinstance(value, float) and value.is_integer():
        return int(value)
    if isinstance(value, dict):
        return {str(key): _normal(inner) for key, inner in value.items()}
    if isinstance(value, list | tuple):
        return [_normal(inner) for inner in value]
    return value if isinstance(value, bool | int | float | str) or value is None else str(value)


def _together(part: str, keys: tuple[str, ...], where: str) -> tuple[Any, ...]:
    values = [parse_value(word.strip()) for word in split(part, ":")]
    if len(values) != len(keys):
        message = f'"{part}" has {len(values)} values for {len(keys)} keys'
        raise SweepError(f"{where}: {message}; join them by a colon, like a,b=1:10,2:20")
    return tuple(values)
