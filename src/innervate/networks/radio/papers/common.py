"""What the figures of the radio paper share: runs of the slotted level, looks of curves."""

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from matplotlib.axes import Axes

from innervate.networks.radio.slotted.drive import SLOT
from innervate.networks.radio.slotted.model import slotted
from innervate.papers import drawing
from innervate.papers.experiment import Measured, Point, columns, verdict
from innervate.papers.words import joined, spans
from innervate.plot import style

TAU_US = 104
TURNAROUND_US = 2000  # "It takes 2ms to change a mode" (section 4)
TURNAROUND = TURNAROUND_US / SLOT
SIZES = (5, 25)  # T of Figs. 4 to 7
RESERVED = "csma-cd-r"
CONTENDING = ("csma-cd-d1", "csma-cd-d2", "csma-cd-d2p")
SHORT = dict(zip(CONTENDING, ("D1", "D2", "D2'"), strict=True))
PEERS = ("p-persistent", "slotted-aloha", "dcf", "tree", "tdma")
MACS = (RESERVED, *CONTENDING, *PEERS)
READING_B = f"{RESERVED} B"
EVERYBODY = (RESERVED, READING_B, *CONTENDING, *PEERS)
WHOLE = tuple(range(2, 101))
FEW = (2, 3, 4, 5, 7, 10, 15, 20, 30, 50, 70, 100)

Options = tuple[tuple[str, Any], ...]


