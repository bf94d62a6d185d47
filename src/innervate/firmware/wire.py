"""Frames on the wire in C: an encoder and a decoder from the same layouts as Python's."""

from __future__ import annotations

from typing import Any

from innervate.firmware.emit import Library
from innervate.firmware.errors import FirmwareError
from innervate.firmware.records import name_of
from innervate.network import Network
from innervate.wire.layout import SPARE, is_fixed, width

CRC_BYTES = 2
REASONS = ("OK", "BAD_LENGTH", "BAD_CRC", "BAD_KIND")


class Wire:
    """The coder of a network whose frames are a kind, fields of fixed number and a CRC.

    Args:
        library: the role.
        network: its network.

    Attributes:
        sizes: bytes of a whole frame of each kind.

    Raises:
        FirmwareError: its frames are others.
    """

    def __init__(self, library: Library, network: Network) -> None:
        frames = network.frames
        if not hasattr(frames, "KIND_BITS"):
            raise FirmwareError(f"{network.name}: its frames do not begin with a kind alone")
        self.library, self.prefix = library, library.prefix
        self.kind_bits: int = frames.KIND_BITS
        self.layouts: tuple[tuple[int, str, Any], ...] = frames.LAYOUTS
        for _kind, name, fields in self.layouts:
            if not is_fixed(fields):
                raise FirmwareError(f"{network.name}: a {name} has fields of variable number")
        self.sizes = {kind: (self.kind_bits + width(fields) + 7) // 8 + CRC_BYTES
                      for kind, _name, fields in self.layouts}  # fmt: skip

    def header(self) -> str:
        """The text of the coder's header."""
        small, big = self.prefix, self.prefix.upper()
        reasons = [f"#define {big}_{name} {i}" for i, name in enumerate(REASONS)]
        return "\n".join([
            f"/** Frames of {small} on the wire, made from its layouts. */",
            f"#ifndef {big}_WIRE_H", f"#define {big}_WIRE_H", "", f'#include "{small}.h"', "",
            "#ifdef __cplusplus", 'extern "C" {', "#endif", "",
            f"#define {big}_SIZE_MAX {max(self.sizes.values())} /* bytes of the longest frame */",
            f"#define {big}_SIZE_MIN {min(self.sizes.values())} /* of the shortest */", "",
            f"/* What {small}_decode says: read, or why not. */", *reasons, "",
            f"/** The bytes of a frame, {big}_SIZE_MAX at most; how many, 0 if there is no such",
            " * kind. Bits that a field has too many of are left out. */",
            f"int32_t {small}_encode(const {small}_frame_t *frame, uint8_t *data);", "",
            "/** Reads received bytes into a frame; any bytes at all will do. Sets `kind` and the",
            f" * fields of that kind. Returns {big}_OK, or else why not, with the frame as it",
            " * was. */",
            f"int32_t {small}_decode(const uint8_t *data, int32_t size, {small}_frame_t *frame);",
            "", "#ifdef __cplusplus", "}", "#endif", "", f"#endif /* {big}_WIRE_H */", "",
        ])  # fmt: skip

    def source(self) -> str:
        """The text of the coder's source."""
        small, big = self.prefix, self.prefix.upper()
        sizes = [f"    case {kind}:\n        return {size}; /* {name} */"
                 for kind, name, _ in self.layouts for size in (self.sizes[kind],)]  # fmt: skip
        return "\n".join([
            f"/* Frames of {small} on the wire, most significant bit first. */",
            f'#include "{small}_wire.h"', '#include "innervate_wire.h"', "",
            "/* Bytes of a frame of a kind, its CRC included; 0 if there is none. */",
            f"static int32_t {small}_size_of(int32_t kind)", "{", "    switch (kind) {", *sizes,
            "    default:", "        return 0;", "    }", "}", "",
            f"int32_t {small}_encode(const {small}_frame_t *frame, uint8_t *data)", "{",
            f"    const int32_t size = {small}_size_of(frame->kind);",
            "    innervate_bits_t place = {0, 0};", "    place.data = data;",
            "    for (int32_t i = 0; i < size; i++) {", "        data[i] = 0;", "    }",
            "    if (size == 0) {", "        return 0;", "    }",
            f"    innervate_put(&place, {self.kind_bits}, frame->kind);",
            "    switch (frame->kind) {", *self._cases(self._put), "    }",
            "    innervate_seal_crc(data, size);", "    return size;", "}", "",
            f"int32_t {small}_decode(const uint8_t *data, int32_t size, {small}_frame_t *frame)",
            "{", "    int32_t at = 0;",
            f"    if (size < {big}_SIZE_MIN || size > {big}_SIZE_MAX) {{",
            f"        return {big}_BAD_LENGTH;", "    }",
            "    if (!innervate_is_sound(data, size)) {", f"        return {big}_BAD_CRC;", "    }",
            f"    const int32_t kind = innervate_get(data, &at, {self.kind_bits});",
            f"    if ({small}_size_of(kind) == 0) {{", f"        return {big}_BAD_KIND;", "    }",
            f"    if ({small}_size_of(kind) != size) {{", f"        return {big}_BAD_LENGTH;",
            "    }", f"    frame->kind = ({self._type('kind')})kind;", "    switch (kind) {",
            *self._cases(self._get), "    }", f"    return {big}_OK;", "}", "",
        ])  # fmt: skip

    def _type(self, name: str) -> str:
        return self.library.records["frame"][name].type

    def _cases(self, line: Any) -> list[str]:
        """Cases by kind; kinds of the same layout share one."""
        shared: dict[Any, list[tuple[int, str]]] = {}
        for kind, name, fields in self.layouts:
            shared.setdefault(fields, []).append((kind, name))
        found = []
        for fields, kinds in shared.items():
            found += [f"    case {kind}: /* {name} */" for kind, name in kinds[:-1]]
            kind, name = kinds[-1]
            found.append(f"    case {kind}: /* {name} */")
            for field in fields:
                found += line(*field)
            found.append("        break;")
        return [*found, "    default:", "        break;"]

    def _put(self, name: str, many: int, bits: int, _signed: int) -> list[str]:
        if name == SPARE:
            return [f"        place.at += {bits};"]
        return self._each(name, many, "innervate_put(&place, {bits}, {place});", bits)

    def _get(self, name: str, many: int, bits: int, signed: int) -> list[str]:
        if name == SPARE:
            return [f"        at += {bits};"]
        how = "innervate_get_signed" if signed else "innervate_get"
        text = f"{{place}} = ({self._type(name)}){how}(data, &at, {{bits}});"
        return self._each(name, many, text, bits)

    def _each(self, name: str, many: int, text: str, bits: int) -> list[str]:
        place = f"frame->{name_of(name)}"
        if not many:
            return ["        " + text.format(bits=bits, place=place)]
        return [
            f"        for (int32_t i = 0; i < {many}; i++) {{",
            "            " + text.format(bits=bits, place=f"{place}[i]"), "        }",
        ]  # fmt: skip
