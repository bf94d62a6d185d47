"""Radio on a grid: every combination of offers, pair delays and random choices from a few values.

The simulator's own loop and channel run each combination; what is checked is that nobody waits for
ever, that no two turns overlap, that turns come in the order of their places, and that no packet
is taken for delivered that nobody received.
"""

import itertools
from collections.abc import Callable, Iterator
from dataclasses import asdict, dataclass, replace
from typing import Any

import numpy as np

from innervate import scenario as scenarios
from innervate.dialect import rng
from innervate.kernel.clock import wall_s
from innervate.networks.radio.protocol.constants import DATA, WINDOWS
from innervate.networks.radio.sim import build as builder
from innervate.networks.radio.sim import simulate as simulator
from innervate.running.errors import RunError
from innervate.sim.status import BROKEN
from innervate.sim.tables import get, put

STATIONS = (2, 3, 4)
MODES = ("practical", "paper")
HORIZON_S = 2.0
EVENTS = 1 << 20
DEADLOCK, OVERLAP, ORDER, SILENT, INVARIANT = range(1, 6)
FRAMES = {1: "a CR-R", 2: "its packet", 3: "an opening", 4: "a report"}
STORY_FRAMES = 30
WORDS = {
    DEADLOCK: "a packet is never delivered",
    OVERLAP: "two turns overlap: their order is open",
    ORDER: "a turn is not the one that was announced",
    SILENT: "a packet that nobody received is taken for delivered",
    INVARIANT: "a checker of the simulator",
}


@dataclass(frozen=True, slots=True)
class Grid:
    """What is combined on a grid."""

    stations: int = 3  # 2 .. 4
    mode: str = "practical"  # "practical" or "paper"
    turnaround_us: int = 0  # ta
    packet_slots: int = 5  # T
    # moments at which stations after the first are offered their packet
    offers_us: tuple[int, ...] = (0, 52, 104, 208)
    delays_us: tuple[int, ...] = (52, 104)  # what a pair's delay can be
    draws: int = 1  # how many first draws of each station are combined
    parts: int = 3  # into how many equal parts the range of a draw is cut; one value of each

    @property
    def points(self) -> int:
        """How many combinations there are."""
        pairs = self.stations * (self.stations - 1) // 2
        choices = self.parts ** (self.draws * self.stations)
        return int(
            len(self.offers_us) ** (self.stations - 1) * len(self.delays_us) ** pairs * choices
        )

    @property
    def words(self) -> str:
        """What all of its points have in common."""
        return f"{self.stations} stations, {self.mode}, turnaround {self.turnaround_us} us"


@dataclass(frozen=True, slots=True)
class Point:
    """One combination: offers (us), delays of the pairs in order, parts of each station's draws."""

    offers_us: tuple[int, ...]
    delays_us: tuple[int, ...]
    parts: tuple[tuple[int, ...], ...]


@dataclass(slots=True)
class Found:
    """What came of a grid."""

    grid: Grid  # what was combined
    done: int  # points that were run
    wall_s: float  # how long that took
    broken: dict[int, int]  # what is broken and how often
    first: dict[int, Point]  # the first point for each of these
    ended: str  # "complete" or "interrupted"

    def as_dict(self) -> dict[str, Any]:
        """What was found, as `innervate verify radio --json` prints it."""
        return {
            "grid": asdict(self.grid),
            "points": self.grid.points,
            "done": self.done,
            "wall_s": round(self.wall_s, 3),
            "ended": self.ended,
            "broken": {WORDS[code]: count for code, count in self.broken.items()},
            "first": {WORDS[code]: asdict(point) for code, point in self.first.items()},
        }


def seeds_of(grid: Grid) -> dict[tuple[int, ...], list[int]]:
    """For each combination of parts a generator state per station whose first draws fall there.

    Stations get different states, so that what they draw later differs.
    """
    wanted = list(itertools.product(range(grid.parts), repeat=grid.draws))
    found: dict[tuple[int, ...], list[int]] = {parts: [] for parts in wanted}
    seed = 1
    while any(len(states) < grid.stations for states in found.values()):
        seed = (seed * 48_271 + 11) % rng.FIXED_POINT
        state = rng.seeded(seed)
        x, parts = state, []
        for _ in range(grid.draws):
            x = rng.step(x)
            parts.append((x & rng.LOW15) * grid.parts >> 15)
        states = found[tuple(parts)]
        if len(states) < grid.stations and state not in states:
            states.append(state)
    return found


def points(grid: Grid) -> Iterator[Point]:
    """All combinations; the first station is always offered its packet first."""
    others, pairs = grid.stations - 1, grid.stations * (grid.stations - 1) // 2
    choices = list(itertools.product(range(grid.parts), repeat=grid.draws))
    for offers in itertools.product(grid.offers_us, repeat=others):
        for delays in itertools.product(grid.delays_us, repeat=pairs):
            for parts in itertools.product(choices, repeat=grid.stations):
                yield Point((0, *offers), delays, parts)


