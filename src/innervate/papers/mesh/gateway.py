"""The gateway dies: what is lost without a standby, and how soon one has made new tables."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from innervate.analysis.mesh import summarize
from innervate.analysis.mesh_messages import DELIVERED, messages
from innervate.papers.experiment import Claim, Experiment, Point, Results, verdict
from innervate.papers.mesh.bed import BYTES, GATEWAY, Bed, Options, kill
from innervate.papers.mesh.words import joined, percent, seeds_of
from innervate.plot import style
from innervate.protocol.mesh_words import END_TO_END, MONITOR
from innervate.scenario.mesh_plan import Offer
from innervate.sim.mesh.simulate import simulate
from innervate.trace.streams import stream

DIES_S = 22.0  # at the earliest; up to a discovery period later
PERIOD_S = 10
AFTER_S = 50
BIN_S = 2
SOONEST = 30.0  # seconds until there are new tables, at most


class Setting(NamedTuple):
    """Who could take over, and who dies."""

    name: str
    standbys: tuple[int, ...]
    dead: tuple[int, ...]


NONE = Setting("no standby", (), (GATEWAY,))
ONE = Setting("one standby", (1,), (GATEWAY,))
SECOND = Setting("two, the first dies too", (1, 2), (GATEWAY, 1))
SETTINGS = (NONE, ONE, SECOND)


def bed(setting: Setting) -> Bed:
    """Networks with these standbys."""
    more: Options = (("standby", list(setting.standbys)),) if setting.standbys else ()
    return Bed(duration_s=DIES_S + PERIOD_S + AFTER_S + 3, more=more)


def measure(of: Bed, seed: int, dead: tuple[int, ...]) -> dict[str, Any]:
    """Takeover; delivery to the gateway and among others, by seconds since the death."""
    plan = of.plan(seed)
    draw = stream(seed, "papers/death")
    dies_us = round(DIES_S * 1e6) + draw.draw(PERIOD_S * 1_000_000)
    kill(plan, dead, dies_us)
    others = [node for node in range(plan.nodes) if node not in dead]
    # One to the gateway and one to another node, from everyone in every bin.
    for k in range(-BIN_S, AFTER_S // BIN_S):
        for node in others:
            since = dies_us + k * BIN_S * 1_000_000
            to = [one for one in others if one != node][draw.draw(len(others) - 1)]
            for flow, dest in enumerate((MONITOR, to)):
                at = since + draw.draw(BIN_S * 1_000_000)
                plan.offers.append(Offer(at, node, dest, END_TO_END, BYTES, flow))
    plan.offers.sort(key=lambda offer: offer.at_us)
    result = simulate(plan)
    found = messages(result)
    counts = []
    for flow in range(2):
        mine = found.only(found.flow == flow)
        bins = (mine.offered_us - dies_us) // (BIN_S * 1_000_000) + BIN_S
        came = mine.state == DELIVERED
        counts.append([np.bincount(bins[came], minlength=int(bins.max()) + 1).tolist(),
                       np.bincount(bins).tolist()])  # fmt: skip
    summary = summarize(result)
    return {"takeover_s": summary["takeover_s"], "bins": counts,
            "duplicates": summary["duplicates"]}  # fmt: skip


def point(setting: Setting, seeds: range) -> Point:
    """The point of a setting."""
    return bed(setting).point(_what(setting), seeds, measure, setting.dead)


def _what(setting: Setting) -> str:
    return f"gateway dies, {setting.name}"


def told(results: Results, setting: Setting, seeds: range) -> list[dict[str, Any]]:
    """What its runs gave."""
    runs: list[dict[str, Any]] = results[bed(setting).key_of(_what(setting), seeds)]
    return runs


def takeovers(runs: list[dict[str, Any]]) -> list[float]:
    """Seconds from the death to the last node's new tables; infinite where that never came."""
    return sorted(np.inf if run["takeover_s"] is None else run["takeover_s"] for run in runs)


def points(quick: bool) -> list[Point]:
    """Every setting."""
    return [point(setting, seeds_of(quick)) for setting in SETTINGS]


def _shares(runs: list[dict[str, Any]], flow: int) -> tuple[Any, Any]:
    """(seconds since the death, share delivered) of every bin."""
    came, sent = np.sum([run["bins"][flow] for run in runs], axis=0)
    return (np.arange(len(sent)) - BIN_S + 0.5) * BIN_S, came / np.maximum(sent, 1)


