"""How a mesh breaks, in plain sentences, and the network after each event."""

from dataclasses import dataclass, field
from typing import Any

from innervate.networks.mesh.protocol import constants as const
from innervate.networks.mesh.verify import local as local
from innervate.networks.mesh.verify import net as mesh_net
from innervate.networks.mesh.verify.local import NONE
from innervate.networks.mesh.verify.net import DEAD, Move, Net, Nets
from innervate.networks.mesh.verify.search import Found
from innervate.verify import cases

KINDS = {
    const.REQUEST: "a discovery request",
    const.RESPONSE: "a discovery response",
    const.TABLE: "a table",
    const.TABLE_ACK: "a table's acknowledgement",
    const.DATA: "message",
    const.E2E_ACK: "an end-to-end ack",
    const.ALARM: "the alarm",
    const.POSITION: "its position",
    const.GRAPH: "the graph",
}
TIMERS = {
    const.TX: "has waited",
    const.ACK_WAIT: "hears no ack",
    const.ROUND: "goes on with the discovery round",
    const.TICK: "has its beat",
    const.RETRY: "has heard of no arrival and tries again",
    const.JOBS: "has no answer to a table",
}
BEFALLS = {
    mesh_net.DIE: "dies",
    mesh_net.SWITCH_ON: "is switched on",
    mesh_net.REVIVE: "is switched on again, its memory lost",
    mesh_net.OUTSIDE: "finds itself outside the fence",
}
TITLES = {
    local.BROKEN_TWICE: "a packet is delivered twice",
    local.BROKEN_ROUND: "a packet goes round",
    local.BROKEN_RANGE: "a value is out of its declared range",
    local.BROKEN_OUTBOX: "an outbox overflows",
    local.BROKEN_HELD: "a frame is handed down while another is under way",
    local.BROKEN_UNHEARD: "a message is not delivered though its recipient is connected",
    local.BROKEN_ENDLESS: "a packet stays for ever",
    local.BROKEN_GATEWAYS: "nodes do not agree on one gateway",
    local.BROKEN_CRASH: "a handler cannot go on",
    local.BROKEN_ACKED: "a node waits for an ack that it has heard",
    local.BROKEN_DEPOSED: "a standby leads though its gateway lives",
    local.BROKEN_FIRST: "the first round has no end",
}


@dataclass(slots=True)
class Scene:
    """The network after an event."""

    hops: list[int]  # each node's next hop to the story's recipient in its table, -1 none
    dead: list[int]  # nodes that are
    actor: int  # whose event it was
    sent: tuple[int, ...] = ()  # (from, to) of a frame that was received, or ()
    lost: tuple[int, ...] = ()  # (from, to) of a frame or ack that was not, or ()


@dataclass(kw_only=True)
class MeshStory(cases.Story):
    """How something breaks in a mesh."""

    found: Found  # the search that found it
    dest: int  # the recipient that the pictures are about
    scenes: list[Scene] = field(default_factory=list)  # the network after each
    # two nodes that are each other's next hop to `dest`, if there are
    ring: list[int] = field(default_factory=list)


def tell(found: Found) -> MeshStory:
    """The story of what a search found broken."""
    assert found.start is not None
    story = MeshStory(TITLES[found.broken], found=found, dest=_dest(found))
    before = found.start
    for move, after, _ in found.path:
        text = _sentence(found.nets, move, before, after)
        story.sentences.append(f"{text[0].upper()}{text[1:]}.")
        story.scenes.append(_scene(found.nets, story.dest, move, after))
        before = after
    story.ring = ring(story.scenes[-1].hops if story.scenes else [])
    if found.broken == local.BROKEN_ROUND and story.ring:
        a, b = story.ring
        story.title = (
            f"packets for node {story.dest} go to and fro between nodes {a} and {b}, for good: "
            "each has the other in its table"
        )
    elif found.broken in (local.BROKEN_UNHEARD, local.BROKEN_ENDLESS, local.BROKEN_GATEWAYS):
        story.title += ", though nothing fails any more"
    return story


