"""Beyond the paper: delay against load with 2 ms to switch, beside what the paper names and DCF.

All on the event level, with the same delays, turnaround and packets. Load is a share of the
hand-over bound: what the channel can carry if every packet is heard by everybody, one a turn.
A delay counts from the offer to the end of the frame that was received, for all alike. What a
sender learns, and when, counts only by the time that the channel is kept for it: the practical
mode's windows and pulses, DCF's two slots (its receivers would have to switch, and its sender, too:
`DCF_ANSWERS` keeps that free), nothing with TDMA, a token ring and polling, whose senders are told.

DCF takes a packet for received once anybody has it: in IEEE 802.11 one receiver answers, and a
packet for all is neither answered nor sent again (RFC 9119, 3.1.1). Ours are for all, and are heard
by all. `DCF_HERE` is what a DCF would have to do here: it sends until all have a packet, and keeps
time for one answer. Bars are judged by `DCF`; what they are beside `DCF_HERE` is said with them.
"""

from dataclasses import dataclass, replace
from itertools import product

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from innervate.analysis.intervals import mean_interval
from innervate.networks.radio.analysis import formulas as forms
from innervate.networks.radio.papers.common import SIZES, TURNAROUND, TURNAROUND_US, Look
from innervate.networks.radio.papers.medium import Channel
from innervate.networks.radio.papers.practice import DELAY
from innervate.networks.radio.papers.where import PARTS, parts
from innervate.networks.radio.scenario.baselines import GRANTED as TOLD
from innervate.networks.radio.scenario.baselines import Granted, baseline
from innervate.networks.radio.scenario.plan import RadioPlan
from innervate.networks.radio.sim.simulate import simulate
from innervate.papers import drawing
from innervate.papers.experiment import Claim, Claims, Measured, Point, beyond, sized, verdict
from innervate.papers.words import joined
from innervate.plot import style
from innervate.sim.tables import uniform

TITLE = "Beyond the paper: delay against load"
CAPTION = (
    "Event level, turnaround 2 ms, delays 52..104 us, Poisson packets. Bars: 95 % between runs. "
    "Above 2,000 slots, where DCF, polling and the ring cannot carry the load: off the chart. "
    "Dotted: one queue that everybody sees, the least that anybody could have. Delays end with "
    "the packet; what its sender learns costs time on the channel only. DCF counts a packet that "
    "anybody received; the darkest dashes send until everybody has it."
)
STATIONS = (5, 20)
BARS = (0.1, 0.3, 0.6, 0.9)  # loads that are judged
LOADS = (0.1, 0.2, 0.3, 0.45, 0.6, 0.75, 0.9)
loads = sized(BARS, LOADS)  # shares of the channel
PRACTICAL, DCF, TDMA, RING, POLLING = "practical", "dcf", "tdma", "token-ring", "polling"
DCF_ANSWERS = "dcf, answering"  # the answer takes the turnaround, there and back
DCF_HERE = "dcf, for all, answering"  # ... and a packet goes again until everybody has it
GRANTED = {
    DCF_ANSWERS: Granted(answers="turnaround"),
    DCF_HERE: Granted(received_by="everybody", answers="turnaround"),
}
NEAR_DCF = 1.3  # times DCF's delay at a tenth of the load
FLOOR_PACKETS = 20_000
TOP = 2000  # slots; what is above is off the chart
_DOT = style.DASHES[2]
LOOKS = {
    (PRACTICAL, 1): Look("CSMA/CD-R, practical", style.BLUE, "-", "o"),
    (PRACTICAL, 4): Look("... up to 4 packets a turn", style.SKY, "-", "o"),
    (DCF, 1): Look("802.11 DCF, told for nothing", style.PURPLE, "-", "v"),
    (DCF_ANSWERS, 1): Look("... time for its answers", style.PURPLE, style.DASHES[1], "<"),
    (DCF_HERE, 1): Look("... and until everybody has it", style.WINE, style.DASHES[1], ">"),
    (TDMA, 1): Look("TDMA", style.BLACK, "-", "s"),
    (RING, 1): Look("token ring, token of 2 slots", style.VERMILION, "-", "^"),
    (RING, 4): Look("... up to 4 packets a token", style.ORANGE, "-", "^"),
    (POLLING, 1): Look("polling", style.GREEN, "-", "D"),
}  # fmt: skip


