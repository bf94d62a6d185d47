"""Where a packet goes next, and what happens when its hop does not answer [mesh 4 NEXT]."""

from innervate.dialect.rng import draw
from innervate.networks.mesh.protocol.constants import (
    ALTERNATE,
    CRC_BYTES,
    DATA,
    DETOURED,
    HEADER_BYTES,
    LOUDEST,
    NOBODY,
    ORDERED,
    PARITY,
    PATH_MAX,
    RANDOM,
    SEARCH,
    SOURCE_ROUTE,
    TABLE,
    TABLE_FREE,
    TABLES,
    WHOLE_GRAPH,
)
from innervate.networks.mesh.protocol.duplicates import forget_bad, forwarded_at, is_bad, is_skipped
from innervate.networks.mesh.protocol.neighbours import (
    count_neighbours,
    is_strong,
    is_suspect,
    loudest,
    place_of,
    random_neighbour,
)
from innervate.networks.mesh.protocol.search import add_failed, find_hop, is_edge
from innervate.networks.mesh.protocol.upward import is_untried, uplink

ANYHOW = 2  # for `bad`
CALLS = 2  # a message is flooded in so many of its tries, the parities of which differ


def planned(node, params, dest):
    """The next hop in the table, 255 none."""
    return node.next[node.bank * params.width + dest]


def alternate(node, params, dest):
    """The alternate in the table, 255 none."""
    return node.alt[node.bank * params.width + dest]


def learn_way(node, params, frame):
    """Who brought a packet leads to its origin, as far as no table says who does.

    The answer goes back so, and what follows it: nobody has to search for a way that was found.
    If it gave packets for the origin back before, it leads there now.
    """
    forget_bad(node, frame.link_src, frame.origin)
    if params.on_demand or (params.mode == TABLES and params.failover == SEARCH):
        at = node.bank * params.width + frame.origin
        if node.version == 0 or node.next[at] == NOBODY:
            node.next[at] = frame.link_src


def is_usable(node, params, i, who):
    """1 if the packet in place i may go to `who`."""
    return is_untried(node, i, who) and not is_suspect(node, params, who)


def is_fit(node, params, i, who, bad):
    """1 if `who` may be next, and gave back packets for this recipient before as `bad` says.

    ANYHOW: whoever is untried, whatever we suspect.
    """
    if bad == ANYHOW:
        return is_untried(node, i, who)
    return is_usable(node, params, i, who) and is_bad(node, who, node.q_dest[i]) == bad


def loudest_fit(node, params, i, bad):
    """The loudest of the neighbours that may be next, or NOBODY."""
    best = -1
    for k in range(params.places):
        if best < 0 or node.rssi[k] > node.rssi[best]:
            if is_fit(node, params, i, node.neighbour[k], bad):
                best = k
    if best < 0:
        return NOBODY
    return node.neighbour[best]


def search(node, params, i, bad):
    """Recipient, table, alternate, uplink, any other neighbour: the first that may be next.

    Uplinks are for the gateway, and for whom we know no way to: those nearer to it have tables
    sooner than we.
    """
    dest = node.q_dest[i]
    if is_strong(node, params, place_of(node, params, dest)) and is_fit(node, params, i, dest, bad):
        return dest
    who = planned(node, params, dest)
    if is_fit(node, params, i, who, bad):
        return who
    who = alternate(node, params, dest)
    if is_fit(node, params, i, who, bad):
        return who
    if dest == node.gateway or planned(node, params, dest) == NOBODY:
        who = uplink(node, params, i)
        if is_fit(node, params, i, who, bad):
            return who
    if params.failover != SEARCH:
        return NOBODY
    return loudest_fit(node, params, i, bad)


