"""Layouts: what is where in a frame, as tables that coders, dissectors and documents read.

A field is (name, many, bits, 1 if signed), most significant bit first. `many` says how many:
0 = a single number, n = an array of n, the name of an earlier field = as many as that says,
REST = up to the end, PAIRS = one for each pair of as many as the first field says. `bits` is a
number, or the fields of a group that is repeated.
"""

from innervate.wire.bits import get, put, signed

SPARE = ""  # the name of bits that are sent as 0 and not looked at
REST = -1
PAIRS = -2
BROKEN = -1


def width(fields: tuple) -> int:  # type: ignore[type-arg]
    """Bits of the fields, those of variable number not counted."""
    bits = 0
    for _name, many, each, _signed in fields:
        if not isinstance(many, str) and many >= 0:
            bits += each * max(1, many)
    return bits


def is_fixed(fields: tuple) -> bool:  # type: ignore[type-arg]
    """True if no number is variable."""
    return not any(isinstance(many, str) or many < 0 for _name, many, _bits, _signed in fields)


def pack(
    fields: tuple,  # type: ignore[type-arg]
    buffer: bytearray,
    at: int,
    record: object,
) -> int:
    """Write a record's fields from bit `at` on; returns the bit behind them.

    Raises:
        ValueError: a value does not fit into its bits.
    """
    for name, many, bits, is_signed in fields:
        if name == SPARE:
            at += bits
            continue
        value = getattr(record, name)
        for item in value if many else (value,):
            put_number(buffer, at, bits, is_signed, item, name)
            at += bits
    return at


def put_number(buffer: bytearray, at: int, bits: int, is_signed: int, item: int, name: str) -> None:
    """Write one number at bit `at`.

    Raises:
        ValueError: it does not fit into its bits.
    """
    low = -(1 << (bits - 1)) if is_signed else 0
    if not low <= item < low + (1 << bits):
        raise ValueError(name + " does not fit into its bits")
    put(buffer, at, bits, item)


def unpack(
    fields: tuple,  # type: ignore[type-arg]
    data: bytes | bytearray | memoryview,
    at: int,
    record: object,
) -> int:
    """Read fields of fixed number from bit `at` on into a record; returns the bit behind them."""
    for name, many, bits, is_signed in fields:
        for i in range(max(1, many)):
            item = get(data, at, bits)
            at += bits
            if is_signed:
                item = signed(item, bits)
            if many:
                getattr(record, name)[i] = item
            elif name != SPARE:
                setattr(record, name, item)
    return at


def read(
    fields: tuple,  # type: ignore[type-arg]
    data: bytes | bytearray | memoryview,
    at: int,
    end: int,
    found: list,  # type: ignore[type-arg]
) -> int:
    """Read any fields from bit `at` to at most `end` as (name, value), appended to `found`.

    Arrays are lists, groups are lists of such lists. Returns the bit behind them, or BROKEN if
    they would not fit: any bytes will do.
    """
    for name, many, bits, is_signed in fields:
        count = _times(many, found)
        values = []  # type: ignore[var-annotated]
        while len(values) != count and not (count == REST and at >= end):
            if isinstance(bits, tuple):
                group = []  # type: ignore[var-annotated]
                at = read(bits, data, at, end, group)
                if at == BROKEN:
                    return BROKEN
                values.append(group)
                continue
            if at + bits > end:
                return BROKEN
            item = get(data, at, bits)
            values.append(signed(item, bits) if is_signed else item)  # type: ignore[arg-type]
            at += bits
        if name != SPARE:
            found.append((name, values[0] if many == 0 else values))
    return at


def _times(many: object, found: list) -> int:  # type: ignore[type-arg]
    if many == PAIRS:
        first = found[0][1]
        return int(first * (first - 1) // 2)
    if isinstance(many, int):
        return many or 1
    for name, value in found:
        if name == many:
            return int(value)
    raise ValueError("a layout counts by a field that is not there")
