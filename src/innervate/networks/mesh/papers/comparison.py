"""The mesh's job beside other protocols: messages between any two, deaths, alarms, a dead root."""

from __future__ import annotations

from functools import partial
from typing import Any

from innervate.networks.mesh.analysis.messages import NEVER as LOST
from innervate.networks.mesh.analysis.messages import messages
from innervate.networks.mesh.papers import testbed as beds
from innervate.networks.mesh.papers.testbed import LITERAL, MeshTestbed, Options
from innervate.networks.mesh.protocol.constants import END_TO_END, MONITOR
from innervate.networks.mesh.scenario.plan import MeshFault, Offer
from innervate.networks.mesh.sim.simulate import simulate
from innervate.papers import in_field
from innervate.papers.in_field import KILL, NEVER, REVIVE, Sent, World
from innervate.papers.jobs import Entry, Given
from innervate.trace.streams import stream

HERE = f"{__name__}:world"
GATEWAY = beds.GATEWAY
FIRST, LATER, PEERS, ALARMS, AFTER = "first", "later", "peers", "alarms", "after"
BEGIN_US = 20_000_000  # all protocols know their ways
GAP_US = 100_000  # from message to message of all nodes
END_US = 3_000_000
OUTAGE_US = 40_000_000
STANDBY = 1


def plan_of(given: Given, seed: int, protocol: Options = (), more: Options = ()) -> Any:
    """The mesh of a case, in which nobody sends and nobody dies."""
    seconds = (BEGIN_US + _lasts_us(given) + END_US) / 1e6
    bed = MeshTestbed(nodes=given["nodes"], protocol=protocol, duration_s=seconds, more=more)
    return bed.plan(seed)


def _lasts_us(given: Given) -> int:
    if given.get("root"):
        return 2 * OUTAGE_US
    return int(given["rounds"]) * int(given["nodes"]) * GAP_US


def world(given: Given, seed: int) -> World:
    """Who hears whom, who dies and who sends, in a case."""
    plan = plan_of(given, seed)
    radio = plan.radio
    air = {"byte_ns": radio.byte_ns, "phy_bytes": radio.phy_bytes,
           "turnaround_us": radio.turnaround_us, "capture_db": radio.capture_cdb / 100,
           "sense_db": (radio.rssi50_cdb - radio.sense_cdb) / 100}  # fmt: skip
    made = World(plan.nodes, radio.rssi_cdb, radio.prob_q15, plan.good, air, GATEWAY, BEGIN_US,
                 plan.duration_us)  # fmt: skip
    if given.get("root"):
        made.faults = [(BEGIN_US, KILL, GATEWAY), (BEGIN_US + OUTAGE_US, REVIVE, GATEWAY)]
        made.sent = _through_an_outage(made, seed)
    else:
        gone = beds.dying(plan, given["dead"])
        made.faults = [(BEGIN_US, KILL, node) for node in gone]
        made.sent = _rounds(made, seed, gone, given["rounds"])
    return made


def _rounds(made: World, seed: int, gone: list[int], rounds: int) -> list[Sent]:
    """Each live node writes to another one, always the same, in each round."""
    draw = stream(seed, "papers/senders")
    alive = [node for node in range(made.nodes) if node not in gone]
    left = list(alive)
    order = [left.pop(draw.draw(len(left))) for _ in alive]
    to = {node: [one for one in alive if one != node][draw.draw(len(alive) - 1)] for node in order}
    span = made.nodes * GAP_US
    return [Sent(BEGIN_US + k * span + i * GAP_US + 1, node, to[node], LATER if k else FIRST)
            for k in range(rounds) for i, node in enumerate(order)]  # fmt: skip


def _through_an_outage(made: World, seed: int) -> list[Sent]:
    """By turns a message to another node, and an alarm, of a node that is drawn."""
    draw = stream(seed, "papers/senders")
    found = []
    for at in range(BEGIN_US, made.duration_us - END_US, GAP_US):
        source = 1 + draw.draw(made.nodes - 1)
        other = 1 + draw.draw(made.nodes - 2)
        other += other >= source
        is_out = at < BEGIN_US + OUTAGE_US
        if (at // GAP_US) % 2:
            found.append(Sent(at + 1, source, in_field.MONITOR, ALARMS if is_out else AFTER))
        else:
            found.append(Sent(at + 1, source, other, PEERS if is_out else "peers after"))
    return found


def measure(protocol: Options, more: Options, given: Given, seed: int) -> dict[str, Any]:
    """One run of a mesh."""
    made = world(given, seed)
    plan = plan_of(given, seed, protocol, more)
    assert plan.radio.rssi_cdb == made.rssi_cdb
    flags = END_TO_END if plan.params["reliable"] else 0
    plan.faults = [MeshFault(at, action, node, 0, 0, i)
                   for i, (at, action, node) in enumerate(made.faults)]  # fmt: skip
    plan.offers = [
        Offer(one.at_us, one.source, MONITOR if one.dest == in_field.MONITOR else one.dest, flags,
              beds.BYTES, 0) for one in made.sent
    ]  # fmt: skip
    result = simulate(plan, checks=False)
    found = messages(result)
    came = [NEVER if at == LOST else at for at in found.delivered_us.tolist()]
    assert found.offered_us.tolist() == [one.at_us for one in made.sent]
    sent = result.sent[result.sent["time"] >= made.since_us]
    return in_field.figures(made, came, int((sent["end"] - sent["time"]).sum()))


def warm_up() -> None:
    """Compile the loop."""
    for nodes in (10, 50, 100):
        simulate(MeshTestbed(nodes=nodes, duration_s=0.001).plan(1), checks=False)


SEARCH: Options = ()
GRAPH: Options = (("failover", "graph"),)
ENTRIES = (
    Entry("mesh", "mesh", "this mesh as it is set: tables, then search along the path trace",
          partial(measure, SEARCH, ()), warm_up, 0.3),
    Entry("mesh", "mesh, graph", 'the same with failover = "graph": every node has the whole graph',
          partial(measure, GRAPH, ()), warm_up, 0.3),
    Entry("mesh", "the document", "the mesh's document to the letter: one transmission, a random "
          "neighbour for the next packet, nothing from end to end",
          partial(measure, LITERAL, ()), warm_up, 0.3),
)  # fmt: skip
