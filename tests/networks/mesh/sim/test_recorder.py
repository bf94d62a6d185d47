"""What a mesh's run remembers of deliveries: each packet once, for each start of who sent it."""

import itertools
from types import SimpleNamespace

import pytest

from innervate.networks.mesh.sim.recorder import BROKEN_TWICE, check_once, is_looped

FORGET_US = 1_000


def world(boots=()):
    run = SimpleNamespace(forget=FORGET_US, broken=0, broken_node=-1, duplicates=0)
    radios = [SimpleNamespace(boots=0) for _ in range(254)]
    for node, count in boots:
        radios[node].boots = count
    size = 1 << 12
    return SimpleNamespace(
        run=[run], radios=radios, duplicate_key=[0] * size, duplicate_at=[0] * size
    )


def frame(origin, seq):
    return SimpleNamespace(origin=origin, seq=seq)


def test_no_two_packets_are_taken_for_the_same():
    made = world()
    some = list(
        itertools.product((0, 1, 127, 128, 253), (0, 1, 128, 253), (0, 1, 255, 256, 65_535))
    )
    for node, origin, seq in some:
        check_once(made, node, frame(origin, seq), 0)
    assert made.run[0].broken == 0
    assert made.run[0].duplicates == len(some)
    for node, origin, seq in some:
        made.run[0].broken = 0
        check_once(made, node, frame(origin, seq), 1)
        assert (made.run[0].broken, made.run[0].broken_node) == (BROKEN_TWICE, node)
    assert made.run[0].duplicates == len(some)


@pytest.mark.parametrize(("later_us", "broken"), [(0, 1), (FORGET_US - 1, 1), (FORGET_US, 0)])
def test_a_number_may_come_again_when_it_may_be_forgotten(later_us, broken):
    made = world()
    check_once(made, 2, frame(1, 7), 5_000)
    check_once(made, 2, frame(1, 7), 5_000 + later_us)
    assert bool(made.run[0].broken) == broken
    made.run[0].broken = 0
    check_once(made, 2, frame(1, 7), 5_000 + later_us + FORGET_US - 1)  # since the newest
    assert made.run[0].broken == BROKEN_TWICE


@pytest.mark.parametrize("who", [1, 2])
@pytest.mark.parametrize("boots", [1, 2, 512, 1023])
def test_who_was_switched_on_anew_counts_anew(who, boots):
    made = world()
    check_once(made, 2, frame(1, 7), 0)
    made.radios[who].boots = boots
    check_once(made, 2, frame(1, 7), 1)
    assert made.run[0].broken == 0
    made.radios[3 - who].boots = boots
    check_once(made, 2, frame(1, 7), 1)
    assert made.run[0].broken == 0
    assert made.run[0].duplicates == 3


@pytest.mark.parametrize(("path", "length", "looped"), [
    ([], 0, 0), ([1], 1, 0), ([1, 1], 1, 0), ([1, 1], 2, 1), ([1, 2, 3, 1], 4, 1),
    ([1, 2, 3, 1], 3, 0), ([2, 1, 3, 3], 4, 1), ([1, 2, 3, 2, 4], 5, 1), ([1, 2, 3, 4], 4, 0),
])  # fmt: skip
def test_a_packet_has_looped_if_a_node_is_twice_on_its_path(path, length, looped):
    assert is_looped(SimpleNamespace(path=path, path_len=length)) == looped
