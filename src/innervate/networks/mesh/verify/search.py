"""Breadth-first through the states of a mesh; then, from every one, a schedule without faults.

States are kept whole: a row of numbers that stand for whole records, no hash stands for one. Node
states, calls and rows are bounded together by `memory`.
"""

from __future__ import annotations

import random
from array import array
from collections.abc import Callable
from dataclasses import dataclass, field

from innervate.kernel.clock import wall_s
from innervate.networks.mesh.verify import fair as mesh_fair
from innervate.networks.mesh.verify.first import begin
from innervate.networks.mesh.verify.model import MeshModel
from innervate.networks.mesh.verify.net import Net, Nets, Successor
from innervate.verify.explore import EVERY_S, MEMORY, Tally

ROW_BYTES = 330  # a kept state, with its place among those known and its links backward
LOCAL_BYTES = 6_000  # a node's state, with the calls that were made on it
CHUNK = 500

Progress = Callable[[Tally], bool]


@dataclass(slots=True)
class Found:
    """What a search of a mesh found."""

    model: MeshModel  # what was explored
    nets: Nets  # its states' meaning
    tally: Tally  # how much of it; `depth` in events
    calls: int = 0  # handler calls that were made; all others were remembered
    broken: int = 0  # what is broken, a number of local.py; 0 nothing
    # the way there: (move, state after it, broken)
    path: list[Successor] = field(default_factory=list)
    start: Net | None = None
    fair: int = 0  # states whose calm future was looked at
    longest: int = 0  # the most events that one of them took until everything was settled

    @property
    def wide(self) -> list[int]:
        """Draws out of more than FEW, of which each node had one value: out of how many."""
        return sorted(self.nets.locals.wide)


def explore(
    model: MeshModel,
    *,
    nets: Nets | None = None,
    memory: int = MEMORY,
    states: int = 0,
    live: bool = True,
    progress: Progress | None = None,
) -> Found:
    """All states that `model` can reach, breadth first, until something is broken.

    It also ends when `states` (0 = no limit) were found, when they take `memory` bytes, roughly, or
    when `progress`, called every EVERY_S at most, returns True. `nets` may be of a copy of the
    protocol; with `live` the calm future of every state is looked at, too.
    """
    first, found = _begun(model, nets or Nets(model))
    if found.broken:
        return found
    search = _Search(found.nets, first, found.tally)
    started = told = wall_s()
    while search.tally.ended == "interrupted":
        search.advance(states, memory)
        now = wall_s()
        search.tally.wall_s = now - started
        if progress is not None and now - told >= EVERY_S and search.tally.ended == "interrupted":
            told = now
            if progress(search.tally):
                break
    if search.broken:
        found.broken = search.broken
        found.path = search.path(search.broken_at, search.broken_which)
    elif live:
        _look_ahead(found, search, progress)
        search.tally.wall_s = wall_s() - started
    found.calls = found.nets.locals.calls
    return found


def _begun(model: MeshModel, nets: Nets, depth: int = 0) -> tuple[Net, Found]:
    """Where a search begins, and what is found so far: that the first round breaks, if it does."""
    begun = begin(nets)
    nets.locals.begin()
    tally = Tally(states=1, ended="broken") if begun.broken else Tally(depth=depth)
    found = Found(model, nets, tally, nets.locals.calls, begun.broken, begun.path, begun.start)
    return begun.net, found


def _look_ahead(found: Found, search: _Search, progress: Progress | None) -> None:
    """The calm future of every state found."""
    fair = mesh_fair.Fair(found.nets)
    told = wall_s()
    for index, row in enumerate(search.rows):
        broken = fair.check(found.nets.unpack(row))
        found.fair, found.longest = index + 1, fair.longest
        if broken:
            found.broken, found.path = broken, search.path(index)
            search.tally.ended = "broken"
            return
        if progress is not None and index % CHUNK == 0 and wall_s() - told > 1:
            told = wall_s()
            if progress(search.tally):
                search.tally.ended = "interrupted"
                return


class _Search:
    """The states found so far, in the order in which they were."""

    def __init__(self, nets: Nets, first: Net, tally: Tally) -> None:
        self.nets = nets
        self.first = first
        row = nets.pack(self.first)
        self.known = {row: 0}
        self.rows = [row]
        self.before = array("q", [-1])
        self.which = array("i", [0])
        self.next = 0
        self.level_end = 1
        self.broken = self.broken_at = self.broken_which = 0
        self.tally = tally
        tally.states = 1

    def advance(self, states: int, memory: int) -> None:
        """Find the successors of some more states."""
        tally, nets = self.tally, self.nets
        for _ in range(CHUNK):
            if self.next >= len(self.rows):
                tally.ended = "complete"
                break
            self._expand()
            if self.broken:
                tally.ended = "broken"
                break
            self.next += 1
            if self.next == self.level_end and self.next < len(self.rows):
                self.level_end = len(self.rows)
                tally.depth += 1
        tally.states, tally.expanded = len(self.rows), self.next
        used = len(self.rows) * ROW_BYTES + len(nets.locals.states) * LOCAL_BYTES
        if tally.ended == "interrupted":
            if states and len(self.rows) >= states:
                tally.ended = "limit"
            elif used > memory:
                tally.ended = "memory"

    def _expand(self) -> None:
        """The successors of the next state."""
        here = self.nets.unpack(self.rows[self.next])
        for which, (_, after, broken) in enumerate(self.nets.successors(here)):
            self.tally.generated += 1
            if broken:
                self.broken, self.broken_at, self.broken_which = broken, self.next, which
                return
            self._keep(after, which)

    def _keep(self, net: Net, which: int) -> None:
        row = self.nets.pack(net)
        if row not in self.known:
            self.known[row] = len(self.rows)
            self.rows.append(row)
            self.before.append(self.next)
            self.which.append(which)

    def path(self, index: int, last: int = -1) -> list[Successor]:
        """The events from the start to a state, and one more."""
        order = []
        while index > 0:
            order.append(self.which[index])
            index = self.before[index]
        order.reverse()
        if last >= 0:
            order.append(last)
        return replay(self.nets, self.first, order)


def replay(nets: Nets, net: Net, order: list[int]) -> list[Successor]:
    """The events that these choices among the successors stand for."""
    found = []
    for which in order:
        found.append(nets.successors(net)[which])
        net = found[-1][1]
    return found


def wander(
    model: MeshModel,
    walks: int,
    *,
    seed: int = 1,
    length: int = 400,
    live: bool = True,
    progress: Progress | None = None,
) -> Found:
    """So many random walks of at most `length` events, for budgets too large to exhaust."""
    nets = Nets(model)
    first, found = _begun(model, nets, length)
    if found.broken:
        return found
    chance, fair = random.Random(seed), mesh_fair.Fair(nets)
    started = wall_s()
    for walk in range(walks):
        net, order, broken = first, [], 0
        for _ in range(length):
            some = nets.successors(net)
            if not some or broken:
                break
            order.append(chance.randrange(len(some)))
            _, net, broken = some[order[-1]]
            found.tally.generated += 1
        if not broken and live:
            broken = fair.check(net)
            found.fair, found.longest = walk + 1, fair.longest
        found.tally.states = found.tally.expanded = walk + 1
        found.tally.wall_s = wall_s() - started
        if broken:
            found.broken, found.path = broken, replay(nets, first, order)
            found.tally.ended = "broken"
            break
        if progress is not None and walk % 10 == 0 and progress(found.tally):
            break
    else:
        found.tally.ended = "walked"
    found.calls = nets.locals.calls
    return found
