"""Clusters of a network, against the shortest ways that networkx finds."""

import random
from collections import Counter

import networkx
import pytest

from innervate.topology.clusters import heads, nearest, shared
from innervate.topology.placement import components, distances, neighbours


def drawn(seed, count=40):
    """(near, costs) of a connected network with links of 1 to 9."""
    draw = random.Random(seed)
    costs = {}
    for node in range(1, count):
        for other in {draw.randrange(node), draw.randrange(count)} - {node}:
            costs[node, other] = costs[other, node] = draw.randint(1, 9)
    return neighbours(count, [pair for pair in costs if pair[0] < pair[1]]), costs


def lattice(wide, high):
    links = [(y * wide + x, y * wide + x + 1) for y in range(high) for x in range(wide - 1)]
    links += [(y * wide + x, (y + 1) * wide + x) for y in range(high - 1) for x in range(wide)]
    return neighbours(wide * high, links)


def even(near):
    return {(a, b): 1 for a, around in enumerate(near) for b in around}


def hold_together(near, owner):
    """Whether the nodes of each cluster are joined by nodes of it."""
    found = []
    for which in set(owner):
        members = [node for node, one in enumerate(owner) if one == which]
        place = {node: i for i, node in enumerate(members)}
        inside = [[place[b] for b in near[a] if b in place] for a in members]
        found.append(len(components(inside)) == 1)
    return all(found)


@pytest.mark.parametrize("seed", range(20))
def test_everybody_belongs_to_the_nearest(seed):
    near, costs = drawn(seed)
    starts = random.Random(seed).sample(range(len(near)), 4)
    graph = networkx.DiGraph()
    graph.add_weighted_edges_from((a, b, cost) for (a, b), cost in costs.items())
    ways = [networkx.single_source_dijkstra_path_length(graph, start) for start in starts]
    owner = nearest(near, costs, starts)
    for node, which in enumerate(owner):
        best = min(way[node] for way in ways)
        assert which == [way[node] for way in ways].index(best), f"node {node}, seed {seed}"
    assert hold_together(near, owner)


def test_of_two_as_near_the_first_and_nobody_where_no_way_leads():
    near = neighbours(4, [(0, 1), (1, 2)])
    assert nearest(near, even(near), [2, 0]) == [1, 0, 0, -1]


def test_what_one_costs_in_itself_counts():
    near = neighbours(7, [(i, i + 1) for i in range(6)])
    assert nearest(near, even(near), [0, 6]) == [0, 0, 0, 0, 1, 1, 1]
    assert nearest(near, even(near), [0, 6], [2, 0]) == [0, 0, 0, 1, 1, 1, 1]
    assert nearest(near, even(near), [0, 6], [0, 1]) == [0, 0, 0, 0, 1, 1, 1]
    assert nearest(near, even(near), [0, 6], [0, 2]) == [0, 0, 0, 0, 0, 1, 1]


def test_heads_of_a_line_stand_amidst_their_thirds():
    near = neighbours(30, [(i, i + 1) for i in range(29)])
    assert sorted(heads(near, 3, range(30))) == [4, 14, 24]


@pytest.mark.parametrize("seed", range(10))
def test_heads_are_in_the_middle_of_their_clusters(seed):
    near, _ = drawn(seed, 60)
    able = [node for node in range(60) if node % 7]
    found = heads(near, 4, able)
    assert len(set(found)) == 4
    assert set(found) <= set(able)
    owner = nearest(near, even(near), found)
    for which, head in enumerate(found):
        members = [node for node in range(60) if owner[node] == which]
        inside = [[members.index(b) for b in near[a] if owner[b] == which] for a in members]
        sums = {node: sum(distances(inside, i)) for i, node in enumerate(members) if node in able}
        assert sums[head] == min(sums.values()), f"cluster of {head}, seed {seed}"


def test_as_many_heads_as_nodes():
    near = lattice(3, 2)
    assert sorted(heads(near, 6, range(6))) == list(range(6))


def test_what_is_too_much_for_one_goes_to_the_next():
    near = lattice(20, 5)
    starts = [43, 52]
    before = nearest(near, even(near), starts)
    assert Counter(before) == {0: 40, 1: 60}
    owner = shared(near, even(near), starts, 55)
    assert Counter(owner) == {0: 45, 1: 55}
    assert hold_together(near, owner)
    assert [owner[start] for start in starts] == [0, 1]
    assert shared(near, even(near), starts, 60) == before, "nothing was too much"


def test_the_limit_itself_is_not_too_much():
    near = neighbours(6, [(i, i + 1) for i in range(5)])
    assert shared(near, even(near), [0, 3], 4) == [0, 0, 1, 1, 1, 1]
    assert shared(near, even(near), [0, 3], 3) == [0, 0, 0, 1, 1, 1]


def test_where_it_cannot_be_everybody_belongs_to_the_nearest():
    near = lattice(10, 2)
    assert shared(near, even(near), [2, 19], 5) == nearest(near, even(near), [2, 19])


@pytest.mark.parametrize("seed", range(20))
def test_shared_clusters_hold_together_about_their_heads(seed):
    near, costs = drawn(seed)
    starts = random.Random(seed).sample(range(len(near)), 5)
    for most in range(8, 25, 2):
        owner = shared(near, costs, starts, most)
        assert [owner[start] for start in starts] == list(range(5)), f"seed {seed}, {most}"
        assert hold_together(near, owner)
