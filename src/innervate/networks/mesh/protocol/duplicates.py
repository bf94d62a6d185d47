"""What is remembered of packets: delivered, forwarded, failed neighbours, bad neighbours."""

from innervate.dialect.arith import HALF16, MASK16
from innervate.networks.mesh.protocol.constants import ALL, PARITY, TABLES
from innervate.networks.mesh.protocol.fields import FORWARDED, SKIPS, WINDOW_WORDS

FLOODED = 20  # in done_kind: a flooded alarm, whose instances count apart
WANTED = 21  # ... a message that is flooded to find its recipient, by its parity
BITS = 15
ANEW = 320  # numbers behind the newest: more than a packet can be that is still on its way
UNREACHABLE = 254  # in bad_neighbour: nobody leads there


def clear_duplicates(node, params):
    """Empty all four tables, as after switching on."""
    for k in range(params.width):
        node.idle[k] = 0
    for k in range(FORWARDED):
        node.done_origin[k] = ALL
    for k in range(SKIPS):
        node.skip_origin[k] = ALL
        node.bad_neighbour[k] = ALL
    node.done_at = 0
    node.skip_at = 0
    node.bad_at = 0


def accept(node, params, origin, seq, first):
    """1 if this packet was not delivered before [mesh 1]; it counts as delivered from now on.

    The window of an origin begins anew after silence, and where a packet that says FIRST is far
    too old for it: its origin has started anew. One in the window, or not far behind it, does not
    throw it away: what its origin sent with FIRST it may send again, and copies of that may have
    lost their way for a while. (An origin that starts anew there, one in 200, is heard after a
    silence.) A packet too old for the window does not count
    as a sign of life: else an origin that started anew would never be heard.
    """
    base = origin * WINDOW_WORDS
    ahead = (seq - node.newest[origin]) & MASK16
    behind = MASK16 - ahead
    if node.idle[origin] == 0:
        begin_window(node, params, origin, seq)
        return 1
    if ahead >= HALF16 and behind >= BITS * WINDOW_WORDS:
        if not first or behind < ANEW or node.heard_seq[origin] == seq:
            return 0
        begin_window(node, params, origin, seq)
        return 1
    node.idle[origin] = params.forget
    if ahead == 0:
        return 0
    if ahead < HALF16:
        slide(node, base, ahead)
        node.newest[origin] = seq
        return 1
    word = base + behind // BITS
    bit = 1 << (behind % BITS)
    if node.window[word] & bit:
        return 0
    node.window[word] = node.window[word] | bit
    return 1


def begin_window(node, params, origin, seq):
    """Of this origin nothing but `seq` was delivered."""
    node.idle[origin] = params.forget
    node.newest[origin] = seq
    node.heard_seq[origin] = seq
    for k in range(WINDOW_WORDS):
        node.window[origin * WINDOW_WORDS + k] = 0


