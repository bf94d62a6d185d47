"""CSMA/CD after IEEE 802.3 and 802.11 DCF: backoff counters. Times in ticks."""

from typing import NamedTuple

import numpy as np

from innervate.networks.radio.slotted.draws import draw
from innervate.networks.radio.slotted.recorder import COLLISIONS, NEVER, deliver, going

DOUBLINGS_MAX = 10


class Contention(NamedTuple):
    """Times and rules of CSMA/CD."""

    slot: int  # slot, packet: how long they last
    packet: int
    cost: int  # after the last station of a collision went on air the channel is sensed idle
    turn: int  # from a decision to the first bit on air
    back: int  # from the end of a frame until its sender senses the channel
    backoff: int  # a step of the backoff
    linear: int  # k + 1 values after k collisions, else 2^k
    redraw: int  # who got through draws 0 or 1 as well


class Counters(NamedTuple):
    """Times and rules of 802.11 DCF."""

    slot: int  # an idle step of every counter
    success: int  # success, cost: the whole times that a packet and a collision take
    cost: int
    # window, stages: counters start drawn from `window` values, doubled at most so many times.
    window: int
    stages: int
    at_once: int  # they start at 0


def contend(recorder, rules):
    """1-persistent CSMA/CD with binary (or linear) backoff, which runs on while others send.

    A station that decides at t is on air from t + turn; who decides before it can be heard, turn
    and half a slot later, sends too. The channel is sensed idle a slot after a packet, or `cost`
    after the last station of a collision went on air; by its senders `back` after its end, if that
    is later, and there their backoff begins.
    """
    slot, turn, back, backoff = rules.slot, rules.turn, rules.back, rules.backoff
    count = len(recorder.offer)
    due = np.zeros(count, np.int64)
    tries = np.zeros(count, np.int64)
    found = np.zeros(count + 1, np.int64)
    for i in range(count):
        due[i] = _slot_of(recorder.offer[i], slot)
    idle = 0
    while going(recorder):
        first = max(idle, _least(due))
        limit = first + turn + slot // 2
        senders = 0
        for i in range(count):  # no branches: this is where the time goes
            found[senders] = i
            senders += due[i] < limit
        if senders == 1:
            winner = found[0]
            end = first + turn + rules.packet
            idle = end + slot
            tries[winner] = 0
            deliver(recorder, winner, end)
            due[winner] = max(idle, end + back, _slot_of(recorder.offer[winner], slot))
            if rules.redraw:
                due[winner] += draw(recorder.rng, 2) * backoff
            continue
        recorder.counts[COLLISIONS] += 1
        last = first
        for j in range(senders):
            last = max(last, due[found[j]])
        idle = last + turn + rules.cost
        known = max(idle, idle - slot + back)
        for j in range(senders):
            i = found[j]
            tries[i] += 1
            window = tries[i] + 1 if rules.linear else 1 << min(tries[i], DOUBLINGS_MAX)
            due[i] = known + draw(recorder.rng, window) * backoff


def _slot_of(offer, slot):
    """The beginning of a slot at which a packet offered at `offer` can be sent."""
    return (offer + slot - 1) // slot * slot


def _least(due):
    """The earliest of these times; a loop of its own, which the compiler makes wide."""
    first = due[0]
    for i in range(1, len(due)):
        first = min(first, due[i])
    return first


def distribute(recorder, rules):
    """802.11 DCF as Bianchi's model has it: a busy period is one step of every counter."""
    slot, window, count = rules.slot, rules.window, len(recorder.offer)
    left = np.zeros(count, np.int64)
    stage = np.zeros(count, np.int64)
    time = 0
    if not rules.at_once:
        for i in range(count):
            left[i] = draw(recorder.rng, window)
    while going(recorder):
        wait = _shortest(recorder, left, time, slot)
        senders = 0
        winner = 0
        start = time + wait * slot
        for i in range(count):
            here = _waiting_since(recorder.offer[i], time, slot)
            if here + left[i] == wait:
                senders += 1
                winner = i
        time = start + (rules.success if senders == 1 else rules.cost)
        if senders > 1:
            recorder.counts[COLLISIONS] += 1
        for i in range(count):
            here = _waiting_since(recorder.offer[i], start - wait * slot, slot)
            if here + left[i] == wait:
                stage[i] = 0 if senders == 1 else min(stage[i] + 1, rules.stages)
                left[i] = draw(recorder.rng, window << stage[i])
            elif here <= wait:
                left[i] -= wait - here + 1
        if senders == 1:
            deliver(recorder, winner, time)


def _waiting_since(offer, time, slot):
    """Idle steps from `time` until a station has a packet."""
    return 0 if offer <= time else (offer - time + slot - 1) // slot


def _shortest(recorder, left, time, slot):
    """Idle steps until the first counter is at 0."""
    wait = NEVER
    for i in range(len(left)):
        wait = min(wait, _waiting_since(recorder.offer[i], time, slot) + left[i])
    return wait


PARTS = (_slot_of, _least, _waiting_since, _shortest)
