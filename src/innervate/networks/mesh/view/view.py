"""What a simulated mesh looks like: the map, routes, alarms, robots and fence."""

from dataclasses import dataclass, field
from typing import Any, ClassVar

import numpy as np

from innervate.analysis.headline import Headline
from innervate.kernel.words import number_of
from innervate.networks.mesh.analysis.headline import headline
from innervate.networks.mesh.analysis.reach import Ways, of_simulation
from innervate.networks.mesh.plot.words import fault_words
from innervate.networks.mesh.protocol import constants as c
from innervate.networks.mesh.scenario.plan import MeshFault
from innervate.networks.mesh.sim.build import MACS
from innervate.networks.mesh.view.recorder import TrafficRecorder
from innervate.networks.mesh.view.scene import Field
from innervate.scenario.actions.field import CUT, KILL, RESTORE, REVIVE, TABLE
from innervate.sim.field.states import ALIVE, DEAD, OFF, ON_AIR
from innervate.topology.placement import neighbours
from innervate.web.engine import Engine, Rows
from innervate.web.errors import Refused
from innervate.web.field_view import cut_of
from innervate.web.history import History
from innervate.web.messages import number
from innervate.web.view import Memory, View

KINDS = {
    c.REQUEST: "request", c.RESPONSE: "response", c.TABLE: "table", c.TABLE_ACK: "ack",
    c.ACTIVATE: "table", c.GRAPH: "table", c.DATA: "data", c.E2E_ACK: "ack", c.ACK: "ack",
    c.ALARM: "alarm", c.POSITION: "beacon",
}  # fmt: skip
ALARMS = {c.PREDICT: "is about to cross", c.CROSS: "has crossed the fence", c.LOST: "is lost",
          c.CLEAR: "is inside again"}  # fmt: skip
SMOOTH = 0.3  # share of a new value in a load
MESSAGES_MAX = 4_096
FLIGHTS_MAX = 2_000


@dataclass(slots=True)
class MeshMemory(Memory):
    """Besides: airtime and latencies since the last point, messages and alarms under way."""

    air_us: Any = None
    load: Any = None
    since_us: int = 0
    latency_us: list[int] = field(default_factory=list)
    messages: dict[tuple[int, int], int] = field(default_factory=dict)
    alarms: dict[tuple[int, int], int] = field(default_factory=dict)