def draw(results: Results, quick: bool) -> Figure:
    """Delivery over the time since the death; times to new tables."""
    figure, (left, right) = style.panels(style.WIDE_IN, 2.6, 1, 2, width_ratios=(1.5, 1))
    seeds = seeds_of(quick)
    for i, setting in enumerate(SETTINGS):
        runs = told(results, setting, seeds)
        x, y = _shares(runs, 0)
        left.plot(x, 100 * y, color=style.SERIES[i], ls=style.DASHES[i], marker=style.MARKERS[i],
                  markevery=(3 + i, 5), label=f"to the gateway, {setting.name}")  # fmt: skip
    x, y = _shares(told(results, NONE, seeds), 1)
    left.plot(x, 100 * y, color=style.SOFT, ls=":", label="among others, no standby")
    left.axvline(0, color=style.INK, lw=0.8)
    left.set_ylim(-4, 150)
    left.set_yticks(range(0, 101, 20))
    left.set_xlabel("offered so long after the death (s)")
    left.set_ylabel("delivered (%)")
    left.set_title("a  messages")
    left.legend(loc="upper center", ncols=2)
    _times(right, results, seeds)
    return figure


def _times(ax: Axes, results: Results, seeds: range) -> None:
    for i, setting in enumerate(SETTINGS[1:], 1):
        times = takeovers(told(results, setting, seeds))
        share = 100 * np.arange(1, len(times) + 1) / len(times)
        ax.step(times, share, where="post", color=style.SERIES[i], ls=style.DASHES[i],
                label=setting.name)  # fmt: skip
    ax.axvline(SOONEST, color=style.INK, lw=0.8, ls=":")
    ax.annotate("asked for", (SOONEST, 4), xytext=(3, 0), textcoords="offset points")
    ax.set_xlim(20, 40)
    ax.set_ylim(0, 130)
    ax.set_yticks(range(0, 101, 20))
    ax.set_xlabel("last new table after the death (s)")
    ax.set_ylabel("networks (%)")
    ax.set_title("b  new tables")
    ax.legend(loc="upper left")


def judge(results: Results, quick: bool) -> list[Claim]:
    """The document's single gateway; ours."""
    seeds = seeds_of(quick)
    none = told(results, NONE, seeds)
    gone, after = (_shares(none, flow)[1][BIN_S + 1 :] for flow in range(2))
    rows = [
        Claim(
            "1.1",
            "the routing tables are computed centrally, by the gateway node: the network outlives "
            "the gateway",
            f"no standby, {AFTER_S} s after its death: {percent(gone.mean())} of the messages to "
            f"the gateway, {percent(after.mean(), 1)} of those among others are delivered; "
            f"{len(none)} networks",
            verdict(gone.mean() > 0.9),
            "tables in place keep forwarding, but whatever is for the gateway or monitor is lost "
            "for good, nobody can join, failures are bypassed and never repaired",
        )
    ]
    for setting in SETTINGS[1:]:
        runs = told(results, setting, seeds)
        times = takeovers(runs)
        late = _shares(runs, 0)[1][-5:].mean()
        rows.append(
            Claim(
                "beyond",
                f"a standby makes new tables within {SOONEST:g} s of the gateway's death"
                if setting is ONE
                else "if the first standby dies with it, the second does, 5 s later",
                f"median {np.median(times):.1f} s, at most {times[-1]:.1f} s; then "
                f"{percent(late, 1)} of the messages to the gateway come; {len(times)} networks",
                verdict(times[-1] <= SOONEST + 5 * (setting is SECOND)),
                "25 s of that is waiting: 2.5 periods without a request, 5 s more for each rank",
            )
        )
    twice = sum(run["duplicates"] for setting in SETTINGS for run in told(results, setting, seeds))
    rows.append(
        Claim(
            "beyond",
            "no message is delivered twice, to the old gateway or the new one",
            f"{twice} of {joined([s.name for s in SETTINGS])}",
            verdict(twice == 0),
        )
    )
    return rows


EXPERIMENT = Experiment(
    "gateway",
    "1.1: the gateway dies",
    "30 nodes; the gateway is switched off at some moment of a discovery period. a: messages of "
    "everyone to the gateway (whoever it is) and to others. b: until the last node has the new "
    "gateway's table.",
    points,
    draw,
    judge,
)
