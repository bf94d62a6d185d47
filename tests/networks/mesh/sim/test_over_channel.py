"""A mesh over a radio team's channel: when that has something to do next, and what it does then."""

from types import SimpleNamespace as Of

import pytest

from innervate.networks.mesh.sim import over_channel
from innervate.sim import heap
from innervate.sim.channel import loop
from innervate.sim.channel.world import Heap

TIMER_80 = heap.key_of(80, heap.TIMER, 1, 0)
END_50 = heap.key_of(50, heap.ENDS, 1, 0)
READY_50 = heap.key_of(50, heap.READY, 0, 0)


def world_of(*keys, told=0, now=50):
    run = [Of(now=now, handled=7)]
    queue = Heap([*keys, *[0] * 4], [len(keys)])
    return Of(run=[Of(handled=100)], below=Of(heap=queue, told=[told], run=run))


CASES = [
    # (events in the queue, stations to be told of a carrier, when, whether they are told first)
    ((TIMER_80,), 0, 80, False), ((), 0, heap.LAST >> heap.TIME_SHIFT, False),
    ((TIMER_80,), 1, 50, True), ((), 1, 50, True),
    ((END_50, TIMER_80), 1, 50, False),  # all edges of a moment come before
    ((READY_50 - 1, TIMER_80), 1, 50, False), ((READY_50, TIMER_80), 1, 50, True),
    ((READY_50, TIMER_80), 0, 50, False),
]  # fmt: skip


@pytest.mark.parametrize(("keys", "told", "when", "_first"), CASES)
def test_the_channel_is_due_when_its_first_event_is_or_at_once_to_tell(keys, told, when, _first):
    assert over_channel.due(world_of(*keys, told=told)) == when


@pytest.mark.parametrize(
    ("keys", "told", "when", "first"), [case for case in CASES if case[0] or case[3]]
)
def test_its_next_event_is_handled_and_counted(monkeypatch, keys, told, when, first):
    done = []

    def noted(name):
        def handle(below, _do, *what):
            below.run[0].handled += 3
            done.append((name, *what))

        return handle

    monkeypatch.setattr(loop, "tell_all", noted("tell"))
    monkeypatch.setattr(loop, "dispatch", noted("dispatch"))
    world = world_of(*keys, told=told)
    over_channel.step(world, Of(channel=None), when)
    assert done == [("tell", when) if first else ("dispatch", keys[0], when)]
    assert world.below.run[0].now == when
    assert world.run[0].handled == 103
