"""What was on the air and who heard what, moment by moment, of random transmissions and faults."""

import random

import numpy as np
import pytest

from innervate.networks.radio.analysis import air as radio_air
from innervate.networks.radio.protocol.constants import CRR, DATA, OPEN, REPORT_STOPPED
from innervate.networks.radio.scenario.plan import RadioFault
from innervate.scenario.actions.channel import FADE, GARBLE, JOIN, KILL
from tests.networks.radio.analysis.test_summary import made

STATIONS, END, TA = 4, 600, 7


def drawn(seed):
    """(transmissions, faults) of a few stations; a station sends one frame at a time."""
    draw, sent, faults = random.Random(seed), [], []
    for node in range(STATIONS):
        at = draw.randrange(TA, 60)
        while at < END:
            long = draw.randrange(1, 50)
            sent.append((at, at + long, node, draw.choice([DATA, OPEN, CRR, CRR])))
            at += long + draw.randrange(2 * TA, 120)
        edges = [at for start, end, *_ in sent for at in (start - TA, start - 3, start, end - 1)]
        for action in draw.choices([FADE, FADE, GARBLE, KILL, KILL, JOIN], k=draw.randrange(7)):
            faults.append((draw.choice(edges), action, node, draw.randrange(1, 3)))
    draw.shuffle(sent)
    return sent, [RadioFault(*fault, index) for index, fault in enumerate(sorted(faults))]


def is_off(faults, node, moment):
    """True from a KILL on, up to the next JOIN; the last station is not there at the beginning."""
    before = [fault.action == JOIN for fault in faults if fault.node == node
              and fault.action in (JOIN, KILL) and fault.at_us <= moment]  # fmt: skip
    return not before[-1] if before else node == STATIONS - 1


def cut_short(one, faults):
    """When a transmission ends: with its sender, if that died after it had decided to send."""
    start, end, node, _ = one
    deaths = [fault.at_us for fault in faults if fault.action == KILL and fault.node == node
              and start - TA <= fault.at_us < end]  # fmt: skip
    return max(start, min(deaths)) if deaths else end


def hidden(one, sent, faults):
    """True for the CR-Rs that a FADE takes: the next so many, those of a GARBLE come first."""
    node = one[2]
    left = {GARBLE: 0, FADE: 0}
    waiting = [fault for fault in faults if fault.node == node and fault.action in left]
    for other in sorted(s for s in sent if s[2] == node and s[3] == CRR):
        while waiting and waiting[0].at_us < other[0] - TA:
            fault = waiting.pop(0)
            left[fault.action] = fault.value
        takes = next((action for action in (GARBLE, FADE) if left[action]), None)
        if takes is not None:
            left[takes] -= 1
        if other == one:
            return takes == FADE
    return False


@pytest.mark.parametrize("seed", range(12))
def test_each_station_hears_what_is_there_at_that_moment(seed):
    sent, faults = drawn(seed)
    draw = random.Random(seed)
    delays = [[0 if a == b else draw.choice([-1, 3, 11]) for b in range(STATIONS)]
              for a in range(STATIONS)]  # fmt: skip
    result = made(sent=sent, faults=faults, stations=STATIONS, ta=TA)
    result.plan.delays_us = delays
    result.plan.absent = [0] * (STATIONS - 1) + [1]
    found = radio_air.signals(result, 0, END)
    spans = [(one[0], cut_short(one, faults), one[2]) for one in sent
             if not hidden(one, sent, faults)]  # fmt: skip
    for station, heard in enumerate(found):
        for moment in range(END):
            there = sum(
                start + delays[node][station] <= moment < end + delays[node][station]
                for start, end, node in spans
                if node != station and delays[node][station] >= 0
            )
            deaf = any(start - TA <= moment < cut_short((start, end, node, kind), faults) + TA
                       or start - TA <= moment < end + TA
                       for start, end, node, kind in sent if node == station)  # fmt: skip
            off = is_off(faults, station, moment)
            listens = not deaf and not off
            now = [bool(((spans_[:, 0] <= moment) & (moment < spans_[:, 1])).any())
                   for spans_ in heard]  # fmt: skip
            assert now == [there > 0 and listens, there == 1 and listens, deaf, off], moment
    window = radio_air.signals(result, 200, 300)
    for whole, part in zip(found, window, strict=True):
        for a, b in zip(whole, part, strict=True):
            inside = [(max(x, 200), min(y, 300)) for x, y in a.tolist() if x < 300 and y > 200]
            assert list(map(tuple, b.tolist())) == inside


@pytest.mark.parametrize("seed", range(12))
def test_groups_are_what_overlaps_without_a_gap(seed):
    sent, faults = drawn(seed)
    result = made(sent=sent, faults=faults, stations=STATIONS, ta=TA)
    found = radio_air.groups(result)
    order = sorted(sent, key=lambda one: one[0])
    ends = [cut_short(one, faults) for one in order]
    groups = []
    for one, end in zip(order, ends, strict=True):
        if not groups or one[0] >= max(groups[-1][1]):
            groups.append(([], []))
        groups[-1][0].append(one)
        groups[-1][1].append(end)
    assert found.members.tolist() == [len(members) for members, _ in groups]
    assert found.start.tolist() == [members[0][0] for members, _ in groups]
    assert found.end.tolist() == [max(its) for _, its in groups]
    assert found.of.tolist() == [k for k, (members, _) in enumerate(groups) for _ in members]
    carries = [len(members) > 1 and any(one[3] in (DATA, OPEN) for one in members)
               for members, _ in groups]  # fmt: skip
    assert found.collision.tolist() == carries
    air = radio_air.air(result)
    assert air.deaf_to.tolist() == [one[1] + TA for one in order]
    assert air.deaf_from.tolist() == [one[0] - TA for one in order]
    assert [sent[row] for row in air.row] == order


@pytest.mark.parametrize(("before_us", "faded"), [(0, False), (1, True)])
def test_a_fade_takes_what_is_decided_after_it(before_us, faded):
    sent = [(100, 110, 0, CRR), (200, 210, 0, CRR)]
    faults = [RadioFault(100 - TA - before_us, FADE, 0, 1, 0)]
    result = made(sent=sent, faults=faults, ta=TA)
    assert radio_air.air(result).faded.tolist() == [faded, not faded]


def test_who_breaks_off_on_a_cable_is_heard_no_longer():
    """Each stop is of the newest transmission of that station then, and makes none longer."""
    sent = [(100, 200, 0, DATA), (150, 260, 1, DATA), (300, 400, 0, DATA), (300, 390, 1, DATA)]
    rows = [(160, 1, REPORT_STOPPED), (300, 0, REPORT_STOPPED), (395, 1, REPORT_STOPPED)]
    result = made(sent=sent, rows=rows)
    assert radio_air.air(result).end.tolist() == [200, 260, 400, 390]
    result.plan.params["full_duplex"] = 1
    found = radio_air.air(result)
    assert found.end.tolist() == [200, 160, 300, 390]
    assert (found.deaf_from == found.deaf_to).all()
    assert np.array_equal(found.deaf_from, found.start)  # there is no turnaround
