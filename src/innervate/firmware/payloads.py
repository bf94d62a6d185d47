"""Payloads in C: what says whether bytes are what a frame's kind has, from layouts."""

from typing import Any

from innervate.firmware.errors import FirmwareError
from innervate.live.board import Coded
from innervate.wire.layout import PAIRS, REST, is_fixed, width


def cases(coded: Coded) -> list[str]:
    """A case for each kind of payload; none where payloads are not looked into."""
    payloads: dict[Any, list[int]] = {}
    for form in coded.forms:
        for kind, fields in form.payloads.items():
            payloads.setdefault(fields, []).append(kind)
    lines = []
    for fields, kinds in payloads.items():
        lines += [f"    case {kind}:" for kind in kinds]
        lines += [f"        {line}" for line in _walk(fields)]
    return lines


def _walk(fields: tuple[Any, ...]) -> list[str]:
    """Lines that go through a payload's fields, from bit `at` on, and say whether it ends there."""
    for name, many, bits, _ in fields:
        if isinstance(bits, tuple) and many != REST and not is_fixed(bits):
            raise FirmwareError(f"{name}: groups of variable length are read at the end alone")
        if many == PAIRS:
            raise FirmwareError(f"{name}: pairs are no payload")
    if not fields or fields[-1][1] != REST:
        lines, skip = _passed(fields)
        return [*lines, f"return at + {skip} == end;" if skip else "return at == end;"]
    lines, bits = _whole(fields[:-1]), fields[-1][2]
    if not isinstance(bits, tuple):
        return [*lines, f"return at <= end && (end - at) % {bits} == 0;"]
    return [*lines, "while (at < end) {", *(f"    {line}" for line in _whole(bits)), "}",
            "return at == end;"]  # fmt: skip


def _whole(fields: tuple[Any, ...]) -> list[str]:
    """Lines that go over all of some fields."""
    lines, skip = _passed(fields)
    return [*lines, *([f"at += {skip};"] if skip else [])]


def _passed(fields: tuple[Any, ...]) -> tuple[list[str], int]:
    """Lines that go over fields, and how many bits are then still to be passed over."""
    lines, skip, counted = [], 0, {many for _, many, _, _ in fields if isinstance(many, str)}
    for name, many, bits, _ in fields:
        each = width(bits) if isinstance(bits, tuple) else bits
        if isinstance(many, str):
            lines.append(f"at += count * {each};")
        elif name in counted:
            lines += _count(skip, each)
            skip = 0
        else:
            skip += each * max(1, many)
    return lines, skip


def _count(skip: int, bits: int) -> list[str]:
    """Lines that read how many follow, behind some bits that are passed over."""
    return [f"if (at + {skip + bits} > end) {{", "    return 0;", "}",
            *([f"at += {skip};"] if skip else []),
            f"count = innervate_get(data, &at, {bits});"]  # fmt: skip
