"""Payloads in C: functions that say whether bytes are what a frame's kind has, from layouts."""

from __future__ import annotations

from typing import Any

from innervate.firmware.errors import FirmwareError
from innervate.live.board import Coded
from innervate.wire.layout import PAIRS, REST, is_fixed, width


def whole(prefix: str, coded: Coded) -> list[str]:
    """The texts of the functions; none where payloads are not looked into."""
    payloads: dict[Any, list[int]] = {}
    for form in coded.forms:
        for kind, fields in form.payloads.items():
            payloads.setdefault(fields, []).append(kind)
    if not payloads:
        return []
    lines = []
    for fields, kinds in payloads.items():
        lines += [f"    case {kind}:" for kind in kinds]
        lines += [f"        {line}" for line in _walk(fields)]
    return ["\n".join([
        "/* 1 if bits `at` to `end` are exactly a payload of this kind. */",
        f"static int32_t {prefix}_is_whole(const uint8_t *data, int32_t kind, int32_t at, "
        "int32_t end)", "{",
        "    int32_t count;", "    switch (kind) {", *lines, "    default:", "        return 0;",
        "    }", "}", "",
    ]), _fits(prefix, coded)]  # fmt: skip


def _fits(prefix: str, coded: Coded) -> str:
    """What may be in front of a payload and behind it, and the payload."""
    flags = coded.version[1] + coded.kind_bits
    lead = [f"    if ((flags & {coded.lead}) && at < end) {{",
            "        begin = at + 1 + data[at];", "    }"] if coded.lead else []  # fmt: skip
    trail = [f"    if ((flags & {coded.trail}) && begin < end && data[end - 1] > 0 &&",
             f"            {prefix}_is_whole(data, kind, 8 * begin, "
             "8 * (end - 1 - data[end - 1]))) {",
             "        return 1;", "    }"] if coded.trail else []  # fmt: skip
    return "\n".join([
        "/* 1 if bytes `at` to `end` are a payload, and what forwarding puts around. */",
        f"static int32_t {prefix}_fits(const uint8_t *data, int32_t at, int32_t end)", "{",
        f"    const int32_t kind = data[0] & {(1 << coded.kind_bits) - 1};",
        f"    const int32_t flags = data[{flags // 8}];", "    int32_t begin = at;", *lead, *trail,
        f"    return {prefix}_is_whole(data, kind, 8 * begin, 8 * end);", "}", "",
    ])  # fmt: skip


def _walk(fields: tuple[Any, ...]) -> list[str]:
    """Lines that go through a payload's fields, from bit `at` on, and say whether it ends there."""
    lines, skip, counted = [], 0, {many for _, many, _, _ in fields if isinstance(many, str)}
    for name, many, bits, _ in fields:
        if isinstance(bits, tuple) and many != REST and not is_fixed(bits):
            raise FirmwareError(f"{name}: groups of variable length are read at the end alone")
        if many == PAIRS:
            raise FirmwareError(f"{name}: pairs are no payload")
        each = width(bits) if isinstance(bits, tuple) else bits
        if many == REST:
            lines += [f"at += {skip};"] if skip else []
            if not isinstance(bits, tuple):
                return [*lines, f"return at <= end && (end - at) % {each} == 0;"]
            inner = _groups(bits)
            return [*lines, "while (at < end) {", *(f"    {line}" for line in inner), "}",
                    "return at == end;"]  # fmt: skip
        if isinstance(many, str):
            lines.append(f"at += count * {each};")
        elif name in counted:
            lines += _count(skip, each)
            skip = 0
        else:
            skip += each * max(1, many)
    return [*lines, f"return at + {skip} == end;" if skip else "return at == end;"]


def _groups(fields: tuple[Any, ...]) -> list[str]:
    """Lines for one of the groups that go on to the end."""
    lines, skip, counted = [], 0, {many for _, many, _, _ in fields if isinstance(many, str)}
    for name, many, bits, _ in fields:
        if isinstance(many, str):
            lines.append(f"at += count * {bits};")
        elif name in counted:
            lines += _count(skip, bits)
            skip = 0
        else:
            skip += bits * max(1, many)
    return [*lines, *([f"at += {skip};"] if skip else [])]


def _count(skip: int, bits: int) -> list[str]:
    """Lines that read how many follow, behind some bits that are passed over."""
    return [f"if (at + {skip + bits} > end) {{", "    return 0;", "}",
            *([f"at += {skip};"] if skip else []),
            f"count = innervate_get(data, &at, {bits});"]  # fmt: skip
