"""The event queue: a hierarchical timing wheel, exact to the microsecond and first in first out.

Four levels of 1,024 buckets; level l has buckets of 1024^l us, so an event is inserted and taken
out in constant time and moved at most three times between. A bucket is a linked list in order of
insertion; moving keeps the order, hence events come out by (time_us, order of insertion).

A slot is an index into `events`. The first slots belong to timers, one each for life; the rest is
a pool of frames on their way. `links` holds what follows a slot in its list, and, behind
`BUCKETS` places for the buckets themselves, needs no case for an empty list.
Written so that it runs compiled on arrays and plain on lists.
"""

from innervate.kernel.bits import lowest_bit

BITS = 10
SIZE = 1 << BITS
MASK = SIZE - 1
LEVELS = 4
BUCKETS = LEVELS * SIZE
WORDS = SIZE // 64
NIL = -1

# Words of `wheel.clock`.
NOW = 0  # time of the last event taken (us)
PENDING = 1  # rest of that time's list, not yet taken

# Words of `wheel.pool`.
FREE = 0  # head of the list of slots given back
FRESH = 1  # first slot never used
LAST = 2  # end of the pool


def insert(wheel, slot, time):
    """Queue an unqueued slot at `time` (us), which must not be before the wheel's clock."""
    delta = time ^ wheel.clock[NOW]
    bucket = time & MASK
    if delta >= SIZE:
        if delta < 1 << 20:
            bucket = SIZE + ((time >> 10) & MASK)
        elif delta < 1 << 30:
            bucket = 2 * SIZE + ((time >> 20) & MASK)
        else:
            bucket = 3 * SIZE + ((time >> 30) & MASK)
    event = wheel.events[slot]
    event.time = time
    event.bucket = bucket
    append(wheel, bucket, slot)


def append(wheel, bucket, slot):
    """Put a slot at the end of a bucket's list; an empty list's tail is the bucket itself."""
    wheel.links[BUCKETS + slot] = NIL
    wheel.links[wheel.tails[bucket]] = slot
    wheel.tails[bucket] = BUCKETS + slot
    wheel.words[bucket >> 6] |= 1 << (bucket & 63)


def detach(wheel, bucket):
    """Take a bucket's whole list: its first slot. The bucket is empty then."""
    slot = wheel.links[bucket]
    wheel.links[bucket] = NIL
    wheel.tails[bucket] = bucket
    wheel.words[bucket >> 6] &= ~(1 << (bucket & 63))
    return slot


def remove(wheel, slot):
    """Take a slot out of the queue, wherever it is; walks the list that it is in."""
    event = wheel.events[slot]
    bucket = event.bucket
    event.bucket = NIL
    links = wheel.links
    if wheel.clock[PENDING] == slot:
        wheel.clock[PENDING] = links[BUCKETS + slot]
        return
    place = bucket
    if event.time == wheel.clock[NOW] and wheel.clock[PENDING] != NIL:
        place = BUCKETS + wheel.clock[PENDING]
        while links[place] != slot and links[place] != NIL:
            place = BUCKETS + links[place]
        if links[place] != slot:
            place = bucket
    while links[place] != slot:
        place = BUCKETS + links[place]
    links[place] = links[BUCKETS + slot]
    if wheel.tails[bucket] == BUCKETS + slot:
        wheel.tails[bucket] = place
    if links[bucket] == NIL:
        detach(wheel, bucket)


def first(wheel, level, start):
    """The first bucket of a level from index `start` on that is not empty, or NIL."""
    word = start >> 6
    base = level * WORDS
    bits = wheel.words[base + word] & (-1 << (start & 63))
    while bits == 0:
        word += 1
        if word == WORDS:
            return NIL
        bits = wheel.words[base + word]
    return (word << 6) + lowest_bit(bits)


def pop(wheel, until):
    """Take the next event before `until` (us) off the queue and set the clock to it; or NIL."""
    slot = wheel.clock[PENDING]
    if slot == NIL:
        slot = next_list(wheel, until)
        if slot == NIL:
            return NIL
    wheel.clock[PENDING] = wheel.links[BUCKETS + slot]
    wheel.events[slot].bucket = NIL
    return slot


def next_list(wheel, until):
    """Move on to the next time before `until` that has events: the first of them, or NIL."""
    while True:
        now = wheel.clock[NOW]
        index = first(wheel, 0, now & MASK)
        if index != NIL:
            time = now - (now & MASK) + index
            if time >= until:
                return NIL
            wheel.clock[NOW] = time
            return detach(wheel, index)
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
            wheel.clock[NOW] = time
            slot = detach(wheel, level * SIZE + index)
            while slot != NIL:
                behind = wheel.links[BUCKETS + slot]
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
        pool[FREE] = wheel.links[BUCKETS + slot]
    return slot


def give(wheel, slot):
    """Hand a pool slot back."""
    wheel.links[BUCKETS + slot] = wheel.pool[FREE]
    wheel.pool[FREE] = slot
