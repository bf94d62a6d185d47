"""The slotted level of the radio: slot counter, whole collisions, finishing order given [radio 1].

A reference model: it reproduces the numbers of the CSMA/CD-R paper's Figs. 4-7 and the baselines
next to them, and is exempt from the one-source rule. What a real medium makes of these protocols
is the event level's business.

    csma-cd-r      reservation after a collision; reading A: T + 1 slots a packet, reports inside
                   the window; B: packets back to back, a slot a report [radio Q1]
    csma-cd-d1     802.3 truncated binary exponential backoff, a collision costs one slot
    csma-cd-d2     the same, a collision costs a whole packet and its idle slot: the wireless case
    csma-cd-d2p    D2, where a station that got through draws a backoff of 0 or 1 slots as well
    slotted-aloha  slots as long as a packet            tree   binary splitting, likewise
    nonpersistent, p-persistent   slotted CSMA          tdma   fixed turns of T + 1 slots
    dcf            802.11 DCF without retry limit, as in Bianchi 2000

Backoff runs on while others send and never gives up: with the attempt limit of 802.3 packets would
be lost, and capture, its main effect here, would look milder than it is.
"""

from dataclasses import dataclass, replace
from typing import Any, NamedTuple

import numpy as np

from innervate.networks.radio.scenario.slotted import BY_CHANCE
from innervate.networks.radio.slotted import recorder as rec
from innervate.networks.radio.slotted.draws import MEAN_MAX, generator
from innervate.networks.radio.slotted.drive import MACS, SLOT, USED_BY, Job, Options, drive, loop
from innervate.networks.radio.slotted.recorder import Recorder, new_recorder, schedule

TRAFFIC = {"saturated": rec.SATURATED, "disaster": rec.DISASTER, "poisson": rec.POISSON}
STATIONS_MAX = 10_000
PACKET_SLOTS_MAX = 10_000
SUCCESSES_MAX = 100_000_000
LOAD_MAX = 50.0


@dataclass(frozen=True, slots=True, eq=False)
class SlottedResult:
    """What a slotted run measured after its warm-up; times in slots.

    throughput is airtime_slots / elapsed_slots; elapsed_slots counts the idle slot that belongs to
    a packet. duration_slots, from time 0 to the end of the last packet, counts the warm-up too.
    `order` has the station of every success, delay_slots its time from the offer to the end of the
    frame. jain is the fairness index of the successes, jain_round its mean over all runs of n
    successes. An infinite population counts as one station and has no delays.
    """

    elapsed_slots: float
    airtime_slots: float
    throughput: float
    duration_slots: float
    successes: list[int]
    order: list[int]
    collisions: int
    delay_slots: Any
    jain: float
    jain_round: float


@dataclass(frozen=True, slots=True)
class Setting:
    """What runs on the slotted channel.

    Attributes:
        mac: one of MACS.
        stations: 1..10,000; 0 = an infinite population (slotted-aloha, nonpersistent, p-persistent
            under Poisson traffic), which ends after `packets` successes or 1,000 times as many
            attempts.
        packet_slots: packet length T, 1..10,000 slots.
        traffic: "saturated", "disaster" (all at once, one packet each) or "poisson". Whoever has a
            packet in csma-cd-* sends as soon as the channel is idle.
        packets: per station in the mean, >= 1: a saturated run ends after stations * packets
            successes, whosever they are; a Poisson run with the first station that has none left.
        seed: root seed >= 0; the streams of protocol and traffic are derived from it.
        warmup: share of the successes that is not measured, 0 <= warmup < 1; none in a disaster.
        load: Poisson: packets offered per packet time (T slots) by all stations together, up to
            50; with an infinite population that is fresh packets and retransmissions.
        until_slots: packets that end later do not count, and the time measured ends there.
    """

    mac: str
    stations: int
    packet_slots: int
    traffic: str
    packets: int = 1000
    seed: int = 1
    warmup: float = 0.1
    load: float | None = None
    until_slots: float | None = None

    def check(self) -> None:
        """Raise ValueError for what is outside its range."""
        mac, stations, traffic = self.mac, self.stations, self.traffic
        if mac not in MACS:
            raise ValueError(f"mac is one of {', '.join(sorted(MACS))}; not {mac!r}")
        if traffic not in TRAFFIC:
            raise ValueError(f"traffic is one of {', '.join(TRAFFIC)}; not {traffic!r}")
        if not 0 <= stations <= STATIONS_MAX:
            raise ValueError(f"stations are 0..{STATIONS_MAX}; not {stations}")
        if stations == 0 and not (mac in BY_CHANCE and traffic == "poisson"):
            raise ValueError(f"{mac} with {traffic} traffic needs stations >= 1")
        if not 1 <= self.packet_slots <= PACKET_SLOTS_MAX:
            raise ValueError(f"packet_slots are 1..{PACKET_SLOTS_MAX}; not {self.packet_slots}")
        if self.packets < 1 or max(1, stations) * self.packets > SUCCESSES_MAX:
            raise ValueError(
                f"packets are >= 1 and at most {SUCCESSES_MAX} in all; not {self.packets}"
            )
        if self.seed < 0 or not 0 <= self.warmup < 1:
            raise ValueError("seed is >= 0 and warmup in 0 <= warmup < 1")
        if (self.load is not None) != (traffic == "poisson"):
            raise ValueError("load belongs to poisson traffic, and only to it")
        if self.load is not None and not 0 < self.load <= LOAD_MAX:
            raise ValueError(f"load is in 0 < load <= {LOAD_MAX:g}; not {self.load}")