@dataclass(frozen=True, slots=True)
class Offered:
    """Poisson packets at a load, by one protocol."""

    mac: str  # "practical" or a baseline's name
    per_turn: int  # most packets in a turn
    size: int  # T, slots
    n: int  # stations
    load: float  # share of the hand-over bound, 0 .. 1
    packets: int  # about, of all stations

    def __str__(self) -> str:
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
            mac = self.mac.split(",")[0]
            params = baseline(mac, self.n, plan.params, granted=GRANTED.get(self.mac, TOLD))
            plan = replace(plan, protocol=mac, params=params)
        return plan

    def measure(self, seed: int) -> dict[str, float]:
        """Mean delay, slots from offer to the end of the frame; what went wrong."""
        result = simulate(self.plan(seed), checks=False)
        packets, counts = result.packets, result.counts
        slots = (packets["end"] - packets["offered"]) / result.plan.params["slot_us"]
        left = result.plan.wanted - counts["completed"]
        spent = parts(result) if (self.mac, self.per_turn) == (PRACTICAL, 1) else {}
        return {"mean": float(slots.mean()), "silent": counts["silent"], "open": left, **spent}


def point(who: tuple[str, int], size: int, n: int, load: float, quick: bool) -> Point:
    """One place of a curve."""
    packets, seeds = (600, 2) if quick else (3000, 5)
    offered = Offered(*who, size, n, load, packets)
    return Point.each(str(offered), 3e-4 * packets, seeds, offered.measure)


def points(quick: bool, of: tuple[tuple[str, int], ...] = tuple(LOOKS)) -> list[Point]:
    """A point for each protocol, packet length, number of stations and load."""
    return [point(*one, quick) for one in product(of, SIZES, STATIONS, loads(quick))]


def delay(
    got: Measured, who: tuple[str, int], size: int, n: int, load: float
) -> tuple[float, float]:
    """Mean delay, slots, and half its 95 % interval between runs."""
    between = mean_interval(got[point(who, size, n, load, got.quick)]["mean"])
    return between.value, between.high - between.value


def perfect_queue(size: int, load: float, per_turn: int = 1) -> float:
    """The least mean delay, slots: all packets in one queue that everybody sees (M/D/1).

    With several packets a turn as if every turn was full: fewer hand-overs nobody can have.
    """
    service = size + (TURNAROUND + DELAY) / per_turn
    busy = load * service / (size + TURNAROUND + DELAY)
    return size + TURNAROUND + busy * service / (2 * (1 - busy))


def at_once(size: int, n: int, load: float) -> float:
    """The least mean delay, slots, if whoever finds the channel idle sends at once.

    Others who decide before they can hear that collide with it; they are lost together, all learn
    it for nothing when the last has ended, and from there on stand in the perfect queue.
    """
    deaf, turn = TURNAROUND + DELAY, size + TURNAROUND + DELAY
    drawn = (1 + uniform(1, "at once", FLOOR_PACKETS, 1 << 30)) / (1 << 30)
    offers = np.cumsum(-np.log(drawn) * turn / load).tolist()
    of = uniform(1, "at once, of", FLOOR_PACKETS, n).tolist()
    free, total = 0.0, 0.0
    for i, at in enumerate(offers):
        if at >= free:  # idle: who else begins before this is heard?
            last, k = at, i + 1
            while k < len(offers) and offers[k] < at + deaf:
                last = offers[k] if of[k] != of[i] else last
                k += 1
            free = at if last == at else last + turn
        total += free + TURNAROUND + size - at
        free += turn
    return total / len(offers)


def draw(got: Measured) -> Figure:
    """A panel for every length of packets and number of stations."""
    figure, axes = style.panels(style.WIDE_IN, 6.2, 2, 2)
    places = [(size, n) for size in SIZES for n in STATIONS]
    for ax, letter, (size, n) in zip(axes, "abcd", places, strict=True):
        _panel(ax, got, size, n)
        ax.set_title(f"{letter}  T = {size}, n = {n}")
    for ax in (axes[0], axes[2]):
        ax.set_ylabel("mean delay (slots)")
    for ax in axes[2:]:
        ax.set_xlabel("load (% of the hand-over bound)")
    drawing.legend(figure, axes[0], "lower center", ncols=3)
    return figure


def _panel(ax: Axes, got: Measured, size: int, n: int) -> None:
    x = [100 * load for load in loads(got.quick)]
    for who, look in LOOKS.items():
        found = [delay(got, who, size, n, load) for load in loads(got.quick)]
        means, halves = zip(*found, strict=True)
        low = [min(half, 0.9 * mean) for mean, half in found]
        reach = [low, halves]
        ax.errorbar(x, means, reach, ms=3, lw=1.1, elinewidth=0.6, capsize=1.5, **look.how)
    fine = np.linspace(0.05, 0.95, 60)
    for per_turn, colour, name in ((1, style.INK, "floor: one perfect queue"),
                                   (4, style.SOFT, "floor, 4 packets a turn")):  # fmt: skip
        least = [perfect_queue(size, load, per_turn) for load in fine]
        ax.plot(100 * fine, least, color=colour, ls=_DOT, lw=1.1, label=name)
    ax.set(yscale="log", ylim=(size + 5, TOP), xlim=(5, 95))


