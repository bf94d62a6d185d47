"""The neighbour table: who was heard, how loud, and who does not answer."""

from innervate.dialect.arith import MASK16, MASK30
from innervate.dialect.outbox import report
from innervate.networks.mesh.protocol.constants import NOBODY, REPORT_SUSPECT
from innervate.networks.mesh.protocol.link_quality import ALL_ACKED

FREE = 255
UNHEARD = 255
LIVELY_TICKS = 2
TICKS_MAX = 32_767
RSSI_SPAN = 1024  # of quarters of a dBm: a tick counts for more than any of them
HOP_FIRST = 4  # frames under way to a neighbour of which nothing is known

# In `suspect`.
SUSPECT = 1  # avoided for a while
DOUBT = 2  # not heard since: one transmission is enough to ask
SILENT = 4  # not heard since the newest hop to it began


def clear_neighbours(node, params):
    """Empty the neighbour table, as after switching on."""
    for k in range(params.places):
        node.neighbour[k] = FREE
        forget_link(node, k)


def forget_link(node, k):
    """Nothing is known of how often the neighbour in place k answers, and how soon."""
    node.suspect[k] = 0
    node.round_depth[k] = UNHEARD
    node.ack_ratio[k] = ALL_ACKED
    node.misses[k] = 0
    node.hop_trip[k] = 0
    node.hop_spread[k] = 0
    node.hop_doubled[k] = 0
    node.hop_under[k] = 0
    node.hop_most[k] = HOP_FIRST
    node.hop_cut[k] = -1
    node.hop_failed[k] = -1


def place_of(node, params, who):
    """Where a neighbour is in the table, or -1."""
    for k in range(params.places):
        if node.neighbour[k] == who:
            return k
    return -1


def hear(node, params, who, rssi):
    """A frame of `who` was received: it is there, and whatever was suspected, it lives.

    Of more neighbours than there are places the loudest are kept.
    """
    k = place_of(node, params, who)
    if k >= 0:
        node.rssi[k] = node.rssi[k] + ((4 * rssi - node.rssi[k]) >> 2)
    else:
        k = 0
        for j in range(params.places):
            if node.neighbour[j] == FREE:
                k = j
                break
            if node.rssi[j] < node.rssi[k]:
                k = j
        if node.neighbour[k] != FREE and node.rssi[k] >= 4 * rssi:
            return -1
        node.neighbour[k] = who
        node.rssi[k] = 4 * rssi
        forget_link(node, k)
    node.heard[k] = node.ticks
    node.suspect[k] = 0
    return k


def hear_again(node, params, who):
    """An ack for somebody else, whose rssi is not ours: `who` lives, no more than that."""
    k = place_of(node, params, who)
    if k >= 0:
        node.heard[k] = node.ticks
        node.suspect[k] = 0


def is_lively(node, k):
    """1 if the neighbour in place k was heard within the last two ticks."""
    return ((node.ticks - node.heard[k]) & 65_535) <= LIVELY_TICKS


def suspect(node, params, now, who, planned, out):
    """`who` did not acknowledge: avoid it for a while, or until it is heard."""
    k = place_of(node, params, who)
    if k >= 0:
        node.suspect[k] = node.suspect[k] | SUSPECT | DOUBT
        node.until[k] = (node.ticks + ticks_until(node, params, now)) & MASK16
        report(out, REPORT_SUSPECT, who, planned)


def ask(node, params, who):
    """A hop to `who` begins: is it heard before we know what became of it?"""
    k = place_of(node, params, who)
    if k >= 0:
        node.suspect[k] = node.suspect[k] | SILENT


def ticks_until(node, params, now):
    """The first tick that is suspect_us away or more is so many from the newest."""
    late = (now - node.tick_at) & MASK30
    return min((late + params.suspect_us - 1) // params.tick_us + 1, TICKS_MAX)


def is_over(node, k):
    """1 if the suspicion of the neighbour in place k has lasted its time."""
    return (node.ticks - node.until[k]) & MASK16 <= TICKS_MAX


def is_suspect(node, params, who):
    """1 if `who` is a neighbour that did not answer."""
    k = place_of(node, params, who)
    return who == node.gone or (k >= 0 and node.suspect[k] & SUSPECT)


def is_silent(node, params, who):
    """1 if the neighbour `who` was not heard since the newest hop to it began."""
    k = place_of(node, params, who)
    return k >= 0 and node.suspect[k] & SILENT != 0


def trust(node, params):
    """End all suspicions; who was not heard since stays in DOUBT."""
    for k in range(params.places):
        node.suspect[k] = node.suspect[k] & ~SUSPECT


def sweep(node, params):
    """Every tick: suspicions end; neighbours that were silent for too long are forgotten."""
    most = 3 * params.period_max + 2
    for k in range(params.places):
        if node.neighbour[k] != FREE:
            if node.suspect[k] & SUSPECT and is_over(node, k):
                node.suspect[k] = DOUBT
            if ((node.ticks - node.heard[k]) & 65535) > most:
                node.neighbour[k] = FREE


def is_strong(node, params, k):
    """1 if the neighbour in place k is loud enough to be relied on."""
    return k >= 0 and node.rssi[k] >= 4 * params.min_rssi


def random_neighbour(node, params, not_this, nor_this, pick):
    """The pick-th neighbour that is neither of two; NOBODY beyond the last."""
    for k in range(params.places):
        who = node.neighbour[k]
        if who != FREE and who != not_this and who != nor_this:
            if pick == 0:
                return who
            pick = pick - 1
    return NOBODY


def count_neighbours(node, params, not_this, nor_this):
    """How many neighbours are neither of two."""
    count = 0
    for k in range(params.places):
        who = node.neighbour[k]
        if who != FREE and who != not_this and who != nor_this:
            count = count + 1
    return count


def standing(node, params, k):
    """By how much the neighbour in place k comes first: it is loud; `recent`: heard, then loud."""
    if params.recent:
        return node.rssi[k] - RSSI_SPAN * ((node.ticks - node.heard[k]) & MASK16)
    return node.rssi[k]


def loudest(node, params, not_this, nor_this):
    """The neighbour that comes first by `standing` and is neither of two, or NOBODY."""
    best = -1
    for k in range(params.places):
        who = node.neighbour[k]
        if who != FREE and who != not_this and who != nor_this:
            if best < 0 or standing(node, params, k) > standing(node, params, best):
                best = k
    if best < 0:
        return NOBODY
    return node.neighbour[best]