def giver(node, i):
    """Who had the packet in place i before it came here first, or NOBODY.

    Its path says so where we have forgotten it, unless that had come back to somebody before.
    """
    kind = node.q_kind[i] | ((node.q_flags[i] & PARITY) >> 1)
    at = forwarded_at(node, node.q_origin[i], node.q_seq[i], kind)
    if at >= 0 and node.done_kind[at] == kind and node.done_from[at] != NOBODY:
        return node.done_from[at]
    before = NOBODY
    for k in range(node.q_path_len[i]):
        who = node.q_path[i * PATH_MAX + k]
        if who == node.number:
            return before
        before = who
    return NOBODY


def named(node, params, i):
    """Before the packet goes back: recipient, or next in the table, that did not answer before.

    Three lost frames would else shut out whoever is behind a bridge until the suspicion ends.
    """
    dest = node.q_dest[i]
    if place_of(node, params, dest) >= 0 and is_untried(node, i, dest):
        return dest
    who = planned(node, params, dest)
    if place_of(node, params, who) >= 0 and is_untried(node, i, who):
        return who
    return NOBODY


def give_back(node, params, i):
    """Who gave us the packet in place i, first or last; at its origin anybody is the last resort.

    Three lost frames would else keep who has but one neighbour silent until the suspicion ends.
    """
    if node.q_origin[i] == node.number:
        return loudest_fit(node, params, i, ANYHOW)
    who = giver(node, i)
    if is_skipped(node, node.q_origin[i], node.q_seq[i], who):
        who = node.q_from[i]
        if is_skipped(node, node.q_origin[i], node.q_seq[i], who):
            who = NOBODY
    return who


def seek(node, params, i):
    """Whoever leads on by what we know, or else anybody; back where it came from if nobody."""
    who = search(node, params, i, 0)
    if who == NOBODY:
        who = search(node, params, i, 1)
    if who == NOBODY and params.failover == SEARCH:
        who = named(node, params, i)
        if who == NOBODY:
            who = give_back(node, params, i)
    return who


def choose_by_search(node, params, i):
    """The next hop by table, alternates and path-trace search."""
    who = seek(node, params, i)
    if who != NOBODY and who != planned(node, params, node.q_dest[i]):
        node.q_flags[i] = node.q_flags[i] | DETOURED
    return who


def room_of(node, params, i):
    """How long the payload of the packet in place i may be."""
    return params.mtu - HEADER_BYTES - CRC_BYTES - node.q_path_len[i]


def is_near(node, params, who):
    """1 if `who` is a neighbour that is loud enough, and answers."""
    strong = is_strong(node, params, place_of(node, params, who))
    return strong and not is_suspect(node, params, who)


def choose_by_graph(node, params, i):
    """The next hop on a shortest path around all that failed and all that had the packet.

    Where the graph knows none, links may have come that it does not have: search.
    """
    dest = node.q_dest[i]
    if is_near(node, params, dest):
        return dest
    if node.version:
        who = find_hop(node, params, i, dest, room_of(node, params, i), 1)
        if who != NOBODY:
            return who
    return seek(node, params, i)


def choose_by_route(node, params, i):
    """Table-free: the next of the source route, the recipient if near, else the gateway.

    The gateway itself writes the route.
    """
    dest = node.q_dest[i]
    if not node.q_flags[i] & SOURCE_ROUTE:
        if is_near(node, params, dest):
            return dest
        if not node.leading:
            if params.on_demand and is_usable(node, params, i, planned(node, params, dest)):
                return planned(node, params, dest)
            return uplink(node, params, i)
        plan_route(node, params, i)
    if node.q_flags[i] & SOURCE_ROUTE and node.q_body[i * node.q_room] > 0:
        return node.q_body[i * node.q_room + 1]
    return NOBODY


def plan_route(node, params, i):
    """The gateway puts the way to the recipient in front of the payload in place i."""
    dest = node.q_dest[i]
    if dest >= params.nodes:
        return
    first = find_hop(node, params, i, dest, room_of(node, params, i), 0)
    if first == NOBODY:
        return
    count = node.far[first] + 1  # as find_hop has measured it
    length = node.q_length[i]
    if length + count + 1 > room_of(node, params, i):
        return
    for k in range(length):
        at = i * node.q_room + length - 1 - k
        node.q_body[at + count + 1] = node.q_body[at]
    node.q_body[i * node.q_room] = count
    at = first
    for k in range(count):
        node.q_body[i * node.q_room + 1 + k] = at
        at = downhill(node, params, at)
    node.q_length[i] = length + count + 1
    node.q_flags[i] = node.q_flags[i] | SOURCE_ROUTE


