"""A mesh's counterexample as a scenario: the simulator plays it with radios, times and all.

The story's order of events becomes times: messages are offered a few seconds apart, deaths come
between them. A frame or ack that the story loses is lost by cutting its link for as long as it is
on the air; when that is, a run with all losses before it tells. Seeds are tried until random
choices fall as the story has them.
"""

from dataclasses import dataclass
from typing import Any

from innervate import scenario as scenarios
from innervate.networks.mesh.protocol import constants as const
from innervate.networks.mesh.sim.simulate import simulate
from innervate.networks.mesh.verify import model as mesh_model
from innervate.networks.mesh.verify import net as mesh_net
from innervate.networks.mesh.verify.story import MeshStory, ring
from innervate.sim.tables import get

FIRST_S = 12.0  # tables are in force, the next round is far
APART_S = 2.0
MORE = 40  # messages after the story's, to show that it goes on
SEEDS = 40


@dataclass(frozen=True, slots=True)
class Loss:
    """A frame or ack of the story that is lost."""

    offer: int  # after so many messages were offered
    # sender, to: who sent it, who should have received it
    sender: int
    to: int
    kind: int  # its type
    nth: int  # so many like it went out before, since that message


def write(story: MeshStory) -> str:
    """A scenario that closes the same loop; "" if no seed does, or there is none to close."""
    if not story.ring or story.found.model.robot >= 0:
        return ""
    for seed in range(1, SEEDS + 1):
        text = _timed(story, seed)
        if text and loop_of(text, story.dest) == sorted(story.ring):
            return "".join(f"# {line}\n" for line in story.lines()) + text
    return ""


def loop_of(text: str, dest: int) -> list[int]:
    """Two nodes that are each other's next hop to `dest` when a scenario ends, or nothing."""
    result = simulate(scenarios.plan(scenarios.loads(text)))
    width = result.plan.params["width"]
    hops = []
    for node in range(result.plan.nodes):
        table, bank = get(result.world.nodes, node, "next"), get(result.world.nodes, node, "bank")
        hops.append(int(table[int(bank) * width + dest]))
    return sorted(ring(hops))


def _timed(story: MeshStory, seed: int) -> str:
    """The scenario with every loss at its time; "" if a frame of the story is never sent."""
    events = _deaths(story)
    for loss in _losses(story):
        rows = _transmissions(_text(story, seed, events), loss)
        if len(rows) <= loss.nth:
            return ""
        start, end = rows[loss.nth]
        link = f"link = [{min(loss.sender, loss.to)}, {max(loss.sender, loss.to)}]"
        events.append((start - 1, f'action = "cut"\n{link}'))
        events.append((end + 1, f'action = "restore"\n{link}'))
    return _text(story, seed, events)


def _transmissions(text: str, loss: Loss) -> list[tuple[int, int]]:
    """(start, end) in us of all frames like the lost one, after its message was offered."""
    sent = simulate(scenarios.plan(scenarios.loads(text))).sent
    since = (FIRST_S + APART_S * (loss.offer - 1)) * 1e6
    like = (sent["node"] == loss.sender) & (sent["link_dst"] == loss.to)
    like &= (sent["kind"] == loss.kind) & (sent["time"] >= since)
    return [(int(row["time"]), int(row["end"])) for row in sent[like]]


def _losses(story: MeshStory) -> list[Loss]:
    """The story's losses, in order."""
    found: list[Loss] = []
    offer, seen = 0, dict[Any, int]()
    packets = story.found.nets.locals.packets
    for move, _, _ in story.found.path:
        if move.kind == mesh_net.OFFER:
            offer, seen = offer + 1, {}
        if move.kind != mesh_net.AIR:
            continue
        packet = packets[move.frame]
        ways = [(move.node, packet.link_dst, packet.kind)]
        if packet.flags & const.ACK_WANTED and not move.missed:
            ways.append((packet.link_dst, move.node, const.ACK))
        for way in ways:
            nth = seen.get(way, 0)
            seen[way] = nth + 1
            is_lost = move.deaf if way[2] == const.ACK else way[1] in move.missed
            if is_lost:
                found.append(Loss(offer, *way, nth))
    return found


def _deaths(story: MeshStory) -> list[tuple[int, str]]:
    """When nodes die: halfway between the messages before and after."""
    found, offer = [], 0
    for move, _, _ in story.found.path:
        offer += move.kind == mesh_net.OFFER
        if move.kind == mesh_net.DIE:
            at = round((FIRST_S + APART_S * (offer - 0.5)) * 1e6)
            found.append((at, f'action = "kill"\nnode = {move.node}'))
    return found


def _text(story: MeshStory, seed: int, events: list[tuple[int, str]]) -> str:
    model = story.found.model
    last = len(model.offers) - 1
    flows = [
        {"from": node, "to": dest, "start_s": FIRST_S + APART_S * place, "every_s": APART_S,
         "count": MORE if place == last else 1, "bytes": 1, "reliable": model.reliable}
        for place, (node, dest) in enumerate(model.offers)
    ]  # fmt: skip
    end_s = FIRST_S + APART_S * (len(model.offers) + MORE) + 10.0
    text = mesh_model.scenario_text(model, "counterexample", end_s, seed, flow=flows)
    for at_us, what in sorted(events):
        text += f"\n[[event]]\nat_s = {at_us / 1e6:.6f}\n{what}\n"
    return text
