"""The shared medium [mesh 6]: who hears what, who receives a frame.

A signal is everywhere at once, as strong as the pair's power. A receiver gets a frame if it was
alive and listened from start to end, if the signal was stronger by the ratio of capture than the
strongest sum of everything else it met, and if the pair's chance of reception says so. A node that
decided to send is deaf for the turnaround and for the frame (the vulnerable window).

Without `collisions` the medium is ideal: only the chance counts, nobody is deaf, and a node may
have several frames on the air.
"""

from innervate.dialect.arith import MASK30
from innervate.dialect.rng import LOW15, step
from innervate.sim import taps
from innervate.sim.field import powers
from innervate.sim.field.queue import ENDS, STARTS, TIMER, key_of, push
from innervate.sim.field.states import ALIVE, COMMITTED, DEAD, FREE, HELD, ON_AIR, VOID

NONE = -1
DEAF = (1 << 62) - 1  # interference that nothing survives
SEVERED = DEAF - 1  # ... of who was cut off from the sender, or joined to it again, in the middle

RSSI_LOW, RSSI_HIGH = -128, 127

BROKEN_AIR = 1  # too many frames under way at once
BROKEN_OUTBOX = 2
BROKEN_RANGE = 3
BROKEN_HELD = 5  # a frame was handed down while another was under way
BROKEN_FRAME = 6  # a receiver changed the frame that it was handed


def breaks(world, what, node):
    """Something happened that must not; the first is told."""
    run = world.run[0]
    if run.broken == 0:
        run.broken, run.broken_node = what, node


def set_timer(world, node, timer, at, time, now):
    """A timer of a node, its protocol's or one below, fires at the node's clock reading `at`."""
    when = time + max(0, ((at - now + (1 << 29)) & MASK30) - (1 << 29))
    place = node * world.run[0].timers + timer
    if world.due[place] != when:
        world.due[place] = when
        push(world.heap, key_of(when, TIMER, node, timer))


def reserve(world, node, state):
    """A place for a frame of `node`, or NONE: the run is broken then."""
    run = world.run[0]
    if run.free == 0:
        breaks(world, BROKEN_AIR, node)
        return NONE
    run.free -= 1
    place = world.free[run.free]
    air = world.air[place]
    air.node, air.state = node, state
    return place


def release(world, place):
    """Give back the place of a frame that nobody needs any more."""
    run = world.run[0]
    world.air[place].state = FREE
    world.free[run.free] = place
    run.free += 1


def commit(world, place, time):
    """The sender of the frame at `place` turns its radio round: deaf from now on."""
    run, air = world.run[0], world.air[place]
    air.state = COMMITTED
    if run.collisions:
        world.radios[air.node].deaf = 1
        miss(world, air.node, time)
    push(world.heap, key_of(time + run.turnaround, STARTS, air.node, place))


def airtime(world, length):
    """How long a frame of `length` bytes is on the air, us."""
    run = world.run[0]
    return (run.phy_bytes + length) * run.byte_ns // 1000


def miss(world, node, time):
    """A node cannot receive what is on the air now; what ends this moment it has received."""
    run = world.run[0]
    for i in range(run.on_air):
        place = world.on_air[i]
        if world.air[place].end > time:
            world.worst[place * run.nodes + node] = DEAF


def start(world, place, time, length):
    """The frame at `place` goes on the air, `length` bytes long."""
    run, air = world.run[0], world.air[place]
    node = air.node
    air.state = ON_AIR
    air.start = time
    air.end = time + airtime(world, length)
    world.on_air[run.on_air] = place
    run.on_air += 1
    run.transmissions += 1
    world.radios[node].on_air += 1
    for j in range(run.nodes):
        listens = world.radios[j].state == ALIVE and not world.radios[j].deaf
        world.worst[place * run.nodes + j] = 0 if listens else DEAF
    if run.collisions:
        add_signal(world, node, 1)
        note_interference(world)
    push(world.heap, key_of(air.end, ENDS, node, place))


def add_signal(world, node, times):
    """A signal of `node` more, or (`times` = -1) less, at everybody."""
    nodes = world.run[0].nodes
    first = node * nodes
    for j in range(nodes):
        world.sums[j] += times * world.power[first + j]


