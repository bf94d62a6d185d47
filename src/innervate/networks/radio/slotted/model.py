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
from typing import Any

import numpy as np

from innervate.networks.radio.analysis import summary
from innervate.networks.radio.slotted import recorder as rec
from innervate.networks.radio.slotted.draws import MEAN_MAX, generator
from innervate.networks.radio.slotted.drive import SLOT, TRAFFIC, USED_BY, Job, Setting, drive, loop
from innervate.networks.radio.slotted.recorder import Recorder, new_recorder, schedule


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
        given: what else there is in `Setting`.

    Raises:
        ValueError: an argument outside its range, or one that this protocol has no use for.
    """
    for name in given:
        if name not in Setting.__dataclass_fields__:
            raise ValueError(f"{name} is no option; there are {', '.join(USED_BY)}")
    setting = Setting(mac, stations, packet_slots, traffic, **given)
    setting.check(given)
    if traffic == "disaster":
        setting = replace(setting, packets=1, warmup=0.0)
    recorder = _offered(setting, plain)
    return _measure(recorder, setting, drive(Job(setting, recorder, plain)))


def _offered(setting: Setting, plain: bool) -> Recorder:
    """What a run is written into, with the packets that stations will be offered."""
    stations, packets, load = setting.stations, setting.packets, setting.load
    name = f"slotted/{setting.mac}/{stations}"
    kind = TRAFFIC[setting.traffic] if stations else rec.SATURATED
    recorder = new_recorder(kind, max(1, stations), packets, generator(setting.seed, name))
    if load is not None and stations:
        interval = max(1, round(stations * _times(setting)[1] / load))
        if interval > MEAN_MAX or interval * packets > rec.NEVER // 64:
            raise ValueError(f"{packets} packets take too long at a load of {load}")
        loop(schedule, plain)(recorder, generator(setting.seed, f"{name}/arrivals"), interval)
    return recorder


def _times(setting: Setting) -> tuple[int, int]:
    """Of a slot, and of a packet on the air."""
    if setting.dcf is not None:
        return setting.dcf.slot_us, setting.dcf.payload_us
    return SLOT, setting.packet_slots * SLOT


def _measure(recorder: Recorder, setting: Setting, gap: int) -> SlottedResult:
    """Times and shares from what the loop wrote down; `gap`: idle time that a packet has behind it.

    Up to a moment, if one is given.
    """
    slot, airtime = _times(setting)
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
        # Over the whole rounds of n successes; of all if there is no round.
        jain_round=summary.jain_of_rounds(order, stations) or jain(successes),
    )


def _collisions(recorder: Recorder, done: int, all_done: int) -> int:
    """Collisions up to the last success that counts; in a whole run to its end."""
    if done == all_done:
        return int(recorder.counts[rec.COLLISIONS])
    return int(recorder.before[done])


def jain(shares: Any) -> float:
    """Jain's fairness index, 1/n (one has everything) to 1; 1 where there is nothing to share."""
    index = summary.jain(shares)
    return 1.0 if index is None else index
