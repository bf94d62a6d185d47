"""The recorder of a slotted run: who has a packet since when, and every success. Times in ticks."""

from typing import Any, NamedTuple

import numpy as np

from innervate.networks.radio.slotted.draws import exponential

NEVER = 1 << 60

# Traffic.
SATURATED = 0
DISASTER = 1
POISSON = 2

# Places in Recorder.counts.
DONE = 0
COLLISIONS = 1
LIMIT = 2
TRAFFIC = 3
PACKETS = 4

Numbers = np.ndarray[Any, np.dtype[np.int64]]


class Recorder(NamedTuple):
    """All tables of a run, 64-bit integers."""

    rng: Numbers
    counts: Numbers
    offer: Numbers  # by station: since when its packet waits, or NEVER
    sent: Numbers  # by station
    arrivals: Numbers  # Poisson: `PACKETS` instants for each station
    station: Numbers  # by success, like the three that follow
    offered: Numbers
    end: Numbers
    before: Numbers  # collisions up to then


def new_recorder(traffic: int, stations: int, packets: int, rng: Numbers) -> Recorder:
    """A recorder; all stations have a packet at time 0, unless `schedule` makes it Poisson."""
    limit = stations * packets
    return Recorder(
        rng=rng,
        counts=np.array([0, 0, limit, traffic, packets], np.int64),
        offer=np.zeros(stations, np.int64),
        sent=np.zeros(stations, np.int64),
        arrivals=np.zeros(limit if traffic == POISSON else 1, np.int64),
        station=np.zeros(limit, np.int64),
        offered=np.zeros(limit, np.int64),
        end=np.zeros(limit, np.int64),
        before=np.zeros(limit, np.int64),
    )


def schedule(recorder, rng, interval):
    """Poisson arrivals: every station has packets `interval` apart in the mean."""
    packets = recorder.counts[PACKETS]
    for i in range(len(recorder.offer)):
        time = 0
        for j in range(packets):
            time += exponential(rng, interval)
            recorder.arrivals[i * packets + j] = time
        recorder.offer[i] = recorder.arrivals[i * packets]


def going(recorder):
    """True until enough packets are through, or a Poisson station has no more to offer."""
    return recorder.counts[DONE] < recorder.counts[LIMIT]


def deliver(recorder, station, end):
    """A packet of `station` got through at `end`; its next one is offered."""
    counts = recorder.counts
    at = counts[DONE]
    if at >= counts[LIMIT]:
        return
    recorder.station[at] = station
    recorder.offered[at] = recorder.offer[station]
    recorder.end[at] = end
    recorder.before[at] = counts[COLLISIONS]
    counts[DONE] = at + 1
    recorder.sent[station] += 1
    if counts[TRAFFIC] == SATURATED:
        recorder.offer[station] = end
    elif counts[TRAFFIC] == DISASTER:
        recorder.offer[station] = NEVER
    elif recorder.sent[station] < counts[PACKETS]:
        recorder.offer[station] = recorder.arrivals[
            station * counts[PACKETS] + recorder.sent[station]
        ]
    else:
        counts[LIMIT] = counts[DONE]


def ready(recorder, time, found):
    """Stations with a packet at `time`, into `found`; how many."""
    count = 0
    for i in range(len(recorder.offer)):
        if recorder.offer[i] <= time:
            found[count] = i
            count += 1
    return count


def opening(recorder, time, grid):
    """The first instant from `time` on, in steps of `grid`, at which a station has a packet."""
    first = NEVER
    for i in range(len(recorder.offer)):
        first = min(first, recorder.offer[i])
    if first <= time:
        return time
    return time + (first - time + grid - 1) // grid * grid
