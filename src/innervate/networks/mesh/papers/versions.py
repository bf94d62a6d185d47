"""Section 1.1: tables of two versions at the same time; robots move meanwhile."""

from typing import Any

import numpy as np
from matplotlib.figure import Figure

from innervate.networks.mesh.analysis.messages import DELIVERED, counted, messages
from innervate.networks.mesh.analysis.summary import looped
from innervate.networks.mesh.papers.document import beyond, ours
from innervate.networks.mesh.papers.testbed import HOPS, MeshTestbed, Options, send_anywhere
from innervate.networks.mesh.protocol.constants import REPORT_ROUND, REPORT_TABLE
from innervate.networks.mesh.sim.simulate import simulate
from innervate.papers import drawing
from innervate.papers.experiment import Claims, Measured, Point, sized, verdict
from innervate.papers.words import joined, percent
from innervate.plot import style

TITLE = "1.1: tables of two versions"
CAPTION = (
    "30 nodes, half of them robots that go anywhere in the square; a discovery every 10 s. "
    "Everyone sends a message to somebody every second, without end-to-end acks. Lost: of all, "
    "connected or not."
)
ROBOTS = 15
FROM_S, UNTIL_S, EVERY_S = 8, 108, 1
speeds = sized((0.5, 2.0), (0.1, 0.5, 1.0, 2.0))  # of robots, metres a second
TWO: Options = (("activation", True),)
# Alternates alone, and the document's rule with three transmissions, which takes no notice of
# where a packet has been: a search would find its way by any table.
ALTERNATES, RANDOM, SEARCH = (
    (("failover", failover), *HOPS) for failover in ("alternate", "random", "search")
)
SCHEMES: dict[str, Options] = {
    "alternates, at once": ALTERNATES,
    "alternates, two phases": (*ALTERNATES, *TWO),
    "random, at once": RANDOM,
    "random, two phases": (*RANDOM, *TWO),
    "search, at once": SEARCH,
}


def point(scheme: str, speed: float, quick: bool) -> Point:
    """Half of the nodes are robots that go anywhere."""
    robots = [{"node": node, "random": True, "speed_mps": speed} for node in range(30 - ROBOTS, 30)]
    protocol: Options = (*SCHEMES[scheme], ("period_max_s", 10.0))
    testbed = MeshTestbed(protocol=protocol, duration_s=UNTIL_S + 2.0, more=(("robot", robots),))
    what = f"versions at {speed:g} m/s, {scheme}"
    return Point.each(what, 0.5, 4 if quick else 15, measure, testbed)


def points(quick: bool) -> list[Point]:
    """Every scheme over the speed."""
    return [point(scheme, speed, quick) for scheme in SCHEMES for speed in speeds(quick)]


def measure(of: MeshTestbed, seed: int) -> dict[str, Any]:
    """Messages among all, one a node and second."""
    plan = of.plan(seed)
    send_anywhere(plan, FROM_S, UNTIL_S, EVERY_S)
    result = simulate(plan)
    found = counted(messages(result))
    return {"sent": len(found.state), "came": int(np.count_nonzero(found.state == DELIVERED)),
            "looped": looped(result), "waits_s": _waits(result)}  # fmt: skip


def _waits(result: Any) -> float:
    """From the beginning of a round to when a node uses its table, s, in the mean."""
    rows = result.rows
    begun, used = (rows["time"][rows["code"] == code] for code in (REPORT_ROUND, REPORT_TABLE))
    since = begun[np.searchsorted(begun, used, "right") - 1]
    return round(float(np.mean(used - since)) / 1e6, 3)


def values(got: Measured, scheme: str, name: str) -> list[list[float]]:
    """A number of every network, at each speed."""
    return [got[point(scheme, speed, got.quick)][name] for speed in speeds(got.quick)]


def shares(got: Measured, scheme: str, name: str) -> list[float]:
    """Of the messages sent at each speed, the share that `came` or `looped`."""
    both = zip(values(got, scheme, name), values(got, scheme, "sent"), strict=True)
    return [sum(some) / sum(sent) for some, sent in both]


def draw(got: Measured) -> Figure:
    """Lost and looped over the speed."""
    figure, axes = style.panels(style.WIDE_IN, 2.9, 1, 2)
    for i, scheme in enumerate(SCHEMES):
        lost = [100 * (1 - one) for one in shares(got, scheme, "came")]
        axes[0].plot(speeds(got.quick), lost, label=scheme, **style.look(i))
        round_ = [100 * one for one in shares(got, scheme, "looped")]
        axes[1].plot(speeds(got.quick), round_, **style.look(i))
    for ax, words, letter in zip(axes, ("lost", "visited a node twice"), "ab", strict=True):
        ax.set(xlabel="speed of half of the nodes (m/s)", ylabel=f"{words} (%)",
               title=f"{letter}  {words}")  # fmt: skip
        ax.set_ylim(bottom=0)
    drawing.legend(figure, axes[0], ncols=3)
    return figure


def judge(got: Measured) -> Claims:
    """The document's silence; what two phases would give."""
    places = [f"{speed:g} m/s" for speed in speeds(got.quick)]
    for rule, words in (("alternates", "alternates alone"), ("random", "by the document's rule")):
        both = [f"{rule}, {when}" for when in ("at once", "two phases")]
        once, twice = (shares(got, scheme, "came") for scheme in both)
        better = all(a >= b - 0.001 for a, b in zip(once, twice, strict=True))
        pairs = (
            f"{at}: {percent(a, 2)} against {percent(b, 2)}"
            for at, a, b in zip(places, once, twice, strict=True)
        )
        waits = [np.mean(values(got, scheme, "waits_s")) for scheme in both]
        yield ours(
            "1.1",
            "tables that are used as they come deliver no less (0.001) than if all change "
            f"together, {words}; the document says nothing of that",
            "delivered, at once against in two phases: " + joined(pairs),
            verdict(better, "A10"),
            f"A10: a table is in use {waits[0]:.1f} s after its round began, in two phases "
            f"{waits[1]:.1f} s; which part of the difference that makes is not known",
        )
    first, second, other, late = (max(shares(got, name, "looped")) for name in list(SCHEMES)[:4])
    yield ours(
        "1.1",
        "two phases keep packets from going round (half as many)",
        f"visited a node twice, at most: alternates {percent(first, 2)} at once, "
        f"{percent(second, 2)} in two phases; random {percent(other, 2)} and {percent(late, 2)}",
        verdict(late < other / 2),
        "A9: who replaces next hops at random makes loops in both; alternates alone, which send "
        "nothing to who is in the path, make none to speak of in either",
    )
    best = shares(got, "search, at once", "came")
    yield beyond(
        "with the search it hardly matters: 0.99 of all messages come at any of these speeds",
        joined(f"{at}: {percent(one, 2)}" for at, one in zip(places, best, strict=True)),
        verdict(min(best) >= 0.99),
        "" if min(best) >= 0.99 else "not known why; who was out of reach was not looked at",
    )