def judge(got: Measured) -> Claims:
    """At each load: below what it has to be below?"""
    runs = [got[one] for one in points(got.quick, ((PRACTICAL, 1), (PRACTICAL, 4)))]
    silent, left = (round(sum(sum(run[name]) for run in runs)) for name in ("silent", "open"))
    yield beyond(
        "with 2 ms the practical mode loses nothing silently at any load",
        f"{sum(len(run['open']) for run in runs)} runs: {silent} lost silently, {left} left over",
        verdict(silent == left == 0),
    )
    for n in STATIONS:
        yield _light(got, n)
    for load, rivals in ((0.3, (DCF, TDMA)), (0.6, (TDMA, RING)), (0.9, (TDMA, RING))):
        for n in STATIONS:
            yield _below(got, n, load, rivals, 1)
    for load in (0.6, 0.9):
        for n in STATIONS:
            yield _below(got, n, load, (TDMA, RING), 4)


def spent(got: Measured, size: int, n: int, load: float) -> str:
    """Where the slots of our mean delay went, besides the turnaround and the packet itself."""
    run = got[point((PRACTICAL, 1), size, n, load, got.quick)]
    means = {"turnaround and packet": TURNAROUND + size}
    means |= {name: sum(run[name]) / len(run[name]) for name in PARTS}
    return "of which " + joined(f"{name} {mean:.1f}" for name, mean in means.items())


def _light(got: Measured, n: int) -> Claim:
    words, fine = [], True
    for size in SIZES:
        ours, half = delay(got, (PRACTICAL, 1), size, n, 0.1)
        dcf, _ = delay(got, (DCF, 1), size, n, 0.1)
        fine = fine and ours <= NEAR_DCF * dcf
        answers, _ = delay(got, (DCF_ANSWERS, 1), size, n, 0.1)
        words.append(
            f"T = {size}: {ours:.1f} +- {half:.1f} slots, {ours / dcf:.2f} times DCF's {dcf:.1f}, "
            f"{ours / answers:.2f} times that of a DCF with time for answers, "
            f"{_beside_here(got, ours, size, n, 0.1)}, "
            f"floor {perfect_queue(size, 0.1):.1f} for anybody, {at_once(size, n, 0.1):.1f} for "
            f"who sends at once; {spent(got, size, n, 0.1)}"
        )
    return beyond(
        f"at 10 % load and {n} stations the mean delay is at most 1.3 times DCF's",
        joined(words, "; "),
        verdict(fine),
        "" if fine else _REASONS[0.1],
    )


def _beside_here(got: Measured, ours: float, size: int, n: int, load: float) -> str:
    """What the bar would be beside a DCF that does what ours do."""
    here, _ = delay(got, (DCF_HERE, 1), size, n, load)
    fine = ours <= NEAR_DCF * here if load == BARS[0] else ours < here
    return (
        f"{ours / here:.2f} times the {here:,.0f} of a DCF that sends until all have it and keeps "
        f"time for its answers (beside that one it {'holds' if fine else 'does not hold'})"
    )


def _below(got: Measured, n: int, load: float, rivals: tuple[str, ...], per_turn: int) -> Claim:
    words, fine = [], True
    names = [LOOKS[mac, 1].name.split(",")[0] for mac in rivals]
    for size in SIZES:
        ours, half = delay(got, (PRACTICAL, per_turn), size, n, load)
        pairs = [(mac, 1 if mac in (DCF, TDMA) else per_turn) for mac in rivals]
        theirs = [delay(got, pair, size, n, load)[0] for pair in pairs]
        fine = fine and ours < min(theirs)
        beside = joined(f"{name} {value:.0f}" for name, value in zip(names, theirs, strict=True))
        floor = perfect_queue(size, load, per_turn)
        where = "" if per_turn > 1 else f"; {spent(got, size, n, load)}"
        if DCF in rivals:
            beside += f", {_beside_here(got, ours, size, n, load)}"
        words.append(f"T = {size}: {ours:.0f} +- {half:.0f} slots, {beside}, "
                     f"floor {floor:.0f}{where}")  # fmt: skip
    turn = "" if per_turn == 1 else f", up to {per_turn} packets a turn and a token,"
    return beyond(
        f"at {100 * load:.0f} % load and {n} stations{turn} the mean delay is below "
        + " and ".join(names),
        joined(words, "; "),
        verdict(fine),
        "" if fine else _REASONS[load],
    )


_REASONS = {
    0.1: "a pulse proves an opening, a turnaround and two slots behind its beginning, when nobody "
    "else can have begun: whoever pulses is deaf for two turnarounds; DCF is told for nothing",
    0.3: "who comes while others send asks for a place: a window and a report cost two "
    "turnarounds, more than its packet",
    0.6: "as at 30 %: kept places are asked in one window, but a window and its report are two "
    "turnarounds; a token asks few stations quicker",
    0.9: "windows and reports: the ring and TDMA know all their stations beforehand, and a token "
    "goes with a packet",
}
