"""Which loop runs which protocol of the slotted level, with which times. Times in ticks."""

import functools
from collections.abc import Callable, Collection
from dataclasses import dataclass
from math import exp
from typing import Any

import numpy as np

from innervate.kernel import compilation
from innervate.networks.radio.scenario.slotted import BACKOFF, BY_CHANCE, TURNAROUND
from innervate.networks.radio.slotted import chance as chance
from innervate.networks.radio.slotted import contend as contend
from innervate.networks.radio.slotted import draws as draws
from innervate.networks.radio.slotted import recorder as rec
from innervate.networks.radio.slotted import turns as turns
from innervate.networks.radio.slotted.recorder import Numbers, Recorder

SLOT = 208  # the paper's us
POISSON_TAIL = 1e-12
TRAFFIC = {"saturated": rec.SATURATED, "disaster": rec.DISASTER, "poisson": rec.POISSON}
STATIONS_MAX = 10_000
PACKET_SLOTS_MAX = 10_000
SUCCESSES_MAX = 100_000_000
LOAD_MAX = 50.0
MACS = TURNAROUND | BACKOFF | BY_CHANCE | {"dcf", "tree", "tdma"}
USED_BY = {
    "p": BY_CHANCE,
    "reading": {"csma-cd-r"},
    "window": {"csma-cd-r"},
    "backoff": BACKOFF,
    "backoff_slots": BACKOFF,
    "turnaround_slots": TURNAROUND,
    "return_slots": TURNAROUND - {"csma-cd-r"},
    "dcf": {"dcf"},
}


@dataclass(frozen=True, slots=True)
class Dcf:
    """Times (us) and backoff of 802.11 DCF: `window` values, doubled at most `stages` times.

    `success_us` and `collision_us` last from the start of the frame to the next backoff step.
    """

    slot_us: int
    payload_us: int
    success_us: int
    collision_us: int
    window: int
    stages: int

    @property
    def sound(self) -> bool:
        """All in range: times positive, 1 <= window doubled `stages` times <= 2^20."""
        times = self.slot_us, self.payload_us, self.success_us, self.collision_us
        return (
            min(times) > 0
            and self.stages in range(21)
            and 0 < self.window << self.stages <= 1 << 20
        )


def dcf_here(packet_slots: int) -> Dcf:
    """DCF on the paper's channel: behind a packet an idle slot, a one-byte answer, an idle slot.

    802.11's window for FHSS, 16 to 1024 (Bianchi 2000, Table I).
    """
    packet = packet_slots * SLOT
    return Dcf(SLOT, packet, packet + 3 * SLOT, packet + SLOT, window=16, stages=6)