def base_plan(grid: Grid) -> Any:
    """The plan that all points share."""
    if grid.stations not in STATIONS or grid.mode not in MODES:
        raise RunError(f"a grid has 2 to 4 stations and a mode of {', '.join(MODES)}")
    if min(grid.delays_us) < 1 or max(grid.delays_us) > 2 * min(grid.delays_us):
        raise RunError("the greatest delay may be at most twice the least")
    tau_us = [min(grid.delays_us), max(grid.delays_us)]
    tables = {
        "kind": "radio", "name": "grid", "duration_s": HORIZON_S, "stations": grid.stations,
        "packet_slots": grid.packet_slots, "traffic": {"kind": "disaster"},
        "channel": {"tau_us": tau_us, "turnaround_us": grid.turnaround_us},
        "protocol": {"mode": grid.mode},
    }  # fmt: skip
    return scenarios.plan(scenarios.from_dict(tables))


def plan_of(plan: Any, grid: Grid, point: Point) -> Any:
    """The plan of one point; the offers come after everybody has listened for a while."""
    n = grid.stations
    delays = [[0] * n for _ in range(n)]
    for (i, j), delay in zip(itertools.combinations(range(n), 2), point.delays_us, strict=True):
        delays[i][j] = delays[j][i] = delay
    begin = 2 * plan.params["join_us"]
    arrivals = [[begin + offer] for offer in point.offers_us]
    return replace(plan, delays_us=delays, arrivals=arrivals, wanted=n)


def run_point(plan: Any, point: Point, seeds: dict[tuple[int, ...], list[int]]) -> tuple[int, Any]:
    """Run one point: what is broken, 0 nothing, and the frames that were sent."""
    world = builder.build(plan, plain=False)
    for i, parts in enumerate(point.parts):
        put(world.stations, i, rng=seeds[parts][i])
    advance = simulator.compiled_loop(plan.protocol)
    advance(world, plan.duration_us, EVENTS)
    sent = world.sent[: int(get(world.run, 0, "sent"))]
    return judge(world, plan, sent), sent


def judge(world: Any, plan: Any, sent: Any) -> int:
    """What is broken when a run is over, 0 nothing; `sent` are its frames."""
    if int(get(world.run, 0, "status")) == BROKEN:
        return INVARIANT
    if int(get(world.run, 0, "silent")):
        return SILENT
    if broken := check_turns(sent, plan.protocol):
        return broken
    return DEADLOCK if int(get(world.run, 0, "completed")) < plan.wanted else 0


def check_turns(sent: Any, protocol: str) -> int:
    """What is wrong with the turns, 0 nothing.

    No two data frames after the first reservation overlap; in the practical mode each comes from
    the place that the one before it named.
    """
    data = sent[sent["kind"] == DATA]
    if protocol.endswith("paper"):
        data = data[_after_reservation(sent, data)]
    overlaps = data["time"][1:] < data["end"][:-1]
    if bool(np.any(overlaps)):
        return OVERLAP
    if protocol.endswith("practical"):
        for before, after in itertools.pairwise(data):
            named = int(before["next"])
            opens = named >= WINDOWS or named == int(before["pos"])
            if not opens and named != int(after["pos"]):
                return ORDER
    return 0


def _after_reservation(sent: Any, data: Any) -> Any:
    """Which data frames start after the first CR-R."""
    others = sent[sent["kind"] != DATA]
    if not len(others):
        return np.zeros(len(data), bool)
    return data["time"] > others["time"].min()


def story(grid: Grid, point: Point) -> list[str]:
    """What happens at a point, in sentences; times from the first offer."""
    plan = plan_of(base_plan(grid), grid, point)
    _, sent = run_point(plan, point, seeds_of(grid))
    return sentences(grid, point, sent, plan.arrivals[0][0])


def sentences(grid: Grid, point: Point, sent: Any, begin: int) -> list[str]:
    """How stations stand and what they are offered, and the first frames of `sent`."""
    pairs = itertools.combinations(range(grid.stations), 2)
    far = ", ".join(f"{i}-{j} {d} us" for (i, j), d in zip(pairs, point.delays_us, strict=True))
    told = [f"The stations are this far apart: {far}."]
    told += [f"Station {i} is offered a packet at {at} us." for i, at in enumerate(point.offers_us)]
    for row in sent[:STORY_FRAMES]:
        what = FRAMES.get(int(row["kind"]), "a frame")
        span = f"{int(row['time']) - begin} to {int(row['end']) - begin} us"
        told.append(f"Station {int(row['node'])} sends {what}, {span}.")
    return told


def search(
    grid: Grid,
    progress: Callable[[Found], bool] | None = None,
    limit: int = 0,
) -> Found:
    """Run all points of a grid, or the first `limit`."""
    plan, seeds = base_plan(grid), seeds_of(grid)
    found = Found(grid, 0, 0.0, {}, {}, "interrupted")
    run_point(plan_of(plan, grid, next(points(grid))), next(points(grid)), seeds)  # compiles
    started = wall_s()
    for point in points(grid):
        broken, _ = run_point(plan_of(plan, grid, point), point, seeds)
        found.done += 1
        found.wall_s = wall_s() - started
        if broken:
            found.broken[broken] = found.broken.get(broken, 0) + 1
            found.first.setdefault(broken, point)
        if progress is not None and found.done % 100 == 0 and progress(found):
            return found
        if found.done == limit:
            return found
    found.ended = "complete"
    return found
