"""What --seed takes: a whole number from 0, below 2^63."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Annotated, Any

from cyclopts import Parameter

from innervate.cli import errors


def _whole_seed(_type: Any, tokens: Sequence[Any]) -> int:
    """What --seed takes: a library's guess at a number could run another seed than was meant."""
    text = tokens[0].value
    if not (text.isascii() and text.isdigit() and int(text) < 2**63):
        message = f'--seed must be a whole number from 0, below 2^63, not "{text[:40]}"'
        raise errors.UserError(message)
    return int(text)


Seed = Annotated[int | None, Parameter(converter=_whole_seed)]

_SET = Parameter(name=["--set"], negative="", allow_leading_hyphen=True)
Sets = Annotated[list[str] | None, _SET]
