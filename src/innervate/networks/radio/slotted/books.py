"""What a slotted run keeps: who has a packet since when, and every success. Times in ticks."""

from typing import Any, NamedTuple

import numpy as np

from innervate.networks.radio.slotted.draws import exponential

NEVER = 1 << 60

# Traffic.
SATURATED = 0
DISASTER = 1
POISSON = 2

# Places in Books.counts.
DONE = 0
COLLISIONS = 1
LIMIT = 2
TRAFFIC = 3
PACKETS = 4

Numbers = np.ndarray[Any, np.dtype[np.int64]]


class Books(NamedTuple):
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


def open_books(traffic: int, stations: int, packets: int, rng: Numbers) -> Books:
    """Books in which every station has a packet at time 0; `schedule` makes it Poisson traffic."""
    limit = stations * packets
    return Books(
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


def schedule(books, rng, interval):
    """Poisson arrivals: every station has packets `interval` apart in the mean."""
    packets = books.counts[PACKETS]
    for i in range(len(books.offer)):
        time = 0
        for j in range(packets):
            time += exponential(rng, interval)
            books.arrivals[i * packets + j] = time
        books.offer[i] = books.arrivals[i * packets]


def going(books):
    """True until enough packets are through, or a Poisson station has no more to offer."""
    return books.counts[DONE] < books.counts[LIMIT]


def deliver(books, station, end):
    """A packet of `station` got through at `end`; its next one is offered."""
    counts = books.counts
    at = counts[DONE]
    if at >= counts[LIMIT]:
        return
    books.station[at] = station
    books.offered[at] = books.offer[station]
    books.end[at] = end
    books.before[at] = counts[COLLISIONS]
    counts[DONE] = at + 1
    books.sent[station] += 1
    if counts[TRAFFIC] == SATURATED:
        books.offer[station] = end
    elif counts[TRAFFIC] == DISASTER:
        books.offer[station] = NEVER
    elif books.sent[station] < counts[PACKETS]:
        books.offer[station] = books.arrivals[station * counts[PACKETS] + books.sent[station]]
    else:
        counts[LIMIT] = counts[DONE]


def ready(books, time, found):
    """Stations with a packet at `time`, into `found`; how many."""
    count = 0
    for i in range(len(books.offer)):
        if books.offer[i] <= time:
            found[count] = i
            count += 1
    return count


def opening(books, time, grid):
    """The first instant from `time` on, in steps of `grid`, at which a station has a packet."""
    first = NEVER
    for i in range(len(books.offer)):
        first = min(first, books.offer[i])
    if first <= time:
        return time
    return time + (first - time + grid - 1) // grid * grid
