"""Section 2.2: frames get lost, nobody dies; what a rule that takes loss for death does."""

from typing import Any

import numpy as np
from matplotlib.figure import Figure

from innervate.networks.mesh.analysis.messages import DELIVERED, messages
from innervate.networks.mesh.analysis.paths import Ground
from innervate.networks.mesh.papers.document import RELIABLE, beyond, ours, said
from innervate.networks.mesh.papers.failures import DOCUMENT, GRAPH, SEARCH, Rule
from innervate.networks.mesh.papers.testbed import HOPS, MeshTestbed, seeds, send_anywhere
from innervate.networks.mesh.protocol.constants import REPORT_TABLE
from innervate.networks.mesh.scenario.plan import ONE
from innervate.networks.mesh.sim.simulate import simulate
from innervate.papers import drawing
from innervate.papers.experiment import Claims, Measured, Point, sized, verdict
from innervate.papers.words import joined, percent
from innervate.plot import style
from innervate.sim.tables import get
from innervate.topology.placement import UNHEARD, distances

TITLE = "2.2: frames get lost, and nobody dies"
CAPTION = (
    "30 nodes, links of equal quality; everyone sends a message to somebody every 2 s, the gateway "
    "looks for changes every 10 s and longer. Wrong: the next hop is not one hop nearer."
)
FIVE = 5
FROM_S, UNTIL_S, BIN_S = 8, 68, 5
EVERY_S = 2  # one message from everyone, to somebody drawn anew
NONE = 255
losses = sized((0, 5), (0, 1, 2, 5, 10, 20))  # shares of frames lost, in percent
THREE = Rule("document, three transmissions", (*DOCUMENT.protocol[:-1], ("transmissions", 3)))
PLAIN_SEARCH = Rule("search", (*SEARCH.protocol, *HOPS))
PLAIN_GRAPH = Rule("graph", (*GRAPH.protocol, *HOPS))
RULES = (DOCUMENT, THREE, PLAIN_SEARCH, PLAIN_GRAPH)


def point(rule: Rule, loss: int, quick: bool) -> Point:
    """Networks whose gateway goes on looking every 10 s, as it always does."""
    testbed = MeshTestbed(protocol=rule.protocol, duration_s=UNTIL_S + 2.0)
    return testbed.point(f"lossy {loss} %", seeds(quick), measure, loss)


def points(quick: bool) -> list[Point]:
    """Every rule over the loss."""
    return [point(rule, loss, quick) for rule in RULES for loss in losses(quick)]


