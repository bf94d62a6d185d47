"""Two small things that plain Python and compiled code must spell differently.

Each has a plain body and a compiled one with the same result; `tests/kernel` holds them together.
"""

from __future__ import annotations

from typing import Any

from llvmlite import ir
from numba import types
from numba.extending import intrinsic, overload

MASK64 = (1 << 64) - 1
FACTOR = 0x9E3779B97F4A7C15


def lowest_bit(word: int) -> int:
    """Index of the lowest set bit of a word != 0."""
    return (word & -word).bit_length() - 1


def mix(state: int, word: int) -> int:
    """Fold a word into a 64-bit fingerprint; both are taken modulo 2^64, the result is signed."""
    mixed = ((state ^ word) * FACTOR) & MASK64
    mixed ^= mixed >> 32
    return mixed - (1 << 64) if mixed >> 63 else mixed


@intrinsic  # type: ignore[untyped-decorator]
def _count_trailing_zeros(typing_context: Any, word: Any) -> Any:
    def generate(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        return builder.cttz(args[0], ir.Constant(ir.IntType(1), 1))

    return types.int64(types.int64), generate


@intrinsic  # type: ignore[untyped-decorator]
def _mix64(typing_context: Any, state: Any, word: Any) -> Any:
    def generate(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        product = builder.mul(builder.xor(args[0], args[1]), ir.Constant(ir.IntType(64), FACTOR))
        return builder.xor(product, builder.lshr(product, ir.Constant(ir.IntType(64), 32)))

    return types.int64(types.int64, types.int64), generate


@overload(lowest_bit, inline="always")  # type: ignore[untyped-decorator]
def _lowest_bit(word):
    return lambda word: _count_trailing_zeros(word)


@overload(mix, inline="always")  # type: ignore[untyped-decorator]
def _mix(state, word):
    return lambda state, word: _mix64(state, word)
