"""Breadth-first search through the states of a system: rows of bytes, each kept once.

A system brings `parts` (functions that compiled code calls), `start`, `variants(world, move)`,
`step(world, move, variant, choice)` and `check(world)`; they work on the row `world.work`, and are
handed on together as `do`. The row
that is kept is the smallest among its images under the symmetries of the graph. The table of
known states has open addresses; its entries hold 32 bits of a row's hash and its number.
"""

from collections.abc import Callable
from typing import Any, NamedTuple

from innervate.kernel.bits import mix
from innervate.kernel.compilation import bound

# Places in `Search.run`.
COUNT, NEXT, LIMIT, SLOTS, GENERATED, STATUS, MOVES, WORDS, IMAGES, WIDTH = range(10)
BROKEN, BROKEN_AT, LEFT_OUT, RANDOM = range(10, 14)
NUMBERS = 14

# Why `expand` stopped.
GOING, DONE, GROW, FULL, FOUND = range(5)

# What a step says of a state that is not to be followed: more in flight than there is room for.
TOO_MANY = -1

# Most successors of one state; more would be a mistake in the system.
MARGIN = 1 << 14
LOW32 = 0xFFFFFFFF
HIGH_BITS = 0x8080808080808080 - (1 << 64)

# Streams of a walk beside the one that chooses moves: another move, and what a draw gives.
OTHER_WAY, DRAWN = 7, 11


class Search(NamedTuple):
    """The states found so far."""

    run: Any
    rows: Any  # their words, one after the other
    table: Any  # hash << 32 | number + 1; 0 = free
    before: Any  # the state each was first reached from, -1 the start
    body: Any  # a mask of words: what has to be equal; of other bytes more is better


class Engine(NamedTuple):
    """The search, bound to a system; `refill` enters all rows into a new table."""

    insert: Callable[..., int]
    refill: Callable[..., None]
    expand: Callable[..., None]
    wander: Callable[..., None]


def fetch_row(world, search, index):
    """A kept row into the one to work on."""
    words = search.run[WORDS]
    for i in range(words):
        world.work_words[i] = search.rows[index * words + i]


def compare(a, b, words):
    """1 if row a is smaller than b in the order of their words."""
    for i in range(words):
        if a[i] != b[i]:
            return a[i] < b[i]
    return False


def choose_image(world, search):
    """The smallest image of `world.work`, by its body first, into `world.best`."""
    run = search.run
    words, width = run[WORDS], run[WIDTH]
    for i in range(words):
        world.best_words[i] = world.work_words[i]
    for g in range(1, run[IMAGES]):
        if is_smaller_image(world, search, g * width):
            for i in range(words):
                world.best_words[i] = world.trial_words[i]


def is_smaller_image(world, search, start):
    """Make an image in `world.trial`, as long as it is not greater; 1 if it is smaller."""
    words = search.run[WORDS]
    is_open = True
    for i in range(words):
        for k in range(8 * i, 8 * i + 8):
            world.trial[k] = world.work[world.image[start + k]]
        if is_open:
            here = world.trial_words[i] & search.body[i]
            there = world.best_words[i] & search.body[i]
            if here > there:
                return False
            is_open = here == there
    return not is_open or compare(world.trial_words, world.best_words, words)


def hash_of(table, start, body, words):
    """64 bits of a row's body."""
    state = 0
    for i in range(words):
        state = mix(state, table[start + i] & body[i])
    return mix(state, words)


def covers(table, start, row, body, words):
    """1 if a kept row has the body of `row`, and no byte beside it that is less (below 128)."""
    for i in range(words):
        here, there, mask = table[start + i], row[i], body[i]
        if (here ^ there) & mask:
            return False
        if here != there:
            ahead = ((here & ~mask) | HIGH_BITS) - (there & ~mask)  # each byte by itself
            if ahead & HIGH_BITS != HIGH_BITS:
                return False
    return True


def look_up(search, best, mark):
    """The slot of the table that holds the row `best`, or the free one where it belongs."""
    run = search.run
    words = run[WORDS]
    mask = run[SLOTS] - 1
    slot = mark & mask
    while True:
        entry = search.table[slot]
        if entry == 0:
            return slot
        if ((entry ^ mark) >> 32) == 0:
            start = ((entry & LOW32) - 1) * words
            if covers(search.rows, start, best, search.body, words):
                return slot
        slot = (slot + 1) & mask


def insert(world, search, before):
    """Keep the state in `world.work` unless it is known; 1 if it is new."""
    choose_image(world, search)
    run = search.run
    words = run[WORDS]
    mark = hash_of(world.best_words, 0, search.body, words)
    slot = look_up(search, world.best_words, mark)
    if search.table[slot] != 0:
        return False
    index = run[COUNT]
    for i in range(words):
        search.rows[index * words + i] = world.best_words[i]
    search.before[index] = before
    search.table[slot] = (mark & ~LOW32) | (index + 1)
    run[COUNT] = index + 1
    return True


