"""A node of managed flooding: what it does when something happens."""

from innervate.dialect.arith import MASK16, MASK30
from innervate.dialect.outbox import deliver, report, send, set_timer
from innervate.dialect.rng import draw
from innervate.networks.flooding.protocol.sizes import BODY, OWN, PLACES, SEEN

PACKET = 1  # kinds of frame
ACK = 2
MESSAGE = 1  # inputs: for item.dest, 255 = for all
EVERYBODY = 255

FORGET = PLACES + OWN  # timers: one for each of those, and this one
TIMERS = FORGET + 1
OUTBOX = 12
ANSWER_MORE = 2  # hops that an answer may go besides those that the question went

REPORT_ACKED = 1  # packet a is acknowledged: by its recipient (b 1), or heard again (b 0)
REPORT_GAVE_UP = 2  # packet a was not acknowledged, after b more tries
REPORT_FULL = 3  # packet b of a found no place


def on_start(node, params, now, cause, out):
    """The node is switched on, or has lost its memory: nothing is known, nothing waits."""
    node.oldest = 0
    for i in range(SEEN):
        node.seen_from[i] = -1
    for i in range(PLACES):
        node.waits[i] = 0
    for i in range(OWN):
        node.open[i] = 0
    if cause:  # others may remember ids that we had
        node.id = draw(node, MASK16)
    set_timer(out, FORGET, (now + params.forget_us) & MASK30)


def on_input(node, params, now, kind, item, out):
    """Our user has a message for somebody, or for all; a place is kept until it is acknowledged."""
    if item.dest == node.number:
        return
    node.id = (node.id + 1) & MASK16
    remember(node, node.number, node.id)
    place = first_free(node.open, OWN)
    if place < 0:
        report(out, REPORT_FULL, node.number, node.id)
        return
    node.open[place] = 1
    node.open_id[place] = node.id
    node.open_dest[place] = item.dest
    node.open_tries[place] = 0
    node.open_made[place] = item.made_at
    for i in range(BODY):
        node.open_body[place * BODY + i] = item.body[i]
    send_own(node, params, now, place, out)


def on_frame(node, params, now, port, frame, out):
    """A frame was received, of whoever it was passed on by."""
    if frame.origin == node.number:
        acknowledged(node, frame.id, 0, out)
        return
    is_new = not is_known(node, frame.origin, frame.id)
    if not is_new and frame.hops != frame.start:
        spare(node, frame)
        return
    remember(node, frame.origin, frame.id)
    if is_new and (frame.dest == node.number or frame.dest == EVERYBODY):
        take(node, frame, out)
    if frame.dest == node.number:
        if frame.kind == PACKET and frame.want:
            answer(node, params, frame, out)
    elif frame.hops > 0:
        pass_on(node, params, now, frame, out)


def on_timer(node, params, now, timer, out):
    """A packet has waited long enough: another's is passed on, an own one sent again."""
    if timer == FORGET:
        node.seen_from[node.oldest] = -1
        node.oldest = (node.oldest + 1) % SEEN
        set_timer(out, FORGET, (now + params.forget_us) & MASK30)
        return
    if timer < PLACES:
        if node.waits[timer]:
            node.waits[timer] = 0
            node.passed_on = (node.passed_on + 1) & MASK16
            fill(node, timer, out.frame[send(out, 0, 0, 0)])
        return
    place = timer - PLACES
    if not node.open[place]:
        return
    if node.open_tries[place] >= params.retries:
        node.open[place] = 0
        report(out, REPORT_GAVE_UP, node.open_id[place], node.open_tries[place])
        return
    node.open_tries[place] += 1
    send_own(node, params, now, place, out)


def take(node, frame, out):
    """A packet is for us: hand it up; an acknowledgement ends the wait for it."""
    if frame.kind == ACK:
        acknowledged(node, frame.ack, 1, out)
        return
    copy = out.frame[deliver(out, PACKET)]
    copy.kind = PACKET
    copy.origin = frame.origin
    copy.id = frame.id
    copy.dest = frame.dest
    copy.hops = frame.hops
    copy.start = frame.start
    copy.want = frame.want
    copy.ack = 0
    copy.rssi = frame.rssi
    copy.made_at = frame.made_at
    for i in range(BODY):
        copy.body[i] = frame.body[i]


