"""Who has a way to the sink over time, told from changes of next hops alone, whoever wrote them.

Nodes are numbers, the sink one of them; a cable is (node, port, node, port). For networks over
cables whose nodes have one next hop each: what is compared has one definition.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np

from innervate.analysis.ways import NOWHERE as NOWHERE
from innervate.analysis.ways import follow
from innervate.topology.placement import distances, neighbours

Cable = tuple[int, int, int, int]
Change = tuple[int, int, int]  # when (us), who, its port from then on; -1 none


class Ways:
    """A network whose next hops change and whose cables and nodes go down."""

    def __init__(self, nodes: int, sink: int, cables: Sequence[Cable]) -> None:
        self.nodes, self.sink, self.cables = nodes, sink, cables
        # (when, how many nodes that are joined with the sink have no way to it): a step function,
        # only where it changes
        self.steps: list[tuple[int, int]] = []
        self.loops: list[int] = []  # when next hops closed a loop
        self._far: dict[tuple[int, int], int] = {}
        for a, port_a, b, port_b in cables:
            self._far[a, port_a], self._far[b, port_b] = b, a
        self._port = [NOWHERE] * nodes
        self._dead: set[int] = set()
        self._settle(0)

    def play(self, changes: Iterable[Change], harm: Iterable[Harm] = ()) -> Ways:
        """Play changes and harm in order of time; of one moment harm comes first."""
        waiting = sorted(harm, key=lambda one: one.at_us)
        for at, node, port in changes:
            while waiting and waiting[0].at_us <= at:
                self._suffer(waiting.pop(0))
            self._change(at, node, port)
        for one in waiting:
            self._suffer(one)
        return self

    def _change(self, at: int, node: int, port: int) -> None:
        self._port[node] = port
        self._children[self._hop[node]].discard(node)
        hop = self._hop[node] = self._far.get((node, port), NOWHERE)
        self._children[hop].add(node)
        is_loop = self._comes_back(node)
        if is_loop:
            self.loops.append(at)
        self._spread(node, hop == self.sink or (not is_loop and hop >= 0 and self._routed[hop]))
        self._note(at)

    def _comes_back(self, start: int) -> bool:
        node = self._hop[start]
        for _ in range(self.nodes):
            if node in (NOWHERE, self.sink):
                return False
            if node == start:
                return True
            node = self._hop[node]
        return False  # a loop that others closed

    def _spread(self, start: int, routed: bool) -> None:
        """A node and all whose ways lead through it have a way, or none."""
        waiting = [start]
        while waiting:
            node = waiting.pop()
            if self._routed[node] != routed:
                self._routed[node] = routed
                self._without += -1 if routed else 1
                waiting += self._children[node]

    def _suffer(self, harm: Harm) -> None:
        for place in harm.cables:
            a, port_a, b, port_b = self.cables[place]
            self._far.pop((a, port_a), None)
            self._far.pop((b, port_b), None)
        self._dead |= set(harm.nodes)
        for key, other in list(self._far.items()):
            if key[0] in self._dead or other in self._dead:
                del self._far[key]
        self._settle(harm.at_us)

    def _settle(self, at: int) -> None:
        """Work out anew who has a way, from next hops and cables."""
        self._hop = [self._far.get((n, self._port[n]), NOWHERE) for n in range(self.nodes)]
        # The last: of nowhere.
        self._children: list[set[int]] = [set() for _ in range(self.nodes + 1)]
        for node, hop in enumerate(self._hop):
            self._children[hop].add(node)
        self._routed = [root != NOWHERE for root in self.roots()]
        live = [(node, other) for (node, _), other in self._far.items()]
        joined = distances(neighbours(self.nodes, live), self.sink)
        self._without = sum(
            far > 0 and not routed for far, routed in zip(joined, self._routed, strict=True)
        )
        self._note(at)

    def roots(self) -> list[int]:
        """The last node before the sink of every node's way; NOWHERE without one."""
        hop = np.array(self._hop, np.int64)
        found: list[int] = follow(hop, hop == self.sink)[0].tolist()
        return found

    def _note(self, at: int) -> None:
        if not self.steps or self.steps[-1][1] != self._without:
            self.steps.append((at, self._without))


@dataclass(frozen=True, slots=True)
class Harm:
    """What goes down at a moment: places in the list of cables, nodes."""

    at_us: int
    cables: tuple[int, ...] = ()
    nodes: tuple[int, ...] = ()


def settled_us(steps: Sequence[tuple[int, int]], start: int, end: int, calm_us: int) -> int | None:
    """The first moment from `start` on from which nobody is without a way for so long; None never.

    At the end of what is looked at, less will do.
    """
    inside = _between(steps, start, end)
    after = [*(at for at, _ in inside[1:]), end]
    for (at, count), till in zip(inside, after, strict=True):
        if count == 0 and (till - at >= calm_us or till == end):
            return at
    return None


def most_without(steps: Sequence[tuple[int, int]], start: int, end: int) -> int:
    """The greatest number without a way from one moment on until just before another."""
    return max((count for _, count in _between(steps, start, end)), default=0)


def time_without_us(steps: Sequence[tuple[int, int]], start: int, end: int) -> int:
    """Time without a way, added up over all nodes, us."""
    inside = _between(steps, start, end)
    after = [*(at for at, _ in inside[1:]), end]
    return sum(count * (till - at) for (at, count), till in zip(inside, after, strict=True))


def _between(steps: Sequence[tuple[int, int]], start: int, end: int) -> list[tuple[int, int]]:
    before = [count for at, count in steps if at <= start][-1:]
    return [*((start, count) for count in before), *(s for s in steps if start < s[0] < end)]
