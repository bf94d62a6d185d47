"""The event queue of a radio channel: a binary heap of whole numbers.

A key holds time, rank, station and what for, so that the smallest is the next event and equal
times keep the order of [radio M6]: signal ends (and frames received by them), signal starts,
radios that listen again, timers, commands, packets offered, outcomes. Carrier notifications,
between signal starts and radios, are kept apart by the loop: they would be half of all events.
"""

STATION_BITS = 10
SENDER_BITS = 10
AIR_BITS = 3  # transmissions of one sender that can be under way at once
RANK_SHIFT = STATION_BITS + SENDER_BITS + AIR_BITS
TIME_SHIFT = RANK_SHIFT + 3
STATION_SHIFT = SENDER_BITS + AIR_BITS
STATIONS_MAX = 1 << STATION_BITS
AIRS = 1 << AIR_BITS
TIME_MAX = 1 << (63 - TIME_SHIFT)
LAST = (1 << 63) - 1  # no event is later

ENDS = 0
STARTS = 1
READY = 2
TIMER = 3
COMMAND = 4
OFFER = 5
OUTCOME = 6


def key_of(time, rank, station, what):
    """The key of an event."""
    return (time << TIME_SHIFT) | (rank << RANK_SHIFT) | (station << STATION_SHIFT) | what


def push(heap, key):
    """Queue an event; the loop makes sure beforehand that there is room."""
    keys = heap.keys
    i = heap.size[0]
    heap.size[0] = i + 1
    while i > 0:
        above = (i - 1) >> 1
        if keys[above] <= key:
            break
        keys[i] = keys[above]
        i = above
    keys[i] = key


def pop(heap):
    """Take the first event off the queue."""
    size = heap.size[0] - 1
    heap.size[0] = size
    if size > 0:
        replace(heap, heap.keys[size])


def replace(heap, key):
    """Put `key` in the place of the first event, which is taken off."""
    keys = heap.keys
    size = heap.size[0]
    i = 0
    below = 1
    while below < size:
        if below + 1 < size and keys[below + 1] < keys[below]:
            below += 1
        if key <= keys[below]:
            break
        keys[i] = keys[below]
        i = below
        below = 2 * i + 1
    keys[i] = key
