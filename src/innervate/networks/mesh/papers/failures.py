"""Section 2.2: nodes die, and their neighbours replace them; every rule of replacing."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from innervate.networks.mesh.papers import sending
from innervate.networks.mesh.papers.sending import DOCUMENT, GRAPH, RULES, SEARCH, Rule
from innervate.networks.mesh.papers.testbed import MeshTestbed
from innervate.networks.mesh.papers.words import joined, percent, seeds_of
from innervate.papers.experiment import Claim, Experiment, Point, Results, verdict
from innervate.plot import style

DEAD = tuple(range(9))
WORST = 8
ORIGIN = Rule("random, not the origin", (("failover", "random"), ("avoid", "origin")))
NAMES = {"document": "the document to the letter"}


def dead_of(quick: bool) -> tuple[int, ...]:
    """Numbers of nodes that die, one point each."""
    return (0, 4, 8) if quick else DEAD


def make_testbeds(rule: Rule) -> tuple[MeshTestbed, ...]:
    """Without a second try from end to end, and with it."""
    return (sending.make_testbed(rule, reliable=False), sending.make_testbed(rule))


def points(quick: bool) -> list[Point]:
    """Every rule and number of dead; the worst with end-to-end acks too."""
    seeds = seeds_of(quick)
    testbeds = {rule: make_testbeds(rule) for rule in (*RULES, ORIGIN)}
    made = [sending.point(testbeds[rule][0], k, seeds) for rule in RULES for k in dead_of(quick)]
    again = [rule for rule in RULES if rule is not DOCUMENT]
    made += [sending.point(testbeds[rule][1], k, seeds) for rule in again for k in (0, WORST)]
    return [*made, sending.point(testbeds[ORIGIN][0], WORST, seeds)]


def lost(results: Results, of: MeshTestbed, dead: int, quick: bool, which: str) -> float:
    """Share of the messages that did not come."""
    came, sent = sending.share(sending.told(results, of, dead, seeds_of(quick)), which)
    return 1 - came / sent


def draw(results: Results, quick: bool) -> Figure:
    """First packets, later ones, and both with end-to-end acks."""
    figure, axes = style.panels(style.WIDE_IN, 2.9, 1, 3, width_ratios=(1, 1, 0.9), sharey=True)
    for which, ax, letter in zip(("first", "later"), axes[:2], "ab", strict=True):
        for i, rule in enumerate(RULES):
            shares = [
                100 * lost(results, make_testbeds(rule)[0], k, quick, which) for k in dead_of(quick)
            ]
            ax.plot(dead_of(quick), shares, color=style.SERIES[i], marker=style.MARKERS[i],
                    ls=style.DASHES[i % 4], label=NAMES.get(rule.name, rule.name))  # fmt: skip
        ax.set_xlabel("dead nodes that nobody knows of")
        ax.set_title(f"{letter}  {'first packet' if which == 'first' else 'three later ones'}")
    axes[0].set_ylabel("lost of connected (%)")
    _reliable(axes[2], results, quick)
    handles, labels = axes[0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside lower left", ncols=6, columnspacing=1.2)
    return figure


def _reliable(ax: Axes, results: Results, quick: bool) -> None:
    rules = RULES[1:]
    for j, (which, hatch) in enumerate((("first", ""), ("later", "////"))):
        shares = [
            100 * lost(results, make_testbeds(rule)[1], WORST, quick, which) for rule in rules
        ]
        x = np.arange(len(rules)) + 0.38 * (j - 0.5)
        ax.bar(x, shares, 0.36, color=style.SERIES[1 : len(rules) + 1], hatch=hatch,
               edgecolor="white", lw=0, label=which)  # fmt: skip
        for at, share in zip(x, shares, strict=True):
            ax.text(at, share + 0.6, f"{share:.1f}", ha="center", size=5.5)
    ax.set_xticks(range(len(rules)), [rule.name for rule in rules], rotation=25)
    ax.set_title(f"c  end-to-end acks, {WORST} dead")
    ax.text(0.98, 0.96, "left first, hatched later", transform=ax.transAxes, ha="right", va="top",
            size=6.5)  # fmt: skip


def judge(results: Results, quick: bool) -> list[Claim]:
    """The document's sentences, one by one; ours."""
    return [
        _replaced(results, quick),
        _letter(results, quick),
        _next(results, quick),
        _source(results, quick),
        _rssi(results, quick),
        *(_ours(results, quick, rule) for rule in (SEARCH, GRAPH)),
        _again(results, quick),
        _loops(results, quick),
    ]


def _pair(results: Results, quick: bool, rule: Rule, which: str, end: bool = False) -> str:
    runs = sending.told(results, make_testbeds(rule)[int(end)], WORST, seeds_of(quick))
    came, sent = sending.share(runs, which)
    return f"{came} of {sent} ({percent(came / sent, 1)})"


def _replaced(results: Results, quick: bool) -> Claim:
    after = lost(results, make_testbeds(DOCUMENT)[0], WORST, quick, "later")
    return Claim(
        "2.2",
        '"if a node X dies, the nodes which list X as the next hop in their routing tables, will '
        'replace it automatically": the packets after the first arrive',
        f"{WORST} dead, to the letter: later packets {_pair(results, quick, DOCUMENT, 'later')}",
        verdict(after < 0.05),
        "a random neighbour need not be nearer: packets circle until they have visited 24 nodes, "
        "and a lost frame is taken for a death and rewrites a table that was right",
    )