def note_interference(world):
    """Signals have changed: every frame on the air may have met worse than before."""
    run = world.run[0]
    for i in range(run.on_air):
        place = world.on_air[i]
        first, mine = place * run.nodes, world.air[place].node * run.nodes
        for j in range(run.nodes):
            met = world.sums[j] - world.power[mine + j]
            if met > world.worst[first + j]:
                world.worst[first + j] = met


def leave(world, place):
    """A frame's signal ends: it disturbs nobody from now on."""
    run = world.run[0]
    node = world.air[place].node
    last = run.on_air - 1
    for i in range(last):
        if world.on_air[i] == place:
            world.on_air[i] = world.on_air[last]
            break
    run.on_air = last
    world.radios[node].on_air -= 1
    world.radios[node].deaf = 0
    if run.collisions:
        add_signal(world, node, -1)


def receivers(world, place, tap):
    """Who received the frame that has just ended: their number; world.got has them in order.

    `tap` keeps a frame for a capture.
    """
    run = world.run[0]
    node = world.air[place].node
    count = 0
    for j in range(run.nodes):
        signal = world.power[node * run.nodes + j]
        if signal == 0 or world.radios[j].state != ALIVE:
            continue
        if signal * powers.CAPTURE_ONE // run.capture < world.worst[place * run.nodes + j]:
            miss_frame(world, place, j, taps.COLLISION, tap)
            continue
        run.rng = step(run.rng)
        if (run.rng & LOW15) < world.prob[node * run.nodes + j]:
            world.got[count] = j
            count += 1
        else:
            miss_frame(world, place, j, taps.NOISE, tap)
    run.received += count
    return count


def miss_frame(world, place, node, why, tap):
    """A node in reach has not received the frame at `place`: a capture says so."""
    air = world.air[place]
    at = place * world.run[0].nodes + node
    if world.prob[air.node * world.run[0].nodes + node] > 0:
        met = taps.SENDING if world.worst[at] == DEAF else why
        if world.worst[at] == SEVERED:
            met = taps.CUT
        tap(world, place, node, air.end, 0, met)


def rssi_dbm(world, sender, node):
    """What a node measures of a frame, whole dBm, as it stands on the wire."""
    rssi = (world.rssi[sender * world.run[0].nodes + node] + 50) // 100
    return min(max(rssi, RSSI_LOW), RSSI_HIGH)


def senses(world, node):
    """1 if the channel is busy at a node: it hears power enough, or it is about to send."""
    return world.radios[node].deaf or world.sums[node] >= world.run[0].sense


def abandon(world, place):
    """The frame's sender died: its signal, if there is one, ends now, and is no frame any more."""
    state = world.air[place].state
    if state == ON_AIR:
        leave(world, place)
    if state == HELD:
        release(world, place)
    else:
        world.air[place].state = VOID


def die(world, node):
    """A node stops; the loop has abandoned its frames."""
    radio = world.radios[node]
    radio.state, radio.deaf, radio.held, radio.tell_at = DEAD, 0, NONE, NONE


def set_noise(world, node, power):
    """A jammer at a node, or its end (0)."""
    radio = world.radios[node]
    if world.run[0].collisions:
        world.sums[node] += power - radio.noise
        radio.noise = power
        note_interference(world)


def set_power(world, i, j):
    """The signal from i to j has changed: its strength as rssi and cuts say."""
    run = world.run[0]
    at = i * run.nodes + j
    power = 0
    if not world.cut[at]:
        power = powers.strength(world.strengths, world.rssi[at])
    if run.collisions and world.radios[i].on_air:
        world.sums[j] += power - world.power[at]
    world.power[at] = power


def set_cut(world, i, j, cut):
    """No signal between two nodes, either way, or again as before; what is half over is lost."""
    nodes = world.run[0].nodes
    if world.cut[i * nodes + j] == cut:
        return
    world.cut[i * nodes + j] = cut
    world.cut[j * nodes + i] = cut
    set_power(world, i, j)
    set_power(world, j, i)
    sever(world, i, j)
    sever(world, j, i)
    note_interference(world)


def sever(world, sender, node):
    """A node does not receive what `sender` has on the air now."""
    run = world.run[0]
    for i in range(run.on_air):
        place = world.on_air[i]
        at = place * run.nodes + node
        if world.air[place].node == sender and world.worst[at] < SEVERED:
            world.worst[at] = SEVERED
