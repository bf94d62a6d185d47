"""Records as C has them: structs from declarations, each number as wide as its range."""

from struct import calcsize
from typing import Any, NamedTuple

from innervate.firmware.errors import FirmwareError
from innervate.live.board import Declaration, Role

# C types, narrowest first: their ranges, and their codes as `struct` and `array` have them.
TYPES = {
    "uint8_t": (0, 255, "B"), "int8_t": (-128, 127, "b"), "uint16_t": (0, 65_535, "H"),
    "int16_t": (-32_768, 32_767, "h"), "int32_t": (-(1 << 31), (1 << 31) - 1, "i"),
}  # fmt: skip
CODES = {name: code for name, (_low, _high, code) in TYPES.items()}
BYTES = {name: calcsize(code) for name, code in CODES.items()}
WIDE = "int32_t"
# Words of C and C++ that would be no names of fields or variables there.
WORDS = frozenset((
    "and", "and_eq", "asm", "auto", "bitand", "bitor", "bool", "break", "case", "catch",
    "char", "class", "compl", "const", "constexpr", "continue", "default", "delete", "do",
    "double", "else", "enum", "explicit", "export", "extern", "false", "float", "for",
    "friend", "goto", "if", "inline", "int", "long", "mutable", "namespace", "new", "not",
    "not_eq", "operator", "or", "or_eq", "private", "protected", "public", "register",
    "restrict", "return", "short", "signed", "sizeof", "static", "struct", "switch",
    "template", "this", "throw", "true", "try", "typedef", "typename", "union", "unsigned",
    "using", "virtual", "void", "volatile", "while", "xor", "xor_eq",
))  # fmt: skip


class Field(NamedTuple):
    """A field of a struct."""

    name: str
    type: str  # of a number in it, in C
    length: int  # 0 = a single number
    # Its declared range.
    low: int
    high: int
    unit: str
    meaning: str


def type_of(low: int, high: int) -> str:
    """The narrowest C type for a range."""
    return next(name for name, (least, most, _) in TYPES.items() if least <= low and high <= most)


def name_of(name: str) -> str:
    """A name as C and C++ take it."""
    return f"{name}_" if name in WORDS else name


def fields_of(declaration: Declaration, wide: bool = False) -> dict[str, Field]:
    """The fields of a declaration by name; `wide` = each number with 32 bits.

    Raises:
        FirmwareError: the length of an array is no number.
    """
    found = {}
    for name, length, low, high, unit, meaning in declaration:
        if not isinstance(length, int):
            raise FirmwareError(f"field {name}: its length is {length!r}; C needs a number")
        kind = WIDE if wide else type_of(low, high)
        found[name] = Field(name, kind, length, low, high, unit, meaning)
    return found


def records_of(role: Role) -> dict[str, dict[str, Field]]:
    """All records of a role by what they are: state, gate, params, frame, item, action.

    One whose items are frames has no record "item".
    """
    named: dict[str, Declaration] = {"state": role.state, "params": role.params}
    if role.has_gate:
        named["gate"] = role.gate
    if role.frame:
        named["frame"] = role.frame
    if role.item is not role.frame:
        named["item"] = role.item
    found = {what: _ordered(fields_of(given, role.wide)) for what, given in named.items()}
    # Narrow ones first: there are many actions, and what aligns them would be lost.
    actions = sorted(fields_of(role.action, role.wide).values(), key=lambda f: BYTES[f.type])
    return {**found, "action": {field.name: field for field in actions}}


def _ordered(fields: dict[str, Field]) -> dict[str, Field]:
    """Numbers before arrays, narrow ones first: small processors reach what is near at once."""
    ranked = sorted(fields.values(), key=lambda f: (f.length * BYTES[f.type], BYTES[f.type]))
    return {field.name: field for field in ranked}


def struct(name: str, fields: dict[str, Field], meaning: str) -> str:
    """The text of a struct, every field with its range and meaning."""
    lines = [f"/** {meaning} */", "typedef struct {"]
    for field in fields.values():
        array = f"[{field.length}]" if field.length else ""
        lines.append(f"    {field.type} {name_of(field.name)}{array}; {_note(field)}")
    return "\n".join([*lines, f"}} {name};"]) + "\n"


def _note(field: Field) -> str:
    meaning = field.meaning.replace("*/", "* /")
    return f"/* {field.low}..{field.high} {field.unit}: {meaning} */"


def initial(field: Field, value: int | None = None) -> int:
    """What a field begins with: `value`, 0, or the value in range nearest 0."""
    return min(max(value or 0, field.low), field.high)


def layout(fields: dict[str, Field]) -> tuple[list[tuple[str, Any]], int]:
    """How C lays a struct out: (name, (offset, type, length)) of each field, and its size."""
    at, widest, found = 0, 1, []
    for field in fields.values():
        size = BYTES[field.type]
        at = (at + size - 1) // size * size
        found.append((field.name, (at, field.type, field.length)))
        at += size * max(field.length, 1)
        widest = max(widest, size)
    return found, (at + widest - 1) // widest * widest
