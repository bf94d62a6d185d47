"""Practical CSMA/CD-R outside a sequence: when to open one, and again after a collision."""

from innervate.dialect.arith import MASK30, after
from innervate.dialect.outbox import report
from innervate.dialect.rng import draw
from innervate.networks.radio.protocol import modes
from innervate.networks.radio.protocol.bounds import BEHIND, notice
from innervate.networks.radio.protocol.constants import (
    ALONE,
    HEARD_TAIL,
    LONE_WINDOWS,
    NONE,
    NOT_HEARD,
    OPEN,
    REPORT_COLLISION,
    UNKNOWN,
    WINDOWS,
)
from innervate.networks.radio.protocol.modes import (
    ACTIVE,
    BUSY,
    QUIET,
    arm,
    clear_round,
    code_for,
    count_kept,
    disprove,
    first_free,
    rest_round,
    wanted_window,
)
from innervate.networks.radio.protocol.station import blank, load_packets
from innervate.networks.radio.protocol.times import (
    guard,
    is_slow,
    join_after,
    least_delay,
    minislot,
    most_delay,
    probe_slots,
    retry_within,
    silence_behind,
)

LONELY_FREE = 3  # openings into silence before the wait grows
LONELY_MOST = 5  # doublings
STEPS = 6  # of a turnaround and a delay in Wr


def listen_first(station, params, now, cause, out):
    """Begin outside any sequence. On switching on, listen as long as one can be silent."""
    wait = 0
    station.lonely = station.fails = station.opener = 0
    station.slot = NONE
    if cause:
        wait = join_after(params, station.wide)
    leave_sequence(station, params, now, wait)
    clear_round(station)
    schedule(station, now, out)


def leave_sequence(station, params, now, wait_us):
    """Leave the sequence; a new one may be opened `wait_us` from now."""
    rest_round(station, params)
    station.mode = modes.IDLE
    station.credit = station.pending = station.act = station.armed = 0
    station.tail = station.collided = station.last_ok = 0
    station.used = station.wide
    station.at = (now + wait_us) & MASK30


def schedule(station, now, out):
    """Set the timer of an opening; it runs without packets, too.

    `at` is a reading of a clock that wraps: it means something only while the timer runs.
    """
    if not station.cd:
        wait = 0
        if after(station.at, now):
            wait = (station.at - now) & MASK30
        arm(station, now, wait, out)


def end_sequence(station, params, now, out):
    """The sequence has ended, as all who followed it know: whoever has a packet may open."""
    leave_sequence(station, params, now, guard(params, station.used) + 1)
    schedule(station, now, out)


def offered(station, params, now, out):
    """A packet came; in an idle channel it goes out at once."""
    if station.mode == modes.IDLE and not station.armed:
        station.at = now
        schedule(station, now, out)


def open_now(station, params, now, out):
    """Send an opening: our packets, or after a collision a short probe."""
    if station.queued == 0 or station.cd:
        return
    frame = blank(out)
    least = probe_slots(params, station.wide)
    frame.slots = least
    count = 0
    silence = 0
    most = loads(station, params)
    if most:
        count = load_packets(station, frame, most)
        silence = silence_behind(params, station.wide, frame.slots)
        if silence == 0:
            frame.slots = max(frame.slots, least)
    frame.kind = OPEN
    rest_round(station, params)
    frame.pos = take_place(station, params)
    more = station.queued > count
    if more:
        station.live[station.pos] = ACTIVE
    elif frame.pos == UNKNOWN:
        station.pos = NONE
    else:
        station.live[station.pos] = QUIET
    frame.next = ALONE
    size = wanted_window(station, params)
    if station.collided and is_slow(params):
        size = max(size, 2)  # there was a collision: more than one will ask
    size = max(size, 1) + count_kept(station)
    if size > 1:
        frame.next = code_for(params, size) + LONE_WINDOWS - WINDOWS
    station.next = frame.next
    frame.more = 1 if more else 0
    frame.wide = station.wide
    station.used = station.wide
    station.pending = count
    station.named = NONE
    if more:
        station.cur = station.pos
    station.last_ok = 0
    station.end = (now + params.ta_us + frame.slots * params.slot_us + silence) & MASK30
    station.mode = modes.SEND_OPEN


