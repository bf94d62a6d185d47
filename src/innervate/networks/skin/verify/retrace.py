"""From what a reduced search found back to whole states, which a story is told of.

A reduced path says of each whole state what it is reduced to (reduction.py). So only whole states
that are reduced to the next one are looked for: some steps of the path may take several events,
of which all but one deliver what the reduced search has forgotten.
"""

from collections.abc import Iterator

from innervate.networks.skin.verify import reduction
from innervate.networks.skin.verify import row as skin_row
from innervate.networks.skin.verify import system as skin_system
from innervate.networks.skin.verify import world as w
from innervate.verify.explore import Result
from innervate.verify.twin import Twin

ENOUGH = 20  # whole states that go on; what is reduced to the same has the same futures


def retrace(found: Result) -> Result | None:
    """The path of a broken reduced search in whole states; None if it was not found.

    There may be none: equal beacons in a row count as one, and that one may be lost.
    """
    system = skin_system.system_of()
    room = found.model.layout().capacity
    whole = Twin(found.model.changed(lean=False, capacity=room), system)
    lean = Twin(found.model, system)
    before: dict[bytes, bytes] = {}
    here = [whole.image()]
    path = _without_rounds(found.path)
    for target, following in zip(path, [*path[1:], None], strict=True):
        again: dict[bytes, int] = {}  # the move that led to a state which is reduced to the same
        known = set(here)
        there: list[bytes] = []
        for state in here:  # grows by these
            if len(there) >= ENOUGH:
                break
            for move, after, kept, is_broken in _successors(whole, lean, state, found.broken):
                if following is None and is_broken:
                    return _result(found, whole, before, state)
                if after in known:
                    continue
                if kept == following:
                    there.append(after)
                elif kept == target and again.get(state, move) == move:
                    again[after] = move
                    here.append(after)
                else:
                    continue
                known.add(after)
                before[after] = state
        if not there:
            return None
        here = there
    return None


def _without_rounds(path: list[bytes]) -> list[bytes]:
    """A path that comes to no state twice; a random walk may."""
    short: list[bytes] = []
    for state in path:
        if state in short:
            del short[short.index(state) :]
        short.append(state)
    return short


def _successors(
    whole: Twin, lean: Twin, state: bytes, broken: int
) -> Iterator[tuple[int, bytes, bytes, bool]]:
    """Of each successor: the move, itself, what it is reduced to, whether it is broken."""
    whole.put(state)
    for move, *_ in whole.successors():
        code = whole.world.found[0] or whole.system.check(whole.world)
        yield move, whole.image(), reduced(lean, whole.row()), code == broken


def reduced(lean: Twin, row: bytes) -> bytes:
    """A whole state as the reduced search keeps it."""
    lean.put(row)
    if lean.model.merges:
        for c in range(lean.model.graph.cells):
            skin_row.trim(lean.world, c)
    if lean.world.at[w.LEAN]:
        reduction.tidy(lean.world)
    return lean.image()


def _result(found: Result, whole: Twin, before: dict[bytes, bytes], last: bytes) -> Result:
    path = [last]
    while path[-1] in before:
        path.append(before[path[-1]])
    return Result(whole.model, found.tally, found.broken, path=path[::-1])
