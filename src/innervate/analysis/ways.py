"""Chains of next hops: where they lead, after how many hops, and which lead nowhere."""

from typing import Any

import numpy as np

Numbers = np.ndarray[Any, np.dtype[np.int64]]
Flags = np.ndarray[Any, np.dtype[np.bool_]]
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


def reach(links: Any, start: Any, hops_max: int | None = None) -> Any:
    """Per node: can it be reached from `start` (flags) over `links` (a matrix of flags).

    Args:
        links: from row to column.
        start: who is there already.
        hops_max: over so many links at most; None any number.
    """
    found = start.copy()
    hops = 0
    while hops_max is None or hops < hops_max:
        more = found | (links[found].any(axis=0) if found.any() else found)
        if (more == found).all():
            break
        found, hops = more, hops + 1
    return found
