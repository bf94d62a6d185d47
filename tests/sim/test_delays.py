"""Classes of latencies: which is whose, how long their longest is, what is kept of each way."""

from types import SimpleNamespace

import pytest

from innervate.sim.delays import CLASSES, EXACT, PER_OCTAVE, class_of, longest_of, note


@pytest.mark.parametrize(("latency_us", "number"), [
    (0, 0), (1, 1), (511, 511), (512, 512), (513, 512), (514, 513), (1023, 767), (1024, 768),
    (1027, 768), (1028, 769), (2047, 1023), (2048, 1024), ((1 << 30) - 1, CLASSES - 1),
])  # fmt: skip
def test_the_class_of_a_latency(latency_us, number):
    assert class_of(latency_us) == number
    assert latency_us <= longest_of(number)


def test_classes_follow_each_other_without_a_gap():
    assert (EXACT, PER_OCTAVE, CLASSES) == (512, 256, 512 + 256 * 21)
    for number in range(CLASSES - 1):
        last = longest_of(number)
        assert class_of(last) == number
        assert class_of(last + 1) == number + 1
    assert longest_of(CLASSES - 1) == (1 << 30) - 1


def test_each_way_keeps_its_own():
    ways = 2
    world = SimpleNamespace(
        delays=[SimpleNamespace(high=0, count=0, sum=0) for _ in range(ways)],
        delay_counts=[0] * (ways * CLASSES),
    )
    for way, latency_us in ((1, 600), (1, 601), (0, 5), (1, 100)):
        note(world, way, latency_us)
    assert [(one.high, one.count, one.sum) for one in world.delays] == [(5, 1, 5), (601, 3, 1301)]
    where = {place: count for place, count in enumerate(world.delay_counts) if count}
    assert where == {5: 1, CLASSES + 100: 1, CLASSES + class_of(600): 2}
