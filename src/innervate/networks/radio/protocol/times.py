"""Times of practical CSMA/CD-R that follow from what stations believe of their delays.

`wide` is 0 while the configured bounds are believed. Each step above it doubles the greatest delay
and gives up the least: a sequence then takes longer and bears delays that the bounds exclude.
"""

from innervate.networks.radio.protocol.constants import KEPT, WIDE_MOST

ASKING_SLOTS = 7  # of a report for a few kept places
LONGEST_US = (1 << 28) - 1


def least_delay(params, wide):
    """The least delay believed in, us."""
    if wide:
        return 1
    return params.dmin_us


def most_delay(params, wide):
    """The greatest delay believed in, us."""
    return params.dmax_us << wide


def minislot(params, wide):
    """w: a CR-R, twice the spread of the delays, and a bit."""
    if wide:
        return params.slot_us + 2 * (most_delay(params, wide) - 1) + params.bit_us
    return params.minislot_us


def frame_from(params, wide):
    """Noise of this length or longer is no minislot's CR-Rs or pulses: it was a frame."""
    return max(2 * params.slot_us, minislot(params, wide) if wide else 0)


def probe(params, wide):
    """u: two openings of this length overlap at every station, whatever their delays."""
    if wide:
        length = max(2 * params.slot_us, 3 * most_delay(params, wide) + params.slot_us)
        return params.ta_us + length
    return params.probe_us


def probe_slots(params, wide):
    """How many whole slots an opening lasts at least."""
    return (probe(params, wide) + params.slot_us - 1) // params.slot_us


def silence_behind(params, wide, slots):
    """How long slow radios are silent behind an opening of so many slots, so that u has passed.

    Whoever began before it could hear it is heard in that time, if not with it.
    """
    if wide or not is_slow(params):
        return 0
    return max(probe_slots(params, 0) - slots, 0) * params.slot_us


def retry_within(params, wide):
    """Wr: colliders wait less than this."""
    if wide:
        return 6 * (params.ta_us + most_delay(params, wide)) + params.slot_us
    return params.retry_us


def join_after(params, wide):
    """J: longer than any silence in a sequence."""
    if wide:
        longest = max(retry_within(params, wide) + 2 * minislot(params, wide),
                      33 * minislot(params, wide))  # fmt: skip
        return min(2 * params.ta_us + longest + 3 * params.slot_us, LONGEST_US)
    return params.join_us


def turn_timeout(params, wide):
    """D: silence after which a turn is given up."""
    if wide:
        return 2 * params.ta_us + 4 * most_delay(params, wide) + minislot(params, wide)
    return params.dead_us


def is_slow(params):
    """1 if the radio needs longer to switch than two minislots last: a window is dear."""
    return params.ta_us > 2 * params.minislot_us


def pass_slots(params):
    """Length of a turn without a packet; quick radios tell it from CR-Rs by its length."""
    return 2 if is_slow(params) else 3


def is_few(params, places):
    """1 if a round of so many places goes on without packets, with a turn for each.

    Half of such a round is then no longer than a window for all of them, its report and what the
    turn behind that waits; a quarter longer where a turn may have several packets, as a longer
    round carries no less then.
    """
    turn = params.ta_us + pass_slots(params) * params.slot_us
    return 2 * places * turn <= (5 if params.per_turn > 1 else 4) * asking(params, places)


def asking(params, places):
    """What a window for so many places takes, its report and what the turn behind that waits."""
    return 3 * params.ta_us + ASKING_SLOTS * params.slot_us + (places + 1) * params.minislot_us


def keeps(params):
    """How many places are kept for stations without packets: quick radios pass their turns on."""
    return KEPT if is_slow(params) else 0


def split_into(params):
    """Minislots for each that collided: the slower the radio, the dearer another window."""
    return 4 if is_slow(params) else 2


def guard(params, wide):
    """What a turn waits so that it cannot overtake the one before at a third station."""
    return max(0, most_delay(params, wide) - 2 * least_delay(params, wide) - params.ta_us)


def wider_for(params, wide, delay):
    """How wide the bounds have to be for a delay of so many us; always more than `wide`."""
    found = wide + 1
    while found < WIDE_MOST and most_delay(params, found) < delay:
        found = found + 1
    return min(found, WIDE_MOST)