def measure(of: MeshTestbed, loss: int, seed: int) -> dict[str, Any]:
    """Delivery over time; entries of the tables that lead away or nowhere at the end."""
    plan = of.plan(seed)
    _soften(plan, loss)
    send_anywhere(plan, FROM_S, UNTIL_S, EVERY_S)
    result = simulate(plan)
    found = messages(result)
    bins = (found.offered_us // 1_000_000 - FROM_S) // BIN_S
    came = np.bincount(bins[found.state == DELIVERED], minlength=int(bins.max()) + 1)
    return {"sent": np.bincount(bins).tolist(), "came": came.tolist(), "wrong": _wrong(result),
            "again": _again(result)}  # fmt: skip


def _again(result: Any) -> int:
    """Tables that came into force after the first ones."""
    late = (result.rows["code"] == REPORT_TABLE) & (result.rows["time"] >= FROM_S * 1_000_000)
    return int(np.count_nonzero(late))


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
    plan, nodes = result.plan, result.plan.nodes
    near = Ground(plan).near_at(result.ended_us)
    far = [distances(near, node) for node in range(nodes)]
    wrong = 0
    for node in range(nodes):
        for dest, way in enumerate(row_of(result, node, "next")):
            if dest != node:
                wrong += way == NONE or far[way][dest] != far[node][dest] - 1
    return float(wrong / (nodes * (nodes - 1)))


def row_of(result: Any, node: int, name: str) -> list[int]:
    """What a node's table says under a name, by destination."""
    plan, table = result.plan, result.world.nodes
    first = int(get(table, node, "bank")) * plan.params["width"]
    row: list[int] = np.asarray(get(table, node, name))[first : first + plan.nodes].tolist()
    return row


def over_time(got: Measured, rule: Rule, loss: int) -> Any:
    """Share delivered of what was offered in each span."""
    runs = got[point(rule, loss, got.quick)]
    return np.sum(runs["came"], axis=0) / np.sum(runs["sent"], axis=0)


def delivered(got: Measured, rule: Rule, loss: int) -> float:
    """Share delivered over all the time."""
    runs = got[point(rule, loss, got.quick)]
    return float(np.sum(runs["came"]) / np.sum(runs["sent"]))


def wrong(got: Measured, rule: Rule, loss: int) -> float:
    """Share of entries that lead away or nowhere, at the end."""
    return float(np.mean(got[point(rule, loss, got.quick)]["wrong"]))


def draw(got: Measured) -> Figure:
    """Over time at five percent; over the loss; tables at the end."""
    figure, axes = style.panels(style.WIDE_IN, 2.7, 1, 3)
    some = losses(got.quick)
    for i, rule in enumerate(RULES):
        look = style.look(i)
        y = over_time(got, rule, FIVE)
        axes[0].plot((np.arange(len(y)) + 0.5) * BIN_S, 100 * y, label=rule.name, **look)
        axes[1].plot(some, [100 * delivered(got, rule, k) for k in some], **look)
        if rule is not PLAIN_GRAPH:
            axes[2].plot(some, [100 * wrong(got, rule, k) for k in some], **look)
    for ax, title, x, y in zip(
        axes,
        (f"a  {FIVE} % of the frames lost", "b  over the loss", "c  wrong entries after 60 s"),
        ("since the tables (s)", "frames lost (%)", "frames lost (%)"),
        ("delivered (%)", "delivered within 60 s (%)", "entries (%)"),
        strict=True,
    ):
        ax.set(title=title, xlabel=x, ylabel=y, ylim=(-3, 104))
    drawing.legend(figure, axes[0], ncols=4)
    return figure


def judge(got: Measured) -> Claims:
    """Claims on tables under loss: one transmission, three of them, our rules."""
    bar = f"at {FIVE} % 0.95 of the messages in the last {BIN_S} s, 0.95 of the entries right"
    for rule in (DOCUMENT, THREE):
        share, still = (wrong(got, rule, loss) for loss in (FIVE, 0))
        late = over_time(got, rule, FIVE)[-1]
        again = np.mean(got[point(rule, FIVE, got.quick)]["again"])
        row = (
            f"{FIVE} % of the frames lost, after 60 s: {percent(share)} of the entries lead away "
            f"or nowhere, {percent(late)} of the messages come; without loss but for collisions "
            f"{percent(still)} wrong, {percent(delivered(got, rule, 0), 1)} come",
            verdict(share < 0.05 and late > 0.95),
            "A3, A5: a frame that is lost is taken for a death, and rewrites a table that was "
            f"right; in that time {again:.0f} tables came anew to 30 nodes",
        )
        if rule is DOCUMENT:
            yield said(RELIABLE, f"to the letter, while nobody dies (our bar: {bar})", *row)
        else:
            yield ours("2.2", "the same after three transmissions without an ack", *row)
    for rule in (PLAIN_SEARCH, PLAIN_GRAPH):
        shares = {k: delivered(got, rule, k) for k in losses(got.quick)}
        yield beyond(
            f"{rule.name}: suspicion for 10 s instead, the table stays as it is; all "
            f"messages come at {FIVE} % (0.99), without end-to-end acks",
            joined(f"{k} %: {percent(s, 2)}" for k, s in shares.items()),
            verdict(shares[FIVE] >= 0.99),
        )
