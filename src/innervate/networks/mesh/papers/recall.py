"""Section 1.1: how much of the network a discovery round finds, by reading and by jitter."""

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from innervate.networks.mesh.analysis.summary import summarize
from innervate.networks.mesh.papers import uplinks
from innervate.networks.mesh.papers.document import RESPONDS, ours, said
from innervate.networks.mesh.papers.testbed import MeshTestbed, seeds
from innervate.networks.mesh.protocol.constants import REQUEST, RESPONSE
from innervate.networks.mesh.scenario.plan import ONE
from innervate.papers import drawing
from innervate.papers.experiment import Claim, Claims, Measured, Point, sized, verdict
from innervate.papers.words import joined, percent
from innervate.plot import style

TITLE = "1.1: what a discovery round finds"
CAPTION = (
    "Mean degree 8; shaded: from the worst network to the best. Recall: share of the good links "
    "that the gateway knows after its first round."
)
USUAL_MS = 100
SOME_MS = (1, 10, 100)
# Longest wait before a request is repeated, ms; sizes of the networks, in nodes.
jitters = sized(SOME_MS, (1, 2, 5, 10, 20, 50, 100, 200))
sizes = sized((10, 20, 30), (10, 20, 30, 45, 60))
# Readings of "responds to the request".
READINGS = {"tree": "once a round", "each": "to every request", "list": "once, with all it hears"}


def point(quick: bool, reading: str, jitter_ms: int = USUAL_MS, nodes: int = 30) -> Point:
    """Networks that run one discovery round of a reading, and send nothing."""
    protocol = (("discovery", reading), ("jitter_s", jitter_ms / 1000))
    return MeshTestbed(nodes, protocol=protocol, duration_s=8.0).point(
        "round", seeds(quick), measure
    )


def points(quick: bool) -> list[Point]:
    """Readings over the jitter, and over the size."""
    made = [point(quick, reading, ms) for reading in READINGS for ms in jitters(quick)]
    others = [n for n in sizes(quick) if n != 30]
    made += [point(quick, reading, nodes=n) for reading in READINGS for n in others]
    return [*made, first_ones(quick), *(other_uplink(quick, reading) for reading in READINGS)]


def uplink_of(reading: str) -> str:
    """The next hop to the gateway that a reading of responses takes if nothing is said [A2]."""
    return "best" if reading == "list" else "first"


def other_uplink(quick: bool, reading: str) -> Point:
    """The same networks with the other next hop."""
    uplink = "first" if uplink_of(reading) == "best" else "best"
    protocol = (("discovery", reading), ("uplink", uplink))
    return MeshTestbed(protocol=protocol, duration_s=8.0).point("round", seeds(quick), measure)


def first_ones(quick: bool) -> Point:
    """The same networks with discovery tree: whom nodes heard first, and who is the best."""
    testbed = MeshTestbed(protocol=(("discovery", "tree"),), duration_s=8.0)
    return testbed.point("first and best", seeds(quick), uplinks.measure)


def measure(of: MeshTestbed, seed: int) -> dict[str, Any]:
    """What the first round found of the links, what it cost, and what of it was heard."""
    result = of.run(seed)
    found = summarize(result)["discovery"]
    kept = {name: found[name] for name in ("recall", "airtime_s", "with_tables")}
    return kept | {"requests": heard(result, REQUEST), "responses": heard(result, RESPONSE)}


def heard(result: Any, kind: int) -> list[float]:
    """[receptions of frames of a kind, how many an idle channel would have given, frames]."""
    plan, sent = result.plan, result.sent[result.sent["kind"] == kind]
    idle = np.array(plan.radio.prob_q15).reshape(plan.nodes, plan.nodes).sum(axis=1) / ONE
    return [int(sent["receivers"].sum()), round(float(idle[sent["node"]].sum()), 1), len(sent)]


def told(got: Measured, name: str, reading: str, *case: int, **more: int) -> Any:
    """A number of every network."""
    return got[point(got.quick, reading, *case, **more)][name]


def draw(got: Measured) -> Figure:
    """Recall over the jitter, over the size; airtime of a round."""
    figure, axes = style.panels(style.WIDE_IN, 2.8, 1, 3)
    ms, ns = jitters(got.quick), sizes(got.quick)
    for i, reading in enumerate(READINGS):
        _line(axes[0], i, ms, [told(got, "recall", reading, one) for one in ms])
        _line(axes[1], i, ns, [told(got, "recall", reading, nodes=n) for n in ns])
        spent = [np.mean(told(got, "airtime_s", reading, nodes=n)) for n in ns]
        axes[2].plot(ns, spent, **style.look(i))
    axes[0].set_xscale("log")
    axes[0].set_xticks(SOME_MS, [str(ms) for ms in SOME_MS])
    axes[0].set(xlabel="jitter of requests (ms)", title="a  30 nodes")
    axes[1].set(xlabel="nodes N", title=f"b  {USUAL_MS} ms")
    for ax in axes[:2]:
        ax.set(ylim=(0, 1.04), ylabel="links found (recall)")
    axes[2].set(yscale="log", xlabel="nodes N", ylabel="airtime of all together (s)",
                title="c  what a round costs")  # fmt: skip
    drawing.legend(figure, axes[0], ncols=3)
    return figure


