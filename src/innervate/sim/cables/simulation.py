"""A network of cables under way (see sim/driver.py)."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, ClassVar

from innervate.kernel.records import Declaration
from innervate.sim import wheel
from innervate.sim.cables import build, wires
from innervate.sim.cables import world as w
from innervate.sim.cables.wires import ARRIVED, BLOCKS
from innervate.sim.cables.world import ALIVE
from innervate.sim.counts import Counts
from innervate.sim.driver import Ended, Left, Simulation
from innervate.sim.queue import with_command
from innervate.sim.ranges import is_in_range
from innervate.sim.status import POOL_FULL
from innervate.sim.tables import DELIVERY, ROW, TRAIL, Names, get, put


@dataclass(slots=True, kw_only=True)
class Result(Left):
    """What a simulation of cables leaves: all rows.

    `rows` are what nodes and the recorder reported, `deliveries` what users received, `trail` all
    handler calls; structured arrays with the fields of the simulation's `tables`, times in us.
    `has_deliveries`: `deliveries` holds all of it, rather than nothing.
    """

    rows: Any
    deliveries: Any
    trail: Any
    counters: list[int]
    handled: int
    arrived: int
    has_deliveries: bool = False


class Cables(Simulation):
    """Nodes that are joined by cables; a network may keep other rows, and have more to break.

    Attributes:
        sink: what the node with a port per interface has, and what it has for each port.
    """

    tables: ClassVar[Mapping[str, Names]] = {
        "rows": ROW, "deliveries": DELIVERY, "trail": TRAIL,
    }  # fmt: skip
    broken_words: ClassVar[Mapping[int, str]] = {
        w.BROKEN_RANGE: "a value of {node} is out of its declared range",
        w.BROKEN_OUTBOX: "outbox of {node} overflowed",
        w.BROKEN_PORT: "{node} sends out of a port that no node has",
    }
    sink: ClassVar[tuple[Declaration, Declaration]] = ((), ())
    dropped: ClassVar[Mapping[str, int]] = {}  # why nodes give up messages, and how that counts

    def result(self, ended: Ended, kept: bool) -> Result:
        """What it leaves; `kept`: deliveries were."""
        world = self.world
        return Result(
            counters=[int(count) for count in world.counters],
            handled=int(get(world.run, 0, "handled")),
            arrived=sum(int(world.counters[ARRIVED + block]) for block in BLOCKS),
            has_deliveries=kept,
            **self.left(ended),
            **ended.rows,
        )

    def broken_us(self) -> int:
        """When it broke, as it was noted, us."""
        return max(int(get(self.world.run, 0, "broken_at")), 0)

    def whom(self) -> dict[str, str]:
        """Two nodes, as the graph calls them."""
        label, run = self.plan.graph.label, self.world.run
        return {name: label(int(get(run, 0, f"broken_{name}"))) for name in ("node", "other")}

    def broken_between(self) -> tuple[int, int] | None:
        """The ranges of the node with a port per interface."""
        (own, of_port), pc = self.sink, self.world.pc
        if not pc or (is_in_range(pc.own[0], own) and is_in_range(pc, of_port)):
            return None
        put(self.world.run, 0, broken_at=self.clock_us())
        return w.BROKEN_RANGE, self.plan.graph.cells

    def clock_us(self) -> int:
        """Time of the newest event, us."""
        return int(self.world.wheel.clock[wheel.NOW])

    def counts(self) -> Counts:
        """Frames of all classes on all cables, and what users gave and got."""
        numbers, alive = self.world.counters, self.world.alive
        return Counts(
            nodes=len(alive),
            off=tuple(node for node in range(len(alive)) if alive[node] != ALIVE),
            sent=_in_all_blocks(numbers, wires.SENT),
            arrived=_in_all_blocks(numbers, wires.ARRIVED),
            lost_by={name: _in_all_blocks(numbers, word) for name, word in wires.REASONS.items()},
            offered=int(numbers[wires.OFFERED]),
            delivered=int(numbers[wires.DELIVERED]),
            dropped_by={name: int(numbers[word]) for name, word in self.dropped.items()},
        )

    def next_us(self) -> int | None:
        """When something happens next; None = never."""
        world = self.world
        events = world.wheel.events[: int(world.wheel.pool[wheel.FRESH])]
        times = events["time"][events["bucket"] != wheel.NIL]
        found = [int(times.min())] if len(times) else []
        place = int(get(world.run, 0, "next_command"))
        if place < int(get(world.run, 0, "commands")):
            found.append(int(world.commands["at"][place]))
        return min(found, default=None)

    def grow(self, status: int) -> None:
        """Make room for more frames on their way."""
        if status == POOL_FULL:
            self.world = build.grow_pool(self.world)

    def schedule(self, fault: Any) -> None:
        """Something is to be done to the network."""
        self.schedule_row(build.fault_row(fault))

    def schedule_row(self, row: tuple[int, ...]) -> None:
        """One row of `world.COMMAND`, at a time that has not come yet."""
        self.world, _ = with_command(self.world, "at", row)


def _in_all_blocks(numbers: Any, word: int) -> int:
    return sum(int(numbers[word + block]) for block in wires.BLOCKS)
