"""What a mesh does in the loop of its field: messages, robots' places, memories that are lost."""

from innervate.dialect.arith import MASK16
from innervate.networks.mesh.protocol.constants import ACK, MESSAGE, REPORT_GRAPH, SAMPLE, SENT
from innervate.networks.mesh.sim import recorder
from innervate.sim.field import calls, medium
from innervate.sim.field.states import ALIVE
from innervate.sim.status import BROKEN, DONE, POOL_FULL, ROWS_FULL

DUPLICATES_FULL = 100  # a status: the table of deliveries is half full

BYTE = 0xFF
SPEED_MAX = 127
PLACE_MAX = 32767


def pressing(world):
    """Why the loop has to stop before the next event, or DONE; limits leave room for one."""
    run = world.run[0]
    if run.broken:
        return BROKEN
    if run.rows > run.row_limit or run.sent > run.sent_limit or run.trail > run.trail_limit:
        return ROWS_FULL
    if run.delivered > run.delivered_limit or run.rounds > run.round_limit:
        return ROWS_FULL
    if run.taps > run.tap_limit:
        return ROWS_FULL
    if run.duplicates > run.duplicate_limit:
        return DUPLICATES_FULL
    if world.heap.size[0] + 64 * run.nodes + 64 > len(world.heap.keys):
        return POOL_FULL
    return DONE


def wipe(world, node):
    """A node's memory is lost: all but who it is, and how its random choices go on."""
    own, nodes, gate = world.nodes[node], world.run[0].nodes, world.radios[node].gate
    number, rank, robot, rng = own.number, own.rank, own.robot, own.rng
    words, blank = world.words[node], world.words[nodes]
    for i in range(len(world.low)):
        words[i] = blank[i]
    own.number, own.rank, own.robot, own.rng = number, rank, robot, rng
    spare = len(world.gates) - 1
    if gate != spare:
        words, blank = world.gate_words[gate], world.gate_words[spare]
        for i in range(world.run[0].gate_words):
            words[i] = blank[i]


def offer(world, do, index, time):
    """Hand a message down; its first bytes are the offer's index."""
    message, item = world.offers[index], world.item[0]
    node = message.node
    if world.radios[node].state != ALIVE:
        world.run[0].unasked += 1
        return
    item.handle = index & MASK16
    item.dest, item.flags, item.length = message.dest, message.flags, message.length
    for i in range(message.length):
        item.body[i] = (index >> (8 * (i & 3))) & BYTE
    calls.give(world, do, node, time, MESSAGE)


def tell_place(world, do, index, time):
    """A robot learns where it is, in units from the fence's corner, and how fast it goes."""
    walk, item = world.walks[index], world.item[0]
    item.x = min(max(walk.told_x, -PLACE_MAX), PLACE_MAX)
    item.y = min(max(walk.told_y, -PLACE_MAX), PLACE_MAX)
    item.vx = min(max(walk.vx, -SPEED_MAX), SPEED_MAX)
    item.vy = min(max(walk.vy, -SPEED_MAX), SPEED_MAX)
    calls.give(world, do, walk.node, time, SAMPLE)


def check(world, do, node, _time):
    """A node's record is in its ranges after a call."""
    if not calls.is_sound(world, node):
        medium.breaks(world, medium.BROKEN_RANGE, node)


def tell_sent(world, do, node, time, ok):
    """The router's frame has left the air, or could not."""
    if world.run[0].told:
        world.item[0].ok = ok
        calls.give(world, do, node, time, SENT)


def note_heard(world, node, place):
    """How loud a frame is that was received; acks tell how loud the frame was that they are for."""
    frame = world.frames[place]
    if frame.kind != ACK:
        frame.rssi = medium.rssi_dbm(world, world.air[place].node, node)


def note_report(world, node, time, code):
    """A router reports something; the row is there."""
    if code == REPORT_GRAPH:
        recorder.record_round(world, node, time)


def note_carriers(_world, _do, _time):
    """Routers are not told of the carrier: the medium access below them is, when it looks."""
