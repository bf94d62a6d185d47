"""The table of known states, by itself: what is known, what is smaller, what covers what."""

import random
from types import SimpleNamespace

import pytest

from innervate.verify import search as s

WORDS = 3
BYTES = 8 * WORDS
SLOTS = 256


def words(data):
    return list(memoryview(bytes(data)).cast("q"))


def longs(count):
    return memoryview(bytearray(8 * count)).cast("q")


def table(body=None, images=((),), slots=SLOTS):
    """A search with no states yet; `images` says for each where a byte of it comes from."""
    run = longs(s.NUMBERS)
    run[s.WORDS], run[s.WIDTH], run[s.LIMIT], run[s.SLOTS] = WORDS, BYTES, 100, slots
    run[s.IMAGES] = len(images)
    return s.Search(run, longs(100 * WORDS), longs(slots), longs(100),
                    words(body or [255] * BYTES))  # fmt: skip


def world(row, images=((),)):
    made = {name: bytearray(row) for name in ("work", "best", "trial")}
    views = {f"{name}_words": memoryview(data).cast("q") for name, data in made.items()}
    flat = [place for image in images for place in image or range(BYTES)]
    return SimpleNamespace(**made, **views, image=flat)


def put(one, row):
    one.work[:] = bytes(row)
    return one


