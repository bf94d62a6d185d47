"""Section 2.2: frames get lost, nobody dies; what a rule that takes loss for death does."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.figure import Figure

from innervate.networks.mesh.analysis.messages import DELIVERED, messages
from innervate.networks.mesh.analysis.paths import Ground, distances
from innervate.networks.mesh.papers.sending import DOCUMENT, GRAPH, SEARCH, Rule
from innervate.networks.mesh.papers.testbed import BYTES, MeshTestbed, Options
from innervate.networks.mesh.papers.words import joined, percent, seeds_of
from innervate.networks.mesh.protocol.constants import END_TO_END
from innervate.networks.mesh.scenario.plan import ONE, Offer
from innervate.networks.mesh.sim.simulate import simulate
from innervate.papers.experiment import Claim, Experiment, Point, Results, verdict
from innervate.plot import style
from innervate.sim.tables import get
from innervate.topology.placement import UNHEARD
from innervate.trace.streams import stream

LOSSES = (0, 1, 2, 5, 10, 20)
SOME = (0, 5)
FIVE = 5
FROM_S, UNTIL_S, BIN_S = 8, 68, 5
EVERY_S = 2  # one message from everyone, to somebody drawn anew
NONE = 255
THREE = Rule("document, three transmissions", (*DOCUMENT.protocol[:-1], ("transmissions", 3)))
PLAIN_SEARCH = Rule("search", (*SEARCH.protocol, ("reliable", False)))
PLAIN_GRAPH = Rule("graph", (*GRAPH.protocol, ("reliable", False)))
RULES = (DOCUMENT, THREE, PLAIN_SEARCH, PLAIN_GRAPH)


def make_testbed(rule: Rule) -> MeshTestbed:
    """Networks whose gateway goes on looking every 10 s, as it always does."""
    more: Options = rule.protocol
    return MeshTestbed(protocol=more, duration_s=UNTIL_S + 2.0)


def measure(of: MeshTestbed, seed: int, loss: int) -> dict[str, Any]:
    """Delivery over time; entries of the tables that lead away or nowhere at the end."""
    plan = of.plan(seed)
    _soften(plan, loss)
    draw_ = stream(seed, "papers/senders")
    flags = END_TO_END if plan.params["reliable"] else 0
    for since in range(FROM_S, UNTIL_S, EVERY_S):
        for node in range(plan.nodes):
            dest = draw_.draw(plan.nodes - 1)
            dest += dest >= node
            at = since * 1_000_000 + draw_.draw(EVERY_S * 1_000_000)
            plan.offers.append(Offer(at, node, dest, flags, BYTES, 0))
    plan.offers.sort(key=lambda offer: offer.at_us)
    result = simulate(plan)
    found = messages(result)
    bins = (found.offered_us // 1_000_000 - FROM_S) // BIN_S
    came = found.state == DELIVERED
    return {
        "sent": np.bincount(bins).tolist(),
        "came": np.bincount(bins[came], minlength=int(bins.max()) + 1).tolist(),
        "wrong": _wrong(result),
    }


def _soften(plan: Any, loss: int) -> None:
    """Good links lose so many percent of their frames each way, and there are no others."""
    radio, count = plan.radio, plan.nodes
    good = {pair for a, b in plan.good for pair in ((a, b), (b, a))}
    for a in range(count):
        for b in range(count):
            if (a, b) in good:
                radio.prob_q15[a * count + b] = ONE - ONE * loss // 100
            else:
                radio.prob_q15[a * count + b], radio.rssi_cdb[a * count + b] = 0, UNHEARD


def _wrong(result: Any) -> float:
    """Share of the tables' entries whose next hop is not one hop nearer."""
    plan, world = result.plan, result.world
    near = Ground(plan).near_at(result.ended_us)
    far = [distances(near, node) for node in range(plan.nodes)]
    width, wrong = plan.params["width"], 0
    for node in range(plan.nodes):
        bank = int(get(world.nodes, node, "bank")) * width
        row = np.asarray(get(world.nodes, node, "next"))[bank : bank + plan.nodes].tolist()
        for dest, way in enumerate(row):
            if dest != node:
                wrong += way == NONE or far[way][dest] != far[node][dest] - 1
    return float(wrong / (plan.nodes * (plan.nodes - 1)))


def _losses(quick: bool) -> tuple[int, ...]:
    return SOME if quick else LOSSES


def points(quick: bool) -> list[Point]:
    """Every rule over the loss."""
    return [
        make_testbed(rule).point(f"lossy {loss} %", seeds_of(quick), measure, loss)
        for rule in RULES
        for loss in _losses(quick)
    ]