def refill(search):
    """Enter all rows into an empty table."""
    run = search.run
    words = run[WORDS]
    mask = run[SLOTS] - 1
    for index in range(run[COUNT]):
        mark = hash_of(search.rows, index * words, search.body, words)
        slot = mark & mask
        while search.table[slot] != 0:
            slot = (slot + 1) & mask
        search.table[slot] = (mark & ~LOW32) | (index + 1)


def save_row(world, search):
    """Remember the row in the last place of the rows, to come back to."""
    words = search.run[WORDS]
    last = (search.run[LIMIT] - 1) * words
    for i in range(words):
        search.rows[last + i] = world.work_words[i]


def restore_row(world, search):
    """Make the row that `save_row` remembered the present state."""
    fetch_row(world, search, search.run[LIMIT] - 1)


def append(world, search):
    """Keep the image of the present state behind the others."""
    choose_image(world, search)
    run = search.run
    words = run[WORDS]
    index = run[COUNT]
    for i in range(words):
        search.rows[index * words + i] = world.best_words[i]
    search.before[index] = index - 1
    run[COUNT] = index + 1


def room_left(run):
    """GOING, or why the search cannot go on as it is."""
    if run[NEXT] >= run[COUNT]:
        return DONE
    if run[COUNT] + MARGIN > run[LIMIT]:
        return FULL
    if (run[COUNT] + MARGIN) * 10 > run[SLOTS] * 7:
        return GROW
    return GOING


def note(world, do, search, index, is_new):
    """Remember the first thing that is broken."""
    run = search.run
    broken = world.found[0]
    if broken == 0 and is_new:
        broken = do.check(world)
    if broken != 0 and run[BROKEN] == 0:
        run[BROKEN] = broken
        run[BROKEN_AT] = index
        run[STATUS] = FOUND


def follow(world, do, search, index, move, variant):
    """All successors of a state by one variant of a move."""
    run = search.run
    choice, asked = 0, 1
    while choice < asked:
        fetch_row(world, search, index)
        asked = do.step(world, move, variant, choice)
        if asked > 0 and world.found[0] == TOO_MANY:
            run[LEFT_OUT] += 1
        elif asked > 0:
            run[GENERATED] += 1
            is_new = insert(world, search, index)
            note(world, do, search, index, is_new)
        choice += 1


def expand(world, do, search, budget):
    """Find the successors of up to `budget` more states."""
    run = search.run
    for _ in range(budget):
        run[STATUS] = room_left(run)
        if run[STATUS] != GOING:
            return
        index = run[NEXT]
        for move in range(run[MOVES]):
            fetch_row(world, search, index)
            for variant in range(do.variants(world, move)):
                follow(world, do, search, index, move, variant)
        run[NEXT] = index + 1
        if run[BROKEN] != 0:
            run[STATUS] = FOUND
            return


def choose(world, do, number):
    """A move and variant that can be made, by a number; (-1, 0) if there is none."""
    total = 0
    for move in range(len(world.move_kind)):
        total += do.variants(world, move)
    if total == 0:
        return -1, 0
    wanted = number % total
    for move in range(len(world.move_kind)):
        count = do.variants(world, move)
        if wanted < count:
            return move, wanted
        wanted -= count
    return -1, 0


def stride(world, do, search, move, variant):
    """A step of a walk, what it draws being any that can be; the row before it is saved."""
    save_row(world, search)
    asked = do.step(world, move, variant, 0)
    if asked > 1:
        choice = ((mix(search.run[RANDOM], DRAWN) >> 20) & LOW32) % asked
        if choice > 0:
            restore_row(world, search)
            asked = do.step(world, move, variant, choice)
    return asked


def wander(world, do, search, walks, length):
    """So many random walks from the state in row 0; the rows of the last one are kept."""
    run = search.run
    for _ in range(walks):
        fetch_row(world, search, 0)
        run[COUNT] = 1
        while run[COUNT] < length:
            run[RANDOM] = mix(run[RANDOM], run[COUNT])
            move, variant = choose(world, do, (run[RANDOM] >> 20) & LOW32)
            if move < 0:
                break
            asked = stride(world, do, search, move, variant)
            if asked < 0 or world.found[0] == TOO_MANY:
                restore_row(world, search)  # not that way; the next number is another
                run[GENERATED] += 1
                run[RANDOM] = mix(run[RANDOM], OTHER_WAY)
                if run[RANDOM] & 63 == 0:
                    break
                continue
            run[GENERATED] += 1
            broken = world.found[0]
            if broken == 0:
                broken = do.check(world)
            if broken != 0:
                run[BROKEN], run[BROKEN_AT] = broken, run[COUNT] - 1
                return
            append(world, search)
        run[NEXT] += 1


BOUND = (note, follow, expand, choose, stride, wander)


def build(system: Any) -> Engine:
    """The search for a system."""
    do = bound("system", variants=system.variants, step=system.step, check=system.check)

    def expand_known(world, search, budget):  # type: ignore[no-untyped-def]
        expand(world, do, search, budget)

    def wander_on(world, search, walks, length):  # type: ignore[no-untyped-def]
        wander(world, do, search, walks, length)

    return Engine(insert, refill, expand_known, wander_on)
