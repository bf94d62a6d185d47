"""Which keys are taken and which is used at each moment of a change, and of one that is undone."""

import asyncio

import pytest

from innervate.live.errors import LiveError
from innervate.live.keys import Sealer, ring_of
from innervate.live.rotation import Rotation
from tests.live import time_by_hand
from tests.live.time_by_hand import timed

KEYS = {number: bytes([number]) * 32 for number in range(4)}
GRACE_S = 10.0


def some(*numbers):
    return {number: KEYS[number] for number in numbers}


def seen(*changes, until_s=50):
    """(keys, the one that is used) whenever they are others, by the second; each change is
    (when, numbers, use, and its grace time where it is another).
    """

    async def main():
        sealer = Sealer(ring_of("mesh", some(0), 0), 1)
        rotation, found = Rotation(sealer), {}
        for second in range(until_s):
            for _, numbers, use, *grace_s in (one for one in changes if one[0] == second):
                rotation.begin(some(*numbers), use, *(grace_s or [GRACE_S]))
            await asyncio.sleep(0.5)
            now = (sorted(sealer.ring.keys), sealer.ring.use)
            if now not in list(found.values())[-1:]:
                found[second] = now
            await asyncio.sleep(0.5)
        rotation.stop()
        return found

    return time_by_hand.run(main())


def test_another_key_is_taken_at_once_used_after_a_while_and_the_old_leaves_last():
    assert seen((1, [1], 1)) == {0: ([0], 0), 1: ([0, 1], 0), 11: ([0, 1], 1), 21: ([1], 1)}


def test_a_key_that_stays_is_taken_for_ever():
    assert seen((1, [0, 1], 1)) == {0: ([0], 0), 1: ([0, 1], 0), 11: ([0, 1], 1)}


def test_a_change_that_is_undone_before_it_is_over():
    assert seen((1, [1], 1), (5, [0], 0)) == {
        0: ([0], 0), 1: ([0, 1], 0), 11: ([0, 1], 1), 15: ([0, 1], 0), 25: ([0], 0),
    }  # fmt: skip
    late = seen((1, [1], 1), (15, [0], 0))
    assert late == {0: ([0], 0), 1: ([0, 1], 0), 11: ([0, 1], 1), 25: ([0, 1], 0), 35: ([0], 0)}


def test_of_two_changes_the_last_holds():
    found = seen((1, [1], 1), (4, [2], 2))
    assert list(found.values())[-1] == ([2], 2)
    assert found[4] == ([0, 1, 2], 0)
    assert [use for _, use in found.values()][-2:] == [2, 2]
    assert found[14][1] == 2
    assert [second for second, (_, use) in found.items() if use == 1] == [11]


def test_a_later_change_that_is_quicker_ends_the_one_before():
    assert seen((1, [1], 1), (4, [2], 2, 2.0)) == {
        0: ([0], 0), 1: ([0, 1], 0), 4: ([0, 1, 2], 0), 6: ([0, 1, 2], 2), 8: ([0, 2], 2),
        21: ([2], 2),
    }  # fmt: skip


def test_the_key_of_a_change_that_is_over_is_not_used_again():
    assert seen((1, [1], 1), (4, [1, 2], 2, 2.0)) == {
        0: ([0], 0), 1: ([0, 1], 0), 4: ([0, 1, 2], 0), 6: ([0, 1, 2], 2), 21: ([1, 2], 2),
    }  # fmt: skip


def test_a_node_that_ends_changes_nothing_more():
    async def main():
        sealer = Sealer(ring_of("mesh", some(0), 0), 1)
        rotation = Rotation(sealer)
        rotation.begin(some(1), 1, GRACE_S)
        rotation.stop()
        await asyncio.sleep(5 * GRACE_S)
        return sorted(sealer.ring.keys), sealer.ring.use

    assert time_by_hand.run(main()) == ([0, 1], 0)


def test_a_key_that_leaves_is_used_no_more():
    assert seen((1, [0, 1], 1, 20.0), (2, [1], 1, 2.0)) == {
        0: ([0], 0), 1: ([0, 1], 0), 6: ([1], 1),
    }  # fmt: skip


def test_a_change_to_what_is_there_already_changes_nothing():
    assert seen((1, [0], 0)) == {0: ([0], 0)}


@timed
async def test_a_number_has_one_key():
    rotation = Rotation(Sealer(ring_of("mesh", some(0), 0), 1))
    with pytest.raises(LiveError, match=r"keys\.secret\.0 is another key now"):
        rotation.begin({0: KEYS[1]}, 0, GRACE_S)