def _line(ax: Axes, i: int, x: Any, found: list[list[float]]) -> None:
    reading = list(READINGS)[i]
    low, high = ([end(values) for values in found] for end in (min, max))
    ax.fill_between(x, low, high, color=style.SERIES[i], alpha=0.15, lw=0)
    ax.plot(x, [np.mean(values) for values in found], label=f"{reading}: {READINGS[reading]}",
            **style.look(i))  # fmt: skip


def judge(got: Measured) -> Claims:
    """The three readings; the text's silence on jitter; what it costs; whence it came first."""
    for reading, words in READINGS.items():
        recalls = told(got, "recall", reading)
        without = sum(count < 30 for count in told(got, "with_tables", reading))
        yield said(
            RESPONDS,
            f"{words} ({reading}): the gateway knows the graph (our bar: recall 0.98)",
            f"recall {np.mean(recalls):.3f} in the mean, {min(recalls):.3f} to {max(recalls):.3f}; "
            f"{without} of {len(recalls)} networks had nodes without a table",
            verdict(np.mean(recalls) >= 0.98, *(["A1"] if reading == "list" else [])),
            _why(got, reading),
        )
    yield _soon(got)
    yield _cost(got)
    yield _first(got)


def _why(got: Measured, reading: str) -> str:
    if reading == "tree":
        best = got[other_uplink(got.quick, "tree")]
        return (
            "A1: a tree has N - 1 links of about 4 N, so that 0.24 is the most; A2: with the best "
            f"uplink, not the first, {_found(best)}"
        )
    of = _heard(got, "requests" if reading == "list" else "responses", reading)
    return f"A1: {of} of what an idle channel would carry"


def _found(runs: dict[str, Any]) -> str:
    """What a round found in all networks."""
    without = sum(count < 30 for count in runs["with_tables"])
    return f"recall {np.mean(runs['recall']):.3f}, nodes without a table in {without} networks"


def _heard(got: Measured, kind: str, reading: str, *case: int) -> str:
    """How many frames of a kind there were in a round, and what share of them was heard."""
    came, idle, frames = np.mean(told(got, kind, reading, *case), axis=0)
    return f"{frames:.0f} {kind} are sent in a round, heard {percent(came / idle)}"


def _soon(got: Measured) -> Claim:
    soon = [ms for ms in jitters(got.quick) if ms <= 5]
    means = [float(np.mean(told(got, "recall", "list", ms))) for ms in soon]
    early, late = (_heard(got, "requests", "list", ms) for ms in (soon[0], USUAL_MS))
    return ours(
        "1.1",
        'to broadcast "the same discovery request packet" at once, or within a few ms, is good '
        "enough (recall 0.98); the document says no time",
        joined(f"{ms} ms: recall {mean:.3f}" for ms, mean in zip(soon, means, strict=True))
        + f"; {USUAL_MS} ms: {np.mean(told(got, 'recall', 'list')):.3f} (list)",
        verdict(min(means) >= 0.98),
        f"neighbours that heard the same request repeat it at the same time: {early} of what an "
        f"idle channel would carry; {USUAL_MS} ms: {late}",
    )


def _cost(got: Measured) -> Claim:
    spent = {reading: float(np.mean(told(got, "airtime_s", reading))) for reading in READINGS}
    return ours(
        "1.1",
        "to respond to every request costs little more than to respond once (1.5 times)",
        joined(f"{reading} {value:.2f} s" for reading, value in spent.items())
        + f" on the air in a round of 30 nodes; each is {spent['each'] / spent['list']:.1f} times "
        f"list, and {percent(spent['each'] / 10)} of a period of 10 s",
        verdict(spent["each"] < 1.5 * spent["list"]),
        f"A1: {_heard(got, 'responses', 'each')}; once: {_heard(got, 'responses', 'list')}",
    )


def _first(got: Measured) -> Claim:
    words, worse = [], []
    for reading in READINGS:
        pair = [got[point(got.quick, reading)], got[other_uplink(got.quick, reading)]]
        first, best = pair if uplink_of(reading) == "first" else pair[::-1]
        words.append(f"{reading}: first {_found(first)}, best {_found(best)}")
        worse.append(np.mean(first["recall"]) < np.mean(best["recall"]) - 0.02)
    ones = got[first_ones(got.quick)]
    nodes, other, first_good, best_good = (sum(ones[name]) for name in uplinks.COUNTS)
    return ours(
        "1.1",
        'of "the source node it came from: this is the next hop to the gateway" it hardly matters '
        "whether it is the first or the best (0.02 of recall); that tree and each take the first "
        "and list the best is a choice of ours",
        f"{joined(words, '; ')}; of {len(ones['nodes'])} each",
        verdict(not any(worse)),
        f"A2: in rounds of tree {percent(other / nodes)} of the nodes heard a better one that is "
        f"nearer, too; the link to the first is good for {percent(first_good / nodes)}, to the "
        f"best for {percent(best_good / nodes)}",
    )
