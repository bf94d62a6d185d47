"""Neighbours, the preferred parent, our rank: RFC 6550, 8.2, with MRHOF (RFC 6719) on ETX."""

from innervate.dialect.outbox import report
from innervate.networks.rpl.protocol import sizes
from innervate.networks.rpl.protocol.constants import (
    ETX_MOST,
    ETX_ONE,
    INFINITE,
    NOBODY,
    NONE,
    REPORT_DETACHED,
    REPORT_PARENT,
    REPORT_VERSION,
)
from innervate.networks.rpl.protocol.counters import dag_rank, following, is_newer
from innervate.networks.rpl.protocol.downward import announce, announce_all, forget_all, leave
from innervate.networks.rpl.protocol.trickle import begin_interval, note_consistent, reset_trickle

COST_MAX = 32768  # MAX_PATH_COST
NO_WAY = 1 << 20
GIVEN_UP = 2  # frames in a row without an acknowledgement: the neighbour is not reachable
KEPT = 3
OF = 4  # of an estimate that a new sample leaves


def place_of(node, who):
    """The place of a neighbour; -1 if it has none."""
    for k in range(sizes.NEIGHBOURS):
        if node.nbr[k] == who:
            return k
    return NONE


def meet(node, params, who, rssi):
    """The place of a neighbour, which may be new; -1 if there is none for it."""
    k = place_of(node, who)
    if k >= 0:
        return k
    for i in range(sizes.NEIGHBOURS):
        if node.nbr[i] < 0:
            k = i
    if k < 0:
        k = farthest(node)
    if k >= 0:
        node.nbr[k] = who
        node.nbr_rank[k] = INFINITE
        node.nbr_version[k] = node.version
        node.nbr_dtsn[k] = 0
        node.nbr_etx[k] = guess(rssi - params.half_dbm)
        node.nbr_fails[k] = 0
        node.nbr_dsn[k] = NONE
    return k


def farthest(node):
    """The neighbour that is missed least: of highest rank, not the parent, not being sent to."""
    k = NONE
    for i in range(sizes.NEIGHBOURS):
        if i != node.parent and node.nbr[i] != node.to:
            if k < 0 or node.nbr_rank[i] > node.nbr_rank[k]:
                k = i
    return k


def guess(over_db):
    """What ETX a link may have, from how loud it came in, until acknowledgements say."""
    if over_db >= 4:
        return ETX_ONE
    if over_db == 3:
        return 141
    if over_db == 2:
        return 165
    return 239 if over_db == 1 else 512


