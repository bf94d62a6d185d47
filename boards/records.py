"""Record classes for boards, made from the declarations in `protocol/*_fields.py`.

An array takes as many bytes per item as its declared range needs.
"""

from __future__ import annotations

from typing import Any

from innervate.live.board import Declaration

# Type codes of `array`, narrowest first, with their ranges.
CODES = (("B", 0, 255), ("b", -128, 127), ("H", 0, 65_535), ("h", -32_768, 32_767),
         ("i", -(1 << 31), (1 << 31) - 1))  # fmt: skip
BYTES = {"B": 1, "b": 1, "H": 2, "h": 2, "i": 4}
HEAD = "from array import array\n\n"


def code_of(low: int, high: int) -> str:
    """The narrowest type code for a range."""
    return next(code for code, least, most in CODES if least <= low and high <= most)


def initial(field: tuple[str, Any, int, int, str, str], value: int | None = None) -> str:
    """What a field begins with, as an expression: `value`, 0, or the value in range nearest 0."""
    _name, length, low, high, *_ = field
    start, code = min(max(value or 0, low), high), code_of(low, high)
    if not length:
        return str(start)
    if start:
        return f'array("{code}", [{start}] * {length})'
    if code == "B":
        return f"bytearray({length})"
    return f'array("{code}", bytes({BYTES[code] * length}))'


def class_source(name: str, declaration: Declaration, values: dict[str, int] | None = None) -> str:
    """A class whose instances have the declared fields; `values` are what some begin with."""
    known = values or {}
    lines = [f"        self.{f[0]} = {initial(f, known.get(f[0]))}" for f in declaration]
    head = [f"class {name}:", "    def __init__(self):" if lines else "    pass"]
    return "\n".join(head + lines) + "\n"


def module_source(params: dict[str, int] | None = None, /, **classes: Declaration) -> str:
    """A module with such classes; a class Params begins with `params`."""
    made = (
        class_source(name, fields, params if name == "Params" else None)
        for name, fields in classes.items()
    )
    return HEAD + "\n\n".join(made)
