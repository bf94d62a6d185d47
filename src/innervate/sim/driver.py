"""The one place where a loop is driven: in slices, its tables grown and emptied, its frames tapped.

A loop runs until a time, a budget of events or the room in a table is used up. A `Simulation` goes
on from there, for a whole run (`finish`), for a page that holds the network at any microsecond
(`web/engine.py`), and for whoever wants to look at its tables now and then.
"""

from abc import ABC, abstractmethod
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from typing import Any, ClassVar, NamedTuple

import numpy as np

from innervate.kernel import compilation
from innervate.kernel.clock import wall_s
from innervate.kernel.stop import Stop
from innervate.sim import taps
from innervate.sim.counts import Counts
from innervate.sim.status import BROKEN, BUDGET, DONE
from innervate.sim.tables import WIDE, Names, get, hand_over, move_rows, put, row_dtype

STILL_SLICES = 10  # of events at one moment: more than any network has

Advance = Callable[[Any, int, int], None]
Progress = Callable[[int, int], None]


class InvariantBroken(Exception):
    """A checker found something that must not happen; says what, where, when and which seed.

    Attributes:
        is_foreseen: the scenario does what the protocol is known not to stand.
    """

    is_foreseen = False


class Ended(NamedTuple):
    """How a run ended.

    Attributes:
        ended_us: up to where it ran, simulated time.
        wall_s: how long that took, compiling left out.
        interrupted: it was ended early.
        rows: all rows of every table, as arrays of records.
    """

    ended_us: int
    wall_s: float
    interrupted: bool
    rows: dict[str, Any]


@dataclass(slots=True, kw_only=True)
class Left:
    """What every simulation leaves; its network's class has its rows, too.

    Attributes:
        plan: what ran.
        world: its tables at the end.
        ended_us: up to where it ran.
        wall_s: how long that took.
        fingerprint: of everything that happened.
        interrupted: it was ended early.
    """

    plan: Any
    world: Any
    ended_us: int
    wall_s: float
    fingerprint: str
    interrupted: bool


