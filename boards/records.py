"""Record classes for boards, made from the declarations in `protocol/*_fields.py`.

An array takes as many bytes per item as its declared range needs.
"""

from __future__ import annotations

from boards.roles import Declaration

# Type codes of `array`, narrowest first, with their ranges.
CODES = (("B", 0, 255), ("b", -128, 127), ("H", 0, 65_535), ("h", -32_768, 32_767),
         ("i", -(1 << 31), (1 << 31) - 1))  # fmt: skip
BYTES = {"B": 1, "b": 1, "H": 2, "h": 2, "i": 4}
HEAD = "from array import array\n\n"


def code_of(low: int, high: int) -> str:
    """The narrowest type code for a range."""
    return next(code for code, least, most in CODES if least <= low and high <= most)


def class_source(name: str, declaration: Declaration, values: dict[str, int] | None = None) -> str:
    """A class whose instances have the declared fields, at 0, or the value in range nearest 0.

    Args:
        name: of the class.
        declaration: (name, length, low, high, unit, meaning) of each field.
        values: of single fields that are to begin otherwise.
    """
    lines = [f"class {name}:", "    def __init__(self):"]
    for field, length, low, high, *_ in declaration:
        start = (values or {}).get(field, min(max(0, low), high))
        if not length:
            made = str(start)
        elif start == 0 and code_of(low, high) == "B":
            made = f"bytearray({length})"
        elif start == 0:
            code = code_of(low, high)
            made = f'array("{code}", bytes({BYTES[code] * length}))'
        else:
            made = f'array("{code_of(low, high)}", [{start}] * {length})'
        lines.append(f"        self.{field} = {made}")
    return "\n".join(lines if declaration else [lines[0], "    pass"]) + "\n"


def module_source(**classes: Declaration) -> str:
    """A module with such classes."""
    return HEAD + "\n\n".join(class_source(name, fields) for name, fields in classes.items())
