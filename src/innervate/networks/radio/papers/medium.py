"""Runs of CSMA/CD-R on the event level: frames of microseconds, half-duplex radios [radio 3]."""

from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np

from innervate.networks.radio.analysis import airtime
from innervate.networks.radio.analysis import summary as radio
from innervate.networks.radio.analysis.packets import settled, traffic_of
from innervate.networks.radio.papers.common import TAU_US, Options
from innervate.networks.radio.protocol.constants import DATA
from innervate.networks.radio.scenario.plan import RadioPlan, parameters
from innervate.networks.radio.sim.simulate import RadioResult, simulate
from innervate.papers.experiment import Point
from innervate.sim.tables import uniform

START_US = 100_000


@dataclass(frozen=True, slots=True)
class Channel:
    """Stations on a shared medium."""

    # "paper": as worded plus the rules that make it run, one delay for all pairs; "practical":
    # delays of pairs drawn from 52..104 us
    mode: str
    n: int
    packet_slots: int = 25
    ta_us: int = 0
    traffic: str = "disaster"  # "disaster", "saturated" or "poisson"
    spread_us: int = 0  # starts of a disaster are drawn from 0..spread
    # given starts, whatever the carrier says; instead of drawn ones
    starts_us: tuple[int, ...] = ()
    packets: int = 1  # a station, of a saturated run
    load: float = 0.0  # Poisson: packets offered per packet time by all stations together
    options: Options = ()  # of `scenario.radio_plan.parameters`

    def __str__(self) -> str:
        """All of it in words."""
        words = [f"event {self.mode} n={self.n} T={self.packet_slots} ta={self.ta_us} us"]
        words.append(self.traffic)
        if self.traffic == "saturated":
            words.append(f"{self.packets} packets")
        elif self.traffic == "poisson":
            words.append(f"load {self.load:g}, {self.packets} packets")
        elif self.starts_us:
            words.append(f"starts {'+'.join(map(str, self.starts_us))}")
        else:
            words.append(f"spread {self.spread_us} us")
        words += [f"{name}={value}" for name, value in self.options]
        return " ".join(words)

    def plan(self, seed: int) -> RadioPlan:
        """The plan of one run."""
        real = (TAU_US, TAU_US) if self.mode == "paper" else (TAU_US // 2, TAU_US)
        params = parameters(self.packet_slots, self.ta_us, real, **dict(self.options))
        arrivals = self._arrivals(seed, params["slot_us"])
        packets = sum(map(len, arrivals)) if arrivals[0] else self.packets * self.n
        return RadioPlan(
            scenario=None,
            kind="radio",
            seed=seed,
            duration_us=200_000_000 + 400_000 * packets,
            protocol=f"csma-cd-r/{self.mode}",
            stations=self.n,
            params=params,
            delays_us=_delays(self.n, seed, *real),
            saturated=self.traffic == "saturated",
            wanted=packets,
            arrivals=arrivals,
            sizes=[[self.packet_slots] for _ in range(self.n)],
            absent=[0] * self.n,
            forced=bool(self.starts_us),
        )

    def _arrivals(self, seed: int, slot_us: int) -> list[list[int]]:
        if self.traffic == "saturated":
            return [[] for _ in range(self.n)]
        if self.traffic == "poisson":
            mean = self.n * self.packet_slots * slot_us / self.load
            found = []
            for node in range(self.n):
                drawn = 1 + uniform(seed, f"poisson {node}", self.packets, 1 << 30)
                gaps = -mean * np.log(drawn / (1 << 30))
                found.append((START_US + np.cumsum(gaps).astype(np.int64)).tolist())
            return found
        drawn = uniform(seed, "spread", self.n, self.spread_us + 1).tolist()
        return [[START_US + start] for start in self.starts_us or drawn]

    def run(self, seed: int) -> RadioResult:
        """Simulate the plan of a seed to its end, compiled."""
        return simulate(self.plan(seed))

    def point(self, seeds: int) -> Point:
        """The point that measures it with so many seeds."""
        cost = 0.004 + 8e-5 * self.n * self.packets
        return Point.each(str(self), cost, seeds, measure, self)


def _delays(n: int, seed: int, low: int, high: int) -> list[list[int]]:
    """Symmetric delays of the pairs."""
    drawn = (low + uniform(seed, "delay", n * n, high - low + 1)).tolist()
    return [[0 if i == j else drawn[min(i, j) * n + max(i, j)] for j in range(n)] for i in range(n)]


def measure(channel: Channel, seed: int) -> dict[str, Any]:
    """What the figures need of a run."""
    result = channel.run(seed)
    length, slot = radio.duration_us(result), result.plan.params["slot_us"]
    return {
        "throughput": airtime.throughput(result),
        "duration": None if length is None else length / slot,
        "jain_round": radio.jain_round(result),
        "fifo": radio.fifo(result),
        "ordered": is_ordered(result) if traffic_of(result.plan) == "disaster" else None,
        "open": left_open(result),
        "delay": radio.delay_slots(result),
        "waits": waits(result) if result.plan.saturated else None,
        **{name: result.counts[name] for name in ("completed", "silent")},
    }


def left_open(result: Any) -> int:
    """Packets that have not got through at the end; saturated, more than were wanted may have."""
    plan, done = result.plan, result.counts["completed"]
    if plan.saturated:
        return max(0, int(plan.wanted - done))
    return int(sum(map(len, plan.arrivals)) - done)


def waits(result: Any) -> list[float]:
    """Slots between two packets of a station that got through: 50, 95, 99 % and the longest."""
    found = settled(result)
    slot = result.plan.params["slot_us"]
    ends = (found["end"][found["node"] == node] for node in range(result.plan.stations))
    gaps = np.concatenate([np.diff(one) / slot for one in ends])
    percentiles: list[float] = np.percentile(gaps, (50, 95, 99, 100)).tolist()
    return percentiles


def aired(result: Any, kind: int) -> list[tuple[int, int, int]]:
    """(station, start, end) of what was sent, us from the first start."""
    rows = result.sent[result.sent["kind"] == kind]
    return [(int(r["node"]), int(r["time"]) - START_US, int(r["end"]) - START_US) for r in rows]


def said(result: Any, code: int) -> dict[int, list[tuple[int, int]]]:
    """Per station (a, b) of its reports of a kind."""
    found: dict[int, list[tuple[int, int]]] = {}
    for row in result.rows[result.rows["code"] == code]:
        found.setdefault(int(row["node"]), []).append((int(row["a"]), int(row["b"])))
    return found


def is_ordered(result: Any) -> bool:
    """One collision, one resolution, turns in the order of the ends, and no packet more."""
    n = result.plan.stations
    frames = aired(result, DATA)
    first = [node for node, _start, end in sorted(frames[:n], key=lambda frame: frame[2])]
    turns = frames[n:]
    apart = all(one[2] <= other[1] for one, other in pairwise(turns))
    return [frame[0] for frame in turns] == first and apart
