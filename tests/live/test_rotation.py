"""Other keys: nobody is shut out, whoever is started anew meanwhile, and every change ends."""

import pytest

from innervate.live.rotation import Rotation
from tests.live.pair import KEY, OTHER, Wire, begin, join, network_sealer, settle, two
from tests.live.time_by_hand import timed

VALVE = b"OPEN VALVE"


@timed
async def test_a_node_that_has_only_the_new_key_is_back_inside_the_grace():
    a, b = Wire(), Wire()
    join(a, b)
    begin(network_sealer(1), a)
    begin(network_sealer(2), b)
    await settle()
    Rotation(a.sealer).begin({2: OTHER}, 2, 10.0)
    b.sealer.stop()
    b = Wire()
    join(a, b)
    begin(network_sealer(2, {2: OTHER}), b)
    await settle(0.1)
    a.frame(VALVE)
    b.frame(b"back")
    await settle(0.1)
    assert (a.frames(), b.frames()) == ([b"back"], [VALVE])


@timed
async def test_keys_are_changed_without_a_frame_lost():
    a, b = await two()
    old = Rotation(a.sealer), Rotation(b.sealer)
    for k in range(60):
        if k == 10:
            old[0].begin({2: OTHER}, 2, 1.0)
        if k == 15:
            old[1].begin({2: OTHER}, 2, 1.0)
        a.frame(bytes([k]))
        b.frame(bytes([k]))
        await settle(0.1)
    assert a.frames() == b.frames() == [bytes([k]) for k in range(60)]
    assert a.sealer.status() == b.sealer.status() == {"use": 2, "accepted": [2]}
    assert a.sealer.dropped == b.sealer.dropped == {}


def rotating():
    """A node alone on its path, and the changes of its key."""
    a = Wire()
    begin(network_sealer(1), a)
    return a, Rotation(a.sealer)


@timed
async def test_changes_closer_than_the_grace_come_to_an_end():
    a, rotation = rotating()
    for k in range(2, 12):
        rotation.begin({k: bytes([k]) * 32}, k, 10.0)
        await settle(3.0)
    assert a.sealer.ring.use > 5  # not the first one until all is quiet
    assert len(a.sealer.ring.keys) <= 8
    for _ in range(10):
        rotation.begin({11: bytes([11]) * 32}, 11, 10.0)
        await settle(3.0)
    assert a.sealer.status() == {"use": 11, "accepted": [11]}


@pytest.mark.parametrize(
    ("grace_s", "number", "key", "then_s", "after_s"),
    [(10.0, 1, KEY, 10.0, 60.0), (1000.0, 3, bytes([3]) * 32, 0.0, 5000.0)],
    ids=["taken back", "a long grace, then none"],
)
@timed
async def test_the_later_of_two_changes_leaves_a_key_that_is_there(
    grace_s, number, key, then_s, after_s
):
    a, rotation = rotating()
    rotation.begin({2: OTHER}, 2, grace_s)
    await settle(3.0)
    rotation.begin({number: key}, number, then_s)
    await settle(after_s)
    assert a.sealer.status() == {"use": number, "accepted": [number]}
