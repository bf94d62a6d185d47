"""What a capture is told of frames on cables: when, at which end, and why they got no further."""

import pytest

from innervate.dialect.outbox import FLUSH, URGENT
from innervate.sim import taps
from innervate.sim.cables import wires
from innervate.sim.cables.wires import DELAYED, DOWN, LOSSY
from innervate.sim.cables.world import DEAD
from tests.sim.cables.small import END, PEER, Do, small_world

WIRE_US, LATENCY_US = 60, 75
NOW = 1_000


@pytest.fixture
def do():
    world = small_world(tap=True)
    assert world.run[0].wire_us == WIRE_US
    world.ends[END].latency = LATENCY_US
    return Do(world)


def send(do, seq, at=NOW, flags=0):
    frame = do.world.sample[0]
    frame.seq = seq
    wires.transmit(do.world, do, END, frame, at, flags)


def tapped(do):
    """(frame, when, at which end, 1 = it left, why) of all that was kept."""
    world, rows = do.world, do.world.taps[: do.world.run[0].taps]
    return [(world.tapped[i].seq, row.time, row.at, row.out, row.why)
            for i, row in enumerate(rows)]  # fmt: skip


def test_a_frame_leaves_when_its_wire_is_free(do):
    send(do, 1)
    send(do, 2, at=NOW + 5, flags=URGENT)
    assert tapped(do) == [(1, NOW, END, 1, taps.FINE), (2, NOW + WIRE_US, END, 1, taps.FINE)]


@pytest.mark.parametrize(("impaired", "why"), [(DOWN | 4, taps.CUT), (LOSSY, taps.NOISE),
                                               (DOWN | LOSSY | 4, taps.CUT)])  # fmt: skip
def test_a_frame_that_is_lost_as_it_leaves_says_why(do, impaired, why):
    do.world.ends[END].impaired, do.world.buffers[END].lose = impaired, 1
    send(do, 1)
    assert tapped(do) == [(1, NOW, END, 1, why)]


def test_a_frame_that_finds_no_room_is_kept_and_so_is_what_waits_when_it_is_lost(do):
    room = do.world.run[0].queue_frames
    for seq in range(room + 2):
        send(do, seq, at=NOW + seq)
    full = (room + 1, NOW + room + 1, END, 1, taps.QUEUE)
    assert tapped(do) == [(0, NOW, END, 1, taps.FINE), full]
    send(do, 99, at=NOW + 50, flags=URGENT | FLUSH)
    lost = [(seq, NOW + 50, END, 1, taps.BROKEN) for seq in range(1, room + 1)]
    assert tapped(do)[2:] == [*lost, (99, NOW + WIRE_US, END, 1, taps.FINE)]


def test_what_waits_at_who_is_switched_off_says_so(do):
    send(do, 1)
    send(do, 2)
    wires.drop_queue(do.world, do, END, NOW + 9)
    assert tapped(do)[1:] == [(2, NOW + 9, END, 1, taps.OFF)]
    assert do.world.buffers[END].queued == 0


@pytest.mark.parametrize(("epoch", "alive", "why"), [
    (0, 1, taps.FINE), (0, DEAD, taps.OFF), (0, 0, taps.OFF), (1, 1, taps.CUT), (1, DEAD, taps.CUT),
])  # fmt: skip
def test_a_frame_comes_in_or_says_why_not(do, epoch, alive, why):
    send(do, 1)
    world, slot = do.world, do.world.run[0].pool_slots
    world.epoch[PEER], world.alive[1] = epoch, alive
    frame, event = world.frames[0], world.wheel.events[slot]
    found = wires.lands(world, do, event, 1, frame, NOW + LATENCY_US)
    assert found == (why == taps.FINE)
    assert tapped(do)[1:] == [(1, NOW + LATENCY_US, PEER, 0, why)]


def test_what_is_lost_from_a_queue_is_counted_by_its_kind(do):
    do.block_of = lambda frame: 24 if frame.seq > 1 else 0
    do.world.buffers[END].first = do.world.run[0].queue_frames - 1  # round the ring's end
    for seq in (1, 2, 3):
        send(do, seq)
    wires.drop_queue(do.world, do, END, NOW)
    found = {k: count for k, count in enumerate(do.world.counters) if count}
    assert found == {wires.SENT: 1, wires.SENT + 24: 2, wires.LOST_OFF + 24: 2}


def test_a_frame_that_was_held_back_keeps_its_flags(do):
    send(do, 1)
    frame = do.world.sample[0]
    frame.seq = 2
    wires.delay(do.world, do, END, frame, NOW + 5, URGENT)
    slot = do.world.run[0].pool_slots + 1
    assert do.world.wheel.events[slot].kind == DELAYED
    wires.release(do.world, do, slot, NOW + 5)
    assert tapped(do)[1:] == [(2, NOW + WIRE_US, END, 1, taps.FINE)]  # ahead of those that wait


def test_without_a_capture_nothing_is_kept():
    do = Do(small_world())
    send(do, 1)
    assert tapped(do) == []
