"""Discovery at a node: requests are heard and passed on, who was heard is reported [mesh 4]."""

from innervate.dialect.arith import MASK30, later
from innervate.dialect.outbox import report, set_timer
from innervate.dialect.rng import draw
from innervate.networks.mesh.protocol.alarm import redirect
from innervate.networks.mesh.protocol.constants import (
    ALL,
    CONTROL,
    CRC_BYTES,
    EACH,
    HEADER_BYTES,
    JOBS,
    PATH_MAX,
    PRIORITY,
    REPORT_GATEWAY,
    REQUEST,
    RESPONSE,
    ROUND,
    TABLE_FREE,
    TREE,
)
from innervate.networks.mesh.protocol.duplicates import forgive
from innervate.networks.mesh.protocol.frames import add8, add16, add_hop, get16, is_named, store
from innervate.networks.mesh.protocol.hop import NOBODY_GAVE
from innervate.networks.mesh.protocol.neighbours import FREE, UNHEARD, place_of
from innervate.networks.mesh.protocol.queue import WAITS, compose, drop, enqueue, kick
from innervate.networks.mesh.protocol.send import send_up
from innervate.networks.mesh.protocol.table import activate, keep_table
from innervate.networks.mesh.protocol.upward import is_nearer, is_weak

NOTHING = 0
LOOK_AGAIN = 1
RESPOND = 2
COUNTED_MAX = 15  # listed neighbours, in four bits; more go to the packet's end
REQUEST_BYTES = 7  # and behind them who is asked by name
SLACK = 2  # ticks: nodes count them from different moments
JITTER_UNIT_US = 10_000
UPLINKS_TOLD = 3  # table-free: a node tells the gateway no more than that


def newer_epoch(a, b):
    """1 if epoch a is newer than b (8 bits, RFC 1982)."""
    ahead = (a - b) & 255
    return ahead != 0 and ahead < 128


def is_newer(node, params, gateway, epoch, round):
    """1 if a round comes after the one we know: higher epoch, then lower id, then round.

    Who has heard nothing for about as long as a gateway waits that switches on again takes any: it
    has forgotten which epochs and rounds there were. Nothing old is in the air by then, but for
    the round that we know, where somebody asked for it.
    """
    if not node.known:
        return 1
    if epoch == node.epoch and round == node.round and gateway == node.gateway:
        return 0
    if node.quiet > 0 and node.quiet + SLACK >= params.dead:
        return 1
    if epoch != node.epoch and (epoch - node.epoch) & 255 != 128:
        return newer_epoch(epoch, node.epoch)
    if gateway != node.gateway:
        return gateway < node.gateway
    return later(round, node.round)


def begin(node, params, gateway, epoch, round, out):
    """A round that is new to us."""
    if not node.known or node.gateway != gateway or node.epoch != epoch:
        report(out, REPORT_GATEWAY, gateway, epoch)
    node.known = 1
    if node.gateway != gateway:
        node.gone = node.gateway
    elif node.version != node.active:  # tables have come since it was gone
        node.gone = ALL
    node.gateway = gateway
    node.epoch = epoch
    node.round = round
    node.depth = UNHEARD
    node.parent = ALL
    node.quiet = node.silent = 0
    node.due = NOTHING
    if gateway != node.number:
        node.leading = 0
    begin_anew(node, params)


def begin_anew(node, params):
    """Nobody was heard in a round yet; whoever gave packets back is asked again."""
    for k in range(params.places):
        node.round_depth[k] = UNHEARD
    forgive(node)