def loads(station, params):
    """How many packets our opening may carry.

    Behind a collision slow radios take one: a probe is about as long, and a turn for it costs a
    turnaround more. Whoever knows that bounds are wrong may take what others are told for an
    answer, and quick radios find each other sooner with short probes.
    """
    if not station.collided:
        return params.per_turn
    return 1 if is_slow(params) and station.wide == 0 else 0


def take_place(station, params):
    """Our place, or a free one; what to say of it in an opening."""
    if station.pos == NONE:
        station.pos = first_free(station, params)
    if station.pos == NONE or station.busy < BUSY:
        clear_round(station)
        station.pos = 0
        return UNKNOWN
    return station.pos


def retry(station, params, now, tail, out):
    """Our opening collided: with `tail` wait for the others' end, else draw the wait now."""
    report(out, REPORT_COLLISION, 0, 0)
    fails = station.fails
    disprove(station, HEARD_TAIL if tail else NOT_HEARD, out)
    if station.collided:
        station.fails = fails  # of a try: no sign that nobody receives us
    leave_sequence(station, params, now, 0)
    station.collided = 1
    station.tail = tail
    if not tail:
        station.lonely = min(station.lonely + 1, 31)
        wait_again(station, params, now, 0, out)


def wait_again(station, params, now, since, out):
    """Those who collided go first: their set shrinks with every try.

    Slow radios draw one of few moments, so far apart that the later one hears the earlier: those
    who had begun together collide again half as often as if they drew any moment. `since`: longer.
    """
    bound = retry_within(params, station.wide)
    step = 1
    if is_slow(params):
        step = bound // STEPS
        bound = bound + step
    for _ in range(min(max(station.lonely - LONELY_FREE, 0), LONELY_MOST)):
        bound = bound * 2
    wait = since + params.ta_us + most_delay(params, station.wide)
    wait = wait + step * draw(station, bound // step)
    station.at = (now + wait) & MASK30
    schedule(station, now, out)


def notice_late_answer(station, params, out):
    """Nobody answered our opening in its window, but somebody does right behind it."""
    slot = minislot(params, station.wide)
    close = station.end + params.ta_us + 2 * least_delay(params, station.wide)
    close = close + (station.window + station.ack) * slot
    late = (station.rise - close) & MASK30
    if station.lonely >= 2 and late < 2 * slot:
        notice(station, params, most_delay(params, station.wide) + late // 2, BEHIND, out)


def note_noise(station, params):
    """Noise that could be a collision of openings: what began with it is lost with it."""
    if is_slow(params):
        lasts = probe_slots(params, station.wide) * params.slot_us
        station.apart = (station.rise + lasts) & MASK30
        station.joint = 1


def await_answers(station, params):
    """Our opening is out: who is heard before anybody can have switched to answer began with it.

    Where delays are long and packets short our radio listens again before that has come.
    """
    if is_slow(params):
        station.apart = first_answer(station, params)
        station.joint = 1


def first_answer(station, params):
    """Before this moment nobody whom our opening reached can be heard to answer it."""
    return (station.end + max(params.ta_us, params.dmin_us)) & MASK30


def began_with_ours(station, params, now):
    """True if what is heard from now on in our window can be no answer to our opening."""
    return station.opener and not after(now, first_answer(station, params))


def began_together(station, params, start):
    """True if an opening that began then collided, though we heard it alone."""
    if not is_slow(params):
        return False
    if after(start, (station.rise + params.slot_us) & MASK30):
        return True  # right behind another's end
    return station.joint and not after(start, station.apart)


def lose_opening(station):
    """Another had begun with the opening that we followed: both are lost."""
    station.decoded = 0
    station.mode = modes.IDLE
    station.armed = 0
    station.act = 0


def heard_noise(station, params, now, length, out):
    """A burst has ended: the rest of our own collision, or others' trouble that we leave alone."""
    if station.tail:
        station.tail = 0
        size = station.size[station.head]  # of their packet, too, for all we know
        wait_again(station, params, now, silence_behind(params, station.wide, size), out)
        return
    if length >= 2 * params.slot_us:
        station.collided = 1
    else:
        notice_late_answer(station, params, out)
    wait = join_after(params, station.wide)
    station.at = (now + wait + draw(station, retry_within(params, station.wide))) & MASK30
    schedule(station, now, out)
