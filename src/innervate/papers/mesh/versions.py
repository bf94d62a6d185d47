"""Section 1.1: tables of two versions at the same time; robots move meanwhile."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.figure import Figure

from innervate.analysis.mesh import looped
from innervate.analysis.mesh_messages import DELIVERED, counted, messages
from innervate.papers.experiment import Claim, Experiment, Point, Results, verdict
from innervate.papers.mesh.bed import BYTES, Bed, Options
from innervate.papers.mesh.words import joined, percent, seeds_of
from innervate.plot import style
from innervate.scenario.mesh_plan import Offer
from innervate.sim.mesh.simulate import simulate
from innervate.trace.streams import stream

SPEEDS = (0.1, 0.5, 1.0, 2.0)
SOME = (0.5, 2.0)
ROBOTS = 15
FROM_S, UNTIL_S, EVERY_S = 8, 108, 1
# Alternates alone: a search would find its way by any table.
AT_ONCE: Options = (("failover", "alternate"), ("reliable", False))
TWO_PHASE: Options = (*AT_ONCE, ("activation", True))
SCHEMES = (("newest at once", AT_ONCE), ("two phases", TWO_PHASE))
SEARCHED = (("newest at once, search", (("reliable", False),)),
            ("two phases, search", (("reliable", False), ("activation", True))))  # fmt: skip


def bed(protocol: Options, speed: float) -> Bed:
    """Half of the nodes are robots that go anywhere."""
    robots = [{"node": node, "random": True, "speed_mps": speed} for node in range(30 - ROBOTS, 30)]
    period: Options = (("period_max_s", 10.0),)
    return Bed(protocol=(*protocol, *period), duration_s=UNTIL_S + 2.0, more=(("robot", robots),))


def measure(of: Bed, seed: int) -> dict[str, Any]:
    """Messages among all, one a node and second."""
    plan = of.plan(seed)
    draw_ = stream(seed, "papers/senders")
    for since in range(FROM_S, UNTIL_S, EVERY_S):
        for node in range(plan.nodes):
            dest = draw_.draw(plan.nodes - 1)
            dest += dest >= node
            at = since * 1_000_000 + draw_.draw(EVERY_S * 1_000_000)
            plan.offers.append(Offer(at, node, dest, 0, BYTES, 0))
    plan.offers.sort(key=lambda offer: offer.at_us)
    result = simulate(plan)
    found = counted(messages(result))
    return {"sent": len(found.state), "came": int(np.count_nonzero(found.state == DELIVERED)),
            "looped": looped(result)}  # fmt: skip


def _key(protocol: Options, speed: float, quick: bool) -> str:
    return f"versions at {speed:g} m/s, {protocol} seeds {seeds_of(quick)}"


def points(quick: bool) -> list[Point]:
    """Both schemes over the speed, with alternates alone and with search."""
    seeds = seeds_of(quick)
    return [
        Point.of(_key(protocol, speed, quick), 0.5 * len(seeds), _all, protocol, speed, seeds)
        for _, protocol in (*SCHEMES, *SEARCHED)
        for speed in (SOME if quick else SPEEDS)
    ]


def _all(protocol: Options, speed: float, seeds: range) -> list[dict[str, Any]]:
    return [measure(bed(protocol, speed), seed) for seed in seeds]


def share(results: Results, protocol: Options, speed: float, quick: bool, name: str) -> float:
    """Of the messages sent, the share that `came` or `looped`."""
    runs = results[_key(protocol, speed, quick)]
    return float(sum(run[name] for run in runs) / sum(run["sent"] for run in runs))


def draw(results: Results, quick: bool) -> Figure:
    """Lost and looped over the speed."""
    figure, axes = style.panels(style.WIDE_IN, 2.6, 1, 2)
    speeds = SOME if quick else SPEEDS
    for i, (name, protocol) in enumerate((*SCHEMES, *SEARCHED)):
        look: dict[str, Any] = {
            "color": style.SERIES[i],
            "ls": style.DASHES[i],
            "marker": style.MARKERS[i],
        }
        come = [share(results, protocol, speed, quick, "came") for speed in speeds]
        round_ = [share(results, protocol, speed, quick, "looped") for speed in speeds]
        axes[0].plot(speeds, [100 * (1 - one) for one in come], label=name, **look)
        axes[1].plot(speeds, [100 * one for one in round_], **look)
    for ax, words, letter in zip(axes, ("lost", "visited a node twice"), "ab", strict=True):
        ax.set_xlabel("speed of half of the nodes (m/s)")
        ax.set_ylabel(f"{words} (%)")
        ax.set_ylim(bottom=0)
        ax.set_title(f"{letter}  {words}")
    axes[0].legend()
    return figure


def judge(results: Results, quick: bool) -> list[Claim]:
    """The document's silence; what two phases would give."""
    speeds = SOME if quick else SPEEDS
    words, better = [], []
    for speed in speeds:
        once, twice = (share(results, p, speed, quick, "came") for _, p in SCHEMES)
        better.append(once >= twice)
        words.append(f"{speed:g} m/s: {percent(once, 2)} against {percent(twice, 2)}")
    loops = [share(results, p, s, quick, "looped") for _, p in SCHEMES for s in speeds]
    best = [share(results, SEARCHED[0][1], s, quick, "came") for s in speeds]
    return [
        Claim(
            "1.1",
            '"builds the routing tables for all nodes and distributes them": used as they come, '
            "without waiting for the others, they deliver no less than when all change together",
            "delivered, at once against in two phases, alternates alone: " + joined(words),
            verdict(all(better), "A10"),
            "whoever waits uses a table that is older than the links"
            if all(better)
            else "A10: tables of two versions cost more here than older ones",
        ),
        Claim(
            "1.1",
            "mixed versions make packets go round",
            f"visited a node twice: at once {percent(max(loops[: len(speeds)]), 3)} at most, two "
            f"phases {percent(max(loops[len(speeds) :]), 3)}",
            verdict(max(loops) > 0.001),
            "a packet is not sent to a node that is in its path, whatever the table says",
        ),
        Claim(
            "beyond",
            "with the search it hardly matters: 0.99 of all messages come at any of these speeds",
            joined(f"{s:g} m/s: {percent(v, 2)}" for s, v in zip(speeds, best, strict=True)),
            verdict(min(best) >= 0.99),
            "" if min(best) >= 0.99 else "some robots are out of everybody's reach for a while",
        ),
    ]


EXPERIMENT = Experiment(
    "versions",
    "1.1: tables of two versions",
    "30 nodes, half of them robots that go anywhere in the square; a discovery every 10 s; "
    "everyone sends a message to somebody every second, without end-to-end acks. Lost: of all, connected or "
    "not.",
    points,
    draw,
    judge,
)