def on_request(node, params, now, frame, k, out):
    """A discovery request was heard from the neighbour in place k (-1: no room to note it)."""
    gateway = frame.body[0]
    epoch = frame.body[1]
    round = get16(frame, 2)
    if is_newer(node, params, gateway, epoch, round):
        old = node.gateway
        before = node.epoch
        begin(node, params, gateway, epoch, round, out)
        settles = 0
        if old != gateway or not frame.table_ver:  # until it has tables it proves nothing
            settles = params.collect_us
        if old != gateway and old != ALL:
            if node.rank > 1:
                node.rank = node.rank - 1
            redirect(node, params, now, old, out)
        node.active = get16(frame, 4)
        if frame.flags & PRIORITY:
            keep_table(node, params, before, out)
        activate(node, params, epoch, node.active, out)  # should the flood have passed us by
        arm_guard(node, params, now + settles, out)
    elif gateway != node.gateway or epoch != node.epoch or round != node.round:
        return
    fresh = k < 0 or node.round_depth[k] == UNHEARD
    note_request(node, frame, k)
    if node.leading:
        return
    anew = node.depth == UNHEARD
    if anew and frame.rssi < params.faint:
        await_better(node, params, now, frame, out)
    elif anew or is_shorter(node, params, frame):
        node.parent = frame.link_src
        queue_request(node, params, now, frame, 0, out)
        node.depth = frame.path_len + 1
        if anew:
            join(node, params, now, node.depth, is_spared(node, frame), out)
    if params.discovery == EACH and fresh:  # not to every copy
        respond_to(node, params, now, frame.link_src, out)


def is_shorter(node, params, frame):
    """1 if this request makes us nearer to the gateway: without tables all goes up there.

    Where one that had a longer way overtook it, all behind us would go that way for a period.
    """
    if params.mode != TABLE_FREE or frame.rssi < params.faint:
        return 0
    return frame.path_len + 1 < node.depth


def ask_round(node, params, now, out):
    """We know of no round: a request of no gateway asks all in reach for theirs."""
    compose_request(node, params, now, CONTROL, 0, out)


def tell_round(node, params, now, out):
    """A neighbour asks for the round that we know: our request once more, unless one waits.

    Who is nearer to the gateway answers sooner: the first request that is heard decides how far
    its hearer is.
    """
    if node.depth != UNHEARD and queued_request(node) < 0:
        i = compose_request(node, params, now, CONTROL, 0, out)
        if i >= 0:
            for _ in range(node.depth - 1):
                add_hop(node, i)
            quarter = params.jitter_us >> 2
            node.q_due[i] = (now + quarter * node.depth + draw(node, quarter + 1)) & MASK30


