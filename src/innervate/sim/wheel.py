"""The event queue: a hierarchical timing wheel, exact to the microsecond and first in first out.

Four levels of 1,024 buckets; level l has buckets of 1024^l us, so an event is inserted and taken
out in constant time and moved at most three times between. A bucket is a doubly linked list in
order of insertion; moving keeps the order, hence events come out by (time_us, order of insertion).

A slot is an index into `events`. The first slots belong to timers, one each for life; the rest is
a pool of frames on their way. Written so that it runs compiled on arrays and plain on lists.
"""

from innervate.kernel.bits import lowest_bit

BITS = 10
SIZE = 1 << BITS
MASK = SIZE - 1
LEVELS = 4
WORDS = SIZE // 32
FULL = 0xFFFFFFFF
NIL = -1

# Words of `wheel.pool`.
FREE = 0  # head of the list of slots given back
FRESH = 1  # first slot never used
LAST = 2  # end of the pool
LIVE = 3  # pool slots in use


def insert(wheel, slot, time):
    """Queue an unqueued slot at `time` (us), which must not be before the wheel's clock."""
    delta = time ^ wheel.clock[0]
    if delta < SIZE:
        bucket = time & MASK
    elif delta < 1 << 20:
        bucket = SIZE + ((time >> 10) & MASK)
    elif delta < 1 << 30:
        bucket = 2 * SIZE + ((time >> 20) & MASK)
    else:
        bucket = 3 * SIZE + ((time >> 30) & MASK)
    events = wheel.events
    event = events[slot]
    event.time = time
    event.bucket = bucket
    event.next = NIL
    tail = wheel.tails[bucket]
    event.prev = tail
    wheel.tails[bucket] = slot
    if tail == NIL:
        wheel.heads[bucket] = slot
        word = bucket >> 5
        wheel.words[word] |= 1 << (bucket & 31)
        wheel.tops[word >> 5] |= 1 << (word & 31)
    else:
        events[tail].next = slot


def remove(wheel, slot):
    """Take a slot out of the queue, wherever it is."""
    events = wheel.events
    event = events[slot]
    bucket = event.bucket
    before = event.prev
    behind = event.next
    event.bucket = NIL
    if before == NIL:
        wheel.heads[bucket] = behind
    else:
        events[before].next = behind
    if behind == NIL:
        wheel.tails[bucket] = before
        if before == NIL:
            clear(wheel, bucket)
    else:
        events[behind].prev = before


def clear(wheel, bucket):
    """Mark a bucket empty."""
    word = bucket >> 5
    rest = wheel.words[word] & ~(1 << (bucket & 31))
    wheel.words[word] = rest
    if rest == 0:
        wheel.tops[word >> 5] &= ~(1 << (word & 31))


def first(wheel, level, start):
    """The first bucket of a level from index `start` on that is not empty, or NIL."""
    word = start >> 5
    base = level * WORDS
    bits = wheel.words[base + word] & (FULL << (start & 31)) & FULL
    if bits:
        return (word << 5) + lowest_bit(bits)
    bits = wheel.tops[level] & (FULL << word) & ~(1 << word) & FULL
    if bits == 0:
        return NIL
    word = lowest_bit(bits)
    return (word << 5) + lowest_bit(wheel.words[base + word])


def pop(wheel, until):
    """Take the next event before `until` (us) off the queue and set the clock to it; or NIL."""
    while True:
        now = wheel.clock[0]
        index = first(wheel, 0, now & MASK)
        if index != NIL:
            time = now - (now & MASK) + index
            if time >= until:
                return NIL
            wheel.clock[0] = time
            slot = wheel.heads[index]
            event = wheel.events[slot]
            behind = event.next
            event.bucket = NIL
            wheel.heads[index] = behind
            if behind == NIL:
                wheel.tails[index] = NIL
                clear(wheel, index)
            else:
                wheel.events[behind].prev = NIL
            return slot
        if not descend(wheel, now, until):
            return NIL


def descend(wheel, now, until):
    """Move the next bucket of a higher level down, unless it begins at or after `until`."""
    for level in range(1, LEVELS):
        shift = BITS * level
        index = first(wheel, level, (now >> shift) & MASK)
        if index != NIL:
            span = 1 << (shift + BITS)
            time = now - (now & (span - 1)) + (index << shift)
            if time >= until:
                return False
            wheel.clock[0] = time
            bucket = level * SIZE + index
            slot = wheel.heads[bucket]
            wheel.heads[bucket] = NIL
            wheel.tails[bucket] = NIL
            clear(wheel, bucket)
            while slot != NIL:
                behind = wheel.events[slot].next
                insert(wheel, slot, wheel.events[slot].time)
                slot = behind
            return True
    return False


def take(wheel):
    """A free pool slot; the loop makes sure beforehand that there is one."""
    pool = wheel.pool
    slot = pool[FREE]
    if slot == NIL:
        slot = pool[FRESH]
        pool[FRESH] = slot + 1
    else:
        pool[FREE] = wheel.events[slot].next
    pool[LIVE] += 1
    return slot


def give(wheel, slot):
    """Hand a pool slot back."""
    wheel.events[slot].next = wheel.pool[FREE]
    wheel.pool[FREE] = slot
    wheel.pool[LIVE] -= 1
