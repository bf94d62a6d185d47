"""Standbys: is the gateway there? Who asks it is told, and given its graph, part by part.

An answer costs two ways through the mesh, however many nodes it has. Whatever else the gateway
sent and a standby hears is an answer, too.
"""

from innervate.networks.mesh.protocol.constants import (
    ALARMS,
    ALL,
    DETOURED,
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
PATIENCE = 12  # quarters, at first
PATIENCE_MAX = 24  # after an answer that came late
SPARE_HOPS = 3  # of a question of who has no patience: it is not looked for everywhere
EVERYWHERE = 14  # nodes that had a packet for the gateway: then it does not answer anybody


def hear_of_gateway(node, params, now, frame, out):
    """What a frame says of the gateway, or of the one before it: whoever made it lives.

    Without a table it leads no more. Where more than one question was needed, a few in vain prove
    nothing; but whoever has something for a gateway that is looked for everywhere does: links that
    lose much, or a full channel, make for detours that are not as long.
    """
    if frame.origin == node.gone:
        node.gone = ALL
    if frame.origin == node.gateway and frame.table_ver:
        if node.silent > 2:
            node.patience = PATIENCE_MAX
        node.silent = 0
    if node.patience and frame.dest == node.gateway and frame.path_len >= EVERYWHERE:
        if frame.flags & DETOURED:
            node.patience = 0
            arm_guard(node, params, now, out)


def guard(node, gate, params, now, out):
    """A standby's wait is over: ask if no sign of life came, lead if all questions were in vain.

    Who is patient has its question looked for everywhere: that tells it whether it need be.
    """
    node.silent = node.silent + 1
    if node.silent == 1:
        node.patience = max(node.patience - 1, 0)
    elif node.silent > 1 + IN_VAIN + (node.patience >> 2):
        lead(node, gate, params, now, out)
        return
    else:
        i = compose(node, now, ALARMS, GRAPH, node.gateway, 0, out)
        if i >= 0:
            if not node.patience:
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