def told(results: Results, rule: Rule, loss: int, quick: bool) -> list[dict[str, Any]]:
    """What was measured of a rule at a loss in percent, one dict for each seed."""
    runs: list[dict[str, Any]] = results[
        make_testbed(rule).key_of(f"lossy {loss} %", seeds_of(quick))
    ]
    return runs


def over_time(results: Results, rule: Rule, loss: int, quick: bool) -> Any:
    """Share delivered of what was offered in each span."""
    runs = told(results, rule, loss, quick)
    return sum(np.array(run["came"]) for run in runs) / sum(np.array(run["sent"]) for run in runs)


def delivered(results: Results, rule: Rule, loss: int, quick: bool) -> float:
    """Share delivered over all the time."""
    runs = told(results, rule, loss, quick)
    return float(sum(sum(r["came"]) for r in runs) / sum(sum(r["sent"]) for r in runs))


def wrong(results: Results, rule: Rule, loss: int, quick: bool) -> float:
    """Share of entries that lead away or nowhere, at the end."""
    return float(np.mean([run["wrong"] for run in told(results, rule, loss, quick)]))


def draw(results: Results, quick: bool) -> Figure:
    """Over time at five percent; over the loss; tables at the end."""
    figure, axes = style.panels(style.WIDE_IN, 2.7, 1, 3)
    losses = _losses(quick)
    for i, rule in enumerate(RULES):
        look: dict[str, Any] = {
            "color": style.SERIES[i],
            "ls": style.DASHES[i],
            "marker": style.MARKERS[i],
        }
        y = over_time(results, rule, FIVE, quick)
        x = (np.arange(len(y)) + 0.5) * BIN_S
        axes[0].plot(x, 100 * y, label=rule.name, **look)
        axes[1].plot(losses, [100 * delivered(results, rule, k, quick) for k in losses], **look)
        if rule is not PLAIN_GRAPH:
            axes[2].plot(losses, [100 * wrong(results, rule, k, quick) for k in losses], **look)
    axes[0].set_xlabel("since the tables (s)")
    axes[0].set_ylabel("delivered (%)")
    axes[0].set_title(f"a  {FIVE} % of the frames lost")
    axes[1].set_xlabel("frames lost (%)")
    axes[1].set_ylabel("delivered within 60 s (%)")
    axes[1].set_title("b  over the loss")
    axes[2].set_xlabel("frames lost (%)")
    axes[2].set_ylabel("entries (%)")
    axes[2].set_title("c  wrong entries after 60 s")
    for ax in axes:
        ax.set_ylim(-3, 104)
    handles, labels = axes[0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside lower left", ncols=4)
    return figure


def judge(results: Results, quick: bool) -> list[Claim]:
    """Claims on tables under loss: one transmission, three of them, our rules."""
    rows = []
    for rule, words in (
        (DOCUMENT, '"If A does not get an ack from B for this packet, then A updates its routing '
         'table to no longer list B": the tables stay right while nobody dies'),
        (THREE, "the same after three transmissions without an ack"),
    ):  # fmt: skip
        share = wrong(results, rule, FIVE, quick)
        still = wrong(results, rule, 0, quick)
        late = over_time(results, rule, FIVE, quick)[-1]
        rows.append(Claim(
            "2.2", words,
            f"{FIVE} % of the frames lost, after 60 s: {percent(share)} of the entries lead away "
            f"or nowhere, {percent(late)} of the messages come; without loss but for collisions "
            f"{percent(still)} wrong, {percent(delivered(results, rule, 0, quick), 1)} come",
            verdict(share < 0.05 and late > 0.95),
            "A3, A5: every loss is a death; the gateway does not send a table again that has not "
            "changed for it, so what is wrong stays wrong",
        ))  # fmt: skip
    losses = _losses(quick)
    for rule in (PLAIN_SEARCH, PLAIN_GRAPH):
        shares = [delivered(results, rule, k, quick) for k in losses]
        rows.append(Claim(
            "beyond", f"{rule.name}: suspicion for 10 s instead, the table stays as it is; all "
            f"messages come at {FIVE} % (0.99), without end-to-end acks",
            joined(f"{k} %: {percent(s, 2)}" for k, s in zip(losses, shares, strict=True)),
            verdict(shares[losses.index(FIVE)] >= 0.99),
        ))  # fmt: skip
    return rows


EXPERIMENT = Experiment(
    "lossy",
    "2.2: frames get lost, and nobody dies",
    "30 nodes, links of equal quality; everyone sends a message to somebody every 2 s, the gateway "
    "looks for changes every 10 s and longer. Wrong: the next hop is not one hop nearer.",
    points,
    draw,
    judge,
)
