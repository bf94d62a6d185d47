"""Radio, every draw: each choice that stations make at random is tried with each of its values.

As grid.py, but uncompiled, and what a draw gives is no part of the grid: a run asks, every
answer becomes a branch, whichever station asks, and whenever. Draws out of few are tried with all
values, draws of a time with the first, the middle and the last of its range. Behind `depth` draws
every station goes on with a generator of its own.
"""

from collections.abc import Callable
from dataclasses import asdict, dataclass, replace
from types import ModuleType
from typing import Any

import numpy as np

from innervate.dialect import rng
from innervate.kernel.clock import wall_s
from innervate.networks.radio.sim import build as builder
from innervate.networks.radio.sim import recorder, stacks
from innervate.networks.radio.verify import grid as grid
from innervate.sim.channel import loop
from innervate.sim.channel import world as w
from innervate.sim.tables import get, put, row_dtype
from innervate.verify.draws import branches

FEW = 6
ROOM = 512  # frames and reports of a run; a few stations need some dozens


@dataclass(frozen=True, slots=True)
class Tree:
    """What is tried of every draw."""

    grid: grid.Grid  # stations, mode, times; its draws and parts do not count
    depth: int = 6  # how many draws of a run, in the order of their asking, become branches


@dataclass(slots=True)
class Grown:
    """What came of a tree."""

    tree: Tree  # what was tried
    runs: int  # how many
    deepest: int  # most draws in one run
    wall_s: float  # how long that took
    broken: dict[int, int]  # what is broken and how often
    # for each of these the first point and the values that its draws gave
    first: dict[int, tuple[grid.Point, tuple[int, ...]]]
    ended: str  # "complete", "limit" or "interrupted"

    def as_dict(self) -> dict[str, Any]:
        """What was found, as `innervate verify radio --json` prints it."""
        return {
            "tree": asdict(self.tree),
            "runs": self.runs,
            "deepest": self.deepest,
            "wall_s": round(self.wall_s, 3),
            "ended": self.ended,
            "broken": {grid.WORDS[code]: count for code, count in self.broken.items()},
        }


class Asked:
    """Answers draws from a script, notes out of how many they were."""

    def __init__(self, depth: int) -> None:
        self.depth = depth
        self.begin(())

    def begin(self, script: tuple[int, ...]) -> None:
        """A run begins whose first draws are those of `script`."""
        self.script = script
        self.ranges: list[int] = []
        self.own, self.answer = rng.seeded(7), 0

    def ask(self, count: int) -> None:
        """A station draws out of so many."""
        place = len(self.ranges)
        if place < self.depth:
            self.ranges.append(count)
            self.answer = values(count)[self.script[place] if place < len(self.script) else 0]
        else:
            self.own = rng.step(self.own)
            self.answer = self.own % count


def values(count: int) -> list[int]:
    """What is tried of a draw out of so many."""
    return list(range(count)) if count <= FEW else [0, count // 2, count - 1]


def scripted(station: Any, asked: Asked) -> None:
    """Let a plain station's draws be answered; its record is as it was."""
    kind = type(station)
    members = {
        "__slots__": (),
        "choice": property(lambda _: asked.answer, lambda *_: None),
        "asked": property(lambda _: 0, lambda _, count: asked.ask(count) if count else None),
    }
    station.__class__ = type(kind.__name__, (kind,), members)


def search(
    tree: Tree,
    entry: ModuleType | None = None,
    limit: int = 0,
    progress: Callable[[Grown], bool] | None = None,
) -> Grown:
    """All runs of a tree, or the first `limit`; `entry` a copy of the protocol to run."""
    shared = grid.base_plan(tree.grid)
    advance = loop.bind(stacks.bind(entry or stacks.PROTOCOLS[shared.protocol].entry, recorder))
    asked, grown = Asked(tree.depth), Grown(tree, 0, 0, 0.0, {}, {}, "interrupted")
    started = wall_s()
    for point in grid.points(replace(tree.grid, draws=0)):
        plan = grid.plan_of(shared, tree.grid, point)
        todo: list[tuple[int, ...]] = [()]
        while todo:
            script = todo.pop()
            broken, _ = _run(plan, advance, asked, script)
            todo += branches(script, [len(values(count)) for count in asked.ranges])
            grown.runs += 1
            grown.deepest = max(grown.deepest, len(asked.ranges))
            grown.wall_s = wall_s() - started
            if broken:
                grown.broken[broken] = grown.broken.get(broken, 0) + 1
                grown.first.setdefault(broken, (point, script))
            if grown.runs == limit:
                grown.ended = "limit"
                return grown
            if progress is not None and grown.runs % 20 == 0 and progress(grown):
                return grown
    grown.ended = "complete"
    return grown


def story(grown: Grown, code: int) -> list[str]:
    """How the first run went in which this was broken, in sentences."""
    made, (point, script) = grown.tree.grid, grown.first[code]
    shared = grid.base_plan(made)
    advance = loop.bind(stacks.bind(stacks.PROTOCOLS[shared.protocol].entry, recorder))
    plan, asked = grid.plan_of(shared, made, point), Asked(grown.tree.depth)
    _, sent = _run(plan, advance, asked, script)
    told = grid.sentences(made, point, sent, plan.arrivals[0][0])
    whole = script + (0,) * (len(asked.ranges) - len(script))
    drawn = [f"{values(of)[which]} of {of}" for which, of in zip(whole, asked.ranges, strict=True)]
    return [f"What stations draw, in the order of their asking: {', '.join(drawn)}.", *told]


def _run(
    plan: Any, advance: Callable[..., None], asked: Asked, script: tuple[int, ...]
) -> tuple[int, Any]:
    """One run: what is broken, 0 nothing; and the frames that were sent."""
    world = builder.build(plan, plain=True, room=ROOM)
    for station in world.stations:
        scripted(station, asked)
        put([station], 0, rng=1)
    asked.begin(script)
    try:
        advance(world, plan.duration_us, grid.EVENTS)
    except (ArithmeticError, IndexError, ValueError):
        return grid.INVARIANT, []  # a mutant's value that fits nowhere
    rows = world.sent[: int(get(world.run, 0, "sent"))]
    sent = np.array([tuple(getattr(row, f) for f in w.SENT) for row in rows],
                    row_dtype(w.SENT, w.WIDE))  # fmt: skip
    return grid.judge(world, plan, sent), sent
