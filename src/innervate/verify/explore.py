"""Drives a search: memory, progress, interruption; the result and the way to a broken state.

A model says what is explored: `layout()` of a state's row (width, body, moves(), images()),
`world(plain)` to work in, `system()` and `compiled_parts` (see search.py), `first_row(system)`.
"""

import functools
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

from innervate.kernel import compilation, tables
from innervate.kernel.clock import wall_s
from innervate.verify import search as s
from innervate.verify.errors import VerifyError
from innervate.verify.table import Table
from innervate.verify.tally import Tally as Tally

MEMORY = 2 << 30
CHUNK = 20_000
PLAIN_CHUNK = 500
EVERY_S = 0.5

ENDS = {s.DONE: "complete", s.FULL: "memory", s.FOUND: "broken", s.GOING: "interrupted"}


@dataclass(slots=True)
class Result:
    """What a search of states found."""

    model: Any  # what was explored
    tally: Tally  # how much of it
    broken: int = 0  # what is broken, a number of the model's; 0 nothing
    # the states from the start to the last one before it broke, as rows of bytes
    path: list[bytes] = field(default_factory=list)
    rows: Any = None  # all states as rows of 64-bit words


Progress = Callable[[Tally], bool]


@functools.cache
def compiled_engine(parts: Callable[[], Any]) -> s.Engine:
    """The search of a system, compiled: `expand` and `insert` take a world and a search."""
    system = parts()
    images = (s.compare, s.is_smaller_image, s.choose_image)
    known = (s.hash_of, s.covers, s.look_up, s.insert, s.refill)
    walking = (s.save_row, s.restore_row, s.append, s.room_left)
    compilation.register_functions(s.fetch_row, *images, *known, *walking, hot=True)
    compilation.register_functions(*s.BOUND, system.variants, hot=False)
    engine = s.build(system)
    return engine._replace(
        insert=compilation.compiled(s.insert),
        refill=compilation.compiled(s.refill),
        expand=compilation.compiled_as_one(engine.expand),
        wander=compilation.compiled_as_one(engine.wander),
    )


def explore(
    model: Any,
    *,
    plain: bool = False,
    system: Any = None,
    memory: int = MEMORY,
    states: int = 0,
    progress: Progress | None = None,
) -> Result:
    """All states that `model` can reach, breadth first, until something is broken.

    Args:
        model: what is explored.
        plain: uncompiled.
        system: a copy of the protocol to run plain; None the real one.
        memory: bytes the states may take; reaching it ends the search.
        states: end after so many states; 0 = no such limit.
        progress: called every EVERY_S at most; the search ends if it returns True.

    Raises:
        VerifyError: the model does not fit its rows, or the memory.
    """
    system = system or model.system()
    driver = _Driver(model, system, plain, memory, states)
    tally, started, told = Tally(), wall_s(), wall_s()
    while True:
        status = driver.advance()
        if status == s.GROW:
            driver.known.grow(driver.engine.refill)
            continue
        now = wall_s()
        driver.count(tally, now - started)
        if status != s.GOING:
            tally.ended = ENDS[status]
            break
        if states and tally.states >= states:
            tally.ended = "limit"
            break
        if progress is not None and now - told >= EVERY_S:
            told = now
            if progress(tally):
                break
    return driver.result(tally)


def wander(
    model: Any,
    walks: int,
    *,
    seed: int = 1,
    length: int = 400,
    plain: bool = False,
    progress: Progress | None = None,
) -> Result:
    """So many random walks of at most `length` events, for budgets too large to exhaust."""
    system = model.system()
    driver = _Driver(model, system, plain, 64 << 20, length + 2)
    run, walk = driver.run, driver.engine.wander
    run[s.RANDOM], run[s.NEXT] = seed * 2_654_435_761 + 97, 0
    walk(driver.seen_world, driver.known.seen, 0, length)  # compiles
    tally, started = Tally(depth=length), wall_s()
    while int(run[s.NEXT]) < walks and not int(run[s.BROKEN]):
        batch = min(20 if plain else 2000, walks - int(run[s.NEXT]))
        walk(driver.seen_world, driver.known.seen, batch, length)
        tally.states = tally.expanded = int(run[s.NEXT])
        tally.generated, tally.wall_s = int(run[s.GENERATED]), wall_s() - started
        if progress is not None and progress(tally):
            return driver.result(tally)
    tally.ended = "broken" if int(run[s.BROKEN]) else "walked"
    return driver.result(tally)


class _Driver:
    """A search and what it works on."""

    def __init__(self, model: Any, system: Any, plain: bool, memory: int, states: int) -> None:
        self.model, self.lay = model, model.layout()
        # A row, its link backward, and 2 places of the table (at most 70 % full, then doubled).
        limit = memory // (self.lay.width + 4 + 2 * 12)
        limit = min(limit, states + 2 * s.MARGIN if states else limit)
        if limit < 2 * s.MARGIN:
            raise VerifyError("memory for the states is too small; give at least 64 MB")
        if plain:
            limit = min(limit, max(states, 1 << 18) + 2 * s.MARGIN)
        self.engine = s.build(system) if plain else compiled_engine(model.compiled_parts)
        self.known = Table(self.lay, plain, limit, self.lay.body())
        self.run = self.known.search.run
        self.run[s.MOVES] = len(self.lay.moves())
        self.world = model.world(plain)
        for i, value in enumerate(model.first_row(system)):
            self.world.work[i] = value
        self.seen_world = self.world if plain else tables.borrowed(self.world)
        self.engine.insert(self.seen_world, self.known.seen, -1)
        self.engine.expand(self.seen_world, self.known.seen, 0)  # compiles, or loads what was
        self.levels = [0, 1]
        self.chunk = PLAIN_CHUNK if plain else CHUNK

    def advance(self) -> int:
        """Another stretch of the search, at most to the end of the present depth."""
        run = self.run
        budget = min(self.chunk, self.levels[-1] - int(run[s.NEXT]))
        self.engine.expand(self.seen_world, self.known.seen, max(budget, 1))
        if int(run[s.NEXT]) == self.levels[-1] and int(run[s.COUNT]) > self.levels[-1]:
            self.levels.append(int(run[s.COUNT]))
        status = int(run[s.STATUS])
        if status == s.GOING and run[s.NEXT] >= run[s.COUNT]:
            return s.DONE
        return status

    def count(self, tally: Tally, took_s: float) -> None:
        """Bring a tally up to date."""
        run = self.run
        tally.states, tally.expanded = int(run[s.COUNT]), int(run[s.NEXT])
        tally.generated, tally.wall_s = int(run[s.GENERATED]), took_s
        tally.left_out = int(run[s.LEFT_OUT])
        tally.depth = len(self.levels) - 2

    def result(self, tally: Tally) -> Result:
        """What came of the search: counts, and the path to what is broken."""
        run, known = self.run, self.known
        kept = known.search.rows[: known.count * known.words]
        done = Result(self.model, tally, int(run[s.BROKEN]), rows=kept)
        if done.broken:
            index = int(run[s.BROKEN_AT])
            while index >= 0:
                done.path.append(known.row(index))
                index = int(known.search.before[index])
            done.path.reverse()
        return done
