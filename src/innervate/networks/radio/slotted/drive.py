"""Which loop runs which protocol of the slotted level, with which times. Times in ticks."""

import functools
from collections.abc import Callable
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
class Options:
    """What only some of the protocols have.

    Attributes:
        p: slotted-aloha, nonpersistent, p-persistent: probability of sending in a slot, 0 < p <= 1;
            default 1 / stations, and 0.1 for p-persistent with stations = 0.
        reading: csma-cd-r: "A" (default) or "B".
        window: csma-cd-r: slots of the reservation window; default T (T - Tc0 at Tc0 = 0).
        backoff: csma-cd-d*: "binary" (default), or "linear": k + 1 values after k collisions
            [radio Q15].
        backoff_slots: csma-cd-d*: length of a backoff slot in slots, default 1.
        turnaround_slots: csma-cd-r, -d2, -d2p: a packet is on air that long after its decision,
            default 0; carriers that come up meanwhile go unnoticed. csma-cd-r pays it at every
            hand-over: opening, reservation, each turn.
        return_slots: csma-cd-d2, -d2p: how long after its end a sender knows the channel again;
            default turnaround_slots, as on the medium [radio M4]. 0 is a gift to CSMA/CD: its
            packets cost one turnaround instead of two. With either, everybody knows of every
            collision, the last to finish too.
        dcf: a `Dcf`; default `dcf_here(packet_slots)`. Its slots are the result's.
    """

    p: float | None = None
    reading: str = "A"
    window: int | None = None
    backoff: str = "binary"
    backoff_slots: int = 1
    turnaround_slots: float = 0.0
    return_slots: float | None = None
    dcf: Dcf | None = None

    def check(self) -> None:
        """Raise ValueError for what is outside its range."""
        _require(self.p is None or 0 < self.p <= 1, "p is a probability, 0 < p <= 1")
        _require(self.reading in ("A", "B"), "reading is A or B")
        _require(self.window is None or self.window >= 0, "window is a number of slots >= 0")
        _require(self.backoff in ("binary", "linear"), "backoff is binary or linear")
        _require(1 <= self.backoff_slots <= 10_000, "backoff_slots is in 1..10,000")
        _require(0 <= self.turnaround_slots <= 10_000, "turnaround_slots is in 0..10,000")
        _require(0 <= (self.return_slots or 0) <= 10_000, "return_slots is in 0..10,000")
        _require(self.dcf is None or self.dcf.sound, "dcf needs times > 0 and a window >= 1")


def _require(holds: bool, what: str) -> None:
    if not holds:
        raise ValueError(what)


@dataclass(frozen=True, slots=True)
class Job:
    """One run: which protocol, into which recorder; `load` only for an infinite population."""

    mac: str
    recorder: Recorder
    packet_slots: int
    load: float | None
    options: Options
    plain: bool

    @property
    def packet(self) -> int:
        """How long a packet is on the air, ticks."""
        return self.packet_slots * SLOT

    @property
    def turn(self) -> int:
        """From a decision to the first bit on air."""
        return round(self.options.turnaround_slots * SLOT)

    def run(self, function: Callable[..., None], *values: Any) -> None:
        """Call a loop with the recorder and these values: integers, or what holds them."""
        loop(function, self.plain)(self.recorder, *values)


def drive(job: Job) -> int:
    """Run a protocol until its recorder is full; the idle time that belongs to its last packet."""
    if job.mac in BACKOFF:
        return _contend(job)
    if job.mac in BY_CHANCE:
        return _pool(job) if job.load else _attempt(job)
    return {"csma-cd-r": _reserve, "dcf": _dcf, "tree": _tree, "tdma": _tdma}[job.mac](job)


def _reserve(job: Job) -> int:
    """Reading A: T + 1 slots for the collision and for each packet, first report and window next.

    B: no idle slots, and a slot for each of the m - 1 reports.
    """
    packet, turn = job.packet, job.turn
    window = job.packet_slots if job.options.window is None else job.options.window
    if job.options.reading == "A":
        lead = turn + packet + SLOT + turn + SLOT + window * SLOT
        times = turns.Reservation(SLOT, turn, packet, lead, 0, turn + packet + SLOT)
        job.run(turns.reserve, times)
        return SLOT
    lead = turn + packet + turn + window * SLOT
    job.run(turns.reserve, turns.Reservation(SLOT, turn, packet, lead, SLOT, turn + packet))
    return SLOT if len(job.recorder.offer) == 1 else 0


def _contend(job: Job) -> int:
    cost = SLOT if job.mac == "csma-cd-d1" else job.packet + SLOT
    linear, redraw = job.options.backoff == "linear", job.mac == "csma-cd-d2p"
    given = job.options.return_slots
    back = job.turn if given is None else round(given * SLOT)
    times = SLOT, job.packet, cost, job.turn, back, job.options.backoff_slots * SLOT
    job.run(contend.contend, contend.Contention(*times, int(linear), int(redraw)))
    return SLOT


def _dcf(job: Job) -> int:
    times = job.options.dcf or dcf_here(job.packet_slots)
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
    p = job.options.p or 1 / len(job.recorder.offer)
    step, gap = (job.packet, 0) if job.mac == "slotted-aloha" else (SLOT, SLOT)
    job.run(chance.attempt, round(p * draws.UNIT), step, job.packet, gap)
    return gap


def _pool(job: Job) -> int:
    assert job.load is not None
    per_slot = job.load / job.packet_slots
    if job.mac == "slotted-aloha":
        job.run(chance.pool, poisson_table(job.load), job.packet, job.packet, 0)
        return 0
    table = poisson_table(per_slot)
    if job.mac == "nonpersistent":
        job.run(chance.pool, table, SLOT, job.packet, SLOT)
        return SLOT
    after = poisson_table(per_slot * (job.packet_slots + 1))
    p = round((job.options.p or 0.1) * draws.UNIT)
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
