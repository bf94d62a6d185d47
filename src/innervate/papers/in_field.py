"""Jobs over a field: one world for all, and the figures that come of it, whoever does the job.

A job's case names a function of a network, "module:function", that draws the world of a seed: who
hears whom, who dies when, who sends what to whom. Networks that only declare their protocol run in
it by `run_declared`; one of its own loop runs as it likes, and says what came when.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field
from pkgutil import resolve_name
from typing import Any

import numpy as np

from innervate.analysis.percentiles import percentiles
from innervate.dialect.arith import MASK30
from innervate.network import networks
from innervate.papers.jobs import Given
from innervate.scenario import from_dict
from innervate.scenario import plan as plan_of
from innervate.scenario.actions.field import KILL
from innervate.scenario.cables import Input
from innervate.scenario.declared.field import Fault, Heard, sizes_of
from innervate.topology import placement

NEVER = -1
IN_A_ROW = 10  # messages that come, one after the other: then they come again
MONITOR = -1  # the recipient of an alarm: whoever is to know


@dataclass(frozen=True, slots=True)
class Sent:
    """A message that a node's user hands in; all of a world at different times."""

    at_us: int  # when
    source: int  # who sends
    dest: int  # who is to have it, MONITOR = the gateway, or who stands in for it
    part: str  # what it counts for


@dataclass(slots=True)
class World:
    """What is the same for all that do a job."""

    nodes: int  # how many
    # rssi_cdb, prob_q15: per sender and receiver, row after row: how loud, 0.01 dBm, and the chance
    # of reception where nothing disturbs, in 1/32768
    rssi_cdb: list[int]
    prob_q15: list[int]
    good: list[tuple[int, int]]  # links (a < b) that are good both ways
    # of the radio: byte_ns, phy_bytes, turnaround_us, sense_db, capture_db
    air: Mapping[str, float]
    gateway: int  # who is asked for, the root
    since_us: int  # from here on airtime counts
    duration_us: int  # of the run
    # (when, us, KILL or REVIVE, node), in order of time
    faults: list[tuple[int, int, int]] = field(default_factory=list)
    sent: list[Sent] = field(default_factory=list)  # messages, in order of time
    standby: int = NEVER  # who takes an alarm in its place, where a protocol can ask it to
    # of what parts it is asked when their messages come again: (from when, us, and until when they
    # must have come)
    again: dict[str, tuple[int, int]] = field(default_factory=dict)

    def on_at(self, at_us: int) -> set[int]:
        """Who is switched on at a time."""
        on = set(range(self.nodes))
        for when, action, node in self.faults:
            if when <= at_us:
                (on.discard if action == KILL else on.add)(node)
        return on

    def joined(self, at_us: int) -> list[set[int]]:
        """The parts of the network at a time: nodes that good links of live nodes join."""
        on = self.on_at(at_us)
        links = [(a, b) for a, b in self.good if a in on and b in on]
        parts = placement.components(placement.neighbours(self.nodes, links))
        return [on.intersection(part) for part in parts]

    def receivers(self, one: Sent) -> tuple[int, ...]:
        """Who a message is for, by number: one of them."""
        return (self.gateway, self.standby) if one.dest == MONITOR else (one.dest,)


def world_of(given: Given, seed: int) -> World:
    """The world that a case's function draws."""
    made: World = resolve_name(str(given["world"]))(given, seed)
    return made


def figures(world: World, came_us: list[int], airtime_us: int) -> dict[str, float | None]:
    """What an entry's run gave, by name.

    Of every part, by its name, the share that came, in percent, of the messages whose ends were
    joined by good links of live nodes, and what is left of 100 as "..._lost"; the latencies of all
    of them, ms; airtime of all nodes together, in percent of the time; "..._again_s", when messages
    of a part come again: IN_A_ROW of them come, and the first of those is there, None if never.

    Args:
        world: the world.
        came_us: per message, when it first came, NEVER if it did not.
        airtime_us: of all frames that began at `since_us` or later.
    """
    counted = _counted(world)
    parts: dict[str, list[bool]] = {}
    late = []
    for one, came, counts in zip(world.sent, came_us, counted, strict=True):
        if counts:
            parts.setdefault(one.part, []).append(came != NEVER)
        if counts and came != NEVER:
            late.append((came - one.at_us) / 1e3)
    found: dict[str, float | None] = {}
    for name, whole in parts.items():
        found[name] = 100 * sum(whole) / len(whole)
        found[f"{name}_lost"] = 100 - 100 * sum(whole) / len(whole)
    found["p50_ms"], found["p99_ms"] = percentiles(late, (50, 99), nearest=True)
    found["airtime"] = 100 * airtime_us / (world.duration_us - world.since_us)
    for name, span in world.again.items():
        of_part = [came for one, came, counts in zip(world.sent, came_us, counted, strict=True)
                   if counts and one.part == name]  # fmt: skip
        found[f"{name}_again_s"] = _again_s(of_part, *span)
    return found


