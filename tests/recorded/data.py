"""Anything as plain data for JSON: long lists by their number, a digest and a few of them."""

from __future__ import annotations

import dataclasses
import hashlib
import json
from array import array
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import msgspec
import numpy as np

LONG, LONG_ROWS = 16, 5  # lists of more numbers, or of more tables, are not written out
DIGITS = 12  # of fractions
LEFT_OUT = ("scenario",)  # of plans: what they were made of
DOTS = "..."


def digest(value: Any) -> str:
    """Sixteen hexadecimal digits that stand for bytes, a text or plain data."""
    if not isinstance(value, bytes):
        value = (value if isinstance(value, str) else json.dumps(value)).encode()
    return hashlib.blake2b(value, digest_size=8).hexdigest()


def plain(value: Any) -> Any:
    """A value as JSON has it; long lists shortened."""
    if value is None or isinstance(value, bool | int | str):
        return value
    if isinstance(value, float):
        return float(f"{value:.{DIGITS}g}")
    if isinstance(value, bytes | bytearray):
        return value.hex()
    if isinstance(value, Path):
        return value.name
    if isinstance(value, np.ndarray | np.generic):
        return plain(value.tolist())
    if isinstance(value, Mapping):
        return {str(key): plain(inner) for key, inner in value.items()}
    if isinstance(value, set | frozenset):
        return shortened([plain(inner) for inner in sorted(value)])
    if isinstance(value, list | tuple | range | array):
        if hasattr(value, "_asdict"):
            return plain(value._asdict())
        return shortened([plain(inner) for inner in value])
    if dataclasses.is_dataclass(value):
        names = [
            one.name
            for one in dataclasses.fields(value)
            if one.compare and one.name not in LEFT_OUT
        ]
        return {name: plain(getattr(value, name)) for name in names}
    if isinstance(value, msgspec.Struct):
        return plain(msgspec.to_builtins(value))
    raise TypeError(f"{type(value).__name__} is no data")


def shortened(items: list[Any]) -> Any:
    """A list as it is, or if it is long: how many, what they come to, the first and the last."""
    nested = any(isinstance(item, dict | list) for item in items)
    if len(items) <= (LONG_ROWS if nested else LONG):
        return items
    return {"count": len(items), "digest": digest(items), "some": [*items[:2], DOTS, items[-1]]}


def tidy(value: Any, margin: str = "") -> str:
    """JSON with a line for each key, and lists in one line: differences can be read."""
    if isinstance(value, dict) and value:
        inner = margin + " "
        rows = [f"{inner}{json.dumps(key)}: {tidy(value[key], inner)}" for key in value]
        return "{\n" + ",\n".join(rows) + f"\n{margin}}}"
    return json.dumps(value)
