"""What users were handed, by the moment at which it had been given to the network."""

from typing import Any, NamedTuple


class Came(NamedTuple):
    """A moment at which users gave something, us, in order; how much of that was delivered."""

    moments: Any
    counts: Any


def note_came(came, time, latency):
    """Something that was given so long (us) before a time was delivered; -1 = nobody knows when.

    It counts for the moment before.
    """
    if latency < 0:
        return
    moments, since = came.moments, time - latency
    low, high = 0, len(moments)
    while low < high:
        middle = (low + high) // 2
        if moments[middle] <= since:
            low = middle + 1
        else:
            high = middle
    if low > 0:
        came.counts[low - 1] += 1
