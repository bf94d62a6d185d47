"""Stations that send by chance: slotted ALOHA and slotted CSMA. Times in ticks.

Probabilities and cumulative tables are whole numbers of 1 / UNIT, worked out before the run.
"""

import numpy as np

from innervate.networks.radio.slotted.draws import UNIT, choose, draw
from innervate.networks.radio.slotted.recorder import COLLISIONS, deliver, going, opening, ready

STEPS_PER_PACKET = 1000  # an overloaded channel lets nothing through; a run ends all the same


def attempt(recorder, chance, step, packet, gap):
    """A finite population: who has a packet sends it in a step with probability `chance`.

    A step without a sender lasts `step`, one with any packet + gap.
    """
    found = np.zeros(len(recorder.offer), np.int64)
    time = 0
    while going(recorder):
        time = opening(recorder, time, step)
        count = ready(recorder, time, found)
        senders = 0
        winner = 0
        for i in range(count):
            if draw(recorder.rng, UNIT) < chance:
                senders += 1
                winner = found[i]
        if senders == 0:
            time += step
            continue
        if senders == 1:
            deliver(recorder, winner, time + packet)
        else:
            recorder.counts[COLLISIONS] += 1
        time += packet + gap


def pool(recorder, arrivals, step, packet, gap):
    """An infinite population that sends what came during the last `step` (Poisson) at once.

    With packet + gap = step this is slotted ALOHA, else slotted nonpersistent CSMA.
    """
    time = 0
    steps = 0
    while going(recorder) and steps < STEPS_PER_PACKET * len(recorder.end):
        steps += 1
        senders = choose(recorder.rng, arrivals)
        if senders == 1:
            deliver(recorder, 0, time + packet)
        if senders > 1:
            recorder.counts[COLLISIONS] += 1
        time += step if senders == 0 else packet + gap


def persist(recorder, arrivals, after, chance, slot, packet):
    """An infinite population of p-persistent stations (Kleinrock and Tobagi 1975).

    `after` is the table of arrivals during a packet and its idle slot, `arrivals` that of a slot.
    Who collided is out (it comes back as part of the load); everybody waiting sends in a slot
    with probability `chance`.
    """
    time = 0
    sent = 0
    while going(recorder) and sent < STEPS_PER_PACKET * len(recorder.end):
        sent += 1
        waiting = choose(recorder.rng, after)
        while waiting == 0:
            time += slot
            waiting = choose(recorder.rng, arrivals)
        senders = _senders(recorder, waiting, chance)
        while senders == 0:
            time += slot
            waiting += choose(recorder.rng, arrivals)
            senders = _senders(recorder, waiting, chance)
        if senders == 1:
            deliver(recorder, 0, time + packet)
        else:
            recorder.counts[COLLISIONS] += 1
        time += packet + slot


def _senders(recorder, waiting, chance):
    """How many of those who wait send in this slot."""
    senders = 0
    for _ in range(waiting):
        if draw(recorder.rng, UNIT) < chance:
            senders += 1
    return senders


PARTS = (_senders,)
