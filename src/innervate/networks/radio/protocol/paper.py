"""CSMA/CD-R as published: the order of turns after a collision comes from the order of its ends.

Steps 1 to 8 and the rules T1 to N2 are those of [radio 4]: the paper's words, and what had to be
added where it is silent. Step 1 stands in paper_idle.py, 2 to 5 in paper_verify.py,
5 and 6 in paper_reserve.py, 7 in paper_turns.py.
"""

from innervate.dialect.access import FORCE, LEAVE, PACKET
from innervate.networks.radio.protocol.constants import CRR, DATA, MAIN, NOBODY, NONE
from innervate.networks.radio.protocol.paper_idle import (
    AWAIT,
    GARBLED,
    IDLE,
    JOIN,
    QUIET,
    RESERVE,
    SEND_DATA,
    TAIL,
    TURNS,
    arm,
    forced,
    joined,
    offered,
    packet_us,
    take_turn,
    turn_timeout,
    wait,
    waited,
)
from innervate.networks.radio.protocol.paper_reserve import (
    NOISE,
    PACKET_ENDS,
    REPORTS,
    burst_begins,
    burst_ends,
    follow,
    frame_ends,
    reserve_burst,
    send_own,
    sent_crr,
    try_crr,
    window_over,
)
from innervate.networks.radio.protocol.paper_turns import (
    after_garbled,
    garbled,
    go_on,
    nested,
    turn_begins,
    turn_over,
)
from innervate.networks.radio.protocol.paper_verify import (
    await_burst,
    guard_over,
    note_single,
    quiet_burst,
    substitute,
    tail_ends,
    verify,
)
from innervate.networks.radio.protocol.station import carrier_edge, enqueue, hand_up, leave, reset


def on_start(station, params, now, cause, out):
    """Switch on: together with the whole network, or later (Q10: then listen first)."""
    reset(station)
    station.role = NOBODY
    station.left = NONE
    station.total = station.again = station.act = station.armed = 0
    station.free = 1
    station.mode = IDLE
    if cause:
        station.free = 0
        station.mode = JOIN
        arm(station, now + packet_us(params) + turn_timeout(params), out)


def on_input(station, params, now, kind, item, out):
    """PACKET: one more to send. LEAVE: send what is there, then no more."""
    if kind == PACKET:
        if enqueue(station, item, out):
            offered(station, params, now, out)
    elif kind == FORCE:
        if enqueue(station, item, out):
            forced(station, params, now, out)
    elif kind == LEAVE:
        leave(station, out)


def on_frame(station, params, now, port, frame, out):
    """[P 2.3] "a necessary data is extracted and forwarded to the robot", or Receive_CR-R = 1.

    What it means for us is decided when its carrier has ended, a moment later.
    """
    frame_ends(station, params, now, frame.slots * params.slot_us)
    if frame.kind == CRR:
        station.crrs = station.crrs + 1
        station.clear = 1
    elif frame.kind == DATA:
        station.data = 1
        hand_up(frame, out)


def on_carrier(station, params, now, cd, voc, out):
    """The carrier came, went or is another's, or our radio listens again after sending."""
    mode = station.mode
    if mode >= SEND_DATA:
        station.cd = cd
        if cd:
            burst_begins(station, now, 1)
        if mode == SEND_DATA:
            verify(station, params, now, cd, voc, out)
        else:
            sent_crr(station, out)
        return
    edge = carrier_edge(station, cd)
    if edge > 0:
        burst_begins(station, now, 0)
        carrier_came(station)
    elif edge < 0:
        carrier_went(station, params, now, out)
    elif mode == TAIL:
        note_single(station, params, now, voc)


def carrier_came(station):
    """Somebody sends: what silence would have meant does not hold."""
    mode = station.mode
    if mode == TURNS:
        turn_begins(station)
    elif mode != RESERVE:
        station.armed = 0
        station.free = 0


def carrier_went(station, params, now, out):
    """A burst of carrier is over."""
    mode = station.mode
    if mode == TAIL:
        tail_ends(station, params, now, out)
        return
    what = burst_ends(station, params, now, mode == RESERVE and not station.closing)
    if mode == IDLE or mode == JOIN:
        if what == REPORTS:
            follow(station, params, now, out)
        elif mode == IDLE:
            wait(station, params, now, out)
        else:
            arm(station, now + packet_us(params) + turn_timeout(params), out)
    elif mode == QUIET:
        quiet_burst(station, params, now, what, out)
    elif mode == AWAIT:
        await_burst(station, params, now, what, out)
    elif mode == RESERVE:
        reserve_burst(station, params, now, what, out)
    else:
        turns_burst(station, params, now, what, out)


def turns_burst(station, params, now, what, out):
    """A burst during the turns."""
    if what == REPORTS:
        nested(station, params, now, out)
        return
    if station.mode == GARBLED:
        after_garbled(station, params)
    if what == PACKET_ENDS:
        turn_over(station, params, now, out)
    elif what == NOISE:
        garbled(station, params, now, out)
    else:
        go_on(station, params, now, now, out)


def on_timer(station, params, now, timer, out):
    """MAIN: a wait or deadline of the present mode. ACT: our CR-R, or our delayed turn."""
    mode = station.mode
    if timer == MAIN:
        if not station.armed:
            return
        station.armed = 0
        if mode == IDLE:
            waited(station, params, now, out)
        elif mode == JOIN:
            joined(station, params, now, out)
        elif mode == QUIET:
            guard_over(station, params, now, out)
        elif mode == AWAIT:
            substitute(station, params, now, out)
        elif mode == RESERVE:
            window_over(station, params, now, out)
        elif mode == TURNS or mode == GARBLED:
            turn_over(station, params, now, out)
    elif station.act:
        if mode == RESERVE:
            if try_crr(station):
                send_own(station, out)
        elif mode == TURNS:
            station.act = 0
            take_turn(station, params, now, out)
