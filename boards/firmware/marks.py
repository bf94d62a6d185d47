"""A hash over what came of calls, state and outbox after each; in C it stands in `check.c`."""

from __future__ import annotations

import struct
from typing import Any

import numpy as np

from innervate.firmware.emit import Library
from innervate.firmware.packed import Packed
from innervate.live.board import Role

PRIME = 16_777_619
MASK = 0xFFFF_FFFF
WORDS_MAX = 8192
HAVE_FRAMES = (1, 3)  # SEND, DELIVER


def _powers() -> np.ndarray[Any, np.dtype[np.uint32]]:
    """The last one is 1, the one before it PRIME, and so on."""
    found = np.full(WORDS_MAX, PRIME, np.uint32)
    found[0] = 1
    return np.cumprod(found, dtype=np.uint32)[::-1].copy()


POWERS = _powers()


class Mark:
    """The hash; the least change of one call alters it, and all that follow.

    Attributes:
        value: 32 bits.
    """

    def __init__(self, library: Library) -> None:
        self.kinds = library.role.kinds
        self.state = Packed(library.records["state"])
        self.gate = Packed(library.records["gate"]) if "gate" in library.records else None
        self.value = 1

    def add(self, state: Any, gate: Any, out: Any) -> None:
        """What came of a call; `gate` may be None.

        Raises:
            OverflowError, struct.error: a value is out of its declared range.
        """
        words = [out.count[0], out.overflow[0]]
        for i, act in enumerate(out.action[: out.count[0]]):
            words += (act.kind, act.a, act.b, act.c)
            if self.kinds and act.kind in HAVE_FRAMES:
                words += self._frame(out.frame[i])
        data = _whole(self.state.of(state))
        if gate is not None and self.gate is not None:
            data += _whole(self.gate.of(gate))
        data += struct.pack(f"<{len(words)}i", *words)
        found = np.frombuffer(data, np.uint32)
        mixed = (found ^ (found >> np.uint32(15))) * POWERS[-len(found) :]
        self.value = ((self.value ^ int(mixed.sum(dtype=np.uint32))) * PRIME) & MASK

    def _frame(self, frame: Any) -> list[int]:
        """What of a frame goes over a wire."""
        words = [int(frame.kind)]
        for name, many in self.kinds[frame.kind]:
            value = getattr(frame, name)
            count = getattr(frame, many) if isinstance(many, str) else many
            words += [int(v) for v in value[:count]] if many else [int(value)]
        return words


def _whole(data: bytes) -> bytes:
    """Bytes up to a multiple of four."""
    return data + bytes(-len(data) % 4)


def fold_in_c(role: Role) -> str:
    """The same for a frame, as C."""
    cases = []
    for kind, fields in role.kinds.items():
        lines = [f"    case {kind}:"]
        for name, many in fields:
            if not many:
                lines.append(f"        fold((uint32_t)frame->{name});")
                continue
            count = f"frame->{many}" if isinstance(many, str) else many
            lines += [f"        for (int32_t i = 0; i < {count}; i++) {{",
                      f"            fold((uint32_t)frame->{name}[i]);", "        }"]  # fmt: skip
        cases.append("\n".join([*lines, "        break;"]))
    return "\n".join(cases)