def _letter(results: Results, quick: bool) -> Claim:
    gone = lost(results, make_testbeds(DOCUMENT)[0], WORST, quick, "first")
    return Claim(
        "2.2",
        '"the fence crossing event delivery must happen even if some intermediate nodes '
        'malfunctioned"',
        f"{WORST} dead, to the letter: first packets {_pair(results, quick, DOCUMENT, 'first')}",
        verdict(gone < 0.01),
        'A4: "On next packet, A will not forward it to B": the packet that finds out is lost, at '
        "every dead node on its way anew",
    )


def _next(results: Results, quick: bool) -> Claim:
    rule = RULES[1]
    kept, gone = (
        lost(results, make_testbeds(r)[0], WORST, quick, "first") for r in (rule, DOCUMENT)
    )
    return Claim(
        "2.2",
        "it is enough to send the packet that found out again, after three transmissions",
        f"random, {WORST} dead: first {_pair(results, quick, rule, 'first')}, later "
        f"{_pair(results, quick, rule, 'later')}; to the letter {percent(1 - gone, 1)}",
        verdict(kept < 0.01, "A3", "A4"),
        "most of what is lost is saved; the rest goes round in circles",
    )


def _source(results: Results, quick: bool) -> Claim:
    rule = RULES[1]
    ours, other = (
        lost(results, make_testbeds(r)[0], WORST, quick, "first") for r in (rule, ORIGIN)
    )
    return Claim(
        "2.2",
        '"the choice of neighbor is random (except for packet source)": the source is the node the '
        "packet came from, rather than its origin",
        f"{WORST} dead, first packets: {_pair(results, quick, rule, 'first')} without the former, "
        f"{_pair(results, quick, ORIGIN, 'first')} without the latter",
        verdict(ours < other, "A7"),
        "" if ours < other else "both readings send packets back and forth",
    )


def _rssi(results: Results, quick: bool) -> Claim:
    random, loud = (lost(results, make_testbeds(r)[0], WORST, quick, "first") for r in RULES[1:3])
    return Claim(
        "2.2",
        '"in the future it could be based on last heard time and RSSI": better than random',
        f"{WORST} dead: "
        + joined(
            f"{rule.name}: first {_pair(results, quick, rule, 'first')}, later "
            f"{_pair(results, quick, rule, 'later')}"
            for rule in (RULES[2], RULES[1])
        ),
        verdict(loud < random),
        "A6: the loudest neighbour is the nearest one, which has the same way to go; it is always "
        "the same, so two nodes that chose each other keep each other",
    )


def _ours(results: Results, quick: bool, rule: Rule) -> Claim:
    dead = dead_of(quick)
    worst = max(
        lost(results, make_testbeds(rule)[0], k, quick, w) for k in dead for w in ("first", "later")
    )
    what = "alternates, then a search along the path trace" if rule is SEARCH else "the whole graph"
    return Claim(
        "beyond",
        f"{what}: every packet arrives while its recipient is connected, without end-to-end acks",
        f"{dead[0]}..{dead[-1]} dead, at worst {percent(1 - worst, 2)}; {WORST} dead: first "
        f"{_pair(results, quick, rule, 'first')}, later {_pair(results, quick, rule, 'later')}",
        verdict(worst < 0.005),
        "" if worst < 0.005 else "some packets are still lost, see the measurement",
    )


def _again(results: Results, quick: bool) -> Claim:
    words, worse = [], []
    for rule in RULES[1:]:
        shares = [lost(results, testbed, WORST, quick, "later") for testbed in make_testbeds(rule)]
        worse.append(shares[1] > shares[0] + 0.01)
        words.append(f"{rule.name} {percent(1 - shares[0], 1)} to {percent(1 - shares[1], 1)}")
    return Claim(
        "beyond",
        "end-to-end acks with up to five retries help every rule",
        f"{WORST} dead, later packets without and with: {joined(words)}",
        verdict(not any(worse)),
        "where tables circle, every retry circles too, and the acks with it: the channel fills, "
        "acks of hops are lost and rewrite more tables",
    )


def _loops(results: Results, quick: bool) -> Claim:
    words, fine = [], True
    for rule in RULES:
        runs = sending.told(results, make_testbeds(rule)[0], WORST, seeds_of(quick))
        looped = sum(run["looped"] for run in runs)
        sent = sum(sending.share(runs, which)[1] for which in ("first", "later"))
        fine = fine and (looped == 0 or rule in (SEARCH, GRAPH))
        words.append(f"{rule.name} {looped}")
    return Claim(
        "2.2",
        "to replace a next hop makes no loops",
        f"{WORST} dead, of {sent} packets visited a node twice: {joined(words)}",
        verdict(fine),
        "A5, A9: tables rewritten one by one agree on nothing; search and graph come back on "
        "purpose, to try another way",
    )


EXPERIMENT = Experiment(
    "failures",
    "2.2: nodes die that nobody knows of",
    "30 nodes; all at once so many die that are drawn; then every live node sends four messages. "
    "a, b: nothing but acks of hops. c: messages are kept until acknowledged by their recipient. "
    "Counted are those whose ends are still connected by good links.",
    points,
    draw,
    judge,
)
