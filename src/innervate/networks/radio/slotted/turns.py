"""Stations in turn: reservation after a collision, splitting, fixed turns. Times in ticks."""

from typing import NamedTuple

import numpy as np

from innervate.networks.radio.slotted.draws import draw, shuffle
from innervate.networks.radio.slotted.recorder import COLLISIONS, deliver, going, opening, ready


class Reservation(NamedTuple):
    """Times of CSMA/CD-R, in ticks."""

    slot: int  # slot, packet: how long they last
    turn: int  # from a decision to the first bit on air
    packet: int
    # lead, report: turns begin `lead` + (m - 1) * `report` after a collision of m stations began.
    lead: int
    report: int
    each: int  # turns follow one another every so often


def reserve(recorder, times):
    """CSMA/CD-R with the finishing order given: a free random permutation [radio Q3].

    What is offered while turns are taken waits until the last is over. A packet that met no other
    is followed by an idle slot.
    """
    slot, on_air = times.slot, times.turn + times.packet
    found = np.zeros(len(recorder.offer), np.int64)
    time = 0
    while going(recorder):
        time = opening(recorder, time, slot)
        count = ready(recorder, time, found)
        if count == 1:
            time += on_air
            deliver(recorder, found[0], time)
            time += slot
            continue
        recorder.counts[COLLISIONS] += 1
        shuffle(recorder.rng, found, count)
        time += times.lead + (count - 1) * times.report
        for i in range(count):
            deliver(recorder, found[i], time + on_air)
            time += times.each


def split(recorder, packet):
    """Binary splitting with gated access, every step as long as a packet (Capetanakis 1979).

    Whoever has a packet when a resolution begins takes part; a collision splits its stations by
    a fair bit; the last step is the one after which every branch is known to be empty.
    """
    found = np.zeros(len(recorder.offer), np.int64)
    depth = np.zeros(len(recorder.offer), np.int64)
    time = 0
    while going(recorder):
        time = opening(recorder, time, packet)
        count = ready(recorder, time, found)
        depth[:count] = 0
        branches = 1
        while branches > 0:
            time += packet
            branches += _branch(recorder, found, depth, count, time) - 1


def _branch(recorder, found, depth, count, end):
    """One step of splitting that ends at `end`; how many branches it added."""
    senders = 0
    winner = 0
    for i in range(count):
        if depth[i] == 0:
            senders += 1
            winner = i
    collided = senders > 1
    for i in range(count):
        if depth[i] == 0:
            depth[i] = draw(recorder.rng, 2) if collided else -1
        elif depth[i] > 0:
            depth[i] += 1 if collided else -1
    if senders == 1:
        deliver(recorder, found[winner], end)
    if collided:
        recorder.counts[COLLISIONS] += 1
        return 2
    return 0


def take_turns(recorder, slot, packet):
    """TDMA: station after station has packet + 1 slot, used or not."""
    count = len(recorder.offer)
    turn = 0
    while going(recorder):
        station = turn % count
        start = turn * (packet + slot)
        if recorder.offer[station] <= start:
            deliver(recorder, station, start + packet)
        turn += 1


PARTS = (_branch,)
