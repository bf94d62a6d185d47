"""What no file of a node can hold, whatever the field: said by its name before anybody uses it."""

import math
import re
import tomllib
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from innervate.live.errors import LiveError
from innervate.live.machine import machine

TEXT_MAX = 1024  # characters
WHOLE_MAX = 2**63 - 1
DIGITS_MAX = 4300  # what Python reads of a decimal number
DEPTH_MAX = 100  # tables and lists in each other
SHOWN = 60  # characters of a text that is wrong
DEEP = "lists or tables are nested too deeply"
_LONG = re.compile(rf"[0-9](?:_?[0-9]){{{DIGITS_MAX},}}")
_DEEP = re.compile(r"[\[{](?:\s*[\[{]){99}")
_KEY = re.compile(r"""([\w."'-]+)\s*=""")


def fault(tables: Any) -> str:
    """The first field that holds what nothing can use, and why; "" if there is none."""
    return next(_faults(tables, ""), "")


def text(path: Path, none: str, what: str = "") -> str:
    """What stands in a file; `what` it should be, as "the identity ".

    Raises:
        LiveError: it cannot be read, or is no text: `none` says what to do.
    """
    try:
        return machine().read_text(path)
    except OSError as error:
        raise LiveError(f"{path}: {what}cannot be read: {error.strerror}") from None
    except ValueError:
        raise LiveError(f"{path}: {none}") from None


def read(text: str) -> dict[str, Any]:
    """The tables of a TOML text.

    Raises:
        ValueError: why it is none; with the place, and the field if that can be said.
    """
    try:
        tables = tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        raise ValueError(f"not valid TOML: {error}") from None
    except RecursionError:
        raise ValueError(f"not valid TOML: {_place(text, _DEEP)}{DEEP}") from None
    except ValueError:
        raise ValueError(f"{_place(text, _LONG)}a number is too long to be read") from None
    if wrong := fault(tables):
        raise ValueError(wrong)
    return tables


def whole(tables: Any, key: Any, most: int, name: str = "") -> int:
    """A whole number from 0 on in tables, or in a list.

    Raises:
        ValueError: there is none; it begins with the field.
    """
    try:
        value = tables[key]
    except (LookupError, TypeError):
        value = None
    if type(value) is not int or not 0 <= value <= most:
        raise ValueError(f"{name or key}: whole numbers from 0 to {most} are to stand there")
    return value


def octets(tables: dict[str, Any], name: str, size: int) -> bytes:
    """So many bytes, written as hexadecimal digits.

    Raises:
        ValueError: these are none; it begins with the field.
    """
    try:
        data = bytes.fromhex(tables.get(name, ""))
    except (TypeError, ValueError):
        data = b""
    if len(data) != size:
        raise ValueError(f"{name}: {2 * size} hexadecimal digits are to stand there")
    return data


def listed(tables: dict[str, Any], name: str) -> list[Any]:
    """A list; ValueError if it is none, which begins with the field."""
    value = tables.get(name)
    if not isinstance(value, list):
        raise ValueError(f"{name}: a list is to stand there")
    return value


def _place(text: str, what: re.Pattern[str]) -> str:
    """The first line that has it, and the key before it; "" if that cannot be said."""
    last = ""
    for count, line in enumerate(text.splitlines(), 1):
        found = what.search(line)
        keys = _KEY.findall(line[: found.start()] if found else line)
        last = shown(keys[-1]) if keys else last
        if found:
            return f"line {count}{', ' + last if last else ''}: "
    return ""


def shown(text: str) -> str:
    """A text as it can stand in a line, its beginning at least."""
    whole = text if text.isprintable() else repr(text)[1:-1]
    return whole if len(whole) <= SHOWN else whole[:SHOWN] + "..."


def _faults(value: Any, name: str, depth: int = 0) -> Iterator[str]:
    if depth > DEPTH_MAX:
        yield f"{shown(name)}: {DEEP}"
    elif isinstance(value, dict):
        for key, one in value.items():
            below = f"{name}.{shown(key)}" if name else shown(key)
            if _wrong_text(key):
                yield f"{below}: a name that {_wrong_text(key)}"
            yield from _faults(one, below, depth + 1)
    elif isinstance(value, list):
        for i, one in enumerate(value):
            yield from _faults(one, f"{name}.{i}", depth + 1)
    elif isinstance(value, str) and _wrong_text(value):
        yield f"{name}: a text that {_wrong_text(value)}"
    elif isinstance(value, int) and abs(value) > WHOLE_MAX:
        yield f"{name}: a number must be below 2^63"
    elif isinstance(value, float) and not math.isfinite(value):
        yield f"{name}: a number must be finite, not {value}"


def _wrong_text(text: str) -> str:
    if len(text) > TEXT_MAX:
        return f"has {len(text)} characters, more than {TEXT_MAX}"
    if not text.isprintable():
        odd = next(char for char in text if not char.isprintable())
        return f"has a character that cannot be shown ({odd!r}); leave it out"
    return ""
