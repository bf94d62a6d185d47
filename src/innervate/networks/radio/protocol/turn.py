"""Practical CSMA/CD-R, turns: a round of stations that send one after another without a gap.

Every data frame names whose turn follows, and says whether the frame before it was received:
that is the proof which the sender of that frame waits for.
"""

from innervate.dialect.arith import MASK30
from innervate.dialect.outbox import report
from innervate.dialect.rng import draw
from innervate.networks.radio.protocol.constants import ALONE, DATA, NO_PROOF, NONE, REPORT_TURN
from innervate.networks.radio.protocol.idle import rest, schedule
from innervate.networks.radio.protocol.modes import SEND_DATA, TURN, arm, disprove, following
from innervate.networks.radio.protocol.station import blank, load_packets

FAILS_MOST = 3  # packets without proof, then we leave the round


def enter_turn(station, params, now, cur, out):
    """It is the turn of place `cur`: ours, somebody's, or (NONE) the round is over."""
    if cur == NONE:
        finish(station, params, now, out)
        return
    station.cur = cur
    station.act = 0
    if cur == station.pos:
        if station.pending:
            disprove(station, NO_PROOF, out)
        if station.queued == 0 or station.fails >= FAILS_MOST:
            quit_round(station, params, now, out)
        else:
            send_turn(station, params, now, out)
        return
    station.mode = TURN
    if station.cd:
        station.armed = 0
    else:
        arm(station, now, params.dead_us, out)


def finish(station, params, now, out):
    """The round is over for all who followed it; those who did not wait longer to open."""
    if station.pending:
        disprove(station, NO_PROOF, out)
    rest(station, now, params.dead_us + draw(station, params.retry_us))
    schedule(station, now, out)


def quit_round(station, params, now, out):
    """Give up our place: nothing to send, or nobody seems to receive us."""
    station.live[station.pos] = 0
    station.pos = NONE
    station.fails = 0
    rest(station, now, params.join_us + draw(station, params.retry_us))
    schedule(station, now, out)


def send_turn(station, params, now, out):
    """Send our packets; the last of a round opens a window for newcomers now and then."""
    report(out, REPORT_TURN, station.pos, 0)
    frame = blank(out)
    count = load_packets(station, frame, params.per_turn)
    frame.kind = DATA
    more = station.queued > count
    frame.pos = station.pos
    frame.more = 1 if more else 0
    frame.ok = station.last_ok
    behind = following(station, station.pos)
    alone = behind == station.pos or behind == NONE
    wraps = behind <= station.pos
    station.end = (now + params.ta_us + frame.slots * params.slot_us) & MASK30
    limit = params.ta_us + 2 * params.dmax_us
    if alone:
        frame.next = ALONE
        station.named = NONE
    elif wraps and (not more or station.turns + 1 >= params.turns):
        frame.next = station.pos
        station.named = behind
        limit = limit + params.ta_us + 3 * params.dmax_us + params.minislot_us
    else:
        frame.next = behind
        station.named = behind
    station.next = frame.next
    station.until = (station.end + limit) & MASK30
    station.pending = count
    station.last_ok = 0
    station.armed = 0
    station.mode = SEND_DATA
    if not more:
        station.live[station.pos] = 0
    station.cur = behind
    if alone and not more:
        station.cur = NONE
