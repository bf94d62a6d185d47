"""What the mesh's figures share: how many runs, and words."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

TOPOLOGIES = range(1, 31)
FEW = range(1, 5)


def seeds_of(quick: bool) -> range:
    """One network each."""
    return FEW if quick else TOPOLOGIES


def percent(share: float, digits: int = 0) -> str:
    """A share in words."""
    return f"{100 * share:.{digits}f} %"


def joined(words: Iterable[Any], between: str = ", ") -> str:
    """A list in words."""
    return between.join(str(word) for word in words)
