"""Practical CSMA/CD-R, windows as their reporter sees them: it listens, says what it heard, plans.

The reporter sent the frame before the window, listens through all of it and says in a report which
minislots held one CR-R. Those become turns, in their order. Where several collided they split in
the next window, two minislots for each; a window that was far too small is drawn anew from a
larger span. Splitting instead of drawing anew costs 2.3 minislots for each station instead of 2.7.
"""

from innervate.dialect.arith import MASK30, after
from innervate.dialect.rng import draw
from innervate.networks.radio.protocol import modes
from innervate.networks.radio.protocol.bounds import EARLY, LATE, TOGETHER, notice
from innervate.networks.radio.protocol.constants import (
    MINISLOTS,
    NEXT_NONE,
    NO_PROOF,
    NONE,
    NOT_HEARD,
    POSITIONS,
    REPORT,
)
from innervate.networks.radio.protocol.idle import end_sequence, leave_sequence, retry, schedule
from innervate.networks.radio.protocol.modes import (
    ACTIVE,
    QUIET,
    age_kept,
    arm,
    count_kept,
    disprove,
    following,
    note_joined,
    prove,
    rest_round,
    window_of,
)
from innervate.networks.radio.protocol.station import blank
from innervate.networks.radio.protocol.times import (
    frame_from,
    guard,
    is_slow,
    join_after,
    least_delay,
    minislot,
    most_delay,
    retry_within,
    split_into,
)
from innervate.networks.radio.protocol.turn import enter_turn

FIRST_SPAN = 6  # after several answered the first, single minislot
GROWTH = 4  # a window in which hardly anybody was alone
PROBE_WINDOW = 6  # enough to see whether a span is far too small
SPAN_MOST = 1023
LONELY_NOTICE = 3
LONELY_LONG = 8  # ... and before noise of two minislots does, which is as long as a frame
DOUBTED = 2  # `heard`: CR-Rs in this window prove nothing any more
REPORT_SLOTS = 5  # of a report without its two bits for each minislot


def bit(words, place):
    """A bit of a minislot mask."""
    return (words[place >> 4] >> (place & 15)) & 1


def set_bit(words, place):
    """Set the bit of a minislot in a mask of two 16-bit words."""
    words[place >> 4] = words[place >> 4] | (1 << (place & 15))


def clear_bit(words, place):
    """Clear the bit of a minislot in a mask."""
    words[place >> 4] = words[place >> 4] & ~(1 << (place & 15))


def count_bits(words, first, size):
    """How many bits are set from the bit `first` to `size`, left out."""
    count = 0
    for i in range(first, size):
        count = count + bit(words, i)
    return count


def lead(station, params, now, window, ack, out):
    """Listen to the window behind the frame that we have just sent."""
    station.mode = modes.LEAD
    station.window = window
    station.ack = ack
    station.heard = 0
    station.act = 0
    for i in range(2):
        station.good[i] = 0
        station.bad[i] = 0
    station.ref = station.end
    length = window_start(station, params) + (window + ack) * minislot(params, station.used)
    arm(station, station.end, length, out)


def window_start(station, params):
    """Since the end of our frame until the first minislot's first CR-R can be heard."""
    return params.ta_us + 2 * least_delay(params, station.used) + guard(params, station.used)


def opened(station, params, now, out):
    """Our opening is out and nobody else is heard: lead the first window."""
    station.opener = 1
    size = 1
    if station.next < NEXT_NONE:
        size = window_of(params, station.next)
    lead_first(station, params, now, size, 1, out)


def lead_first(station, params, now, window, ack, out):
    """Lead a window that no report announced."""
    age_kept(station, params)
    station.kept = min(count_kept(station), window)
    station.rest = 0
    station.span = window - station.kept
    station.split = 0
    station.joined = 0
    lead(station, params, now, window, ack, out)