def learn_etx(node, k, transmissions):
    """A frame has taken so many transmissions."""
    sample = transmissions * ETX_ONE
    node.nbr_etx[k] = min((KEPT * node.nbr_etx[k] + (OF - KEPT) * sample) // OF, ETX_MOST)


def note_failure(node, params, k):
    """A frame was not acknowledged: the link looks worse; twice, and nobody is there."""
    learn_etx(node, k, 2 * params.transmissions)
    node.nbr_fails[k] = min(node.nbr_fails[k] + 1, 255)
    if node.nbr_fails[k] >= GIVEN_UP:
        node.nbr_rank[k] = INFINITE


def cost_of(node, params, k):
    """The cost of the path through a neighbour [RFC 6719, 3.1]; NO_WAY if it may be no parent.

    Only the parent that we have may have a rank that is not below ours: others may be below us.
    """
    rank = node.nbr_rank[k]
    if node.nbr[k] < 0 or rank == INFINITE or node.nbr_version[k] != node.version:
        return NO_WAY
    if node.nbr_etx[k] > params.link_max or rank + node.nbr_etx[k] > COST_MAX:
        return NO_WAY
    if k != node.parent and rank >= min(node.rank, node.floor):
        return NO_WAY
    return rank + node.nbr_etx[k]


def rank_through(node, params, k):
    """Our rank with this parent: the two first cases of RFC 6719, 3.3."""
    rank = node.nbr_rank[k]
    through = rank + max(node.nbr_etx[k], params.step)
    return max(through, params.step * (1 + dag_rank(rank, params.step)))


def is_too_high(node, params, rank):
    """True if a rank must not be advertised any more in this version [RFC 6550, 8.2.2.4]."""
    if node.lowest == INFINITE or params.increase == 0:
        return False
    return rank > node.lowest + params.increase


def choose(node, params, now, out):
    """Parent selection [RFC 6719, 3.2.2]."""
    if node.number == params.root:
        return
    best = NONE
    least = NO_WAY
    for k in range(sizes.NEIGHBOURS):
        cost = cost_of(node, params, k)
        if cost < least:
            best = k
            least = cost
    cheapest = best
    if best >= 0 and node.parent >= 0:
        if cost_of(node, params, node.parent) < min(least + params.switch, NO_WAY):
            best = node.parent
    if best >= 0 and is_too_high(node, params, rank_through(node, params, best)):
        best = cheapest
    if best < 0 or is_too_high(node, params, rank_through(node, params, best)):
        detach(node, params, now, out)
        return
    follow(node, params, now, best, out)


def follow(node, params, now, k, out):
    """Neighbour k is our preferred parent; our rank is what follows from it."""
    before = node.rank
    node.rank = rank_through(node, params, k)
    if k != node.parent:
        if node.parent >= 0 and node.nbr_fails[node.parent] < GIVEN_UP:
            leave(node, params, now, node.nbr[node.parent], out)
        elif node.old == node.nbr[k]:
            node.old = NOBODY
        node.parent = k
        node.lonely = 0
        node.hold = 0
        node.floor = INFINITE
        report(out, REPORT_PARENT, node.nbr[k], node.rank)
        if params.storing:
            announce_all(node, params, now, out)
        else:
            announce(node, params, now, out)
    if dag_rank(before, params.step) != dag_rank(node.rank, params.step):
        reset_trickle(node, params, now, out)


def detach(node, params, now, out):
    """No parent is left: poison our routes [RFC 6550, 8.2.2.5], and wait before looking down."""
    if node.rank == INFINITE:
        return
    report(out, REPORT_DETACHED, node.rank, 0)
    for k in range(sizes.NEIGHBOURS):
        if node.nbr_rank[k] >= node.rank:
            node.nbr_rank[k] = INFINITE
    if node.nbr_fails[node.parent] < GIVEN_UP:
        leave(node, params, now, node.nbr[node.parent], out)
    node.floor = node.rank
    node.hold = params.hold
    node.lonely = 0
    node.rank = INFINITE
    node.parent = NONE
    node.dio_due = 1
    reset_trickle(node, params, now, out)


def migrate(node, params, now, version, out):
    """Become a member of another version of the DODAG, with no parent yet [8.2.2.4]."""
    first = not node.known
    node.known = 1
    node.version = version
    node.rank = INFINITE
    node.lowest = INFINITE
    node.floor = INFINITE
    node.parent = NONE
    node.hold = 0
    forget_all(node)
    report(out, REPORT_VERSION, version, 0)
    if first:
        begin_interval(node, params, now, out)
    else:
        reset_trickle(node, params, now, out)


def new_version(node, params, now, version, out):
    """The root: a new version of the DODAG, which is global repair."""
    node.version = version
    report(out, REPORT_VERSION, version, 0)
    reset_trickle(node, params, now, out)


def hear_dio(node, params, now, k, frame, out):
    """A neighbour says where it stands [RFC 6550, 8.2.3]."""
    if node.number == params.root:
        hear_at_root(node, params, now, frame, out)
        return
    if not node.known or is_newer(frame.version, node.version):
        migrate(node, params, now, frame.version, out)
    node.nbr_rank[k] = frame.rank
    node.nbr_version[k] = frame.version
    if node.nbr_fails[k] >= GIVEN_UP or node.nbr_etx[k] > params.link_max:
        node.nbr_etx[k] = guess(frame.rssi - params.half_dbm)  # it is there: estimated anew
    node.nbr_fails[k] = 0
    asked = k == node.parent and is_newer(frame.dtsn, node.nbr_dtsn[k])
    node.nbr_dtsn[k] = frame.dtsn
    if frame.version != node.version:
        reset_trickle(node, params, now, out)  # it does not know of ours
        if k == node.parent:  # any more: the root has lost its memory twice
            choose(node, params, now, out)
        return
    rank = node.rank
    parent = node.parent
    choose(node, params, now, out)
    if rank == node.rank and parent == node.parent:
        if dag_rank(frame.rank, params.step) < dag_rank(node.rank, params.step):
            note_consistent(node)
    if asked:
        if not params.storing:
            node.dtsn = following(node.dtsn)
            announce(node, params, now, out)
        else:
            announce_all(node, params, now, out)


def hear_at_root(node, params, now, frame, out):
    """Who knows a version that we do not know of has known us before: go beyond it."""
    other = frame.version != node.version and not is_newer(node.version, frame.version)
    if other or (node.fresh and frame.version == node.version):
        new_version(node, params, now, following(frame.version), out)
    node.fresh = 0
