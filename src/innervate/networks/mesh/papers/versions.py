"""Section 1.1: tables of two versions at the same time; robots move meanwhile."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.figure import Figure

from innervate.networks.mesh.analysis.messages import DELIVERED, counted, messages
from innervate.networks.mesh.analysis.summary import looped
from innervate.networks.mesh.papers.testbed import BYTES, MeshTestbed, Options
from innervate.networks.mesh.papers.words import FEW, joined, percent
from innervate.networks.mesh.scenario.plan import Offer
from innervate.networks.mesh.sim.simulate import simulate
from innervate.papers.experiment import Claim, Experiment, Point, Results, verdict
from innervate.plot import style
from innervate.trace.streams import stream

SPEEDS = (0.1, 0.5, 1.0, 2.0)
SOME = (0.5, 2.0)
ROBOTS = 15
FROM_S, UNTIL_S, EVERY_S = 8, 108, 1
TOPOLOGIES = range(1, 16)
TWO: Options = (("activation", True),)
# Alternates alone, and the document's rule with three transmissions, which takes no notice of
# where a packet has been: a search would find its way by any table.
ALTERNATES: Options = (("failover", "alternate"), ("reliable", False))
RANDOM: Options = (("failover", "random"), ("reliable", False))
SEARCH: Options = (("failover", "search"), ("reliable", False))
PAIRS = ((ALTERNATES, (*ALTERNATES, *TWO)), (RANDOM, (*RANDOM, *TWO)))
SCHEMES = (
    ("alternates, at once", PAIRS[0][0]), ("alternates, two phases", PAIRS[0][1]),
    ("random, at once", PAIRS[1][0]), ("random, two phases", PAIRS[1][1]),
    ("search, at once", SEARCH),
)  # fmt: skip


def seeds_of(quick: bool) -> range:
    """Seeds of the networks, each of which has fifteen robots."""
    return FEW if quick else TOPOLOGIES


def make_testbed(protocol: Options, speed: float) -> MeshTestbed:
    """Half of the nodes are robots that go anywhere."""
    robots = [{"node": node, "random": True, "speed_mps": speed} for node in range(30 - ROBOTS, 30)]
    period: Options = (("period_max_s", 10.0),)
    return MeshTestbed(
        protocol=(*protocol, *period), duration_s=UNTIL_S + 2.0, more=(("robot", robots),)
    )


def measure(of: MeshTestbed, seed: int) -> dict[str, Any]:
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
    """Every scheme over the speed."""
    seeds = seeds_of(quick)
    return [
        Point.of(_key(protocol, speed, quick), 0.5 * len(seeds), _all, protocol, speed, seeds)
        for _, protocol in SCHEMES
        for speed in (SOME if quick else SPEEDS)
    ]


def _all(protocol: Options, speed: float, seeds: range) -> list[dict[str, Any]]:
    return [measure(make_testbed(protocol, speed), seed) for seed in seeds]


def share(results: Results, protocol: Options, speed: float, quick: bool, name: str) -> float:
    """Of the messages sent, the share that `came` or `looped`."""
    runs = results[_key(protocol, speed, quick)]
    return float(sum(run[name] for run in runs) / sum(run["sent"] for run in runs))


def draw(results: Results, quick: bool) -> Figure:
    """Lost and looped over the speed."""
    figure, axes = style.panels(style.WIDE_IN, 2.9, 1, 2)
    speeds = SOME if quick else SPEEDS
    for i, (name, protocol) in enumerate(SCHEMES):
        look: dict[str, Any] = {
            "color": style.SERIES[i],
            "ls": style.DASHES[i % 4],
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
    handles, labels = axes[0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside lower left", ncols=3)
    return figure


def judge(results: Results, quick: bool) -> list[Claim]:
    """The document's silence; what two phases would give."""
    speeds = SOME if quick else SPEEDS
    best = [share(results, SEARCH, s, quick, "came") for s in speeds]
    return [
        *(_at_once(results, quick, i) for i in range(len(PAIRS))),
        _loops(results, quick),
        Claim(
            "beyond",
            "with the search it hardly matters: 0.99 of all messages come at any of these speeds",
            joined(f"{s:g} m/s: {percent(v, 2)}" for s, v in zip(speeds, best, strict=True)),
            verdict(min(best) >= 0.99),
            "" if min(best) >= 0.99 else "some robots are out of everybody's reach for a while",
        ),
    ]


def _at_once(results: Results, quick: bool, pair: int) -> Claim:
    words, better = [], []
    for speed in SOME if quick else SPEEDS:
        once, twice = (share(results, p, speed, quick, "came") for p in PAIRS[pair])
        better.append(once >= twice - 0.001)
        words.append(f"{speed:g} m/s: {percent(once, 2)} against {percent(twice, 2)}")
    return Claim(
        "1.1",
        '"builds the routing tables for all nodes and distributes them": used as they come they '
        "deliver no less than when all change together, "
        + ("alternates alone" if pair == 0 else "by the document's rule"),
        "delivered, at once against in two phases: " + joined(words),
        verdict(all(better), "A10"),
        "whoever waits uses a table that is older than the links"
        if all(better)
        else "A10: tables of two versions cost more here than older ones",
    )


def _loops(results: Results, quick: bool) -> Claim:
    speeds = SOME if quick else SPEEDS
    once, twice, other, late = (
        max(share(results, protocol, speed, quick, "looped") for speed in speeds)
        for _, protocol in SCHEMES[:4]
    )
    return Claim(
        "1.1",
        "two phases keep packets from going round",
        f"visited a node twice, at most: alternates {percent(once, 2)} at once, "
        f"{percent(twice, 2)} in two phases; random {percent(other, 2)} and {percent(late, 2)}",
        verdict(late < other / 2),
        "A9: who replaces next hops at random makes loops whatever the version; whoever looks at "
        "the path sends nothing back, whatever the table says",
    )


EXPERIMENT = Experiment(
    "versions",
    "1.1: tables of two versions",
    "30 nodes, half of them robots that go anywhere in the square; a discovery every 10 s. "
    "Everyone sends a message to somebody every second, without end-to-end acks. Lost: of all, "
    "connected or not.",
    points,
    draw,
    judge,
)
