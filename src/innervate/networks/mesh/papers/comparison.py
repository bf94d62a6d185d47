"""The mesh's job beside other protocols: messages between any two, deaths, alarms, a dead root."""

from collections.abc import Iterator
from functools import partial
from typing import Any, NamedTuple

from innervate.networks.mesh.analysis.messages import NEVER as LOST
from innervate.networks.mesh.analysis.messages import messages
from innervate.networks.mesh.papers import testbed as beds
from innervate.networks.mesh.papers.testbed import GRAPH, HOPS, LITERAL, MeshTestbed, Options
from innervate.networks.mesh.protocol.constants import MONITOR, PRIORITY
from innervate.networks.mesh.scenario.plan import MeshFault, Offer
from innervate.networks.mesh.sim.simulate import simulate
from innervate.papers import in_field, jobs
from innervate.papers.experiment import Claim
from innervate.papers.in_field import NEVER, Sent, World
from innervate.papers.jobs import Case, Column, Compared, Entry, Given, Job, Words
from innervate.scenario.actions.field import KILL, REVIVE
from innervate.trace.streams import stream

HERE = f"{__name__}:world"
GATEWAY = beds.GATEWAY
FIRST, LATER, PEERS, ALARMS, AFTER = "first", "later", "peers", "alarms", "after"
BEGIN_US = 20_000_000  # all protocols know their ways
GAP_US = 100_000  # from message to message of all nodes
END_US = 3_000_000
OUTAGE_US = 40_000_000
SOON_US = 1
STANDBY = 1


def plan_of(given: Given, seed: int, protocol: Options = (), more: Options = ()) -> Any:
    """The mesh of a case, in which nobody sends and nobody dies."""
    seconds = (BEGIN_US + _lasts_us(given) + END_US) / 1e6
    testbed = MeshTestbed(nodes=given["nodes"], protocol=protocol, duration_s=seconds, more=more)
    return testbed.plan(seed)


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
        back_us = BEGIN_US + OUTAGE_US
        made.faults = [(BEGIN_US, KILL, GATEWAY), (back_us, REVIVE, GATEWAY)]
        made.sent = _through_an_outage(made, seed)
        made.standby = STANDBY
        made.again = {PEERS: (BEGIN_US, back_us), ALARMS: (BEGIN_US, back_us),
                      AFTER: (back_us, plan.duration_us)}  # fmt: skip
    else:
        gone = beds.dying(plan, given["dead"])
        since_us = SOON_US if given.get("known") else BEGIN_US
        made.faults = [(since_us, KILL, node) for node in gone]
        made.sent = [] if given.get("silent") else _rounds(made, seed, gone, given)
    return made


def _rounds(made: World, seed: int, gone: list[int], given: Given) -> list[Sent]:
    """In each round every live node writes to another one, always the same; or raises an alarm."""
    to = beds.correspondents(seed, [node for node in range(made.nodes) if node not in gone])
    span = made.nodes * GAP_US
    if given.get("alarms"):
        to = dict.fromkeys((node for node in to if node != GATEWAY), in_field.MONITOR)
    return [Sent(BEGIN_US + k * span + i * GAP_US + 1, node, to[node], LATER if k else FIRST)
            for k in range(given["rounds"]) for i, node in enumerate(to)]  # fmt: skip


