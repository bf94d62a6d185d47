"""F1: with carrier sense and packets of one length the ends are a tie: who can be put in order?"""

from typing import Any, NamedTuple

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from innervate.networks.radio.papers import lanes
from innervate.networks.radio.papers.common import TAU_US, Options
from innervate.networks.radio.papers.medium import Channel
from innervate.networks.radio.slotted.drive import SLOT
from innervate.papers.experiment import Claim, Claims, Measured, Point, beyond, verdict
from innervate.papers.words import joined
from innervate.plot import style

TITLE = "F1: who is put in order?"
CAPTION = (
    "Event level, T = 25, one delay for all, all start within tau. a: collisions that the first "
    "reservation puts in order. b: five robots, in the order of their ends; their CR-Rs overlap."
)
NS = tuple(range(2, 13))
FEW, SEEDS = 10, 40
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


def within(rules: Rules, n: int, quick: bool) -> Point:
    """The paper's words and both rules are held against numbers of 40 runs, always."""
    return channel(rules, n).point(SEEDS if rules in (WORDED, BOTH) or not quick else FEW)


def apart(n: int) -> Point:
    """Stations whose ends lie more than a slot apart."""
    starts = tuple((SLOT + 1) * i for i in range(n))
    return Channel("paper", n, SIZE, starts_us=starts).point(1)


def saturated(n: int, quick: bool, **options: Any) -> Point:
    """All draw their wait within tau, so that all collide in every round."""
    chosen = (("wait_us", TAU_US - 1), *options.items())
    packets = 20 if quick else 200  # a station
    traffic = "saturated"
    return Channel("paper", n, SIZE, traffic=traffic, packets=packets, options=chosen).point(1)


def variants(quick: bool) -> list[Point]:
    """Beyond the paper [radio 8]: a short window for two, stretched waits for ten."""
    two, ten = saturated(2, quick), saturated(10, quick)
    return [two, saturated(2, quick, window_slots=2), ten, saturated(10, quick, dilate=DILATED)]


def points(quick: bool) -> list[Point]:
    """All rules and n; ends apart; variants in saturation; a run to be shown."""
    made = [within(rules, n, quick) for rules in VARIANTS for n in NS]
    made += [apart(n) for n in range(2, 21)]
    return [*made, *variants(quick), Point.of("ties run", 0.1, shown)]


def shown() -> dict[str, Any]:
    """Five robots whose CR-Rs overlap."""
    return lanes.record(channel(BOTH, 5).run(1), UNTIL_US)


def ordered(got: Measured, rules: Rules, n: int) -> tuple[int, int]:
    """How many collisions the first reservation puts in order, of how many."""
    found = got[within(rules, n, got.quick)]["ordered"]
    return sum(found), len(found)


def draw(got: Measured) -> Figure:
    """Share put in order over n; five robots' CR-Rs."""
    figure, (left, right) = style.panels(style.WIDE_IN, 2.8, 1, 2, width_ratios=(1, 1.15))
    _shares(left, got)
    run = got.values["ties run"]
    ends = {frame["station"]: frame["end"] for frame in reversed(run["frames"])}
    order = sorted(ends, key=lambda node: ends[node])
    names = [f"robot {node + 1}" for node in range(5)]
    lanes.draw(right, run, names, order, waves=False)
    right.set(xlim=(FROM_US / 1e3, UNTIL_US / 1e3), title="b  five robots: later CR-Rs overlap")
    right.legend(handles=lanes.keys(waves=False), loc="upper center", ncols=4,
                 bbox_to_anchor=(0.45, -0.19), columnspacing=1.2)  # fmt: skip
    return figure


def _shares(ax: Axes, got: Measured) -> None:
    for i, rules in enumerate(VARIANTS):
        found = [ordered(got, rules, n) for n in NS]
        # Side by side where they would lie on each other.
        ax.plot([n + 0.09 * (i - 2) for n in NS], [100 * hits / of for hits, of in found],
                style.MARKERS[i], ls=style.DASHES[i % 4], color=style.SERIES[i], lw=0.9,
                label=rules.name)  # fmt: skip
    ax.set(xticks=NS, ylim=(-4, 150), yticks=range(0, 101, 20), xlabel="stations n",
           ylabel="put in order (%)", title="a  ordered by the first reservation")  # fmt: skip
    ax.legend(loc="upper center", ncols=2)


def judge(got: Measured) -> Claims:
    """As worded; with the rules; with gaps; how many get through; variants."""
    of = SEEDS
    worded = [ordered(got, WORDED, n)[0] for n in NS]
    yield Claim(
        "2.2",
        "all nodes can arrange for T - T_c0 and retransmit in order after any collision, rules "
        "to the letter",
        f"event level, all start within tau: {joined(worded)} of {of} collisions ordered at "
        f"n = {NS[0]}..{NS[-1]}",
        verdict(min(worded) == of),
        "F1: starts within tau are ends within tau, half a CR-R: the last and the second to "
        "last hear each other's tail, both report, and each counts the other's report",
    )
    both = {n: ordered(got, BOTH, n)[0] for n in NS}
    yield Claim(
        "2.2",
        "the same for up to four stations, with the least rules that help",
        f"with T1 and T4: {joined(f'n = {n}: {k}' for n, k in both.items() if n < 8)} of {of}; "
        "none beyond",
        verdict(min(both[n] for n in (2, 3, 4)) >= 0.95 * of, "F1", "Q6"),
        "T1: who hears a tail shorter than tau was last; T4: overlapping CR-Rs count by length",
    )
    many = [k for n, k in both.items() if n > 4]
    done = sum(sum(got[within(BOTH, n, got.quick)]["completed"]) for n in NS)
    yield Claim(
        "2.2",
        "the same for five stations and more (unlimited scalability)",
        f"{sum(many)} of {of * len(many)} collisions of "
        f"5..{NS[-1]} ordered at once; in the end {done} of {of * sum(NS)} packets get through",
        verdict(min(many) > 0.95 * of),
        "F1: CR-Rs of the third and later stations overlap, several hold the same turn, "
        "collide again and are sorted out at random (T2)",
    )
    yield from _apart(got)


def _apart(got: Measured) -> Claims:
    gaps = [got[apart(n)]["ordered"][0] for n in range(2, 21)]
    yield Claim(
        "2.2",
        "the same for any number whose ends lie more than a slot apart",
        f"{sum(gaps)} of {len(gaps)} in order, n = 2..20, 209 us apart",
        verdict(all(gaps), "Q6"),
        "packets of one length end so far apart only if they start so, against carrier sense",
    )
    two, short, ten, dilated = (got[one]["throughput"][0] for one in variants(got.quick))
    five, of = ordered(got, STRETCHED, 5)
    yield beyond(
        "two small changes help: a window of 2 slots for two stations, T_c stretched over the "
        "window for ten",
        f"S at T = 25, n = 2: {two:.3f}, short window {short:.3f}; n = 10: "
        f"{ten:.3f}, stretched {dilated:.3f}; n = 5 stretched: {five} of {of} ordered",
        verdict(short > two and dilated > ten),
        "stretching needs equal packets and equal delays; the practical mode needs neither",
    )
