"""Standbys: is the gateway there? Who asks it is told, and given its graph, part by part.

An answer costs two ways through the mesh, however many nodes it has. Whatever else the gateway
sent and a standby hears is an answer, too.
"""

from innervate.networks.mesh.protocol.constants import (
    ALARMS,
    ALL,
    GRAPH,
    PARTS_MAX,
    TABLES,
    TTL,
)
from innervate.networks.mesh.protocol.frames import get16
from innervate.networks.mesh.protocol.gateway import lead
from innervate.networks.mesh.protocol.graph_jobs import fill_graph
from innervate.networks.mesh.protocol.queue import compose, kick
from innervate.networks.mesh.protocol.round import arm_guard
from innervate.networks.mesh.protocol.send import send_on
from innervate.networks.mesh.protocol.table import PART_HEAD, part_count, read_edges

IN_VAIN = 4  # questions, each with a wait of its own: then the gateway is dead
TOLERANCE = 40  # eighths of a question more, at first
TOLERANCE_MAX = 64  # after an answer that came late
SPARE_HOPS = 3  # of a question: it is not looked for everywhere


def hear_of_gateway(node, frame):
    """What a frame says of the gateway, or of the one before it: whoever made it lives.

    Without a table it leads no more. Where more than one question was needed, a few in vain prove
    nothing.
    """
    if frame.origin == node.gone:
        node.gone = ALL
    if frame.origin == node.gateway and frame.table_ver:
        if node.silent > 2:
            node.tolerance = TOLERANCE_MAX
        node.silent = 0


def guard(node, gate, params, now, out):
    """A standby's wait is over: ask if no sign of life came, lead if all questions were in vain."""
    node.silent = node.silent + 1
    if node.silent == 1:
        node.tolerance = max(node.tolerance - 1, 0)
    elif node.silent > 1 + IN_VAIN + (node.tolerance >> 3):
        lead(node, gate, params, now, out)
        return
    else:
        i = compose(node, now, ALARMS, GRAPH, node.gateway, 0, out)
        if i >= 0:
            node.q_ttl[i] = min(node.depth + SPARE_HOPS, TTL)
            fill_graph(node, gate, params, i, gate.part, 0)  # of no parts: a question
            send_on(node, params, now, i, out)
        kick(node, params, now, out)
    arm_guard(node, params, now, out)


def on_guard(node, gate, params, now, frame, out):
    """A standby asks us, who lead; or the gateway answers us, a standby."""
    if frame.length < PART_HEAD:
        return
    version = get16(frame, 1)
    index = frame.body[3] >> 4
    count = frame.body[3] & 15
    if node.leading:
        if version != gate.version:
            index = 0
        i = compose(node, now, ALARMS, GRAPH, frame.origin, 0, out)
        if i >= 0:
            fill_graph(node, gate, params, i, index, parts_told(gate, params))
            send_on(node, params, now, i, out)
    elif node.rank >= 0 and params.mode == TABLES and frame.origin == node.gateway:
        if version != gate.version:
            gate.version = version
            gate.part = 0
        if index == gate.part and index < count:
            read_edges(node, params, frame, index)
            gate.part = index + 1


def parts_told(gate, params):
    """How many parts a standby can have of our graph now: tables on their way need the channel."""
    count = part_count(params)
    if params.mode != TABLES or count > PARTS_MAX or gate.links == 0 or gate.open:
        return 0
    return count
