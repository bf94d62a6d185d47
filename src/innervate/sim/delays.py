"""Latencies as they come, in classes: percentiles of any number of them in little room.

Up to 511 us every whole microsecond is a class of its own; beyond, an octave has 256 of them, so
that a class is at most 0.4 % wide. The greatest and the sum are kept exactly.
"""

EXACT = 512
PER_OCTAVE = 256
OCTAVES = 21  # up to 2^30 us
CLASSES = EXACT + PER_OCTAVE * OCTAVES


def note(world, way, latency_us):
    """Take in a latency, 0 <= latency_us < 2^30, of a way: an interface port."""
    kept = world.delays[way]
    kept.high = max(kept.high, latency_us)
    kept.count += 1
    kept.sum += latency_us
    world.delay_counts[way * CLASSES + class_of(latency_us)] += 1


def class_of(latency_us):
    """The class that a latency belongs to."""
    octave = 0
    while (latency_us >> octave) >= EXACT:
        octave += 1
    return octave * PER_OCTAVE + (latency_us >> octave)


def longest_of(number: int) -> int:
    """The longest latency of a class, us."""
    if number < EXACT:
        return number
    octave = number // PER_OCTAVE - 1
    return ((number - octave * PER_OCTAVE + 1) << octave) - 1