@dataclass(frozen=True, slots=True)
class Setting:
    """What runs on the slotted channel; from `p` on, what only some of the protocols have."""

    mac: str  # one of MACS
    # 1..10,000; 0 = an infinite population (slotted-aloha, nonpersistent, p-persistent under
    # Poisson traffic), which ends after `packets` successes or 1,000 times as many attempts.
    stations: int
    packet_slots: int  # packet length T, 1..10,000 slots
    # "saturated", "disaster" (all at once, one packet each) or "poisson". Whoever has a packet in
    # csma-cd-* sends as soon as the channel is idle.
    traffic: str
    # Per station in the mean, >= 1: a saturated run ends after stations * packets successes,
    # whosever they are; a Poisson run with the first station that has none left.
    packets: int = 1000
    seed: int = 1  # root seed >= 0; the streams of protocol and traffic are derived from it
    # Share of the successes that is not measured, 0 <= warmup < 1; none in a disaster.
    warmup: float = 0.1
    # Poisson: packets offered per packet time (T slots) by all stations together, up to 50; with an
    # infinite population that is fresh packets and retransmissions.
    load: float | None = None
    # Packets that end later do not count, and the time measured ends there.
    until_slots: float | None = None
    # Probability of sending in a slot, 0 < p <= 1: 1 / stations if it is not given, and 0.1 for
    # p-persistent with an infinite population.
    p: float | None = None
    reading: str = "A"  # "A" or "B"
    # Slots of the reservation window; T (T - Tc0 at Tc0 = 0) if it is not given.
    window: int | None = None
    backoff: str = "binary"  # or "linear": k + 1 values after k collisions [radio Q15]
    backoff_slots: int = 1  # how long a slot of the backoff is
    # A packet is on air that long after its decision; carriers that come up meanwhile go unnoticed.
    # csma-cd-r pays it at every hand-over: opening, reservation, each turn.
    turnaround_slots: float = 0.0
    # How long after its end a sender knows the channel again; turnaround_slots if not given, as on
    # the medium [radio M4]. 0 is a gift to CSMA/CD: its packets cost one turnaround instead of two.
    # With either, everybody knows of every collision, the last to finish too.
    return_slots: float | None = None
    dcf: Dcf | None = None  # `dcf_here` if it is not given; its slots are the result's

    def check(self, given: Collection[str] = ()) -> None:
        """Raise ValueError for what is outside its range, or given to a protocol without a use."""
        mac, traffic, stations, load = self.mac, self.traffic, self.stations, self.load
        poisson, infinite = traffic == "poisson", stations == 0
        unused = [name for name, macs in USED_BY.items() if name in given and mac not in macs]
        for holds, what in (
            (mac in MACS, f"mac is one of {', '.join(sorted(MACS))}; not {mac!r}"),
            (traffic in TRAFFIC, f"traffic is one of {', '.join(TRAFFIC)}; not {traffic!r}"),
            (0 <= stations <= STATIONS_MAX, f"stations are 0..{STATIONS_MAX}; not {stations}"),
            (not infinite or (mac in BY_CHANCE and poisson),
             f"{mac} with {traffic} traffic needs stations >= 1"),
            (1 <= self.packet_slots <= PACKET_SLOTS_MAX,
             f"packet_slots are 1..{PACKET_SLOTS_MAX}; not {self.packet_slots}"),
            (1 <= self.packets <= SUCCESSES_MAX // max(1, stations),
             f"packets are >= 1 and at most {SUCCESSES_MAX} in all; not {self.packets}"),
            (self.seed >= 0 and 0 <= self.warmup < 1, "seed is >= 0 and warmup in 0 <= warmup < 1"),
            ((load is not None) == poisson, "load belongs to poisson traffic, and only to it"),
            (load is None or 0 < load <= LOAD_MAX,
             f"load is in 0 < load <= {LOAD_MAX:g}; not {load}"),
            (not unused, f"{mac} has no use for {' and '.join(unused)}"),
            (not infinite or "p" not in given or mac == "p-persistent",
             f"{mac} has no use for p with an infinite population"),
            (self.p is None or 0 < self.p <= 1, "p is a probability, 0 < p <= 1"),
            (self.reading in ("A", "B"), "reading is A or B"),
            (self.window is None or self.window >= 0, "window is a number of slots >= 0"),
            (self.backoff in ("binary", "linear"), "backoff is binary or linear"),
            (1 <= self.backoff_slots <= 10_000, "backoff_slots is in 1..10,000"),
            (0 <= self.turnaround_slots <= 10_000, "turnaround_slots is in 0..10,000"),
            (0 <= (self.return_slots or 0) <= 10_000, "return_slots is in 0..10,000"),
            (self.dcf is None or self.dcf.sound, "dcf needs times > 0 and a window >= 1"),
        ):  # fmt: skip
            if not holds:
                raise ValueError(what)


@dataclass(frozen=True, slots=True)
class Job:
    """One run: of which setting, into which recorder."""

    setting: Setting
    recorder: Recorder
    plain: bool

    @property
    def packet(self) -> int:
        """How long a packet is on the air, ticks."""
        return self.setting.packet_slots * SLOT

    @property
    def turn(self) -> int:
        """From a decision to the first bit on air."""
        return round(self.setting.turnaround_slots * SLOT)

    def run(self, function: Callable[..., None], *values: Any) -> None:
        """Call a loop with the recorder and these values: integers, or what holds them."""
        loop(function, self.plain)(self.recorder, *values)