def acknowledged(node, number, is_real, out):
    """An own packet need not be sent again."""
    for i in range(OWN):
        if node.open[i] and node.open_id[i] == number:
            node.open[i] = 0
            report(out, REPORT_ACKED, number, is_real)


def send_own(node, params, now, place, out):
    """Send an own packet, and wait for an acknowledgement."""
    frame = out.frame[send(out, 0, 0, 0)]
    frame.kind = PACKET
    frame.origin = node.number
    frame.id = node.open_id[place]
    frame.dest = node.open_dest[place]
    frame.hops = params.hops
    frame.start = params.hops
    frame.want = 1
    frame.ack = 0
    frame.made_at = node.open_made[place]
    for i in range(BODY):
        frame.body[i] = node.open_body[place * BODY + i]
    set_timer(out, PLACES + place, (now + params.retry_us) & MASK30)


def answer(node, params, frame, out):
    """Acknowledge a packet that is for us; it may go little further than the packet came."""
    node.id = (node.id + 1) & MASK16
    remember(node, node.number, node.id)
    went = max(frame.start - frame.hops, 0)
    copy = out.frame[send(out, 0, 0, 0)]
    copy.kind = ACK
    copy.origin = node.number
    copy.id = node.id
    copy.dest = frame.origin
    copy.hops = min(went + ANSWER_MORE, params.hops)
    copy.start = copy.hops
    copy.want = 0
    copy.ack = frame.id
    copy.made_at = 0
    for i in range(BODY):
        copy.body[i] = 0


def pass_on(node, params, now, frame, out):
    """Keep a packet for a while, then send it with one hop less; once, if it waits already."""
    if waiting(node, frame) >= 0:
        return
    place = first_free(node.waits, PLACES)
    if place < 0:
        report(out, REPORT_FULL, frame.origin, frame.id)
        return
    node.waits[place] = 1
    node.kind[place] = frame.kind
    node.origin[place] = frame.origin
    node.packet[place] = frame.id
    node.dest[place] = frame.dest
    node.hops[place] = frame.hops - 1
    node.start[place] = frame.start
    node.want[place] = frame.want
    node.ack[place] = frame.ack if frame.kind == ACK else 0
    node.made[place] = frame.made_at
    for i in range(BODY):
        node.body[place * BODY + i] = frame.body[i] if frame.kind == PACKET else 0
    wait = 2 * params.cw_max + draw(node, 1 << window(params, frame.rssi))
    set_timer(out, place, (now + wait * params.slot_us) & MASK30)


def window(params, rssi):
    """How many bits the contention window has: few for a faint signal, many for a loud one."""
    span = max(params.loud_dbm - params.faint_dbm, 1)
    over = min(max(rssi - params.faint_dbm, 0), span)
    return params.cw_min + over * (params.cw_max - params.cw_min) // span


def fill(node, place, frame):
    """Make a frame of the packet that waits in a place."""
    frame.kind = node.kind[place]
    frame.origin = node.origin[place]
    frame.id = node.packet[place]
    frame.dest = node.dest[place]
    frame.hops = node.hops[place]
    frame.start = node.start[place]
    frame.want = node.want[place]
    frame.ack = node.ack[place]
    frame.made_at = node.made[place]
    for i in range(BODY):
        frame.body[i] = node.body[place * BODY + i]


def spare(node, frame):
    """Another has passed a packet on: we need not."""
    place = waiting(node, frame)
    if place >= 0:
        node.waits[place] = 0
        node.spared = (node.spared + 1) & MASK16


def waiting(node, frame):
    """The place in which a packet waits to be passed on; -1 if it does not."""
    for i in range(PLACES):
        if node.waits[i] and node.origin[i] == frame.origin and node.packet[i] == frame.id:
            return i
    return -1


def first_free(flags, count):
    """The first place whose flag is 0; -1 if there is none."""
    for i in range(count):
        if not flags[i]:
            return i
    return -1


def is_known(node, origin, number):
    """True if we have met a packet lately."""
    for i in range(SEEN):
        if node.seen_from[i] == origin and node.seen_id[i] == number:
            return True
    return False


def remember(node, origin, number):
    """Put a packet into the oldest place, if it is new."""
    if is_known(node, origin, number):
        return
    node.seen_from[node.oldest] = origin
    node.seen_id[node.oldest] = number
    node.oldest = (node.oldest + 1) % SEEN
