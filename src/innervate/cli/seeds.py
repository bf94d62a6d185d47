"""Numbers that options take whole, or not at all, and what --set takes."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Annotated, Any

from cyclopts import CoercionError, Parameter

from innervate.cli import errors


def _whole_seed(_type: Any, tokens: Sequence[Any]) -> int:
    """What --seed takes: a library's guess at a number could run another seed than was meant."""
    text = tokens[0].value
    if not (text.isascii() and text.isdigit() and int(text) < 2**63):
        message = f'--seed must be a whole number from 0, below 2^63, not "{text[:40]}"'
        raise errors.UserError(message)
    return int(text)


def _whole(_type: Any, tokens: Sequence[Any]) -> int:
    """A whole number; the library would round 2.5 to another than was meant."""
    text = tokens[0].value.lower()
    try:
        return int(text, 0 if text.startswith(("0x", "0o", "0b")) else 10)
    except ValueError:
        raise CoercionError(token=tokens[0], target_type=int) from None


Whole = Annotated[int, Parameter(converter=_whole)]
Seed = Annotated[int | None, Parameter(converter=_whole_seed)]

_SET = Parameter(name=["--set"], negative="", allow_leading_hyphen=True)
Sets = Annotated[list[str] | None, _SET]
