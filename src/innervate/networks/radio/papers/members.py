"""Robots that come and go at any moment of a resolution, and whether it matters who they are."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from innervate.networks.radio.papers.medium import START_US, Channel
from innervate.networks.radio.scenario.plan import RadioFault, RadioPlan
from innervate.networks.radio.sim import build, simulate
from innervate.networks.radio.sim.simulate import RadioResult
from innervate.papers import drawing
from innervate.papers.experiment import Claim, Claims, Measured, Point, verdict
from innervate.papers.words import joined
from innervate.plot import style
from innervate.scenario.actions.channel import JOIN, KILL
from innervate.sim.tables import put

TITLE = "Robots that come and go"
CAPTION = (
    "Event level: disasters of four robots, T = 25; one more robot dies or comes at each moment "
    "of the resolution, against the same run without that. Red: a packet of another robot is lost."
)
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
WHY = {
    "paper": "nothing published says what follows when a robot that has a turn or a report to "
    "send is gone, or one comes in the middle: rules Q9 and Q10 are added here",
    APART: "when the second to last to end dies before its report, the last takes silence for "
    "success (Q9)",
    "practical": "a silent turn passes on after its time; who comes listens first, longer than "
    "any silence inside a sequence",
}


def moments(quick: bool) -> list[int]:
    """When somebody comes or goes, us after the first start."""
    return sorted({*range(0, SPAN_US, 1040 if quick else 104), *CLOSE_US})


def movers(move: str) -> range:
    """Who is removed or added: each of the four, or a fifth."""
    return range(N) if move == "removed" else range(N, N + 1)


def moving(mode: str, move: str, quick: bool) -> Point:
    """A move in a mode at every moment."""
    seeds, count = range(1, 2 if quick else 6), len(moments(quick))
    key = f"one {move} n={N} T={SIZE} {mode} at {count} moments seeds {seeds[0]}-{seeds[-1]}"
    cost_s = 0.002 * count * len(seeds) * len(movers(move))
    return Point.of(key, cost_s, measure, mode, move, moments(quick), seeds)


def renumbered(mode: str, quick: bool) -> Point:
    """Disasters that are run with other numbers as well."""
    return Point.each(f"numbers turned round n=10 T={SIZE} {mode}", 0.02,
                      10 if quick else 40, same_air, mode)  # fmt: skip


def points(quick: bool) -> list[Point]:
    """Every move in every mode, and runs with other numbers."""
    return [moving(*case, quick) for case in CASES] + [renumbered(mode, quick) for mode in MODES]


def _plan(channel: Channel, seed: int) -> RadioPlan:
    plan = channel.plan(seed)
    plan.wanted, plan.duration_us = 0, START_US + AFTER_US
    return plan


def moved(mode: str, move: str, moment_us: int, seed: int, who: int) -> RadioPlan:
    """A disaster of four in which one robot is removed, or a fifth one added."""
    at_us = START_US + moment_us
    starts, n = APART_US if mode == APART else (), N if move == "removed" else N + 1
    channel = Channel(mode.split(",")[0], n, SIZE, spread_us=SPREAD_US, starts_us=starts)
    plan = _plan(channel, seed)
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


def measure(
    mode: str, move: str, moments_us: Sequence[int], seeds: Sequence[int]
) -> dict[str, list[float]]:
    """At every moment, for every robot: what it costs the others, against the run without it."""
    found: dict[str, list[float]] = {"at_us": [], "lost": [], "left": [], "extra": []}
    for seed in seeds:
        still = moved(mode, move, 0, seed, movers(move)[0])
        still.faults = []  # nobody goes, nobody comes
        unmoved = simulate.simulate(still)
        for moment in moments_us:
            for who in movers(move):
                now = others(simulate.simulate(moved(mode, move, moment, seed, who)), who)
                costs = (y - x for x, y in zip(others(unmoved, who), now, strict=True))
                for name, value in zip(found, (moment, *costs), strict=True):
                    found[name].append(float(value))
    return found


def same_air(mode: str, seed: int) -> bool:
    """Does everybody send the same at the same time, whatever they are called?"""
    plan = _plan(Channel(mode, 10, SIZE, spread_us=SPREAD_US), seed)
    own, other = (_aired(plan, numbers) for numbers in (range(10), range(9, -1, -1)))
    return np.array_equal(own, other)


def _aired(plan: RadioPlan, numbers: Sequence[int]) -> np.ndarray[Any, Any]:
    """(time, station, kind) of every transmission, its stations called by these numbers."""
    world = build.build(plan, plain=False, checks=False)
    for i, number in enumerate(numbers):
        put(world.stations, i, number=number)
    simulate.compiled_loop(plan.protocol)(world, plan.duration_us, 1 << 30)
    sent = world.sent[: int(world.run["sent"][0])]
    return np.stack([sent["time"], sent["node"], sent["kind"]], axis=1)


def draw(got: Measured) -> Figure:
    """What it costs the others, over the moment; a panel a move."""
    figure, axes = style.panels(style.WIDE_IN, 2.7, 1, 2, sharey=True)
    for ax, move, letter in zip(axes, MOVES, "ab", strict=True):
        for mode in [mode for mode, what in CASES if what == move]:
            _dots(ax, got[moving(mode, move, got.quick)], mode)
        ax.axhline(0, color=style.INK, lw=0.8)
        ax.set(title=f"{letter}  a robot is {move}", xlabel="moment, ms after the first start")
    axes[0].set_ylabel("the others' last packet is later by (slots)")
    drawing.legend(figure, axes[0], "lower center", ncols=4)
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

    Of others' packets: lost silently, left over, the most that the last one was delayed (slots).
    """
    return lost <= 0 and left <= 0 and extra <= ALLOWED


def judge(got: Measured) -> Claims:
    """Claims on robots added and removed, and on doing without identification."""
    for mode, move in CASES:
        found = got[moving(mode, move, got.quick)]
        lost, left = (sum(max(0.0, x) for x in found[name]) for name in ("lost", "left"))
        extra, bad = max(found["extra"]), sum(x > 0 for x in found["lost"])
        yield Claim(
            "beyond" if mode == "practical" else "2.2",
            f"{NAMES[mode]}: a robot can be {move} at any moment without any bad influence on the "
            "others",
            f"{len(found['at_us']):,} disasters of {N}, {len(moments(got.quick))} moments: "
            f"{lost:.0f} packets of others lost silently because of it (in {bad} runs), "
            f"{left:.0f} not delivered, their last one at most {extra:.0f} slots later",
            verdict(is_harmless(lost, left, extra)),
            f"allowed: {ALLOWED} slots, a packet of its own; {WHY[mode]}",
        )
    same = {mode: got[renumbered(mode, got.quick)] for mode in MODES}
    yield Claim(
        "2.2",
        "a specific number or any way for identification is not used",
        "disasters of 10 in which every frame leaves at the same time when the robots are "
        "numbered the other way round: "
        + joined(f"{NAMES[mode]} {sum(of)} of {len(of)}" for mode, of in same.items()),
        verdict(all(map(all, same.values()))),
        "the sender's number in a data frame is for the robots' programs; the practical mode "
        "gives out places in a round, in the order of the CR-Rs",
    )
