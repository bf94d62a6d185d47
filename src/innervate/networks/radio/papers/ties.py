"""F1: with carrier sense and packets of one length the ends are a tie: who can be put in order?"""

from __future__ import annotations

from typing import Any, NamedTuple

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from innervate.networks.radio.papers import lanes
from innervate.networks.radio.papers.common import TAU_US, Options, joined
from innervate.networks.radio.papers.medium import Channel
from innervate.networks.radio.slotted.drive import SLOT
from innervate.papers.experiment import Claim, Experiment, Point, Results, verdict
from innervate.plot import style

NS = tuple(range(2, 13))
SEEDS = range(1, 41)
FEW = range(1, 11)
SIZE = 25
DILATED = 2 * SIZE - 6
FROM_US, UNTIL_US = 5000, 6200


class Rules(NamedTuple):
    """What was added to the paper's words."""

    name: str
    options: Options


WORDED = Rules("as worded", (("tail_rule", False), ("overlap_rule", False)))
TAIL = Rules("with T1, own tail", (("overlap_rule", False),))
LENGTH = Rules("with T4, by length", (("tail_rule", False),))
BOTH = Rules("with T1 and T4", ())
STRETCHED = Rules("T1, T4, stretched", (("dilate", DILATED),))
VARIANTS = (WORDED, TAIL, LENGTH, BOTH, STRETCHED)


def channel(rules: Rules, n: int) -> Channel:
    """A collision as carrier sense allows it: all start within tau."""
    return Channel("paper", n, SIZE, spread_us=TAU_US - 1, options=rules.options)


def seeds(rules: Rules, quick: bool) -> range:
    """The paper's words and both rules are held against numbers of 40 runs, always."""
    return SEEDS if rules in (WORDED, BOTH) or not quick else FEW


def apart(n: int) -> Channel:
    """Stations whose ends lie more than a slot apart."""
    return Channel("paper", n, SIZE, starts_us=tuple((SLOT + 1) * i for i in range(n)))


def packets(quick: bool) -> int:
    """A station, of the saturated runs."""
    return 20 if quick else 200


def saturated(n: int, quick: bool, **options: Any) -> Channel:
    """All draw their wait within tau, so that all collide in every round."""
    chosen = (("wait_us", TAU_US - 1), *options.items())
    return Channel("paper", n, SIZE, traffic="saturated", packets=packets(quick), options=chosen)


def variants(quick: bool) -> dict[str, Channel]:
    """Beyond the paper [radio 8]: a short window for two, stretched waits for ten."""
    return {
        "two": saturated(2, quick),
        "two W": saturated(2, quick, window_slots=2),
        "ten": saturated(10, quick),
        "ten D": saturated(10, quick, dilate=DILATED),
    }


ONE = range(1, 2)


def points(quick: bool) -> list[Point]:
    """All rules and n; ends apart; a run to be shown; variants in saturation."""
    made = [channel(rules, n).point(seeds(rules, quick)) for rules in VARIANTS for n in NS]
    made += [apart(n).point(ONE) for n in range(2, 21)]
    made += [one.point(ONE) for one in variants(quick).values()]
    return [*made, Point.of("ties run", 0.1, shown)]


def shown() -> dict[str, Any]:
    """Five robots whose CR-Rs overlap."""
    return lanes.record(channel(BOTH, 5).run(1), UNTIL_US)


def ordered(results: Results, rules: Rules, n: int, quick: bool) -> int:
    """How many collisions the first reservation puts in order."""
    return sum(results[channel(rules, n).key_of(seeds(rules, quick))]["ordered"])


def draw(results: Results, quick: bool) -> Figure:
    """Share put in order over n; five robots' CR-Rs."""
    figure, (left, right) = style.panels(style.WIDE_IN, 2.8, 1, 2, width_ratios=(1, 1.15))
    _shares(left, results, quick)
    run = results["ties run"]
    ends = {frame["station"]: frame["end"] for frame in reversed(run["frames"])}
    order = sorted(ends, key=lambda node: ends[node])
    names = [f"robot {node + 1}" for node in range(5)]
    lanes.draw(right, run, names, order, waves=False)
    right.set_xlim(FROM_US / 1e3, UNTIL_US / 1e3)
    right.set_title("b  five robots: later CR-Rs overlap")
    right.legend(handles=lanes.keys(waves=False, deaf=True), loc="upper center", ncols=4,
                 bbox_to_anchor=(0.45, -0.19), columnspacing=1.2)  # fmt: skip
    return figure