def compose_request(node, params, now, rank, flags, out):
    """A request of the round that we know, as its gateway sends it; -1 if there is no place."""
    i = compose(node, now, rank, REQUEST, ALL, flags, out)
    if i >= 0:
        add_hop(node, i)
        add8(node, i, node.gateway)
        add8(node, i, node.epoch)
        add16(node, i, node.round)
        add16(node, i, node.active)
        add8(node, i, params.jitter_us // JITTER_UNIT_US)
    return i


def is_spared(node, frame):
    """1 if we need not respond: we keep our table in a takeover, or others are asked by name."""
    if frame.length == REQUEST_BYTES:
        return frame.flags & PRIORITY and node.version
    return not is_named(frame, REQUEST_BYTES, node.number)


def arm_guard(node, params, now, out):
    """A standby looks again whether the gateway lives, the later the more there are before it."""
    if node.rank >= 0 and params.guard_us:
        waits = max(node.rank, 1)
        if node.silent == 0:  # who is answered late asks less often
            waits = waits + (node.tolerance >> 5)
        set_timer(out, JOBS, (now + params.guard_us * waits) & MASK30)


def note_request(node, frame, k):
    """Who was heard in this round, how loud, and at which depth."""
    if k >= 0:
        node.round_rssi[k] = frame.rssi
        node.round_depth[k] = frame.path_len


def queued_request(node):
    """Where the request that we are to pass on waits in the queue, or -1."""
    for i in range(node.places):
        if node.q_state[i] == WAITS and node.q_kind[i] == REQUEST:
            return i
    return -1


def queue_request(node, params, now, frame, wait, out):
    """Pass the request on after `wait` us and some more; it takes the place of one that waits."""
    i = queued_request(node)
    if i < 0:
        i = enqueue(node, now, CONTROL, NOBODY_GAVE, out)
    if i >= 0:
        store(node, i, frame)
        node.q_link_dst[i] = ALL
        node.q_copies[i] = params.copies
        node.q_due[i] = (now + wait + draw(node, params.jitter_us + 1)) & MASK30
        if not add_hop(node, i):
            drop(node, params, i)


def await_better(node, params, now, frame, out):
    """A weak, perhaps one-way, link must not win: wait whether a better request comes."""
    best = place_of(node, params, node.parent)
    if node.due != LOOK_AGAIN:
        node.due = LOOK_AGAIN
        set_timer(out, ROUND, (now + 2 * params.jitter_us) & MASK30)
    elif best >= 0 and node.round_rssi[best] >= frame.rssi:
        return
    node.parent = frame.link_src
    queue_request(node, params, now, frame, 2 * params.jitter_us, out)


def join(node, params, now, depth, kept, out):
    """We know our depth in this round: respond later, unless we are spared."""
    node.depth = depth
    if params.discovery != EACH and not kept:
        node.due = RESPOND
        wait = params.listen_us + draw(node, params.spread_us + 1)
        set_timer(out, ROUND, (now + wait) & MASK30)


def look_again(node, params, now, out):
    """Nothing but weak requests came: the best of them has to do."""
    best = place_of(node, params, node.parent)
    if best >= 0 and node.round_depth[best] != UNHEARD:
        join(node, params, now, node.round_depth[best] + 1, 0, out)


def step(node, params, now, out):
    """The ROUND timer of a node that is not the gateway."""
    due = node.due
    node.due = NOTHING
    if due == LOOK_AGAIN and node.depth == UNHEARD:
        look_again(node, params, now, out)
    elif due == RESPOND:
        respond(node, params, now, out)
    kick(node, params, now, out)


def is_listed(node, params, k):
    """1 if the neighbour in place k goes into our response."""
    if node.neighbour[k] == FREE or node.round_depth[k] == UNHEARD:
        return 0
    if params.mode == TABLE_FREE and not is_nearer(node, k, node.depth):
        return 0
    return not is_weak(node, params, k)


def count_listed(node, params):
    """How many neighbours go into our responses."""
    count = 0
    for k in range(params.places):
        count = count + is_listed(node, params, k)
    if params.mode == TABLE_FREE:
        count = min(count, UPLINKS_TOLD)
    return count


def open_response(node, params, now, count, out):
    """A response with room for `count` neighbours to be filled in; -1 if there is no place."""
    i = compose(node, now, CONTROL, RESPONSE, node.gateway, 0, out)
    if i >= 0:
        add8(node, i, node.epoch)
        add16(node, i, node.round)
        add8(node, i, params.discovery << 4 | min(count, COUNTED_MAX))
    return i


def respond(node, params, now, out):
    """Report to the gateway who was heard in this round; several packets if they are many."""
    if params.discovery == TREE:
        i = open_response(node, params, now, 0, out)
        if i >= 0:
            send_up(node, params, now, i, out)
        return
    left = count_listed(node, params)
    most = (params.mtu - HEADER_BYTES - CRC_BYTES - PATH_MAX - 4) >> 1
    if left == 0:
        respond_faintly(node, params, now, out)
    at = 0
    for _ in range((left + most - 1) // most):
        here = min(left, most)
        left = left - here
        i = open_response(node, params, now, here, out)
        for k in range(at, params.places):
            if here > 0 and is_listed(node, params, k):
                here = here - 1
                at = k + 1
                if i >= 0:
                    add8(node, i, node.neighbour[k])
                    add8(node, i, node.round_rssi[k])
        if i >= 0:
            send_up(node, params, now, i, out)


def respond_faintly(node, params, now, out):
    """Nobody was heard well: report the best."""
    best = place_of(node, params, node.parent)
    if best < 0:
        return
    i = open_response(node, params, now, 1, out)
    if i >= 0:
        add8(node, i, node.neighbour[best])
        add8(node, i, node.round_rssi[best])
        send_up(node, params, now, i, out)


def respond_to(node, params, now, who, out):
    """Reading "each": a response to every request that is heard, by way of its transmitter."""
    i = open_response(node, params, now, 0, out)
    if i >= 0:
        node.q_due[i] = (now + draw(node, params.spread_us + 1)) & MASK30
        if add_hop(node, i):
            node.q_link_dst[i] = who
            node.q_flags[i] = node.q_flags[i] | 1
            node.q_ttl[i] = node.q_ttl[i] - 1
