"""Section 2.2: nodes die, and their neighbours replace them; every rule of replacing."""

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from innervate.networks.mesh.analysis.messages import duplicates, messages
from innervate.networks.mesh.analysis.paths import Ground
from innervate.networks.mesh.analysis.summary import connected, looped
from innervate.networks.mesh.papers import losses
from innervate.networks.mesh.papers import testbed as beds
from innervate.networks.mesh.papers.document import ANY_TWO, MUST, REPLACED, beyond, ours, said
from innervate.networks.mesh.papers.testbed import HOPS, LITERAL, MeshTestbed, Options
from innervate.networks.mesh.sim.simulate import simulate
from innervate.papers import drawing
from innervate.papers.experiment import Claim, Claims, Measured, Point, sized, verdict
from innervate.papers.words import joined, percent
from innervate.plot import style

TITLE = "2.2: nodes die that nobody knows of"
CAPTION = (
    "30 nodes; all at once so many die that are drawn; then every live node sends four messages. "
    "a, b: nothing but acks of hops. c: messages are kept until acknowledged by their recipient. "
    "Counted are those whose ends are still connected by good links."
)
DEATHS_US = 7_000_000  # tables are there, and the next discovery is far
ROUNDS = 4
EVERY_US = 2_000_000
# No discovery between the deaths and the last message.
QUIET: Options = (("period_s", 60.0), ("period_max_s", 60.0))
DURATION_S = (DEATHS_US + ROUNDS * EVERY_US) / 1e6 + 2.5
WORST = 8
dead_of = sized((0, 4, 8), tuple(range(9)))  # numbers of nodes that die, one point each


class Rule(NamedTuple):
    """What is done when a hop does not answer."""

    name: str
    protocol: Options


DOCUMENT = Rule("document", LITERAL)
RANDOM, RSSI, HEARD, ALTERNATE, SEARCH, GRAPH = (
    Rule(name, (("failover", name),))
    for name in ("random", "rssi", "heard", "alternate", "search", "graph")
)
RULES = (DOCUMENT, RANDOM, RSSI, HEARD, ALTERNATE, SEARCH, GRAPH)


def point(
    rule: Rule, dead: int, quick: bool, end: bool = False, seeds: Callable[[bool], int] = beds.seeds
) -> Point:
    """The networks of a rule, without a second try from end to end, or with it (`end`)."""
    again = () if end or rule is DOCUMENT else HOPS
    testbed = MeshTestbed(protocol=(*QUIET, *rule.protocol, *again), duration_s=DURATION_S)
    return testbed.point(f"{dead} dead", seeds(quick), measure, dead)


def measure(of: MeshTestbed, dead: int, seed: int) -> dict[str, Any]:
    """Messages of live nodes among themselves, after `dead` died; only of connected ones."""
    plan = of.plan(seed)
    gone = beds.dying(plan, dead)
    beds.kill(plan, gone, DEATHS_US)
    alive = [node for node in range(plan.nodes) if node not in gone]
    beds.send_rounds(plan, alive, ROUNDS, DEATHS_US, EVERY_US)
    result = simulate(plan)
    found, ground = messages(result), Ground(plan)
    rounds = [connected(found.only(found.flow == k), ground) for k in range(ROUNDS)]
    return {
        "first": [rounds[0]["delivered"], rounds[0]["sent"]],
        "later": [sum(r[name] for r in rounds[1:]) for name in ("delivered", "sent")],
        "duplicates": duplicates(result),
        "looped": looped(result),
        "first_lost": losses.how(result, found.only(found.flow == 0), ground, gone),
        "later_lost": losses.how(result, found.only(found.flow != 0), ground, gone),
    }


def share(runs: dict[str, Any], which: str) -> tuple[int, int]:
    """Delivered, of how many, in the "first" or "later" rounds."""
    came, sent = (sum(counts) for counts in zip(*runs[which], strict=True))
    return came, sent


ORIGIN = Rule("random, not the origin", (("failover", "random"), ("avoid", "origin")))
NAMES = {"document": "the document to the letter"}


def points(quick: bool) -> list[Point]:
    """Every rule and number of dead; the worst with end-to-end acks too."""
    made = [point(rule, k, quick) for rule in RULES for k in dead_of(quick)]
    made += [point(rule, k, quick, end=True) for rule in RULES[1:] for k in (0, WORST)]
    return [*made, point(ORIGIN, WORST, quick)]


