"""A network in clusters: where their heads stand, and which of them each node is nearest to."""

import heapq
from collections import Counter
from collections.abc import Mapping, Sequence

from innervate.topology.placement import distances

ROUNDS_MAX = 12  # of moving heads; they come to rest before in nearly all networks
STEPS_MAX = 400  # of a quarter of the cheapest link, by which a cluster gives nodes away


def heads(near: Sequence[Sequence[int]], count: int, eligible: Sequence[int]) -> list[int]:
    """So many nodes that are far from each other, each in the middle of those nearest to it.

    Each is at first the one that is farthest from those before; then each moves to the middle of
    its cluster, until none does. Heads are of the eligible ones alone, which ascend.
    """
    found = [eligible[0]]
    apart = distances(near, found[0])
    while len(found) < count:
        found.append(max(eligible, key=lambda node: (node not in found, _far(apart[node]), -node)))
        hops = distances(near, found[-1])
        apart = [min(pair, key=_far) for pair in zip(apart, hops, strict=True)]
    links = {(a, b): 1 for a, around in enumerate(near) for b in around}
    for _ in range(ROUNDS_MAX):
        owner = nearest(near, links, found)
        moved = [_middle(near, owner, which, eligible) for which in range(count)]
        if moved == found:
            break
        found = moved
    return found


def nearest(
    near: Sequence[Sequence[int]],
    costs: Mapping[tuple[int, int], int],
    starts: Sequence[int],
    ahead: Sequence[int] = (),
) -> list[int]:
    """Per node the place in `starts` of the one it has the cheapest way to; -1: none.

    Of several the first. Who is nearest to the same one is joined by nodes that are, too.
    `costs` are above 0, for each link in both directions; `ahead` is what each start itself costs.
    """
    owner = [-1] * len(near)
    line = [(ahead[which] if ahead else 0, which, node) for which, node in enumerate(starts)]
    heapq.heapify(line)
    while line:
        cost, which, node = heapq.heappop(line)
        if owner[node] >= 0:
            continue
        owner[node] = which
        for other in near[node]:
            if owner[other] < 0:
                heapq.heappush(line, (cost + costs[node, other], which, other))
    return owner


def shared(
    near: Sequence[Sequence[int]],
    costs: Mapping[tuple[int, int], int],
    starts: Sequence[int],
    most: int,
) -> list[int]:
    """As `nearest`, but at most so many nodes to each: what is too much goes to the next nearest.

    A cluster that is too large gets a little farther from all its nodes, until none is. Where that
    does not come about, or one would lose its own head, everybody belongs to the nearest.
    """
    ahead = [0] * len(starts)
    step = max(1, min(costs.values(), default=1) // 4)
    first = owner = nearest(near, costs, starts)
    for _ in range(STEPS_MAX):
        sizes = Counter(owner)
        large = [which for which in range(len(starts)) if sizes[which] > most]
        if not large:
            return owner
        for which in large:
            ahead[which] += step
        owner = nearest(near, costs, starts, ahead)
        if any(owner[start] != which for which, start in enumerate(starts)):
            break
    return first


def _far(hops: int) -> int:
    """Whom no way leads to is farther than anybody."""
    return 1 << 30 if hops < 0 else hops


def _middle(
    near: Sequence[Sequence[int]], owner: Sequence[int], which: int, eligible: Sequence[int]
) -> int:
    """The node of a cluster with the fewest hops to all others of it; of several the first."""
    members = [node for node, one in enumerate(owner) if one == which]
    place = {node: i for i, node in enumerate(members)}
    inside = [[place[other] for other in near[node] if other in place] for node in members]
    able = [node for node in eligible if node in place]
    return min(able, key=lambda node: (sum(distances(inside, place[node])), node))
