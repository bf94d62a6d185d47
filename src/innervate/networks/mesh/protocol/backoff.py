"""Who is not acknowledged again and again sends less: then it is the channel, not the neighbours.

A node that tries one neighbour after the other, each several times, makes for hundreds of
transmissions a packet. Where all do so, acks collide, live neighbours are suspected, and that
keeps the channel full for ever after its cause has gone. So acks that are missing make for longer
and longer pauses, as in any medium access, and acks that come for shorter ones. Neighbours that
are silent do not count (they are dead, not drowned out), and alarms never wait.
"""

from innervate.dialect.arith import MASK30, after
from innervate.dialect.rng import draw
from innervate.networks.mesh.protocol.constants import (
    ALARMS,
    DATA,
    DETOURED,
    E2E_ACK,
    END_TO_END,
    POSITION,
)
from innervate.networks.mesh.protocol.link_quality import (
    UNIT,
    learn_ack,
    learn_misses,
    note_miss,
    relief,
)
from innervate.networks.mesh.protocol.neighbours import SILENT

STRAIN_FREE = 48  # quarters of acks that are missing: so many cost no pause
STRAIN_HEAVY = 112  # from here on messages that know their way pause, too
PER_DOUBLING = 16
STRAIN_MAX = 176
LONGEST_US = 65_536  # before it is doubled
NO_BACKOFF = -1
DROWNED_TRIES = 8  # of a hop: where fewer are made at each, the next neighbour costs little


def note_missed(node, params, now, k):
    """The neighbour in place k did not acknowledge: pause, the longer the more of them there were.

    Where each neighbour has frames under way of its own (`hop_frames`), those to who does not
    answer become fewer, and only searches pause.
    """
    note_miss(node, k)
    node.strain = min(node.strain + UNIT, STRAIN_HEAVY if params.hop_frames else STRAIN_MAX)
    if node.strain > STRAIN_FREE:
        span = min(params.ack_us, LONGEST_US) << ((node.strain - STRAIN_FREE) // PER_DOUBLING)
        node.pause = (now + draw(node, span) + 1) & MASK30


def note_answer(node, params, k):
    """The neighbour in place k has acknowledged: the channel has room."""
    node.pause = NO_BACKOFF
    back = UNIT
    if k >= 0:
        learn_misses(node, k)
        back = relief(node, params, k)
        learn_ack(node, k)
    node.strain = max(node.strain - back, 0)


def is_held(node, i):
    """1 if the frame in place i does not go out in a pause: detours, and at worst all messages."""
    kind = node.q_kind[i]
    if node.q_rank[i] == ALARMS or (kind != DATA and kind != E2E_ACK and kind != POSITION):
        return 0
    return (node.q_flags[i] & DETOURED != 0 and kind != E2E_ACK) or node.strain > STRAIN_HEAVY


def is_drowned(node, i, k):
    """1 if a full channel keeps from the neighbour in place k a message that looks for a way.

    Who was heard since the hop began lives, and so many tries in vain are the channel's. Another
    way leads through the same one, and looking for it is what fills that; the origin sends the
    message once more, or asks for its ack.
    """
    if k < 0 or node.suspect[k] & SILENT or node.strain <= STRAIN_FREE:
        return 0
    if not node.q_flags[i] & DETOURED or node.q_tries[i] < DROWNED_TRIES:
        return 0
    kind = node.q_kind[i]
    return kind == E2E_ACK or (kind == DATA and node.q_flags[i] & END_TO_END != 0)


def end_backoff(node, now):
    """Where its time is over."""
    if node.pause != NO_BACKOFF and after(now, node.pause):
        node.pause = NO_BACKOFF