def minislot_of(station, params, rise):
    """The minislot in which a burst began, that for pulses last; -1 outside."""
    start = station.ref + window_start(station, params)
    since = (rise - start) & MASK30
    if not after(rise, start & MASK30):
        return -1
    place = since // minislot(params, station.used)
    if place >= station.window + station.ack:
        return -1
    return place


def check_bounds(station, params, rise, out):
    """1 if a CR-R came when the configured delays allow it; else it is worth a word.

    What came at another time may have answered somebody else: it proves nothing.
    """
    start = (station.ref + window_start(station, params)) & MASK30
    least = least_delay(params, station.used)
    if not after(rise, start):
        delay = least - ((start - rise) & MASK30) // 2
        if station.used == 0:  # else no delay is so short: it answers somebody else
            notice(station, params, max(delay, 0), EARLY, out)
        return False
    within = ((rise - start) & MASK30) % minislot(params, station.used)
    if within > 2 * (most_delay(params, station.used) - least):
        notice(station, params, least + within // 2, LATE, out)
        return False
    return True


def hear_slot(station, params, now, out):
    """A CR-R or pulse, alone in its minislot."""
    if station.mode != modes.LEAD:
        station.decoded = 0
        return
    rise = (now - params.slot_us) & MASK30
    if check_bounds(station, params, rise, out) and station.heard < DOUBTED:
        prove(station, out)
    station.heard = max(station.heard, 1)
    place = minislot_of(station, params, rise)
    if 0 <= place < station.window:
        set_bit(station.good, place)


def end_burst(station, params, now, length, noise, out):
    """The end of a carrier in our window; a report or turn waits for it."""
    if noise and length >= frame_from(params, station.used):
        run_together(station, params, length, out)
        overrun(station, params, now, out)
        return
    if noise:
        fits = check_bounds(station, params, station.rise, out)
        lone = station.ack and not station.opener  # nothing else can prove our packets
        if length >= 2 * params.slot_us and not lone:
            station.heard = DOUBTED  # perhaps a frame, and CR-Rs from now on answer that
        elif fits and station.heard < DOUBTED:
            prove(station, out)
        place = minislot_of(station, params, station.rise)
        if 0 <= place < station.window:
            set_bit(station.bad, place)
    if not station.armed:
        close(station, params, now, out)


def run_together(station, params, length, out):
    """Noise too short for a frame, too long for CR-Rs of one minislot: their delays differ more.

    Other openers' probes can look alike, so an opener waits until it has failed several times.
    """
    if is_slow(params) and length <= 2 * params.slot_us + params.bit_us:
        return  # as long as a turn without a packet
    needed = LONELY_NOTICE
    if length >= 3 * params.slot_us:
        if not station.opener or length > 2 * minislot(params, station.used) + params.slot_us:
            return
        needed = LONELY_LONG
    if station.opener:
        station.lonely = min(station.lonely + 1, 31)
    if not station.opener or station.lonely >= needed:
        delay = least_delay(params, station.used) + (length - params.slot_us) // 2
        notice(station, params, delay, TOGETHER, out)


def overrun(station, params, now, out):
    """Too long for CR-Rs: a frame that we could not read. Nothing in this window proves anything.

    Others may follow it still, and we would take their CR-Rs for answers to our turn: it ends
    first.
    """
    disprove(station, NO_PROOF, out)
    station.last_ok = 0
    if station.opener:
        rest_round(station, params)
    station.window = 0  # nothing is to be reported of it
    if not station.armed:
        close(station, params, now, out)


def end_of_window(station, params, now, out):
    """The window is over, unless a burst is still there."""
    if not station.cd:
        close(station, params, now, out)


def close(station, params, now, out):
    """Say what was heard, if anything was; else go on with the turns."""
    if station.window == 0:
        enter_turn(station, params, now, station.cur, out)
        return
    if not station.heard and station.ack:
        if station.opener:
            retry(station, params, now, 0, out)
        else:
            disprove(station, NOT_HEARD, out)
            wait = join_after(params, station.used)
            leave_sequence(
                station, params, now, wait + draw(station, retry_within(params, station.used))
            )
            schedule(station, now, out)
        return
    good = count_bits(station.good, 0, station.window)
    bad = count_bits(station.bad, 0, station.window)
    doubted = station.opener and station.pending
    if good + bad == 0 and station.rest == 0 and not doubted:
        station.opener = 0
        note_joined(station, 0)
        if station.cur == NONE and station.pending == 0:
            end_sequence(station, params, now, out)
        else:
            enter_turn(station, params, now, station.cur, out)
    else:
        send_report(station, params, now, bad, out)


def answer_kept(station):
    """Kept places that were heard in their minislots have turns, and so has ours if we need it."""
    kept = station.kept
    place = station.pos
    if 0 <= place < kept and station.live[place] >= QUIET:
        if bit(station.good, place):
            station.pos = NONE  # somebody else uses it
        elif station.queued:
            set_bit(station.good, place)
    for i in range(kept):
        if bit(station.good, i):
            station.live[i] = ACTIVE


def send_report(station, params, now, bad, out):
    """REPORT: minislots that are turns now, and the window that follows."""
    if station.pending:
        disprove(station, NO_PROOF, out)
    frame = blank(out)
    frame.kind = REPORT
    frame.kept = station.kept
    answer_kept(station)
    good = count_bits(station.good, station.kept, station.window)
    wants = station.queued and station.pos == NONE
    own = 1 if wants and station.window < MINISLOTS else 0
    frame.slots = REPORT_SLOTS + (1 if station.kept else 0) + (station.window + own + 4) // 5
    base = free_places(station, good + own)
    if base == NONE:
        good = 0
        own = 0
        base = 0
        for i in range(station.kept, MINISLOTS):
            clear_bit(station.good, i)
    if own:
        # A minislot that nobody could use: all give it a place, and we know whose that is.
        set_bit(station.good, station.window)
        station.pos = base + good
    good = good + own
    for i in range(2):
        frame.good[i] = station.good[i]
        frame.bad[i] = station.bad[i]
    station.joined = station.joined + good
    frame.base = base
    for i in range(good):
        station.live[base + i] = ACTIVE
    if station.cur == NONE:
        station.cur = following(station, station.pos)
    plan_window(station, split_into(params), good - own, bad)
    frame.wide = station.wide
    station.used = station.wide
    if station.window == 0:
        note_joined(station, 1)
    frame.window = station.window
    frame.span = station.span
    frame.split = 1 if station.split else 0
    station.kept = 0
    frame.pos = station.cur & 127
    station.opener = 0
    station.last_ok = 0
    station.turns = 0
    station.armed = 0
    station.end = (now + params.ta_us + frame.slots * params.slot_us) & MASK30
    station.mode = modes.SEND_REPORT


def free_places(station, count):
    """The first of the first `count` free places side by side; NONE if there are none."""
    size = 0
    for i in range(POSITIONS):
        size = 0 if station.live[i] else size + 1
        if size >= count:
            return i + 1 - size
    return NONE


def plan_window(station, parts, good, bad):
    """The next window: collided minislots split, and more of the span; or all is drawn anew."""
    window = station.window - station.kept
    span = station.rest
    first = station.split == 0
    if first and bad and window == 1:
        span = FIRST_SPAN
        station.split = 0
    elif first and 2 * bad > window and good + bad == window:
        span = GROWTH * station.span
        station.split = 0
    elif parts * bad > MINISLOTS:
        span = 3 * bad + span
        station.split = 0
    else:
        station.split = bad
    span = min(span, SPAN_MOST)
    fresh = min(span, MINISLOTS - parts * station.split)
    if bad == window and station.split == 0:
        fresh = min(fresh, PROBE_WINDOW)
    station.span = span
    station.window = parts * station.split + fresh
    station.rest = span - fresh


def sent_report(station, params, now, out):
    """Our report is out: lead the next window, or begin the turns."""
    if station.window:
        lead(station, params, now, station.window, 0, out)
    else:
        enter_turn(station, params, now, station.cur, out)