def rows_of(rng, count):
    """Some of few rows: many come twice."""
    few = [[rng.randrange(100) for _ in range(BYTES)] for _ in range(count // 2)]
    return [rng.choice(few) for _ in range(count)]


@pytest.mark.parametrize("slots", [64, 256])
@pytest.mark.parametrize("seed", range(4))
def test_every_state_is_kept_once_and_where_it_was_reached_from_first(seed, slots):
    rows = rows_of(random.Random(seed), 60)
    search, known, here = table(slots=slots), [], world(rows[0])
    for before, row in enumerate(rows):
        is_new = row not in known
        assert bool(s.insert(put(here, row), search, before)) == is_new
        if is_new:
            known.append(row)
            assert search.before[len(known) - 1] == before
        assert search.run[s.COUNT] == len(known)
    for index, row in enumerate(known):
        s.fetch_row(here, search, index)
        assert list(here.work) == row
    # Entered anew into a larger table, all are known, and no other is.
    again = search._replace(table=longs(2 * slots))
    again.run[s.SLOTS] = 2 * slots
    s.refill(again)
    assert not any(s.insert(put(here, row), again, 0) for row in known)
    assert s.insert(put(here, [101] * BYTES), again, 0)


def test_states_that_differ_only_in_what_more_may_happen_are_covered_by_those_with_more():
    body = [0 if k in (3, 20) else 255 for k in range(BYTES)]

    def row(a, b, c=0):
        made = [7] * BYTES
        made[3], made[20], made[10] = a, b, c
        return made

    search, here = table(body), world(row(5, 5))
    assert s.insert(put(here, row(5, 5)), search, 0)
    for less in ((5, 5), (4, 5), (5, 4), (0, 0)):
        assert not s.insert(put(here, row(*less)), search, 0)
    assert s.insert(put(here, row(5, 5, 1)), search, 0)  # differs in what counts
    for more in ((6, 5), (4, 6), (127, 0), (0, 127)):
        assert s.insert(put(here, row(*more)), search, 0)


@pytest.mark.parametrize("seed", range(20))
def test_a_row_covers_another_byte_by_byte(seed):
    rng = random.Random(seed)
    body = [rng.choice((0, 255, 255)) for _ in range(BYTES)]
    kept = [rng.randrange(128) for _ in range(BYTES)]
    other = [value if mask else max(0, min(127, value + rng.choice((-1, 0, 0, 0, 0, 1))))
             for value, mask in zip(kept, body, strict=True)]  # fmt: skip
    if seed % 4 == 0:
        place = body.index(255)
        other[place] ^= 1
    wanted = all(a == b if mask else a >= b
                 for a, b, mask in zip(kept, other, body, strict=True))  # fmt: skip
    beside = [0] * WORDS + words(kept)
    assert bool(s.covers(beside, WORDS, words(other), words(body), WORDS)) == wanted


@pytest.mark.parametrize(("a", "b", "smaller"), [
    ([1, 2, 3], [1, 2, 3], False), ([1, 2, 3], [1, 2, 4], True), ([1, 2, 4], [1, 2, 3], False),
    ([0, 9, 9], [1, 0, 0], True), ([1, 0, 0], [0, 9, 9], False), ([-1, 0, 0], [0, 0, 0], True),
])  # fmt: skip
def test_the_first_words_that_differ_decide(a, b, smaller):
    assert bool(s.compare(a, b, WORDS)) == smaller


@pytest.mark.parametrize("seed", range(12))
@pytest.mark.parametrize("is_lean", [False, True])
def test_of_all_images_of_a_state_the_smallest_is_kept_by_its_body_first(seed, is_lean):
    rng = random.Random(seed)
    body = [0 if is_lean and k % 5 == 0 else 255 for k in range(BYTES)]
    images = [list(range(BYTES)), *(rng.sample(range(BYTES), BYTES) for _ in range(3))]
    row = [rng.randrange(3) for _ in range(BYTES)]
    here = world(row, images)
    s.choose_image(here, table(body, images))
    mask = words(body)

    def rank(image):
        made = words([row[place] for place in image])
        return [a & b for a, b in zip(made, mask, strict=True)], made

    assert words(here.best) == min(map(rank, images))[1]
    assert list(here.work) == row


def test_a_walk_remembers_where_it_was_and_keeps_what_it_passes():
    search, here = table(), world([1] * BYTES)
    s.append(here, search)
    s.append(put(here, [2] * BYTES), search)
    assert search.run[s.COUNT] == 2
    assert list(search.before[:2]) == [-1, 0]
    s.save_row(here, search)
    s.restore_row(put(here, [3] * BYTES), search)
    assert list(here.work) == [2] * BYTES
    s.fetch_row(here, search, 0)
    assert list(here.work) == [1] * BYTES


@pytest.mark.parametrize("many", [1, 2, 3, 4, 5])
def test_a_walk_draws_every_outcome_evenly(many):
    """One move, which draws: what it gave stands in the row. The same seed draws the same."""
    given = []

    def step(world, move, variant, choice):
        world.found[0], world.work[0] = 0, choice
        world.work[1] = (world.work[1] + 1) % 200
        return many

    def check(world):
        given.append(world.work[0])
        return 0

    def walked(seed):
        search, here = table(), world([0] * BYTES)
        here.found, here.move_kind = [0], [0]
        s.append(here, search)
        search.run[s.RANDOM] = seed
        given.clear()
        system = SimpleNamespace(variants=lambda world, move: 1, step=step, check=check)
        s.build(system).wander(here, search, 10, 50)
        assert search.run[s.GENERATED] == len(given) == 10 * 49
        assert here.work[1] == 49  # what a step did first is not left where it was taken again
        return list(given)

    drawn = walked(1)
    counts = [drawn.count(choice) for choice in range(many)]
    assert sum(counts) == len(drawn)
    assert min(counts) > 0.7 * len(drawn) / many
    assert walked(1) == drawn
    assert (walked(2) == drawn) == (many == 1)


@pytest.mark.parametrize(("count", "behind", "limit", "slots", "why"), [
    (5, 5, 10**6, 10**6, s.DONE), (5, 4, 10**6, 10**6, s.GOING),
    (10, 0, 10 + s.MARGIN, 10**6, s.GOING), (11, 0, 10 + s.MARGIN, 10**6, s.FULL),
    (84_000 - s.MARGIN, 0, 10**6, 120_000, s.GOING), (84_001 - s.MARGIN, 0, 10**6, 120_000, s.GROW),
])  # fmt: skip
def test_a_search_stops_when_it_has_all_no_room_or_a_table_seven_tenths_full(
    count, behind, limit, slots, why
):
    run = table().run
    run[s.COUNT], run[s.NEXT], run[s.LIMIT], run[s.SLOTS] = count, behind, limit, slots
    assert s.room_left(run) == why
