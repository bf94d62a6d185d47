"""A model's plain state, stepped by hand: how a kept state was reached is looked up again."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

from innervate.verify import search as s
from innervate.verify.table import Table


@dataclass(slots=True)
class Event:
    """A move: what happens to whom, in which way, and what its draw gave, out of how many."""

    kind: int
    arg: int
    variant: int
    choice: int
    asked: int


class Twin:
    """Plain state of a model, stepped by hand."""

    def __init__(self, model: Any, system: Any) -> None:
        self.model, self.system = model, system
        self.lay = model.layout()
        self.moves = self.lay.moves()
        self.world = model.world(True)
        self.search = Table(self.lay, True, 1, self.lay.body()).search
        self.put(bytes(model.first_row(system)))

    def put(self, row: bytes) -> None:
        """Make a row the present state."""
        self.world.work[:] = row

    def row(self) -> bytes:
        """The present state, as bytes."""
        return bytes(self.world.work)

    def image(self) -> bytes:
        """The present state as the search keeps it."""
        s.choose_image(self.world, self.search)
        return bytes(self.world.best)

    def successors(self) -> Iterator[tuple[int, int, int, int]]:
        """(move, variant, choice, asked) of each; the state is the successor meanwhile."""
        here = self.row()
        for move in range(len(self.moves)):
            self.put(here)
            for variant in range(self.system.variants(self.world, move)):
                choice, asked = 0, 1
                while choice < asked:
                    self.put(here)
                    asked = self.system.step(self.world, move, variant, choice)
                    if asked > 0:
                        yield move, variant, choice, asked
                    choice += 1
        self.put(here)


def find(twin: Twin, target: bytes | None, broken: int) -> Event:
    """The move to the next state of a path, or to one that is broken; the state goes there."""
    for move, variant, choice, asked in twin.successors():
        if target is None:
            code = twin.world.found[0] or twin.system.check(twin.world)
            is_it = code == broken
        else:
            is_it = twin.image() == target
        if is_it:
            kind, arg = twin.moves[move]
            return Event(kind, arg, variant, choice, asked)
    raise AssertionError("a kept state has no way to it")