def lost(got: Measured, rule: Rule, which: str, dead: int = WORST, end: bool = False) -> float:
    """Share of the messages that did not come."""
    came, sent = share(got[point(rule, dead, got.quick, end)], which)
    return 1 - came / sent


def draw(got: Measured) -> Figure:
    """First packets, later ones, and both with end-to-end acks."""
    figure, axes = style.panels(style.WIDE_IN, 2.9, 1, 3, width_ratios=(1, 1, 1.05), sharey=True)
    dead = dead_of(got.quick)
    titles = ("a  first packet", "b  three later ones")
    for which, ax, title in zip(("first", "later"), axes[:2], titles, strict=True):
        for i, rule in enumerate(RULES):
            shares = [100 * lost(got, rule, which, k) for k in dead]
            ax.plot(dead, shares, label=NAMES.get(rule.name, rule.name), **style.look(i))
        ax.set(xlabel="dead nodes that nobody knows of", title=title)
    axes[0].set_ylabel("lost of connected (%)")
    _reliable(axes[2], got)
    drawing.legend(figure, axes[0], ncols=7, columnspacing=1.2)
    return figure


def _reliable(ax: Axes, got: Measured) -> None:
    rules = RULES[1:]
    for j, (which, hatch) in enumerate((("first", ""), ("later", "////"))):
        shares = [100 * lost(got, rule, which, end=True) for rule in rules]
        x = np.arange(len(rules)) + 0.42 * (j - 0.5)
        ax.bar(x, shares, 0.36, color=style.SERIES[1 : len(rules) + 1], hatch=hatch,
               edgecolor="white", lw=0, label=which)  # fmt: skip
        for at, share in zip(x, shares, strict=True):
            ax.text(at, share + 0.6, f"{share:.1f}".removesuffix(".0"), ha="center", size=5)
    ax.set_xticks(range(len(rules)), [rule.name for rule in rules], rotation=90)
    ax.set_title(f"c  end-to-end acks, {WORST} dead")
    ax.set_xlabel("left: first packet, hatched: later ones")


def _came(got: Measured, rule: Rule, which: str, dead: int = WORST) -> str:
    came, sent = share(got[point(rule, dead, got.quick)], which)
    return f"{came} of {sent} ({percent(came / sent, 1)})"


def _both(got: Measured, rule: Rule, dead: int = WORST) -> str:
    return f"first {_came(got, rule, 'first', dead)}, later {_came(got, rule, 'later', dead)}"


def _how(got: Measured, rule: Rule, which: str, dead: int = WORST, *, end: bool = False) -> str:
    """What those that were lost were lost by."""
    return losses.words(got[point(rule, dead, got.quick, end)][f"{which}_lost"])


def judge(got: Measured) -> Claims:
    """The document's sentences, one by one; ours."""
    yield from _letter(got)
    yield from _random(got)
    for rule in (SEARCH, GRAPH):
        yield _ours(got, rule)
    yield _again(got)
    yield _loops(got)


def _letter(got: Measured) -> Claims:
    gone = [lost(got, DOCUMENT, which, 0) for which in ("first", "later")]
    yield said(
        ANY_TWO,
        "nobody is dead, the document to the letter: messages come (our bar: 0.99)",
        _both(got, DOCUMENT, 0),
        verdict(max(gone) < 0.01),
        f"of the later ones {_how(got, DOCUMENT, 'later', 0)}",
    )
    yield said(
        REPLACED,
        "to the letter: the packets after the first arrive (our bar: 0.95)",
        f"{WORST} dead: later packets {_came(got, DOCUMENT, 'later')}",
        verdict(lost(got, DOCUMENT, "later") < 0.05),
        _how(got, DOCUMENT, "later"),
    )
    yield said(
        MUST,
        "to the letter: the first packet arrives, whatever is in it (our bar: 0.99)",
        f"{WORST} dead: first packets {_came(got, DOCUMENT, 'first')}",
        verdict(lost(got, DOCUMENT, "first") < 0.01),
        'A4: "On next packet, A will not forward it to B": the packet that finds out is not sent '
        f"again; {_how(got, DOCUMENT, 'first')}",
    )


