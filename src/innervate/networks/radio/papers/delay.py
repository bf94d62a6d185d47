"""Beyond the paper: delay against load with 2 ms to switch, beside what the paper names and DCF.

All on the event level, with the same delays, turnaround and packets. Load is a share of the
hand-over bound: what the channel can carry if every packet is heard by everybody, one a turn.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from innervate.analysis.intervals import mean_interval
from innervate.networks.radio.analysis import formulas as forms
from innervate.networks.radio.papers.common import SIZES, TURNAROUND, TURNAROUND_US, Look, joined
from innervate.networks.radio.papers.medium import Channel
from innervate.networks.radio.papers.practice import DELAY
from innervate.networks.radio.scenario.baselines import baseline
from innervate.networks.radio.scenario.plan import RadioPlan
from innervate.networks.radio.sim.simulate import simulate
from innervate.papers.experiment import Claim, Experiment, Point, Results, verdict
from innervate.plot import style

STATIONS = (5, 20)
BARS = (0.1, 0.3, 0.6, 0.9)  # loads that are judged
LOADS = (0.1, 0.2, 0.3, 0.45, 0.6, 0.75, 0.9)
PRACTICAL, DCF, TDMA, RING, POLLING = "practical", "dcf", "tdma", "token-ring", "polling"
NEAR_DCF = 1.3  # times DCF's delay at a tenth of the load
TOP = 2000  # slots; what is above is off the chart

_DOT = style.DASHES[2]
LOOKS = {
    (PRACTICAL, 1): Look("CSMA/CD-R, practical", style.BLUE, "-", "o"),
    (PRACTICAL, 4): Look("... up to 4 packets a turn", style.SKY, "-", "o"),
    (DCF, 1): Look("802.11 DCF, told for nothing", style.PURPLE, "-", "v"),
    (TDMA, 1): Look("TDMA", style.BLACK, "-", "s"),
    (RING, 1): Look("token ring, token of 2 slots", style.VERMILION, "-", "^"),
    (RING, 4): Look("... up to 4 packets a token", style.ORANGE, "-", "^"),
    (POLLING, 1): Look("polling", style.GREEN, "-", "D"),
}  # fmt: skip
RIVALS = ((DCF, 1), (TDMA, 1), (RING, 1))


@dataclass(frozen=True, slots=True)
class Offered:
    """Poisson packets at a load, by one protocol.

    Attributes:
        mac: "practical" or a baseline's name.
        per_turn: most packets in a turn.
        size: T, slots.
        n: stations.
        load: share of the hand-over bound, 0 .. 1.
        packets: about, of all stations.
    """

    mac: str
    per_turn: int
    size: int
    n: int
    load: float
    packets: int

    @property
    def key(self) -> str:
        """All of it in words."""
        turn = f" {self.per_turn} a turn" if self.per_turn > 1 else ""
        return (
            f"event delay {self.mac}{turn} n={self.n} T={self.size} ta={TURNAROUND_US} us "
            f"load {self.load:g} of the bound, {self.packets} packets"
        )

    def plan(self, seed: int) -> RadioPlan:
        """The plan of one run: the same offers for every protocol; it ends when all are served."""
        options = (("per_turn", self.per_turn),)
        share = self.load * forms.handover_bound(self.size, TURNAROUND, DELAY)
        each = self.packets // self.n
        channel = Channel("practical", self.n, self.size, TURNAROUND_US, "poisson", packets=each,
                          load=share, options=options)  # fmt: skip
        plan = channel.plan(seed)
        last = min(times[-1] for times in plan.arrivals)  # so that nobody is the last to send
        arrivals = [[at for at in times if at <= last] for times in plan.arrivals]
        plan = replace(plan, arrivals=arrivals, wanted=sum(map(len, arrivals)))
        if self.mac != PRACTICAL:
            params = baseline(self.mac, self.n, plan.params)
            plan = replace(plan, protocol=self.mac, params=params)
        return plan

    def measure(self, seeds: Sequence[int]) -> dict[str, list[float]]:
        """Mean delay of each seed, slots from offer to the end of the frame; what went wrong."""
        found: dict[str, list[float]] = {"mean": [], "p95": [], "silent": [], "open": []}
        for seed in seeds:
            result = simulate(self.plan(seed), checks=False)
            packets = result.packets
            slots = (packets["end"] - packets["offered"]) / result.plan.params["slot_us"]
            found["mean"].append(float(slots.mean()))
            found["p95"].append(float(np.percentile(slots, 95)))
            found["silent"].append(result.counts["silent"])
            found["open"].append(result.plan.wanted - result.counts["completed"])
        return found

    def key_of(self, seeds: Sequence[int]) -> str:
        """The key of its point."""
        return f"{self.key} seeds {seeds[0]}-{seeds[-1]}"

    def point(self, seeds: Sequence[int]) -> Point:
        """The point that measures it."""
        return Point.of(self.key_of(seeds), 3e-4 * self.packets * len(seeds), self.measure, seeds)


def seeds(quick: bool) -> range:
    """Seeds of the runs at each load: 5, or 2 if `quick`."""
    return range(1, 3 if quick else 6)


def offered(who: tuple[str, int], size: int, n: int, load: float, quick: bool) -> Offered:
    """One place of a curve."""
    return Offered(*who, size, n, load, 600 if quick else 3000)


def loads(quick: bool) -> tuple[float, ...]:
    """Offered loads, as shares of the channel."""
    return BARS if quick else LOADS


def points(quick: bool) -> list[Point]:
    """A point for each protocol, packet length, number of stations and load."""
    return [
        offered(who, size, n, load, quick).point(seeds(quick))
        for who in LOOKS
        for size in SIZES
        for n in STATIONS
        for load in loads(quick)
    ]


def delay(
    results: Results, who: tuple[str, int], size: int, n: int, load: float, quick: bool
) -> tuple[float, float]:
    """Mean delay, slots, and half its 95 % interval between runs."""
    found = results[offered(who, size, n, load, quick).key_of(seeds(quick))]["mean"]
    between = mean_interval(found)
    return between.value, between.high - between.value


def perfect_queue(size: int, load: float) -> float:
    """Mean delay, slots, if all packets stood in one queue that everybody sees (M/D/1)."""
    service = size + TURNAROUND + DELAY
    return size + TURNAROUND + load * service / (2 * (1 - load))


def draw(results: Results, quick: bool) -> Figure:
    """A panel for every length of packets and number of stations."""
    figure, axes = style.panels(style.WIDE_IN, 6.2, 2, 2)
    places = [(size, n) for size in SIZES for n in STATIONS]
    for ax, letter, (size, n) in zip(axes, "abcd", places, strict=True):
        _panel(ax, results, size, n, quick)
        ax.set_title(f"{letter}  T = {size}, n = {n}")
    for ax in (axes[0], axes[2]):
        ax.set_ylabel("mean delay (slots)")
    for ax in axes[2:]:
        ax.set_xlabel("load (% of the hand-over bound)")
    handles, names = axes[0].get_legend_handles_labels()
    figure.legend(handles, names, loc="outside lower center", ncols=3)
    return figure


def _panel(ax: Axes, results: Results, size: int, n: int, quick: bool) -> None:
    x = [100 * load for load in loads(quick)]
    for who, look in LOOKS.items():
        found = [delay(results, who, size, n, load, quick) for load in loads(quick)]
        means = [mean for mean, _ in found]
        low = [min(half, 0.9 * mean) for mean, half in found]
        ax.errorbar(x, means, yerr=[low, [half for _, half in found]], color=look.colour,
                    ls=look.dash, marker=look.marker, ms=3, lw=1.1, elinewidth=0.6, capsize=1.5,
                    label=look.name)  # fmt: skip
    fine = np.linspace(0.05, 0.95, 60)
    ax.plot(100 * fine, [perfect_queue(size, load) for load in fine], color=style.INK, ls=_DOT,
            lw=1.1, label="one perfect queue")  # fmt: skip
    ax.set_yscale("log")
    ax.set_ylim(size + 5, TOP)
    ax.set_xlim(5, 95)


def judge(results: Results, quick: bool) -> list[Claim]:
    """At each load: below what it has to be below?"""
    return [
        _sound(results, quick),
        *(_light(results, n, quick) for n in STATIONS),
        *(
            _below(results, n, load, rivals, 1, quick)
            for load, rivals in ((0.3, (DCF, TDMA)), (0.6, (TDMA, RING)), (0.9, (TDMA, RING)))
            for n in STATIONS
        ),
        *(
            _below(results, n, load, (TDMA, RING), 4, quick)
            for load in (0.6, 0.9)
            for n in STATIONS
        ),
    ]


def _sound(results: Results, quick: bool) -> Claim:
    runs = [
        results[offered(who, size, n, load, quick).key_of(seeds(quick))]
        for who in ((PRACTICAL, 1), (PRACTICAL, 4))
        for size in SIZES
        for n in STATIONS
        for load in loads(quick)
    ]
    silent = round(sum(sum(run["silent"]) for run in runs))
    left = round(sum(sum(run["open"]) for run in runs))
    return Claim(
        "beyond",
        "with 2 ms the practical mode loses nothing silently at any load",
        f"{len(runs) * len(seeds(quick))} runs: {silent} lost silently, {left} left over",
        verdict(silent == left == 0),
    )


def _light(results: Results, n: int, quick: bool) -> Claim:
    words, fine = [], []
    for size in SIZES:
        ours, half = delay(results, (PRACTICAL, 1), size, n, 0.1, quick)
        dcf, _ = delay(results, (DCF, 1), size, n, 0.1, quick)
        fine.append(ours <= NEAR_DCF * dcf)
        words.append(
            f"T = {size}: {ours:.1f} +- {half:.1f} slots, {ours / dcf:.2f} times DCF's {dcf:.1f}, "
            f"perfect queue {perfect_queue(size, 0.1):.1f}"
        )
    return Claim(
        "beyond",
        f"at 10 % load and {n} stations the mean delay is at most 1.3 times DCF's",
        joined(words, "; "),
        verdict(all(fine)),
        "" if all(fine) else _LIGHT,
    )


_LIGHT = (
    "an opening lasts a turnaround and two slots, so that two of them overlap everywhere, and a "
    "pulse proves it: whoever pulses is deaf for two turnarounds; DCF is told for nothing"
)


def _below(
    results: Results, n: int, load: float, rivals: tuple[str, ...], per_turn: int, quick: bool
) -> Claim:
    words, fine = [], []
    for size in SIZES:
        ours, half = delay(results, (PRACTICAL, per_turn), size, n, load, quick)
        pairs = [(mac, 1 if mac in (DCF, TDMA) else per_turn) for mac in rivals]
        theirs = [delay(results, pair, size, n, load, quick)[0] for pair in pairs]
        fine.append(ours < min(theirs))
        beside = joined(f"{LOOKS[pair[0], 1].name.split(',')[0]} {value:.0f}"
                        for pair, value in zip(pairs, theirs, strict=True))  # fmt: skip
        words.append(f"T = {size}: {ours:.0f} +- {half:.0f} slots, {beside}, "
                     f"perfect queue {perfect_queue(size, load):.0f}")  # fmt: skip
    turn = "" if per_turn == 1 else f", up to {per_turn} packets a turn and a token,"
    names = joined((LOOKS[mac, 1].name.split(",")[0] for mac in rivals), " and ")
    return Claim(
        "beyond",
        f"at {100 * load:.0f} % load and {n} stations{turn} the mean delay is below {names}",
        joined(words, "; "),
        verdict(all(fine)),
        "" if all(fine) else _REASONS[load],
    )


_REASONS = {
    0.3: "who comes while others send asks for a place: a window and a report cost two "
    "turnarounds, more than its packet",
    0.6: "as at 30 %; a place is kept over a few turns without a packet, three slots and a "
    "turnaround each, where a token has two slots",
    0.9: "windows for newcomers: the ring and TDMA know all their stations beforehand",
}

EXPERIMENT = Experiment(
    "delay",
    "Beyond the paper: delay against load",
    "Event level, turnaround 2 ms, delays 52..104 us, Poisson packets. Bars: 95 % between runs. "
    "Above 2,000 slots, where DCF, polling and the ring cannot carry the load: off the chart. "
    "Dotted: one queue that everybody sees, one packet a turn.",
    points,
    draw,
    judge,
)
