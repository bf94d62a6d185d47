"""Chains of next hops and flags that spread over links, against walking them by hand."""

import random

import numpy as np
import pytest

from innervate.analysis.ways import NOWHERE, follow, reach


def walked(hop, roots):
    """(root, hops) of every node, one step at a time."""
    found = []
    for node in range(len(hop)):
        here, steps = node, 0
        while here not in roots and hop[here] != NOWHERE and steps <= len(hop):
            here, steps = hop[here], steps + 1
        found.append((here, steps) if here in roots else (NOWHERE, NOWHERE))
    return found


def followed(hop, roots):
    is_root = np.isin(np.arange(len(hop)), list(roots))
    return [
        tuple(map(int, pair)) for pair in zip(*follow(np.array(hop, int), is_root), strict=True)
    ]


def test_chains_end_at_their_root():
    assert followed([NOWHERE, 0, 1, NOWHERE], {0}) == [(0, 0), (0, 1), (0, 2), (NOWHERE, NOWHERE)]
    assert followed([1, 0], {0, 1}) == [(0, 0), (1, 0)]  # a root's own hop does not count
    assert followed([1, 0, 1], set()) == [(NOWHERE, NOWHERE)] * 3  # round and round
    assert followed([], set()) == []


@pytest.mark.parametrize("count", [1, 2, 3, 4, 5, 8, 16, 17, 33])
def test_the_longest_chain_there_can_be(count):
    line = [NOWHERE, *range(count - 1)]
    assert followed(line, {0}) == [(0, hops) for hops in range(count)]


@pytest.mark.parametrize("seed", range(30))
def test_any_chains_are_as_walked(seed):
    draw = random.Random(seed)
    count = draw.randint(1, 20)
    hop = [draw.randint(NOWHERE, count - 1) for _ in range(count)]
    roots = set(draw.sample(range(count), draw.randint(0, min(3, count))))
    assert followed(hop, roots) == walked(hop, roots)


def flags(count, *nodes):
    return np.isin(np.arange(count), nodes)


def test_links_are_taken_from_row_to_column_one_hop_at_a_time():
    links = np.zeros((5, 5), bool)
    for a, b in ((0, 1), (1, 2), (2, 3), (4, 3)):
        links[a, b] = True
    for hops, there in ((0, [0]), (1, [0, 1]), (2, [0, 1, 2]), (3, [0, 1, 2, 3]),
                        (None, [0, 1, 2, 3])):  # fmt: skip
        start = flags(5, 0)
        assert np.flatnonzero(reach(links, start, hops)).tolist() == there
        assert np.flatnonzero(start).tolist() == [0]  # left as it was
    assert not reach(links, flags(5)).any()
    assert np.flatnonzero(reach(links, flags(5, 3))).tolist() == [3]