def _shares(ax: Axes, results: Results, quick: bool) -> None:
    for i, rules in enumerate(VARIANTS):
        of = len(seeds(rules, quick))
        shares = [100 * ordered(results, rules, n, quick) / of for n in NS]
        # Side by side where they would lie on each other.
        x = [n + 0.09 * (i - 2) for n in NS]
        ax.plot(x, shares, style.MARKERS[i], ls=style.DASHES[i % 4], color=style.SERIES[i],
                lw=0.9, label=rules.name)  # fmt: skip
    ax.set_xticks(NS)
    ax.set_ylim(-4, 150)
    ax.set_yticks(range(0, 101, 20))
    ax.set_xlabel("stations n")
    ax.set_ylabel("put in order (%)")
    ax.set_title("a  ordered by the first reservation")
    ax.legend(loc="upper center", ncols=2)


def judge(results: Results, quick: bool) -> list[Claim]:
    """As worded; with the rules; with gaps; how many get through; variants."""
    worded = [ordered(results, WORDED, n, quick) for n in NS]
    both = {n: ordered(results, BOTH, n, quick) for n in NS}
    done = sum(sum(results[channel(BOTH, n).key_of(SEEDS)]["completed"]) for n in NS)
    gaps = [results[apart(n).key_of(ONE)]["ordered"][0] for n in range(2, 21)]
    of = len(SEEDS)
    return [
        Claim(
            "2.2",
            "all nodes can arrange for T - T_c0 and retransmit in order after any collision, rules "
            "to the letter",
            f"event level, all start within tau: {joined(worded)} of {of} collisions ordered at "
            f"n = {NS[0]}..{NS[-1]}",
            verdict(min(worded) == of),
            "F1: starts within tau are ends within tau, half a CR-R: the last and the second to "
            "last hear each other's tail, both report, and each counts the other's report",
        ),
        Claim(
            "2.2",
            "the same for up to four stations, with the least rules that help",
            f"with T1 and T4: {joined(f'n = {n}: {k}' for n, k in both.items() if n < 8)} of {of}; "
            "none beyond",
            verdict(min(both[n] for n in (2, 3, 4)) >= 0.95 * of, "F1", "Q6"),
            "T1: who hears a tail shorter than tau was last; T4: overlapping CR-Rs count by length",
        ),
        Claim(
            "2.2",
            "the same for five stations and more (unlimited scalability)",
            f"{sum(both[n] for n in NS if n > 4)} of {of * sum(n > 4 for n in NS)} collisions of "
            f"5..{NS[-1]} ordered at once; in the end {done} of {of * sum(NS)} packets get through",
            verdict(min(both[n] for n in NS if n > 4) > 0.95 * of),
            "F1: CR-Rs of the third and later stations overlap, several hold the same turn, "
            "collide again and are sorted out at random (T2)",
        ),
        Claim(
            "2.2",
            "the same for any number whose ends lie more than a slot apart",
            f"{sum(gaps)} of {len(gaps)} in order, n = 2..20, 209 us apart",
            verdict(all(gaps), "Q6"),
            "packets of one length end so far apart only if they start so, against carrier sense",
        ),
        _beyond(results, quick),
    ]


def _beyond(results: Results, quick: bool) -> Claim:
    found = {
        name: float(results[one.key_of(ONE)]["throughput"][0])
        for name, one in variants(quick).items()
    }
    five = ordered(results, STRETCHED, 5, quick)
    return Claim(
        "beyond",
        "two small changes help: a window of 2 slots for two stations, T_c stretched over the "
        "window for ten",
        f"S at T = 25, n = 2: {found['two']:.3f}, short window {found['two W']:.3f}; n = 10: "
        f"{found['ten']:.3f}, stretched {found['ten D']:.3f}; n = 5 stretched: {five} of "
        f"{len(seeds(STRETCHED, quick))} ordered",
        verdict(found["two W"] > found["two"] and found["ten D"] > found["ten"]),
        "stretching needs equal packets and equal delays; the practical mode needs neither",
    )


EXPERIMENT = Experiment(
    "ties",
    "F1: who is put in order?",
    "Event level, T = 25, one delay for all, all start within tau. a: collisions that the first "
    "reservation puts in order. b: five robots, in the order of their ends; their CR-Rs overlap.",
    points,
    draw,
    judge,
)
