"""What the mesh's figures share: how many runs, and words."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

TOPOLOGIES = range(1, 31)
FEW = range(1, 5)


def seeds_of(quick: bool) -> range:
    """Seeds of the networks: 30 of them, or 4 if `quick`."""
    return FEW if quick else TOPOLOGIES


def percent(share: float, digits: int = 0) -> str:
    """A share, 0 to 1, as "12 %"."""
    return f"{100 * share:.{digits}f} %"


def joined(words: Iterable[Any], between: str = ", ") -> str:
    """Things as text, with `between` between them."""
    return between.join(str(word) for word in words)