def slide(node, base, ahead):
    """The window moves on by `ahead`; the packet that was newest is in it then."""
    for k in range(WINDOW_WORDS):
        at = WINDOW_WORDS - 1 - k
        word = 0
        for b in range(BITS):
            old = at * BITS + b - ahead
            if old == -1:
                word = word | (1 << b)
            elif old >= 0 and node.window[base + old // BITS] & (1 << (old % BITS)):
                word = word | (1 << b)
        node.window[base + at] = word


def age(node, params):
    """Every tick: windows of silent origins are cleared."""
    for k in range(params.nodes):
        if node.idle[k] > 0:
            node.idle[k] = node.idle[k] - 1


def forwarded_at(node, origin, seq, kind):
    """Where a packet is among those that were forwarded, or -1."""
    for k in range(FORWARDED):
        if node.done_origin[k] == origin and node.done_seq[k] == seq:
            if node.done_kind[k] & 63 == kind & 63:
                return k
    return -1


def note_forwarded(node, k, origin, seq, kind, giver, hops):
    """Remember a packet in place k, -1 = a new one.

    kind has its type, and 64 x retry parity; hops = how long its path is.
    """
    if k < 0:
        k = node.done_at
        node.done_at = (k + 1) % FORWARDED
    node.done_origin[k] = origin
    node.done_seq[k] = seq
    node.done_kind[k] = kind
    node.done_from[k] = giver
    node.done_hops[k] = hops


def record_packet(node, frame):
    """Enter a packet into the duplicate cache: 1 if it was there, taken from somebody before.

    A retry by its origin has the other parity and counts as new.
    """
    kind = frame.kind | ((frame.flags & PARITY) >> 1)
    k = forwarded_at(node, frame.origin, frame.seq, kind)
    if k >= 0 and node.done_kind[k] == kind:
        return 1
    clear_skipped(node, frame.origin, frame.seq)
    note_forwarded(node, k, frame.origin, frame.seq, kind, frame.link_src, frame.path_len)
    return 0


def record_return(node, frame):
    """Enter a packet that came back: 1 if it did so before, by its path.

    Else whoever gives it back and misses our ack would make two of it.
    """
    kind = frame.kind | ((frame.flags & PARITY) >> 1)
    k = forwarded_at(node, frame.origin, frame.seq, kind)
    if k < 0:
        note_forwarded(node, k, frame.origin, frame.seq, kind, ALL, frame.path_len)
        return 0
    if node.done_kind[k] == kind and frame.path_len <= node.done_hops[k]:
        return 1
    node.done_kind[k] = kind
    node.done_hops[k] = frame.path_len
    return 0


def record_flood(node, origin, seq, kind, instance):
    """Enter an instance of a flood: 1 if it went through here before."""
    for k in range(FORWARDED):
        if node.done_origin[k] == origin and node.done_seq[k] == seq:
            if node.done_kind[k] == (kind | (instance << 6)):
                return 1
    note_forwarded(node, -1, origin, seq, kind | (instance << 6), ALL, 0)
    return 0


def skip(node, origin, seq, who):
    """Neighbour `who` failed for this packet."""
    k = node.skip_at
    node.skip_at = (k + 1) % SKIPS
    node.skip_origin[k] = origin
    node.skip_seq[k] = seq
    node.skip_neighbour[k] = who


def is_skipped(node, origin, seq, who):
    """1 if neighbour `who` failed for this packet."""
    for k in range(SKIPS):
        if node.skip_origin[k] == origin and node.skip_seq[k] == seq:
            if node.skip_neighbour[k] == who:
                return 1
    return 0


def clear_skipped(node, origin, seq):
    """This packet is tried anew."""
    for k in range(SKIPS):
        if node.skip_origin[k] == origin and node.skip_seq[k] == seq:
            node.skip_origin[k] = ALL


def mark_bad(node, who, dest):
    """Neighbour `who` gave back a packet for `dest`."""
    if not is_bad(node, who, dest):
        k = node.bad_at
        node.bad_at = (k + 1) % SKIPS
        node.bad_neighbour[k] = who
        node.bad_dest[k] = dest


def is_bad(node, who, dest):
    """1 if neighbour `who` gave back a packet for `dest`."""
    for k in range(SKIPS):
        if node.bad_neighbour[k] == who and node.bad_dest[k] == dest:
            return 1
    return 0


def is_unreachable(node, dest):
    """1 if all tries of a message to `dest` were in vain, and nothing was heard of it since.

    A search asks the whole network. All who have messages for somebody who died would search
    without end, and leave no room for the round that mends the tables.
    """
    return is_bad(node, UNREACHABLE, dest)


def mark_reachable(node, dest):
    """`dest` is heard of: it is not unreachable, and searches wait no longer than at first."""
    if forget_bad(node, UNREACHABLE, dest):
        node.search_backoff = 0


def forget_bad(node, who, dest):
    """`who` leads to `dest` after all: 1 if it counted as one that gave back a packet for it."""
    found = 0
    for k in range(SKIPS):
        if node.bad_neighbour[k] == who and node.bad_dest[k] == dest:
            node.bad_neighbour[k] = ALL
            found = 1
    return found


def retry_unreachable(node):
    """Whoever could not be reached may be there; if that is nobody, the wait is halved again."""
    was_unreachable = 0
    for k in range(SKIPS):
        if node.bad_neighbour[k] == UNREACHABLE:
            node.bad_neighbour[k] = ALL
            was_unreachable = 1
    if not was_unreachable:
        node.search_backoff = max(node.search_backoff - 1, 0)


def forgive(node):
    """After some ticks, and in a new round: whoever gave packets back may lead on now.

    Where links lose much a packet comes back from good neighbours, too, one by one; what is for
    those behind a bridge would be looked for on the near side alone.
    """
    for k in range(SKIPS):
        if node.bad_neighbour[k] != UNREACHABLE:
            node.bad_neighbour[k] = ALL


def clear_bad(node, params):
    """New tables: whoever gave packets back may know a way now, but not to whom they leave out."""
    for k in range(SKIPS):
        dest = node.bad_dest[k]
        left_out = params.mode == TABLES and dest < params.width
        if left_out:
            left_out = node.next[node.bank * params.width + dest] == ALL
        if node.bad_neighbour[k] != UNREACHABLE or not left_out:
            node.bad_neighbour[k] = ALL
