"""Frames as they leave their senders and come in, for captures: rows, and copies of the frames.

Nothing is kept unless a simulation was asked to: `run.tap_limit` is 0 then. A frame that was sent
has a row (`world.TAP`) of its own, and one more for whoever received it, or could have and did not.
"""

from collections.abc import Callable
from typing import Any

# Why a frame got no further.
FINE = 0
CUT = 1
NOISE = 2
OFF = 3
QUEUE = 4
BROKEN = 5
COLLISION = 6
SENDING = 7
SPOILT = 8

# Is handed rows and frames, of which it must copy what it keeps, and the time they go up to, us.
Tap = Callable[[Any, Any, int], None]


def record_frame(world, time, at, out, why):
    """The row of a frame; its copy is in `world.tapped[run.taps]`, the caller fills in the rest."""
    run = world.run[0]
    row = world.taps[run.taps]
    run.taps += 1
    row.time, row.start, row.at, row.sender, row.out, row.why = time, time, at, 0, out, why
    return row


def record_queue(world, end, time, why, copy_frame):
    """Keep what waits at a port of a skin and is lost."""
    run, buffer = world.run[0], world.buffers[end]
    if run.tap_limit > 0:
        for i in range(buffer.queued):
            place = end * run.queue_frames + (buffer.first + i) % run.queue_frames
            copy_frame(world.tapped[run.taps], world.queue[place])
            record_frame(world, time, end, 1, why)