def _again_s(came_us: list[int], since_us: int, until_us: int) -> float | None:
    row: list[int] = []
    for came in came_us:
        row = [*row, came] if NEVER < came < until_us else []
        if len(row) == IN_A_ROW:
            return (min(row) - since_us) / 1e6
    return None


def _counted(world: World) -> list[bool]:
    """Per message whether its ends are joined; a gateway that is off is joined to nobody."""
    times = sorted({0, *(at for at, _, _ in world.faults)})
    periods = [world.joined(at) for at in times]
    found = []
    for one in world.sent:
        period = sum(at <= one.at_us for at in times) - 1
        ends = {one.source, world.receivers(one)[0]}
        on = world.on_at(one.at_us)
        # Who asks for a monitor that has died asks in vain, and that counts.
        gone = one.dest == MONITOR and world.gateway not in on
        found.append(one.source in on and (gone or any(ends <= part for part in periods[period])))
    return found


def run_declared(
    kind: str, protocol: Mapping[str, int], inputs: Mapping[bool, Any], world: World
) -> dict[str, float | None]:
    """Run a kind of network that only declares its protocol in a world.

    `inputs` are (kind, item) of what a node is given for a message (False: the item gets `dest`),
    and for an alarm (True).
    """
    network = networks()[kind]
    plan = plan_in(kind, protocol, world)
    for one in world.sent:
        what, item = inputs[one.dest == MONITOR]
        dest = {} if one.dest == MONITOR else {"dest": one.dest}
        plan.inputs.append(Input(one.at_us, one.source, what, {**item, **dest}))
    sizes, air = sizes_of(network.frames), world.air
    most = max(sizes) + 1
    cost = np.array([(air["phy_bytes"] + sizes.get(k, 0)) * air["byte_ns"] // 1000
                     for k in range(most)], np.int64)  # fmt: skip
    spent = 0

    def tap(rows: Any, frames: Any, until_us: int) -> None:
        nonlocal spent
        out = (rows["out"] == 1) & (rows["time"] >= world.since_us)
        spent += int(cost[frames["kind"][out]].sum())

    running = network.simulation(plan, checks=False, observe=True, tap=True)
    rows = running.finish(None, tap).rows["deliveries"]
    return figures(world, _came(world, rows), spent)


def warm_up(kind: str) -> None:
    """Compile the loop of a network that only declares its protocol."""
    small = plan_of(from_dict({"kind": kind, "nodes": 2, "duration_s": 0.001}))
    networks()[kind].simulation(small, checks=False, tap=True).finish()


def plan_in(kind: str, protocol: Mapping[str, int], world: World) -> Any:
    """The plan of such a network in a world, without messages."""
    air = world.air
    radio = {"bits_per_s": round(8e9 / air["byte_ns"]), "preamble_bytes": int(air["phy_bytes"]),
             "turnaround_us": int(air["turnaround_us"]), "sense_db": air["sense_db"],
             "capture_db": air["capture_db"]}  # fmt: skip
    tables = {"kind": kind, "nodes": world.nodes, "duration_s": world.duration_us / 1e6,
              "air": radio, "protocol": dict(protocol)}  # fmt: skip
    plan = plan_of(from_dict(tables))
    plan.heard = Heard(world.rssi_cdb, world.prob_q15)
    plan.good = world.good
    plan.faults = [Fault(at, action, node) for at, action, node in world.faults]
    return plan


def _came(world: World, rows: Any) -> list[int]:
    """Per message when it first came to its recipient, by when it was handed in."""
    place = {one.at_us & MASK30: i for i, one in enumerate(world.sent)}
    assert len(place) == len(world.sent), "two messages at one time"
    came = [NEVER] * len(world.sent)
    for time, node, latency in zip(rows["time"].tolist(), rows["node"].tolist(),
                                   rows["latency"].tolist(), strict=True):  # fmt: skip
        i = place[(time - latency) & MASK30]
        if node in world.receivers(world.sent[i]) and came[i] == NEVER:
            came[i] = time
    return came