@dataclass(frozen=True, slots=True)
class Curve:
    """A protocol of the slotted level over the number of stations."""

    mac: str
    packet_slots: int
    traffic: str
    ns: tuple[int, ...]  # numbers of stations
    seeds: int  # runs each, with seeds 1 and following
    successes: int = 10_000  # of a saturated run, about; at least 20 a station
    options: Options = ()  # of `sim.slotted.slotted`

    @property
    def key(self) -> str:
        """All of it in words."""
        words = "".join(f" {name}={value}" for name, value in self.options)
        if self.traffic == "saturated":
            words += f" {self.successes} successes"
        return (
            f"slotted {self.mac} T={self.packet_slots} {self.traffic}{words} "
            f"n={spans(self.ns)} seeds 1-{self.seeds}"
        )

    def measure(self) -> dict[str, list[list[float]]]:
        """Of every n, the numbers of each seed."""
        rows = [columns(self._run, (n,), range(1, self.seeds + 1)) for n in self.ns]
        return {name: [row[name] for row in rows] for name in rows[0]}

    def _run(self, n: int, seed: int) -> dict[str, float]:
        packets = max(20, self.successes // n // 10 * 10)  # so that the warm-up ends with a round
        run = slotted(
            self.mac, n, self.packet_slots, self.traffic, packets=packets, seed=seed,
            **dict(self.options),
        )  # fmt: skip
        if self.traffic == "disaster":
            return {"duration": run.duration_slots}
        return {"throughput": run.throughput, "jain_round": run.jain_round}

    def point(self) -> Point:
        """The point that measures it."""
        cost = 5e-5 if self.traffic == "disaster" else 1e-6 * self.successes
        return Point.of(self.key, cost * len(self.ns) * self.seeds, self.measure)

    def all(self, got: Measured, name: str = "") -> Any:
        """A number of every n and seed: throughput or duration, if none is named."""
        name = name or {"saturated": "throughput", "disaster": "duration"}[self.traffic]
        return np.array(got.values[self.key][name])

    def mean(self, got: Measured, name: str = "") -> Any:
        """Its mean over the seeds, of every n."""
        return self.all(got, name).mean(axis=1)

    def draw(self, ax: Axes, got: Measured, name: str = "") -> None:
        """The means as a line, and a band behind it."""
        line(ax, LOOKS[self.mac], self.ns, self.mean(got, name))
        band(ax, LOOKS[self.mac], self.ns, self.all(got, name))


def first_from(ns: Iterable[int], holds: Iterable[bool]) -> int | None:
    """The least n from which on it holds for all."""
    found = None
    for n, good in zip(ns, holds, strict=True):
        found = (n if found is None else found) if good else None
    return found


def slope(x: Any, y: Any) -> tuple[float, float, float]:
    """Fitted line: slope, value at 0, and R^2."""
    x, y = np.asarray(x, np.float64), np.asarray(y, np.float64)
    rise, start = np.polyfit(x, y, 1)
    left = ((y - rise * x - start) ** 2).sum()
    return float(rise), float(start), float(1 - left / ((y - y.mean()) ** 2).sum())


def overtaken(
    got: Measured, curves: Sequence[Curve], ahead: Callable[[int, float], bool]
) -> tuple[str, str]:
    """From which n on CSMA/CD-R is `ahead` (n, their mean) of CSMA/CDs, in words; the verdict."""
    found = {
        SHORT[one.mac]: first_from(one.ns, map(ahead, one.ns, one.mean(got))) for one in curves
    }
    words = joined(f"{name} from n = {n}" for name, n in found.items())
    return f"{words} ({curves[-1].seeds} runs each)", verdict(all(found.values()), "Q14")


class Look(NamedTuple):
    """How a curve is called and drawn."""

    name: str
    colour: str
    dash: Any
    marker: str

    @property
    def how(self) -> dict[str, Any]:
        """The same, as matplotlib calls it."""
        marker = self.marker or None
        return {"label": self.name, "color": self.colour, "ls": self.dash, "marker": marker}


_LONG, _DOT, _MIXED = style.DASHES[1:]
LOOKS = {
    "csma-cd-r": Look("CSMA/CD-R", style.BLUE, "-", "o"),
    "csma-cd-r B": Look("CSMA/CD-R, reading B", style.SKY, _LONG, ""),
    "csma-cd-d1": Look("CSMA/CD D1 (wired)", style.GREEN, _LONG, "^"),
    "csma-cd-d2": Look("CSMA/CD D2", style.VERMILION, "-", "s"),
    "csma-cd-d2p": Look("CSMA/CD D2'", style.ORANGE, _MIXED, "D"),
    "dcf": Look("802.11 DCF", style.PURPLE, "-", "v"),
    "p-persistent": Look("CSMA, p = 1/n", style.WINE, _DOT, "P"),
    "tree": Look("tree splitting", style.SOFT, _MIXED, "X"),
    "slotted-aloha": Look("slotted ALOHA", style.BROWN, "-", "*"),
    "tdma": Look("bound: TDMA", style.BLACK, _DOT, ""),
    "practical": Look("practical mode, event level", style.BLACK, "-", "o"),
}
MARKED = (2, 3, 5, 7, 10, 15, 20, 30, 50, 70, 100)


def line(ax: Axes, look: Look, x: Sequence[float], y: Any, marks: Iterable[float] = MARKED) -> None:
    """A curve with markers at some of its places."""
    chosen = set(marks)
    where = [i for i, n in enumerate(x) if n in chosen]
    ax.plot(x, y, markevery=where, ms=3, lw=1.1, **look.how)


SPREAD = (5, 95)  # percentiles of the runs


def bars(ax: Axes, look: Look, x: Sequence[float], runs: Any) -> None:
    """A curve of means with bars from 5 to 95 % of the runs; `runs` has a row for each x."""
    means = [float(np.mean(some)) for some in runs]
    low, high = (
        np.array([np.percentile(some, share) for some in runs]) - means for share in SPREAD
    )
    reach = [np.maximum(-low, 0), np.maximum(high, 0)]
    ax.errorbar(x, means, reach, ms=3, lw=1.1, elinewidth=0.8, capsize=1.5, **look.how)


def band(ax: Axes, look: Look, x: Sequence[float], runs: Any) -> None:
    """From 5 to 95 % of the runs, as a band behind a curve."""
    low, high = (np.percentile(runs, share, axis=1) for share in SPREAD)
    ax.fill_between(x, low, high, color=look.colour, alpha=0.18, lw=0)


def everybody(ax: Axes, got: Measured, curves: Mapping[str, Curve]) -> None:
    """All protocols, named at the right ends of their curves; bands behind those that contend."""
    ends = []
    for mac, one in curves.items():
        look, values = LOOKS[mac], one.mean(got)
        line(ax, look, one.ns, values)
        if mac in CONTENDING:
            band(ax, look, one.ns, one.all(got))
        ends.append((float(values[-1]), look.name, look.colour))
    drawing.end_labels(ax, ends)


def stations_axis(ax: Axes, ticks: Sequence[int] = (2, 5, 10, 20, 50, 100)) -> None:
    """The number of stations, logarithmic."""
    ax.set_xscale("log")
    ax.set_xticks(ticks, [f"{n:,}" for n in ticks])
    ax.minorticks_off()
    ax.set_xlabel("stations n")