def drive(job: Job) -> int:
    """Run a protocol until its recorder is full; the idle time that belongs to its last packet."""
    mac = job.setting.mac
    if mac in BACKOFF:
        return _contend(job)
    if mac in BY_CHANCE:
        return _attempt(job) if job.setting.stations else _pool(job)
    return {"csma-cd-r": _reserve, "dcf": _dcf, "tree": _tree, "tdma": _tdma}[mac](job)


def _reserve(job: Job) -> int:
    """Reading A: T + 1 slots for the collision and for each packet, first report and window next.

    B: no idle slots, and a slot for each of the m - 1 reports.
    """
    packet, turn = job.packet, job.turn
    window = job.setting.packet_slots if job.setting.window is None else job.setting.window
    if job.setting.reading == "A":
        lead = turn + packet + SLOT + turn + SLOT + window * SLOT
        times = turns.Reservation(SLOT, turn, packet, lead, 0, turn + packet + SLOT)
        job.run(turns.reserve, times)
        return SLOT
    lead = turn + packet + turn + window * SLOT
    job.run(turns.reserve, turns.Reservation(SLOT, turn, packet, lead, SLOT, turn + packet))
    return SLOT if len(job.recorder.offer) == 1 else 0


def _contend(job: Job) -> int:
    cost = SLOT if job.setting.mac == "csma-cd-d1" else job.packet + SLOT
    linear, redraw = job.setting.backoff == "linear", job.setting.mac == "csma-cd-d2p"
    given = job.setting.return_slots
    back = job.turn if given is None else round(given * SLOT)
    times = SLOT, job.packet, cost, job.turn, back, job.setting.backoff_slots * SLOT
    job.run(contend.contend, contend.Contention(*times, int(linear), int(redraw)))
    return SLOT


def _dcf(job: Job) -> int:
    times = job.setting.dcf or dcf_here(job.setting.packet_slots)
    at_once = int(job.recorder.counts[rec.TRAFFIC] == rec.DISASTER)
    costs = times.slot_us, times.success_us, times.collision_us
    rules = contend.Counters(*costs, times.window, times.stages, at_once)
    job.run(contend.distribute, rules)
    return 0


def _tree(job: Job) -> int:
    job.run(turns.split, job.packet)
    return 0


def _tdma(job: Job) -> int:
    job.run(turns.take_turns, SLOT, job.packet)
    return SLOT


def _attempt(job: Job) -> int:
    p = job.setting.p or 1 / len(job.recorder.offer)
    step, gap = (job.packet, 0) if job.setting.mac == "slotted-aloha" else (SLOT, SLOT)
    job.run(chance.attempt, round(p * draws.UNIT), step, job.packet, gap)
    return gap


def _pool(job: Job) -> int:
    mac, load = job.setting.mac, job.setting.load
    assert load is not None
    if mac == "slotted-aloha":
        job.run(chance.pool, poisson_table(load), job.packet, job.packet, 0)
        return 0
    per_slot = load / job.setting.packet_slots
    table = poisson_table(per_slot)
    if mac == "nonpersistent":
        job.run(chance.pool, table, SLOT, job.packet, SLOT)
        return SLOT
    after = poisson_table(per_slot * (job.setting.packet_slots + 1))
    p = round((job.setting.p or 0.1) * draws.UNIT)
    job.run(chance.persist, table, after, p, SLOT, job.packet)
    return SLOT


def poisson_table(mean: float) -> Numbers:
    """Cumulative probabilities of a Poisson number, in 1 / UNIT; mean 0..100."""
    share = total = exp(-mean)
    table = [total]
    while len(table) <= mean or share > POISSON_TAIL:
        share *= mean / len(table)
        total += share
        table.append(total)
    return np.array([round(min(1.0, x) * draws.UNIT) for x in table], np.int64)


def loop(function: Callable[..., Any], plain: bool) -> Callable[..., Any]:
    """A loop as it is, or compiled."""
    return function if plain else _compiled(function)


@functools.cache
def _compiled(function: Callable[..., Any]) -> Callable[..., Any]:
    compilation.register_functions(
        draws.step, draws.draw, draws.shuffle, draws.exponential, draws.choose,
        rec.going, rec.deliver, rec.ready, rec.opening,
        *contend.PARTS, *turns.PARTS, *chance.PARTS,
    )  # fmt: skip
    return compilation.compiled(function)