NAMES = frozenset(Setting.__dataclass_fields__)


def slotted(
    mac: str, stations: int, packet_slots: int, traffic: str, *, plain: bool = False, **given: Any
) -> SlottedResult:
    """Run one protocol on the slotted channel.

    Args:
        mac: one of MACS.
        stations: how many; 0 = an infinite population.
        packet_slots: packet length T.
        traffic: "saturated", "disaster" or "poisson".
        plain: run the same loops uncompiled, with the same result.
        given: what else there is in `Setting`, and in `Options` what only some protocols have.

    Raises:
        ValueError: an argument outside its range, or one that this protocol has no use for.
    """
    others = {name: given.pop(name) for name in NAMES & given.keys()}
    setting = Setting(mac, stations, packet_slots, traffic, **others)
    setting.check()
    options = _options(mac, stations, given)
    if traffic == "disaster":
        setting = replace(setting, packets=1, warmup=0.0)
    return _run(setting, options, plain)


def _run(setting: Setting, options: Options, plain: bool) -> SlottedResult:
    """The same, of what may run."""
    slot, airtime = SLOT, setting.packet_slots * SLOT
    if options.dcf is not None:
        slot, airtime = options.dcf.slot_us, options.dcf.payload_us
    stations, packets, load = setting.stations, setting.packets, setting.load
    name = f"slotted/{setting.mac}/{stations}"
    kind = TRAFFIC[setting.traffic] if stations else rec.SATURATED
    recorder = new_recorder(kind, max(1, stations), packets, generator(setting.seed, name))
    if load is not None and stations:
        interval = max(1, round(stations * airtime / load))
        if interval > MEAN_MAX or interval * packets > rec.NEVER // 64:
            raise ValueError(f"{packets} packets take too long at a load of {load}")
        loop(schedule, plain)(recorder, generator(setting.seed, f"{name}/arrivals"), interval)
    offered = None if stations else load
    job = Job(setting.mac, recorder, setting.packet_slots, offered, options, plain)
    return _measure(recorder, setting, _Times(slot, airtime, drive(job)))


def _options(mac: str, stations: int, options: dict[str, Any]) -> Options:
    for name in options:
        if name not in USED_BY:
            raise ValueError(f"{name} is no option; there are {', '.join(USED_BY)}")
        if mac not in USED_BY[name]:
            raise ValueError(f"{mac} has no use for {name}")
    if stations == 0 and "p" in options and mac != "p-persistent":
        raise ValueError(f"{mac} has no use for p with an infinite population")
    given = Options(**options)
    given.check()
    return given


class _Times(NamedTuple):
    """Of a slot, a packet on the air, and the idle time that belongs to it."""

    slot: int
    airtime: int
    gap: int


def _measure(recorder: Recorder, setting: Setting, times: _Times) -> SlottedResult:
    """Times and shares from what the loop wrote down, up to a moment."""
    slot, airtime, gap = times
    until = rec.NEVER if setting.until_slots is None else round(setting.until_slots * slot)
    all_done = int(recorder.counts[rec.DONE])
    done = int(np.searchsorted(recorder.end[:all_done], until, "right"))
    skipped = int(done * setting.warmup)
    ends, order = recorder.end[skipped:done], recorder.station[skipped:done]
    since = int(recorder.end[skipped - 1]) + gap if skipped else 0
    before = int(recorder.before[skipped - 1]) if skipped else 0
    last = int(recorder.end[done - 1]) if done else 0
    elapsed = (last + gap if done == all_done else until) - since
    stations = len(recorder.offer)
    successes = np.bincount(order, minlength=stations)
    delays = (ends - recorder.offered[skipped:done]) / slot
    return SlottedResult(
        elapsed_slots=elapsed / slot,
        airtime_slots=len(ends) * airtime / slot,
        throughput=len(ends) * airtime / elapsed if done else 0.0,
        duration_slots=last / slot,
        successes=successes.tolist(),
        order=order.tolist(),
        collisions=_collisions(recorder, done, all_done) - before,
        delay_slots=delays if setting.stations else delays[:0],
        jain=jain(successes),
        jain_round=_jain_round(order, stations),
    )


def _collisions(recorder: Recorder, done: int, all_done: int) -> int:
    """Collisions up to the last success that counts; in a whole run to its end."""
    if done == all_done:
        return int(recorder.counts[rec.COLLISIONS])
    return int(recorder.before[done])


def jain(shares: Any) -> float:
    """Jain's fairness index, 1/n (one has everything) to 1; 1 where there is nothing to share.

    Jain, Chiu, Hawe 1984: (sum x)^2 / (n sum x^2).
    """
    shares = np.asarray(shares, np.float64)
    squares = float((shares**2).sum())
    return float(shares.sum()) ** 2 / (len(shares) * squares) if squares else 1.0


def _jain_round(order: Any, stations: int) -> float:
    """Mean fairness index over the whole rounds of n successes; of all if there is no round."""
    rounds = len(order) // stations
    if rounds == 0:
        return jain(np.bincount(order, minlength=stations))
    counted = np.arange(rounds * stations) // stations * stations + order[: rounds * stations]
    counts = np.bincount(counted, minlength=rounds * stations).reshape(rounds, stations)
    return float((stations / (counts.astype(np.float64) ** 2).sum(axis=1)).mean())
