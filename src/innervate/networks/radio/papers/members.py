"""Robots that come and go at any moment of a resolution, and whether it matters who they are."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from innervate.networks.radio.papers.common import joined
from innervate.networks.radio.papers.medium import START_US, Channel
from innervate.networks.radio.scenario.plan import RadioFault, RadioPlan
from innervate.networks.radio.sim import build, simulate
from innervate.networks.radio.sim.simulate import RadioResult
from innervate.papers.experiment import Claim, Experiment, Point, Results, verdict
from innervate.plot import style
from innervate.scenario.actions.channel import JOIN, KILL
from innervate.sim.tables import put

N, SIZE, SPREAD_US = 4, 25, 100  # so few are put in order even as published (F1)
SPAN_US, AFTER_US = 36_000, 400_000
CLOSE_US = range(4992, 7488, 104)  # packets have collided, and it is settled who reports that
MODES = ("paper", "practical")
APART = "paper, Fig. 1"  # the paper's own example: starts given, ends more than a slot apart
APART_US = (1248, 1040, 624, 0)
NAMES = {"paper": "as published", APART: "as published, Fig. 1's starts",
         "practical": "practical mode"}  # fmt: skip
LOOKS = {"paper": (style.BLUE, "o"), APART: (style.ORANGE, "s"), "practical": (style.BLACK, "X")}
MOVES = ("removed", "added")
CASES = (("paper", "removed"), (APART, "removed"), ("practical", "removed"),
         ("paper", "added"), ("practical", "added"))  # fmt: skip
ALLOWED = SIZE + 1  # slots: a newcomer's own packet


def moments(quick: bool) -> list[int]:
    """When somebody comes or goes, us after the first start."""
    return sorted({*range(0, SPAN_US, 1040 if quick else 104), *CLOSE_US})


def seeds(quick: bool) -> range:
    """Seeds of the disasters at each moment: 5, or 1 if `quick`."""
    return range(1, 2 if quick else 6)


def movers(move: str) -> range:
    """Who is removed or added: each of the four, or a fifth."""
    return range(N) if move == "removed" else range(N, N + 1)


def points(quick: bool) -> list[Point]:
    """Every move in every mode, and runs with other numbers."""
    count = len(moments(quick)) * len(seeds(quick))
    made = [
        Point.of(
            _key(mode, move, quick), 0.002 * count * len(movers(move)), measure, mode, move, quick
        )
        for mode, move in CASES
    ]
    return made + [
        Point.of(_numbers_key(mode, quick), 0.01 * 2 * len(permuted(quick)), same_air, mode, quick)
        for mode in MODES
    ]


def _key(mode: str, move: str, quick: bool) -> str:
    return (
        f"one {move} n={N} T={SIZE} {mode} at {len(moments(quick))} moments "
        f"seeds {seeds(quick)[0]}-{seeds(quick)[-1]}"
    )


def _plan(mode: str, seed: int, n: int) -> RadioPlan:
    starts = APART_US if mode == APART else ()
    channel = Channel(mode.split(",")[0], n, SIZE, spread_us=SPREAD_US, starts_us=starts)
    plan = channel.plan(seed)
    plan.wanted, plan.duration_us = 0, START_US + AFTER_US
    return plan


def moved(mode: str, move: str, moment_us: int, seed: int, who: int) -> RadioPlan:
    """A disaster of four in which one robot is removed, or a fifth one added."""
    at_us = START_US + moment_us
    plan = _plan(mode, seed, N if move == "removed" else N + 1)
    if move == "added":
        plan.absent[who] = 1
        plan.arrivals[who] = [at_us]
    plan.faults = [RadioFault(at_us, KILL if move == "removed" else JOIN, who, 0, 0)]
    return plan


def others(result: RadioResult, who: int) -> tuple[int, int, float]:
    """Of the others' packets: how many are lost silently, how many left over; T_D, slots."""
    plan = result.plan
    mine = result.packets[result.packets["node"] != who]
    got = mine[mine["receivers"] > 0]
    starts = [times[0] for i, times in enumerate(plan.arrivals) if i != who]
    last_us = int(got["end"].max(initial=0))
    lasted = max(0, last_us - min(starts)) / plan.params["slot_us"]
    return len(mine) - len(got), len(starts) - len(mine), lasted


def measure(mode: str, move: str, quick: bool) -> dict[str, list[float]]:
    """At every moment, for every robot: what it costs the others, against the run without it."""
    found: dict[str, list[float]] = {"at_us": [], "lost": [], "left": [], "extra": []}
    for seed in seeds(quick):
        still = moved(mode, move, 0, seed, movers(move)[0])
        still.faults = []  # nobody goes, nobody comes
        unmoved = simulate.simulate(still)
        for moment in moments(quick):
            for who in movers(move):
                now = others(simulate.simulate(moved(mode, move, moment, seed, who)), who)
                costs = (y - x for x, y in zip(others(unmoved, who), now, strict=True))
                for name, value in zip(found, (moment, *costs), strict=True):
                    found[name].append(float(value))
    return found


def permuted(quick: bool) -> range:
    """Disasters that are run with other numbers as well."""
    return range(1, 11 if quick else 41)


def _numbers_key(mode: str, quick: bool) -> str:
    return f"numbers turned round n=10 T={SIZE} {mode} seeds 1-{len(permuted(quick))}"