def downhill(node, params, at):
    """A neighbour of `at` in the graph that is one hop nearer, by the distances just measured."""
    for c in range(params.nodes):
        if node.far[c] + 1 == node.far[at] and is_edge(node, params, at, c):
            return c
    return at


def is_wanted(node, params, i):
    """1 if the way to the recipient of our message in place i is not known: all are asked.

    The message itself is flooded, twice at most, and whoever passes it on knows a way to us then;
    its end-to-end ack goes back so, and leaves a way to its recipient.
    """
    dest = node.q_dest[i]
    owner = node.q_owner[i]
    if not params.on_demand or node.version or node.q_kind[i] != DATA or owner < 0:
        return 0
    if node.q_flags[i] & ORDERED or node.wait_tries[owner] > CALLS:
        return 0
    if dest == node.gateway or dest == node.gone or planned(node, params, dest) != NOBODY:
        return 0
    if params.mode == TABLES and params.failover < ALTERNATE:
        return 1  # these rules know nothing but tables
    return not is_strong(node, params, place_of(node, params, dest))


def choose_hop(node, params, i):
    """Where the packet in place i goes next; NOBODY: nowhere."""
    if params.mode == WHOLE_GRAPH:
        return choose_by_graph(node, params, i)
    if params.mode == TABLE_FREE:
        return choose_by_route(node, params, i)
    if params.failover >= ALTERNATE:
        return choose_by_search(node, params, i)
    who = planned(node, params, node.q_dest[i])
    if who == NOBODY and node.q_dest[i] == node.gateway:
        return uplink(node, params, i)
    return who


def rewrite(node, params, i, failed):
    """The document's failover: another neighbour takes the dead one's place in the table."""
    spared = node.q_origin[i] if params.avoid_origin else node.q_from[i]
    who = NOBODY
    if params.failover == RANDOM:
        count = count_neighbours(node, params, failed, spared)
        if count > 0:
            who = random_neighbour(node, params, failed, spared, draw(node, count))
    elif params.failover == LOUDEST:
        who = loudest(node, params, failed, spared)
    node.next[node.bank * params.width + node.q_dest[i]] = who


def take_out(node, i, first, count):
    """Take `count` bytes out of the payload of the packet in place i, from byte `first` on."""
    node.q_length[i] = node.q_length[i] - count
    for k in range(i * node.q_room + first, i * node.q_room + node.q_length[i]):
        node.q_body[k] = node.q_body[k + count]


def strip_route(node, i):
    """Take the source route out of the packet in place i."""
    if node.q_flags[i] & SOURCE_ROUTE:
        take_out(node, i, 0, node.q_body[i * node.q_room] + 1)
        node.q_flags[i] = node.q_flags[i] & ~SOURCE_ROUTE


def advance_route(node, i):
    """The first node of the source route is the next hop: it is no longer in it."""
    if node.q_flags[i] & SOURCE_ROUTE and node.q_body[i * node.q_room] > 0:
        node.q_body[i * node.q_room] = node.q_body[i * node.q_room] - 1
        take_out(node, i, 1, 1)


def learn_failure(node, params, i, failed):
    """Neighbour `failed` failed for the packet in place i; lost tables rewrite none."""
    found = params.on_demand and node.version == 0
    if found and planned(node, params, node.q_dest[i]) == failed:
        node.next[node.bank * params.width + node.q_dest[i]] = NOBODY
    if params.mode == TABLE_FREE:
        strip_route(node, i)
    if params.mode != 0:
        add_failed(node, i, failed, room_of(node, params, i))
    elif params.failover < ALTERNATE and node.q_kind[i] != TABLE and not found:
        rewrite(node, params, i, failed)
