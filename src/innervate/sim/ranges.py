"""Declared ranges of records that are not looked at after every event: few, large, or both."""

from typing import Any

import numpy as np

from innervate.kernel.records import Declaration


def is_in_range(record: Any, declaration: Declaration) -> bool:
    """True if every word of a record, of arrays or plain, lies in its declared range."""
    for name, _length, low, high, *_ in declaration:
        words = np.ravel(record[name] if isinstance(record, np.void) else getattr(record, name))
        if len(words) and not low <= words.min() <= words.max() <= high:
            return False
    return True
