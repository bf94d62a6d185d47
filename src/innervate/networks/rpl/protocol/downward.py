"""Who can be reached below us, and how that is told: DAOs [RFC 6550, 9]."""

from innervate.dialect.arith import MASK30
from innervate.dialect.outbox import set_timer
from innervate.dialect.rng import draw
from innervate.networks.rpl.protocol import sizes, timers
from innervate.networks.rpl.protocol.constants import NOBODY, NONE
from innervate.networks.rpl.protocol.counters import following, is_newer

LIFE = 3  # times from DAO to DAO for which a way is good
FOR_EVER = 255
HERE = 1
GONE = 2  # what a parent is to hear of a target
DAO_TRIES = 5
AGAIN = 8  # DelayDAOs from one try to the next


def schedule(node, params, now, out):
    """Send a DAO when DelayDAO is over; if it runs already, it is left alone [9.5]."""
    if not node.dao_armed and node.number != params.root:
        node.dao_armed = 1
        wait = params.dao_us + draw(node, params.dao_us)
        set_timer(out, timers.DAO_DELAY, (now + wait) & MASK30)


def announce(node, params, now, out):
    """Our parent is to hear of us anew: with the next Path Sequence [9.2.1]."""
    node.path_seq = following(node.path_seq)
    node.owed[node.number] = HERE
    node.dao_wait = 0
    schedule(node, params, now, out)


def announce_all(node, params, now, out):
    """A new parent is to hear of us, and of all that we can reach."""
    for target in range(sizes.NODES):
        if node.via[target] >= 0:
            node.owed[target] = HERE
    announce(node, params, now, out)


def leave(node, params, now, old, out):
    """A parent is one no more: it is to hear that nothing is reached by us [9.8]."""
    node.old = old if params.storing else NOBODY
    for target in range(sizes.NODES):
        there = node.via[target] >= 0 or target == node.number
        node.left[target] = 1 if there and params.storing else 0
    if params.storing:
        schedule(node, params, now, out)


def take_dao(node, params, now, frame, out):
    """Storing mode: a child says whom it reaches; what changes our own says so, too [9.8]."""
    changed = 0
    for i in range(sizes.TARGETS):
        target = frame.targets[i]
        if target < sizes.NODES and target != node.number:
            changed += learn(node, frame.src, target, frame.paths[i], frame.life)
    if changed:
        schedule(node, params, now, out)


def learn(node, child, target, path, life):
    """A child reaches a target, or (`life` 0) does no more; 1 if that is news."""
    if life == 0:
        return forget(node, target) if node.via[target] == child else 0
    if node.via[target] >= 0 and is_newer(node.path[target], path):
        return 0
    if node.via[target] == child and node.path[target] == path:
        return 0
    note_way(node, target, child, path, life)
    node.owed[target] = HERE
    return 1


def note_way(node, target, via, path, life):
    """A way is good for so long from when its Path Sequence is first seen [6.7.8]."""
    node.via[target] = via
    node.path[target] = path
    node.life[target] = life


def life_of(params):
    """For how many ticks what we say of ways is good."""
    return LIFE * params.refresh


def forget(node, target):
    """There is no way to a target any more."""
    node.via[target] = NONE
    node.life[target] = 0
    node.owed[target] = GONE
    return 1


def forget_all(node):
    """A new version of the DODAG: who hangs on whom is told anew."""
    for target in range(sizes.NODES):
        node.via[target] = NONE
        node.owed[target] = 0
        node.left[target] = 0
    node.old = NOBODY


def forget_child(node, params, now, child, out):
    """Storing mode: nothing is reached by this child any more [9.8]."""
    changed = 0
    for target in range(sizes.NODES):
        if node.via[target] == child:
            changed += forget(node, target)
    if changed:
        schedule(node, params, now, out)


def grow_older(node, params, now, out):
    """A tick has passed: ways that nobody has told of for too long are forgotten."""
    changed = 0
    for target in range(sizes.NODES):
        if node.via[target] >= 0 and node.life[target] != FOR_EVER:
            node.life[target] -= 1
            if node.life[target] <= 0:
                changed += forget(node, target)
    if changed:
        schedule(node, params, now, out)


def pick(node, params):
    """Storing mode: what the next DAO to our parent says, of what is owed; how many targets."""
    mark = 0
    count = 0
    for target in range(sizes.NODES):
        owed = node.owed[target]
        if owed and count < sizes.TARGETS and (mark == 0 or owed == mark):
            mark = owed
            write(node, count, target)
            count += 1
    blank_behind(node, count)
    node.dao_life = 0 if mark == GONE else life_of(params)
    return count


def pick_left(node):
    """Storing mode: what the next DAO to the parent that we left says; how many targets."""
    count = 0
    for target in range(sizes.NODES):
        if node.left[target] and count < sizes.TARGETS:
            write(node, count, target)
            count += 1
    blank_behind(node, count)
    node.dao_life = 0
    return count


def write(node, place, target):
    """The DAO names a target."""
    node.dao_target[place] = target
    node.dao_path[place] = path_of(node, target)


def path_of(node, target):
    """The Path Sequence of a target."""
    return node.path_seq if target == node.number else node.path[target]


def blank_behind(node, count):
    """The DAO names no more."""
    for i in range(count, sizes.TARGETS):
        node.dao_target[i] = NOBODY
        node.dao_path[i] = 0


def told(node):
    """Our parent has the DAO: what it said is owed no more."""
    mark = HERE if node.dao_life else GONE
    for i in range(sizes.TARGETS):
        target = node.dao_target[i]
        if target < sizes.NODES and node.owed[target] == mark:
            if node.dao_path[i] == path_of(node, target):
                node.owed[target] = 0


def told_left(node):
    """The parent that we left has the DAO."""
    for i in range(sizes.TARGETS):
        if node.dao_target[i] < sizes.NODES:
            node.left[node.dao_target[i]] = 0


def take_report(node, params, target, parent, path):
    """Non-storing mode, the root: a node says who its parent is; 0 if that is old news."""
    if target >= sizes.NODES or parent >= sizes.NODES:
        return 0
    if node.via[target] >= 0 and is_newer(node.path[target], path):
        return 0
    if node.via[target] != parent or node.path[target] != path:
        note_way(node, target, parent, path, life_of(params))
    return 1


def lay_route(node, i):
    """Non-storing mode, the root: write a packet's way into it, from its end; 0 if none is known.

    It has at most so many hops, the first left out, as the longest frame has room for [9.7].
    """
    at = node.q_dest[i]
    count = 0
    while at != node.number and count <= sizes.ROUTE:
        at = node.via[at] if at < sizes.NODES else NONE
        if at < 0:
            return 0
        count += 1
    if at != node.number or count == 0:
        return 0
    at = node.q_dest[i]
    for j in range(count - 1):
        node.q_route[i * sizes.ROUTE + count - 2 - j] = at
        at = node.via[at]
    node.q_length[i] = count - 1
    node.q_next[i] = 0
    node.q_info[i] = at
    return 1