def _random(got: Measured) -> Claims:
    gone, other, random, loud, heard = (
        lost(got, rule, "first") for rule in (DOCUMENT, ORIGIN, RANDOM, RSSI, HEARD)
    )
    yield ours(
        "2.2",
        "it is enough to send the packet that found out again, after three transmissions (0.99)",
        f"random, {WORST} dead: {_both(got, RANDOM)}; to the letter {percent(1 - gone, 1)}",
        verdict(random < 0.01, "A3", "A4"),
        _how(got, RANDOM, "first"),
    )
    yield ours(
        "2.2",
        '"the choice of neighbor is random (except for packet source)": the source is the node the '
        "packet came from, rather than its origin",
        f"{WORST} dead, first packets: {_came(got, RANDOM, 'first')} without the former, "
        f"{_came(got, ORIGIN, 'first')} without the latter",
        verdict(random < other, "A7"),
        "" if random < other else "not known why",
    )
    yield ours(
        "2.2",
        '"in the future it could be based on last heard time and RSSI": by both, whom it heard '
        "last, of those the loudest, more first packets come than by chance",
        f"{WORST} dead: {joined(f'{rule.name}: {_both(got, rule)}' for rule in (HEARD, RANDOM))}",
        verdict(heard < random),
        f"by both {_how(got, HEARD, 'first')}; by chance {_how(got, RANDOM, 'first')}",
    )
    yield ours(
        "2.2",
        "by both words more first packets come than by RSSI alone",
        f"{WORST} dead: {joined(f'{rule.name}: {_both(got, rule)}' for rule in (HEARD, RSSI))}",
        verdict(heard < loud),
        f"by RSSI alone {_how(got, RSSI, 'first')}",
    )
    yield ours(
        "2.2",
        "by RSSI alone more first packets come than by chance",
        f"{WORST} dead: {joined(f'{rule.name}: {_both(got, rule)}' for rule in (RSSI, RANDOM))}",
        verdict(loud < random),
        f"A6: by RSSI {_how(got, RSSI, 'first')}; by chance {_how(got, RANDOM, 'first')}",
    )


def _ours(got: Measured, rule: Rule) -> Claim:
    dead = dead_of(got.quick)
    worst = max(lost(got, rule, which, k) for k in dead for which in ("first", "later"))
    what = "alternates, then a search along the path trace" if rule is SEARCH else "the whole graph"
    return beyond(
        f"{what}: every packet arrives (0.995) while its recipient is connected, without "
        "end-to-end acks",
        f"{dead[0]}..{dead[-1]} dead, at worst {percent(1 - worst, 2)}; {WORST} dead: "
        f"{_both(got, rule)}",
        verdict(worst < 0.005),
        "" if worst < 0.005 else _how(got, rule, "later"),
    )


def _again(got: Measured) -> Claim:
    words, worse, why = [], [], []
    for rule in RULES[1:]:
        without, with_ = (lost(got, rule, "later", end=end) for end in (False, True))
        words.append(f"{rule.name} {percent(1 - without, 1)} to {percent(1 - with_, 1)}")
        worse.append(with_ > without + 0.01)
        if worse[-1]:
            why.append(f"{rule.name}: {_how(got, rule, 'later', end=True)}")
    return beyond(
        "end-to-end acks with up to five retries help every rule, or do no harm (0.01)",
        f"{WORST} dead, later packets without and with: {joined(words)}",
        verdict(not any(worse)),
        joined(why, "; "),
    )


def _loops(got: Measured) -> Claim:
    found = {rule: got[point(rule, WORST, got.quick)] for rule in RULES}
    looped = {rule: sum(runs["looped"]) for rule, runs in found.items()}
    sent = sum(share(found[GRAPH], which)[1] for which in ("first", "later"))
    return ours(
        "2.2",
        "to replace a next hop makes no loops",
        f"{WORST} dead, of {sent} packets visited a node twice: "
        + joined(f"{rule.name} {count}" for rule, count in looped.items()),
        verdict(not any(n for rule, n in looped.items() if rule not in (SEARCH, GRAPH))),
        "A5, A9: who replaces one by one knows nothing of what others did; search and graph may "
        "come back on purpose, to try another way",
    )