def _through_an_outage(made: World, seed: int) -> list[Sent]:
    """By turns a message to another node, and an alarm, of a node that is drawn."""
    draw = stream(seed, "papers/senders")
    found = []
    for at in range(BEGIN_US, made.duration_us - END_US, GAP_US):
        source = 1 + STANDBY + draw.draw(made.nodes - 1 - STANDBY)
        other = 1 + draw.draw(made.nodes - 2)
        other += other >= source
        is_out = at < BEGIN_US + OUTAGE_US
        if (at // GAP_US) % 2:
            found.append(Sent(at + 1, source, in_field.MONITOR, ALARMS if is_out else AFTER))
        else:
            found.append(Sent(at + 1, source, other, PEERS if is_out else "peers after"))
    return found


def planned(protocol: Options, more: Options, given: Given, seed: int) -> tuple[World, Any]:
    """A world, and the plan of a mesh in it."""
    made = world(given, seed)
    plan = plan_of(given, seed, protocol, more)
    assert plan.radio.rssi_cdb == made.rssi_cdb
    flags = beds.flags(plan)
    plan.faults = [MeshFault(at, action, node, 0, 0, i)
                   for i, (at, action, node) in enumerate(made.faults)]  # fmt: skip
    plan.offers = [_offer(one, flags) for one in made.sent]
    return made, plan


def measure(protocol: Options, more: Options, given: Given, seed: int) -> dict[str, Any]:
    """One run of a mesh."""
    made, plan = planned(protocol, more, given, seed)
    result = simulate(plan, checks=False)
    came = []
    if made.sent:
        found = messages(result)
        came = [NEVER if at == LOST else at for at in found.delivered_us.tolist()]
        assert found.offered_us.tolist() == [one.at_us for one in made.sent]
    sent = result.sent[result.sent["time"] >= made.since_us]
    return in_field.figures(made, came, int((sent["end"] - sent["time"]).sum()))


def _offer(one: Sent, flags: int) -> Offer:
    if one.dest == in_field.MONITOR:
        return Offer(one.at_us, one.source, MONITOR, flags | PRIORITY, beds.BYTES, 0)
    return Offer(one.at_us, one.source, one.dest, flags, beds.BYTES, 0)


def warm_up() -> None:
    """Compile the loop of up to 32 nodes; the others are when they are first wanted."""
    simulate(MeshTestbed(duration_s=0.001).plan(1), checks=False)


def cases(quick: bool) -> list[Case]:
    """Deaths, sizes, alarms, a dead root."""
    few = range(1, 4 if quick else 61)
    made = [_messages(nodes, dead, few if quick else range(1, seeds + 1))
            for nodes, dead, seeds in (QUICK if quick else SIZES)]  # fmt: skip
    if not quick:
        made += [
            _case("known", "30 nodes, 8 dead since they were switched on", few, MESSAGES, nodes=30,
                  dead=8, known=1),
            _case("silent", "30 nodes, nobody writes", few, TIMES[-1:], nodes=30, dead=0, silent=1),
        ]  # fmt: skip
    made.append(_case("alarms", "alarms of all, 30 nodes, 8 dead", few, RAISED, nodes=30, dead=8,
                      rounds=1, alarms=1))  # fmt: skip
    made.append(_case("root", "30 nodes, the root off for 40 s, then 37 s more", few, OUTAGE,
                      nodes=30, root=1))  # fmt: skip
    return made


def _messages(nodes: int, dead: int, seeds: range) -> Case:
    title = f"{nodes} nodes, {f'{dead} dead' if dead else 'nobody dies'}"
    return _case(title, title, seeds, MESSAGES, nodes=nodes, dead=dead)


def _case(name: str, title: str, seeds: range, columns: tuple[Column, ...], **given: Any) -> Case:
    return Case(name, title, {"world": HERE, "rounds": 2, **given}, seeds, columns)


TIMES = (
    Column("latency, half within (ms)", "p50_ms", jobs.MEDIAN),
    Column("99 % within (ms)", "p99_ms", jobs.MEDIAN),
    Column("airtime of all (% of the time)", "airtime", jobs.MEAN),
)
MESSAGES = (
    Column("first messages delivered (%)", FIRST, jobs.PERCENT),
    Column("second ones (%)", LATER, jobs.PERCENT),
    *TIMES,
)
RAISED = (Column("alarms at the monitor (%)", FIRST, jobs.PERCENT), *TIMES)
OUTAGE = (
    Column("others' messages meanwhile (%)", PEERS, jobs.PERCENT),
    Column("again after (s)", f"{PEERS}_again_s", jobs.MEDIAN),
    Column("alarms meanwhile (%)", ALARMS, jobs.PERCENT),
    Column("alarms again after (s)", f"{ALARMS}_again_s", jobs.MEDIAN),
    Column("others' messages afterwards (%)", "peers after", jobs.PERCENT),
    Column("alarms afterwards (%)", AFTER, jobs.PERCENT),
    Column("again, from its return (s)", f"{AFTER}_again_s", jobs.MEDIAN),
    TIMES[-1],
)
# Nodes, dead, seeds.
SIZES = (
    (30, 0, 60), (30, 4, 60), (30, 8, 60), (10, 0, 60), (10, 4, 60), (100, 0, 20), (100, 8, 20),
    (254, 0, 5), (254, 8, 5),
)  # fmt: skip
QUICK = ((30, 0, 3), (30, 8, 3), (10, 0, 3))
GRAPH_NODES = 145  # that a flooded graph has room for


class Fewer(NamedTuple):
    """What a mesh is claimed to have less of than another, in a case; why it has not, if so."""

    case: str
    name: str
    other: str
    claim: str
    why: str = ""
    ours: str = "mesh"


FLOOD, TREE, STOOD = "flooding, 7 hops", "RPL, storing", "mesh, standby"
CALM, DEAD = "30 nodes, nobody dies", "30 nodes, 8 dead"
MANY, MOST = "100 nodes, 8 dead", "254 nodes, 8 dead"
CLAIMS = (
    Fewer(DEAD, f"{FIRST}_lost", "the document",
          "fewer first messages are lost than by the document's own rules"),
    Fewer(DEAD, f"{FIRST}_lost", TREE, "fewer first messages are lost than by RPL"),
    Fewer(DEAD, f"{FIRST}_lost", FLOOD, "fewer first messages are lost than by flooding",
          "a reading: a flood goes round the dead without knowing of them; in most runs there is "
          "no difference"),
    Fewer(DEAD, "p99_ms", FLOOD, "99 % come sooner than by flooding",
          "measured: with the same eight dead since they were switched on it is less than a third "
          "of that; who is dead is found out by three transmissions without an answer, hop by hop, "
          "and a flood needs not know"),
    Fewer(CALM, "airtime", FLOOD, "less airtime than flooding, nobody dies"),
    Fewer(DEAD, "airtime", FLOOD, "less airtime than flooding, 8 of 30 die",
          "measured: with the same eight dead since they were switched on it is less than half of "
          "a flood's; a message that meets a dead node is sent in vain, and searches for a way"),
    Fewer(CALM, "airtime", TREE, "less airtime than RPL",
          "measured: without acknowledgements from end to end, which RPL has not, it is as RPL's; "
          "and while nobody writes the mesh's tables take more than RPL's tree"),
    Fewer("root", f"{PEERS}_lost", TREE,
          "fewer messages among others are lost than by RPL while the root is off"),
    Fewer("root", f"{AFTER}_lost", TREE, "fewer alarms are lost than by RPL when it is back",
          "measured: they come again some seconds later; a gateway that was off asks its "
          "neighbours at a beat and leads at the next, RPL's root says at once that it is there"),
    Fewer("root", f"{ALARMS}_again_s", TREE,
          "with a standby alarms come again sooner than by RPL while the root is off", "", STOOD),
    Fewer("root", f"{ALARMS}_again_s", FLOOD,
          "with a standby alarms come again sooner than by flooding while the root is off",
          "measured: a standby asks the gateway four times in vain before it leads, which takes a "
          "second; a flooded alarm is for all",
          STOOD),
    Fewer(MANY, f"{FIRST}_lost", TREE, "fewer first messages are lost than by RPL, 100 nodes"),
    Fewer(MANY, f"{FIRST}_lost", FLOOD,
          "fewer first messages are lost than by flooding, 100 nodes",
          "measured: in many runs there is no difference"),
    Fewer(MANY, "airtime", FLOOD, "less airtime than flooding, 100 nodes"),
    Fewer(MOST, f"{FIRST}_lost", FLOOD,
          "fewer first messages are lost than by flooding, 254 nodes",
          "measured: messages begin, and eight die, 20 s after the start, while tables go out; "
          "after 74 s 137 to 249 nodes have theirs (with nobody dead all, after 43 to 63 s), and "
          "others' messages search, or go up to the gateway"),
)  # fmt: skip


def judge(compared: Compared) -> Iterator[Claim]:
    """What is better here, and what is not."""
    cases = {case.name: case for case in compared.cases()}
    for one in CLAIMS:
        if one.case not in cases:  # of the full size
            continue
        where, words = {one.case: cases[one.case]}, Words(one.claim, one.why)
        yield compared.less(where, one.name, (one.ours, one.other), words)


SEARCH: Options = ()
STOOD_BY: Options = (("standby", [STANDBY]),)


def _fits(given: Given) -> bool:
    return bool(given["nodes"] <= GRAPH_NODES)


def _has_outage(given: Given) -> bool:
    return "root" in given


def _shows_why(given: Given) -> bool:
    return given["nodes"] == 30 and not {"root", "alarms", "silent"} & set(given)


JOBS = (
    Job("mesh", "Messages over several hops",
        "Nodes anywhere in a square, a mean of 8 good links each, 250 kbit/s; 20 s after "
        "they were switched on nodes die that nobody knows of, and then every live node writes 16 "
        "bytes to another, ten messages a second altogether, twice.",
        cases, judge, ("p99_ms", "99 % within (ms)")),
)  # fmt: skip
ENTRIES = (
    Entry("mesh", "mesh", "this mesh as it is set: tables, then search along the path trace; "
          "messages are acknowledged from end to end; an alarm is such a message with priority",
          partial(measure, SEARCH, ()), warm_up, 0.3),
    Entry("mesh", "mesh, graph", 'the same with failover = "graph": every node has the whole graph',
          partial(measure, GRAPH, ()), warm_up, 0.3, _fits),
    Entry("mesh", STOOD, "the first with node 1 standing by for the gateway",
          partial(measure, SEARCH, STOOD_BY), warm_up, 0.3, _has_outage),
    Entry("mesh", "mesh, hops only", "the first without acknowledgements from end to end",
          partial(measure, HOPS, ()), warm_up, 0.3, _shows_why),
    Entry("mesh", "the document", "the mesh's document to the letter: one transmission, a random "
          "neighbour for the next packet, nothing from end to end",
          partial(measure, LITERAL, ()), warm_up, 0.3),
)  # fmt: skip
