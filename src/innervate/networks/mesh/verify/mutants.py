"""The mesh's explorer can fail: copies of the router with a small mistake in each."""

from collections.abc import Iterator

from innervate.networks.mesh.verify import local as mesh_local
from innervate.networks.mesh.verify import model as mesh_model
from innervate.networks.mesh.verify import search as mesh_search
from innervate.networks.mesh.verify import story as mesh_story
from innervate.networks.mesh.verify.model import ASKED, QUICK, SHORT, MeshBudget, MeshModel, text_of
from innervate.networks.mesh.verify.net import Nets
from innervate.prove.mutants import Mutant, planted
from innervate.verify.cases import Catch

STATES = 5_000
WANTED = (*SHORT, ("tables", False), ("on_demand", True))  # ways are not known, but found

MUTANTS = planted(
    ("nobody acknowledges a hop",
     "    if frame.flags & ACK_WANTED:\n        acknowledge(node, params, frame, out)\n", ""),
    ("a hop's ack is ignored", "                close(node, params, i)\n                return i\n",
     "                return -1\n"),
    ("a packet for us is taken for somebody else's",
     "    here = frame.dest == node.number\n", "    here = frame.dest == node.number + 1\n"),
    ("a message is kept under another number",
     "    node.wait_seq[w] = node.q_seq[i]\n", "    node.wait_seq[w] = node.q_seq[i] ^ 1\n"),
    ("what is due waits", "WAITS and after(now, node.q_due[i]):",
     "WAITS and not after(now, node.q_due[i]):"),
    ("nobody waits for a hop's ack",
     "        set_timer(out, ACK_WAIT, (now + wait) & MASK30)\n", ""),
    ("a packet that was delivered is delivered again",
     "    if ahead == 0:\n        return 0\n", "    if ahead == 0:\n        return 1\n"),
    ("the window begins anew with every packet",
     "    if node.idle[origin] == 0:\n", "    if node.idle[origin] >= 0:\n"),
    ("what is behind the newest is new", "    if node.window[word] & bit:\n        return 0\n", ""),
    ("a flood is passed on each time",
     "    note_forwarded(node, -1, origin, seq, kind | (instance << 6), ALL, 0)\n", ""),
    ("who is looked for takes nothing",
     "    if frame.dest == node.number:\n        take(node", "    if 0:\n        take(node"),
    ("a standby never takes over", "if node.quiet >= silence or node.gateway == node.number:",
     "if node.quiet >= 60_000:"),
    ("a gateway does not answer who asks it",
     "    if node.leading:\n        if version != gate.version:\n            index = 0\n",
     "    if node.leading > 1:\n        if version != gate.version:\n            index = 0\n"),
    ("who follows another leads on",
     "    if gateway != node.number:\n        node.leading = 0\n", ""),
    ("a retry is never due", "        set_timer(out, RETRY, (now + soonest) & MASK30)\n",
     "        return\n"),
    ("a frame whose hop failed stays where it is",
     "UNACKED:\n        return\n    node.busy = -1\n", "UNACKED:\n        return\n"),
)  # fmt: skip


def models() -> Iterator[MeshModel]:
    """What each mutant is tried on, smallest first."""
    line, square = mesh_model.parse("line"), mesh_model.parse("square")
    calm, death = MeshBudget(0, 0, 0, 0), MeshBudget(1, 0, 0, 0)
    ack, frame = MeshBudget(0, 0, 0, 1), MeshBudget(0, 0, 1, 0)
    twice = (("e2e_tries", 1), ("transmissions", 2))
    yield MeshModel(line, offers=((2, 0),), budget=ack, settings=SHORT)
    yield MeshModel(line, offers=((2, 0),), budget=frame, settings=twice)
    yield MeshModel(mesh_model.parse("0-1 1-2 2-3"), offers=((3, 1),), budget=calm, settings=WANTED)
    yield MeshModel(square, offers=((3, 0),), budget=death, settings=SHORT)
    yield MeshModel(line, robot=2, budget=calm, settings=SHORT)
    yield MeshModel(line, offers=((2, 0), (2, 0)), budget=calm, settings=twice)
    yield MeshModel(line, standby=(2,), beats=4, budget=MeshBudget(1, 1, 0, 0), settings=QUICK)
    yield MeshModel(line, standby=(2,), beats=3, budget=calm, settings=ASKED)


def hunt(mutant: Mutant) -> Catch:
    """Try a mutant on all models until something is broken."""
    (entry,) = mutant.copies("innervate.networks.mesh.protocol.node")
    states = 0
    for model in models():
        what = "gateways" if model.beats else "an alarm" if model.robot >= 0 else "messages"
        where = f"{text_of(model.links)}, {model.failover}, {what}"
        nets = Nets(model, mesh_local.Locals(model, entry))
        found = mesh_search.explore(model, nets=nets, states=STATES)
        states += found.tally.states
        if found.broken:
            return Catch(mutant, mesh_story.tell(found).title, where, states)
    return Catch(mutant, "", "", states)
