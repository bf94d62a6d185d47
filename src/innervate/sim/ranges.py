"""Declared ranges of records that are not looked at after every event: few, large, or both."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from innervate.kernel.records import Declaration


def plain_check(declaration: Declaration, table: str) -> Callable[[Any, int], bool]:
    """Says if a plain node's record, of a table of the world, is in its declared ranges."""
    scalars = [(name, low, high) for name, length, low, high, *_ in declaration if not length]
    arrays = [(name, low, high) for name, length, low, high, *_ in declaration if length]

    def is_sound(world: Any, node: int) -> bool:
        state = getattr(world, table)[node]
        return all(low <= getattr(state, name) <= high for name, low, high in scalars) and all(
            low <= min(getattr(state, name)) and max(getattr(state, name)) <= high
            for name, low, high in arrays
        )

    return is_sound


def is_in_range(record: Any, declaration: Declaration) -> bool:
    """True if every word of a record, of arrays or plain, lies in its declared range."""
    for name, _length, low, high, *_ in declaration:
        words = np.ravel(record[name] if isinstance(record, np.void) else getattr(record, name))
        if len(words) and not low <= words.min() <= words.max() <= high:
            return False
    return True
