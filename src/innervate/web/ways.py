"""Chains of next hops: where they lead, after how many hops, and which lead nowhere."""

from __future__ import annotations

from typing import Any

import numpy as np

Numbers = np.ndarray[Any, np.dtype[np.int64]]
NOWHERE = -1


def follow(hop: Numbers, is_root: Any) -> tuple[Numbers, Numbers]:
    """(the root that every node's chain ends at, hops to there); NOWHERE for both without one.

    Args:
        hop: per node the next one, NOWHERE if there is none; that of a root does not count.
        is_root: per node, true where chains end.
    """
    count = len(hop)
    nodes = np.arange(count)
    # A place behind the last: nowhere, which leads to itself.
    jump = np.append(np.where(is_root, nodes, np.where(hop == NOWHERE, count, hop)), count)
    steps = (jump != np.arange(count + 1)).astype(np.int64)
    for _ in range(max(1, count.bit_length())):
        steps = steps + steps[jump]
        jump = jump[jump]
    last = jump[:count]
    there = (last < count) & np.append(is_root, False)[last]
    return np.where(there, last, NOWHERE), np.where(there, steps[:count], NOWHERE)


def reach(links: Any, start: Any) -> Any:
    """Per node: can it be reached from `start` (flags) over `links` (a matrix of flags)."""
    found = start.copy()
    while True:
        more = found | (links[found].any(axis=0) if found.any() else found)
        if (more == found).all():
            return found
        found = more