def ring(hops: list[int]) -> list[int]:
    """Two nodes that are each other's next hop, or nothing."""
    for node, hop in enumerate(hops):
        if 0 <= hop < len(hops) and hops[hop] == node and hop != node:
            return [node, hop]
    return []


def next_hops(nets: Nets, net: Net, dest: int) -> list[int]:
    """Every node's next hop to a recipient in its table, -1 none."""
    found = []
    for number in net.nodes:
        hop = 255
        if number != DEAD:
            bank = nets.locals.field(number, "bank")
            hop = nets.locals.field(number, "next")[bank * nets.n + dest]
        found.append(NONE if hop == 255 else hop)
    return found


def _dest(found: Found) -> int:
    """The recipient of the packet that goes round, or of what was offered first."""
    model, last = found.model, found.path[-1] if found.path else None
    if found.broken == local.BROKEN_ROUND and last is not None:
        for number in last[1].nodes:
            handed = NONE if number == DEAD else found.nets.locals.states[number].handed
            if handed != NONE and local.goes_round(found.nets.locals.packets[handed]):
                dest = found.nets.locals.packets[handed].dest
                return dest if dest < model.nodes else 0
    return model.offers[0][1] if model.offers else 0


def _sentence(nets: Nets, move: Move, before: Net, after: Net) -> str:
    who = f"node {move.node}"
    if move.kind in BEFALLS:
        return f"{who} {BEFALLS[move.kind]}"
    if move.kind == mesh_net.OFFER:
        dest = nets.model.offers[move.frame][1]
        return f"{who} is given message {move.frame + 1} for node {dest}"
    what = TIMERS[move.frame] if move.kind == mesh_net.FIRE else _air(nets, move, before)
    return f"{who} {what}{_changes(nets, before, after)}"


def _air(nets: Nets, move: Move, before: Net) -> str:
    """What goes out, to whom, and what comes of it."""
    packet = nets.locals.packets[move.frame]
    what = KINDS.get(packet.kind, "a packet")
    if packet.kind == const.DATA:
        what += f" {packet.body[-1] + 1}" if packet.body else ""
    if packet.link_dst == const.ALL:
        lost = ", ".join(f"node {v}" for v in move.missed)
        return f"sends {what} to all" + (f"; {lost} does not receive it" if lost else "")
    to = f"node {packet.link_dst}"
    path = "-".join(map(str, packet.path))
    text = f"sends {what} to {to} (path {path})"
    if move.missed:
        return f"{text}, but it is lost"
    if before.nodes[packet.link_dst] == DEAD:
        return f"{text}, which is dead"
    return f"{text}, which receives it, but the ack is lost" if move.deaf else text


def _changes(nets: Nets, before: Net, after: Net) -> str:
    """What tables say now that they did not before."""
    told = []
    for dest in range(nets.n):
        pairs = zip(next_hops(nets, before, dest), next_hops(nets, after, dest), strict=True)
        for node, (old, new) in enumerate(pairs):
            alive = before.nodes[node] != DEAD and after.nodes[node] != DEAD
            if old != new and alive:
                hop = "nobody" if new == NONE else f"node {new}"
                told.append(f"node {node} has {hop} in its table for node {dest} now")
    return "".join(f"; {text}" for text in told)


def _scene(nets: Nets, dest: int, move: Move, net: Net) -> Scene:
    dead = [node for node, number in enumerate(net.nodes) if number == DEAD]
    scene = Scene(next_hops(nets, net, dest), dead, move.node)
    if move.kind == mesh_net.AIR:
        to: Any = nets.locals.packets[move.frame].link_dst
        if to != const.ALL:
            pair = (move.node, to)
            if move.missed or to in dead:
                scene.lost = pair
            else:
                scene.sent = pair
                scene.lost = pair[::-1] if move.deaf else ()
    return scene