class Simulation(ABC):
    """A plan's network under way.

    Args:
        plan: what runs.
        world: its tables, before the first event.
        advance: the loop, compiled or plain: (world, until_us, budget of events).
        name: what the loop is called in the cache of compiled code; "" = it is plain.

    Attributes:
        tables: the tables of rows that the loop fills, each with the fields of its rows.
        wide: fields of rows that have 64 bits.
        broken_words: what is broken, by number, with {node} and {other} for who it concerns.
        slice_events: about how many events between two looks at Ctrl-C and progress.
    """

    tables: ClassVar[Mapping[str, Names]]
    wide: ClassVar[frozenset[str]] = WIDE
    broken_words: ClassVar[Mapping[int, str]]
    slice_events: int = 1_000_000

    def __init__(self, plan: Any, world: Any, advance: Advance, name: str = "") -> None:
        self.plan = plan
        self.world = world
        self.name = name
        self._advance = advance
        self._kept: dict[str, list[Any]] = {table: [] for table in self.tables}

    def prepare(self) -> None:
        """Compile the loop, or load what was compiled; nothing is due before time 0."""
        self._advance(self.world, 0, 1)
        if self.name:
            compilation.mark_compiled(self.name)

    def advance(self, until_us: int, budget: int) -> int:
        """Run the loop until a time, a budget of events or the room in a table is used up.

        Returns:
            Why it stopped (see sim/status.py); a table that was full has room again.

        Raises:
            InvariantBroken: a checker found what must not happen.
        """
        self._advance(self.world, until_us, budget)
        if get(self.world.run, 0, "checks") and not get(self.world.run, 0, "broken"):
            self.mark_broken()
        status = int(get(self.world.run, 0, "status"))
        if status == BROKEN:
            raise self.broken()
        self.grow(status)
        move_rows(self.world, self._kept, self.tables, self.wide)
        return status

    def finish(self, progress: Progress | None = None, tap: taps.Tap | None = None) -> Ended:
        """Run to the end of the plan; an interrupt (Ctrl-C) ends it early and keeps what was done.

        Args:
            progress: called now and then with (time_us, duration_us).
            tap: is handed copies of all frames as they leave and come in (see taps.py).
        """
        self.prepare()
        duration_us, status, still = self.plan.duration_us, -1, 0
        started = wall_s()
        with Stop() as stop:
            while status != DONE and not stop.asked:
                before, status = self.clock_us(), self.advance(duration_us, self.slice_events)
                now = self.clock_us()
                still = still + (status == BUDGET) if now == before else 0
                if still >= STILL_SLICES:
                    raise self.standing_still(now)
                hand_over(self.world, tap, duration_us if status == DONE else now)
                if progress is not None:
                    progress(now, duration_us)
        early = status != DONE or self.is_complete()
        ended_us = self.clock_us() if early else duration_us
        return Ended(ended_us, wall_s() - started, status != DONE, self.take())

    def left(self, ended: Ended) -> dict[str, Any]:
        """What `Left` has, by name."""
        return {
            "plan": self.plan, "world": self.world, "ended_us": ended.ended_us,
            "wall_s": ended.wall_s, "fingerprint": self.fingerprint,
            "interrupted": ended.interrupted,
        }  # fmt: skip

    def pieces(self, table: str, until_us: int) -> Iterator[Any]:
        """The rows of one table up to a time, in pieces, as they come."""
        status = -1
        while status != DONE:
            status = self.advance(until_us, self.slice_events)
            yield self.take()[table]

    def take(self) -> dict[str, Any]:
        """The rows that were made since the last call, by table."""
        found = {}
        for name, parts in self._kept.items():
            none = np.zeros(0, row_dtype(self.tables[name], self.wide))
            found[name] = np.concatenate(parts) if parts else none
            parts.clear()
        return found

    @property
    def fingerprint(self) -> str:
        """Of everything that has happened."""
        return f"{int(get(self.world.run, 0, 'fingerprint')) & (1 << 64) - 1:016x}"

    def mark_broken(self) -> None:
        """Mark the run as broken by what is not looked at after every event."""
        broken = self.broken_between()
        if broken is not None:
            code, node = broken
            put(self.world.run, 0, broken=code, broken_node=node, status=BROKEN)

    def broken_between(self) -> tuple[int, int] | None:
        """What is broken of that, and where; None if nothing is."""
        return None

    def is_complete(self) -> bool:
        """True if it ended before its time because there was no more to do."""
        return False

    def counts(self) -> Counts:
        """What the medium has counted; nothing if it does not count."""
        return Counts()

    def clock_us(self) -> int:
        """Time of the newest event, us."""
        return int(get(self.world.run, 0, "now"))

    @abstractmethod
    def next_us(self) -> int | None:
        """When something happens next; None = never."""

    @abstractmethod
    def grow(self, status: int) -> None:
        """Make room in the table that was full."""

    @abstractmethod
    def schedule(self, fault: Any) -> None:
        """Something is to be done to the network at `fault.at_us`, which has not come yet."""

    def standing_still(self, now: int) -> InvariantBroken:
        """What is to be raised about events that follow each other without end at one time, us."""
        many = f"{STILL_SLICES * self.slice_events:,} events, and it is not over"
        return InvariantBroken(f"time stands still at {now / 1e6:.6f} s: {many}")

    def broken(self) -> InvariantBroken:
        """What is to be raised about the broken invariant."""
        return InvariantBroken(self.broken_line())

    def broken_line(self) -> str:
        """The broken invariant, in one line."""
        what = self.said(int(get(self.world.run, 0, "broken"))).format(**self.whom())
        at = self.broken_us() / 1e6
        return f"invariant broken at {at:.6f} s (seed {self.plan.seed}): {what}"

    def said(self, code: int) -> str:
        """What is broken, by its number."""
        return self.broken_words[code]

    def broken_us(self) -> int:
        """When it broke, us; `run.broken_at` on media that note it."""
        return self.clock_us()

    def whom(self) -> dict[str, str]:
        """Who it concerns, in words."""
        return {"node": f"node {int(get(self.world.run, 0, 'broken_node'))}"}