class MeshView(View):
    """Nodes where they are; links are those that were good at the start, and robots' to all."""

    speed: ClassVar[float] = 1.0
    slow: ClassVar[float] = 0.2
    actions = TABLE
    fault_type = MeshFault
    check_us: ClassVar[int] = 10_000

    def __init__(self, engine: Engine, history: History) -> None:
        super().__init__(engine, history)
        self.field = Field(self.plan)
        count = self.plan.nodes
        self.memory = MeshMemory(air_us=np.zeros(count), load=np.zeros(count))
        self.neighbours = neighbours(count, self.plan.good)
        self.recorder = TrafficRecorder(engine)
        self._found: tuple[int, Ways] | None = None
        if self.plan.mac not in MACS:  # a channel on which everybody hears everybody
            self.can = ("kill", "revive")

    def scene(self) -> dict[str, Any]:
        """Nodes, links and what else stands still."""
        series = [
            {"id": "unconnected", "label": "nodes without a way", "unit": "nodes"},
            {"id": "latency", "label": "latency of messages", "unit": "ms"},
            {"id": "airtime", "label": "time on the air, all nodes", "unit": "%"},
        ]
        return {**self.field.scene(), "series": series}

    def note(self, rows: Rows) -> None:
        """Take in what happened since the last call."""
        memory, sent = self.memory, rows["sent"]
        self.recorder.add(rows)
        np.add.at(memory.air_us, sent["node"], sent["end"] - sent["time"])
        if self.tell_faults():
            self.check()
        came = rows["delivered"]
        alarms = came[came["kind"] == c.ALARM]
        told: list[tuple[int, int, Any, Any]] = [
            *((row[0], 0, self._report, row) for row in rows["rows"].tolist()),
            *((row[0], 1, self._alarm_came, row)
              for row in alarms[["time", "body0", "body3"]].tolist()),
        ]  # fmt: skip
        for _, _, note, row in sorted(told, key=lambda one: one[:2]):
            note(*row)
        for row in came[(came["kind"] == c.DATA) & (came["dest"] != c.ALL)]:
            accepted = memory.messages.pop((int(row["origin"]), int(row["seq"])), None)
            if accepted is not None:
                memory.latency_us.append(int(row["time"]) - accepted)

    def _report(self, at: int, node: int, code: int, a: int, b: int) -> None:
        memory, log, name = self.memory, self.log, self.plan.names
        if code == c.REPORT_ACCEPTED:
            memory.messages[node, b] = at
            if len(memory.messages) > MESSAGES_MAX:
                del memory.messages[next(iter(memory.messages))]
        elif code == c.REPORT_SUSPECT:
            self._suspect(at, node, a)
        elif code == c.REPORT_GATEWAY and a == node:
            log.say(at, f"{name[node]} leads as gateway")
        elif code == c.REPORT_TABLES:
            lack = f"{number_of(b, 'node')} {'has' if b == 1 else 'have'} none"
            missing = f", but {lack}" if b else ""
            log.say(at, f"tables are out{missing}", "bad" if b else "info")
        elif code == c.REPORT_EXPIRED:
            log.often("expired", at, f"{name[node]} gave a message up", "bad")
        elif code == c.REPORT_ALARM:
            memory.alarms.setdefault((b, a), at)
            who = "" if node == b else f", says {name[node]}"
            log.often(f"alarm {b}", at, f"robot {name[b]} {ALARMS.get(a, 'raised an alarm')}{who}",
                      "good" if a == c.CLEAR else "bad")  # fmt: skip

    def _suspect(self, at_us: int, node: int, near: int) -> None:
        recovery, fault = self.memory.recovery, self.memory.fault
        name = self.plan.names
        if recovery is not None and recovery.detected_ms is None and at_us >= recovery.at_us:
            pair = {fault.node, fault.other} if fault.action == CUT else {fault.node}
            hit = pair == {node, near} if fault.action == CUT else near in pair
            if hit and fault.action in (CUT, KILL):
                recovery.detected_ms = (at_us - fault.at_us) / 1e3
        self.log.often("suspect", at_us, f"{name[near]} does not answer {name[node]}")

    def _alarm_came(self, at_us: int, robot: int, kind: int) -> None:
        raised = self.memory.alarms.pop((robot, kind), None)
        if raised is not None and kind != c.CLEAR:
            text = f"alarm of robot {self.plan.names[robot]} at the monitor after"
            text += f" {(at_us - raised) / 1e3:.1f} ms"
            self.log.often(f"came {robot}", at_us, text, "good")

    def check(self) -> None:
        """Look whether the network has got over the newest fault."""
        recovery = self.memory.recovery
        if recovery is None or recovery.recovered_ms is not None:
            return
        recovery.cut_off(self.apart())
        recovery.nobody = not self._ways().served.any()
        if recovery.nobody or self._lacking():
            return
        after_us = self.engine.now_us - recovery.at_us
        kept = after_us <= 1
        recovery.recovered_ms = 0.0 if kept else after_us / 1e3
        if not kept:
            text = f"all nodes have a way to the gateway again after {int(after_us / 1e3 + 0.5)} ms"
            self.log.say(self.engine.now_us, text, "good")

    def apart(self) -> int:
        """Nodes that no links join with a gateway now."""
        return int(np.count_nonzero(self._ways().cut_off))

    def _ways(self) -> Ways:
        """Who reaches a gateway now."""
        if self._found is None or self._found[0] != self.engine.now_us:
            self._found = self.engine.now_us, of_simulation(self.engine.world, self.plan)
        return self._found[1]

    def _lacking(self) -> int:
        """Nodes that the network could serve and does not; all while there is no gateway."""
        ways = self._ways()
        return int(np.count_nonzero(ways.astray if ways.leads.any() else ways.on))

    def headline(self) -> Headline:
        """Is all well, and if not, what is wrong."""
        return headline(self._ways(), self.recorder.traffic(self.is_still))

    def forget(self, memory: Any) -> None:
        """Go back to a memory."""
        super().forget(memory)
        self.recorder.forget()
        self._found = None

    def points(self) -> dict[str, float | None]:
        """A point of every plot, for now."""
        memory, now = self.memory, self.engine.now_us
        took = max(1, now - memory.since_us)
        share = memory.air_us / took
        memory.load = (1 - SMOOTH) * memory.load + SMOOTH * share
        waited = memory.latency_us
        found = {
            "unconnected": float(np.count_nonzero(self._ways().without)),
            "latency": round(sum(waited) / len(waited) / 1e3, 2) if waited else None,
            "airtime": round(100 * float(share.sum()), 2),
        }
        memory.air_us = np.zeros(self.plan.nodes)
        memory.latency_us, memory.since_us = [], now
        return found

    def arrays(self, flights: bool) -> dict[str, Any]:
        """The state's fields for nodes and links."""
        world, ways = self.engine.world, self._ways()
        state = world.radios["state"]
        absent = (state == OFF) & (np.array(self.plan.absent) == 1)  # others start by themselves
        fields = {
            "node_up": ((state != DEAD) & ~absent).astype(np.int64),
            "absent": absent.astype(np.int64),
            "link_up": self.field.link_up(world),
            "parent": ways.hop,
            "depth": ways.depth,
            "load": np.minimum(self.memory.load, 1.0).round(3),
            "unconnected": int(np.count_nonzero(ways.without)),
            "apart": self.apart(),
            "way": ways.lacks,
            "leads": ways.leads.astype(np.int64),
            "flights": self._flights() if flights else [],
        }
        if self.field.walks:
            fields["position"] = self.field.positions(world)
        if any(self.plan.robots):
            monitor = self.plan.params["monitor"]
            roots = np.flatnonzero(ways.leads)
            who = roots if monitor == c.MONITOR else [monitor]
            raised = world.nodes["raised"][who][:, : self.plan.nodes]
            robots = np.array(self.plan.robots, np.bool_)
            outside = world.nodes["outside"][: self.plan.nodes] == 2
            fields["alarm"] = (raised.any(axis=0) & robots).astype(np.int64)
            fields["outside"] = (outside & robots).astype(np.int64)
        return fields

    def _flights(self) -> list[dict[str, Any]]:
        """Frames on the air, to whom they are for, or to all who are linked with the sender."""
        world, now = self.engine.world, self.engine.now_us
        found: list[dict[str, Any]] = []
        for place in np.flatnonzero(world.air["state"] == ON_AIR).tolist():
            air, frame = world.air[place], world.frames[place]
            start, end = int(air["start"]), int(air["end"])
            part = round(min(1.0, max(0.0, (now - start) / max(1, end - start))), 3)
            a, to = int(air["node"]), int(frame["link_dst"])
            kind = KINDS.get(int(frame["kind"]), "frame")
            for b in self.neighbours[a] if to == c.ALL else [to]:
                found.append({"a": a, "b": b, "kind": kind, "p": part})
        return found[:FLIGHTS_MAX]

    def words(self, fault: Any) -> str:
        """What a fault does, as "node 3 dies"."""
        return fault_words(self.plan, fault)

    def cut(self, link: int, heal: bool) -> dict[str, int]:
        """The fault that cuts a link, or puts it back."""
        return cut_of(self, self.field.pairs, link, heal)

    def kill(self, node: int, revive: bool) -> dict[str, int]:
        """The fault that switches a node off, or on."""
        state = int(self.engine.world.radios["state"][number("node", node, self.plan.nodes)])
        if revive and (state == ALIVE or not (state == DEAD or self.plan.absent[node])):
            raise Refused("this node is on" if state == ALIVE else "this node starts by itself")
        if not revive and state != ALIVE:
            raise Refused("this node is not on")
        return {"action": REVIVE if revive else KILL, "node": node, "other": 0}

    def event(self, fault: Any) -> dict[str, Any]:
        """The [[event]] table of a fault, without its time."""
        if fault.action in (CUT, RESTORE):
            return {"link": [fault.node, fault.other]}
        return {"node": fault.node}