def same_air(mode: str, quick: bool) -> dict[str, int]:
    """In how many disasters everybody sends the same at the same time, whatever they are called."""
    same = 0
    for seed in permuted(quick):
        plan = Channel(mode, 10, SIZE, spread_us=SPREAD_US).plan(seed)
        plan.wanted, plan.duration_us = 0, START_US + AFTER_US
        own, other = (_aired(plan, numbers) for numbers in (range(10), range(9, -1, -1)))
        same += int(np.array_equal(own, other))
    return {"same": same, "runs": len(permuted(quick))}


def _aired(plan: RadioPlan, numbers: Sequence[int]) -> np.ndarray[Any, Any]:
    """(time, station, kind) of every transmission, its stations called by these numbers."""
    world = build.build(plan, plain=False, checks=False, keep=True, trail=False)
    for i, number in enumerate(numbers):
        put(world.stations, i, number=number)
    simulate.compiled_loop(plan.protocol)(world, plan.duration_us, 1 << 30)
    sent = world.sent[: int(world.run["sent"][0])]
    return np.stack([sent["time"], sent["node"], sent["kind"]], axis=1)


def draw(results: Results, quick: bool) -> Figure:
    """What it costs the others, over the moment; a panel a move."""
    figure, axes = style.panels(style.WIDE_IN, 2.7, 1, 2, sharey=True)
    for ax, move, letter in zip(axes, MOVES, "ab", strict=True):
        for mode in [mode for mode, what in CASES if what == move]:
            _dots(ax, results[_key(mode, move, quick)], mode)
        ax.axhline(0, color=style.INK, lw=0.8)
        ax.set_title(f"{letter}  a robot is {move}")
        ax.set_xlabel("moment, ms after the first start")
    axes[0].set_ylabel("the others' last packet is later by (slots)")
    figure.legend(*axes[0].get_legend_handles_labels(), loc="outside lower center", ncols=4)
    return figure


def _dots(ax: Axes, found: Mapping[str, list[float]], mode: str) -> None:
    at, extra = np.array(found["at_us"]) / 1e3, np.array(found["extra"])
    bad = (np.array(found["lost"]) > 0) | (np.array(found["left"]) > 0)
    colour, marker = LOOKS[mode]
    ax.plot(at[~bad], extra[~bad], marker, color=colour, ms=2.2, alpha=0.5, label=NAMES[mode])
    if bad.any():
        ax.plot(at[bad], extra[bad], marker, color=style.VERMILION, ms=5, mfc="none",
                label=f"{NAMES[mode]}: another's packet is lost")  # fmt: skip


def is_harmless(lost: float, left: float, extra: float) -> bool:
    """Nobody else loses a packet, or waits longer than a newcomer's own packet takes.

    Args:
        lost: packets of others that were lost silently because of it.
        left: packets of others that were not delivered because of it.
        extra: the most that it delayed the last packet of the others, slots.
    """
    return lost <= 0 and left <= 0 and extra <= ALLOWED


def judge(results: Results, quick: bool) -> list[Claim]:
    """Claims on robots added and removed, and on doing without identification."""
    return [
        *(_move(results, quick, mode, move) for mode, move in CASES),
        _nameless(results, quick),
    ]


def _move(results: Results, quick: bool, mode: str, move: str) -> Claim:
    found = results[_key(mode, move, quick)]
    lost, left = (sum(max(0.0, x) for x in found[name]) for name in ("lost", "left"))
    extra = max(found["extra"])
    runs, bad = len(found["at_us"]), sum(x > 0 for x in found["lost"])
    why = {
        "paper": "nothing published says what follows when a robot that has a turn or a report to "
        "send is gone, or one comes in the middle: rules Q9 and Q10 are added here",
        APART: "when the second to last to end dies before its report, the last takes silence for "
        "success (Q9)",
        "practical": "a silent turn passes on after its time; who comes listens first, longer than "
        "any silence inside a sequence",
    }
    return Claim(
        "beyond" if mode == "practical" else "2.2",
        f"{NAMES[mode]}: a robot can be {move} at any moment without any bad influence on the "
        "others",
        f"{runs:,} disasters of {N}, {len(moments(quick))} moments: {lost:.0f} packets of "
        f"others lost silently because of it (in {bad} runs), {left:.0f} not delivered, their "
        f"last one at most {extra:.0f} slots later",
        verdict(is_harmless(lost, left, extra)),
        f"allowed: {ALLOWED} slots, a packet of its own; {why[mode]}",
    )


def _nameless(results: Results, quick: bool) -> Claim:
    found = {mode: results[_numbers_key(mode, quick)] for mode in MODES}
    words = joined(f"{NAMES[mode]} {one['same']} of {one['runs']}" for mode, one in found.items())
    return Claim(
        "2.2",
        "a specific number or any way for identification is not used",
        f"disasters of 10 in which every frame leaves at the same time when the robots are "
        f"numbered the other way round: {words}",
        verdict(all(one["same"] == one["runs"] for one in found.values())),
        "the sender's number in a data frame is for the robots' programs; the practical mode "
        "gives out places in a round, in the order of the CR-Rs",
    )


EXPERIMENT = Experiment(
    "members",
    "Robots that come and go",
    "Event level: disasters of four robots, T = 25; one more robot dies or comes at each moment "
    "of the resolution, against the same run without that. Red: a packet of another robot is lost.",
    points,
    draw,
    judge,
)
