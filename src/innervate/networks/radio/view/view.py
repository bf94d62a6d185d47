"""What a simulated radio team looks like: stations in a ring, and what was on the air."""

import math
from dataclasses import dataclass, field
from typing import Any, ClassVar

import numpy as np

from innervate.analysis.headline import Headline
from innervate.dialect.access import REPORT_LEFT
from innervate.networks.radio.analysis.air import CARRYING
from innervate.networks.radio.analysis.headline import headline
from innervate.networks.radio.analysis.state import facts
from innervate.networks.radio.plot.words import fault_words, protocol_words
from innervate.networks.radio.protocol import constants as c
from innervate.networks.radio.scenario.plan import RadioFault
from innervate.networks.radio.scenario.planning import duration_us
from innervate.scenario.actions.channel import JOIN, KILL, TABLE
from innervate.sim.heap import AIRS
from innervate.web.engine import Engine, Rows
from innervate.web.errors import Refused
from innervate.web.history import TIMELINE, History
from innervate.web.messages import number
from innervate.web.view import Memory, View

KINDS = {c.DATA: "frame", c.OPEN: "voc", c.CRR: "cr", c.REPORT: "ack"}
IDLE, SENDING, RECEIVING, SEVERAL, WAITING, TURNING = range(6)
PLACES = ("pos", "place")  # fields of a station that say when its turn is


@dataclass(slots=True)
class RadioMemory(Memory):
    """Besides: transmissions that may still overlap others, and sums since the last point."""

    air: list[list[int]] = field(default_factory=list)  # start, end, station, kind
    collisions: int = 0
    carried_us: int = 0
    delays_us: list[int] = field(default_factory=list)
    since_us: int = 0
    delivered_us: int = 0  # when the newest packet was known to be delivered
    wrong: set[int] = field(default_factory=set)  # who measured a delay outside its bounds


class RadioView(View):
    """Stations; everybody hears everybody, so there are no links."""

    speed: ClassVar[float] = 0.1
    slow: ClassVar[float] = 0.0
    can: tuple[str, ...] = ("kill", "revive")
    actions = TABLE
    fault_type = RadioFault

    def __init__(self, engine: Engine, history: History) -> None:
        super().__init__(engine, history)
        self.memory = RadioMemory()

    def scene(self) -> dict[str, Any]:
        """Nodes, links and what else stands still."""
        count = self.plan.stations
        radius = max(1.0, count / math.tau)
        turn = [math.tau * i / count for i in range(count)]
        nodes = [
            {"id": i, "label": f"station {i}", "role": "station",
             "x": round(radius * math.sin(a), 3), "y": round(-radius * math.cos(a), 3)}
            for i, a in enumerate(turn)
        ]  # fmt: skip
        series = [
            {"id": "throughput", "label": "time with delivered packets", "unit": "%"},
            {"id": "collisions", "label": "collisions", "unit": "per s"},
            {"id": "delay", "label": "from offer to delivery", "unit": "ms"},
        ]
        return {
            "nodes": nodes, "links": [], "fence": None, "series": series,
            "protocol": protocol_words(self.plan.protocol),
            "slot_us": int(self.plan.params["slot_us"]),
            "turnaround_us": int(self.plan.params["ta_us"]),
        }  # fmt: skip

    def note(self, rows: Rows) -> None:
        """Take in what happened since the last call."""
        memory = self.memory
        memory.air += np.stack(
            [rows["sent"][name] for name in ("time", "end", "node", "kind")], axis=1
        ).tolist()
        for fault in self.tell_faults():
            if fault.action == KILL:
                self._stop(fault.node, fault.at_us)
        told = rows["rows"]
        memory.wrong.update(told["node"][told["code"] == c.REPORT_BOUNDS].tolist())
        told = told[np.isin(told["code"], (c.REPORT_STOPPED, REPORT_LEFT))]
        for at, node, code, _a, _b in told.tolist():
            if code == c.REPORT_STOPPED:
                self._stop(node, at)
            else:
                self.memory.taken.gone(node)
                self.log.say(at, f"station {node} left")
        packets = rows["packets"]
        came = packets[packets["receivers"] > 0]
        memory.carried_us += int(came["slots"].sum()) * int(self.plan.params["slot_us"])
        memory.delivered_us = max(memory.delivered_us, int(came["time"].max(initial=0)))
        memory.delays_us += (came["end"] - came["offered"]).tolist()
        for row in packets[packets["receivers"] == 0].tolist():
            text = f"station {row[3]}: a packet that nobody received counts as delivered"
            self.log.often("silent", row[2], text, "bad")
        self._close()

    def _stop(self, station: int, at_us: int) -> None:
        """A transmission is broken off."""
        decided_us = at_us + int(self.plan.params["ta_us"])
        for sent in self.memory.air:
            if sent[2] == station and sent[0] <= decided_us and sent[1] > at_us:
                sent[1] = max(sent[0], at_us)

    def _close(self) -> None:
        """Show the transmissions that nothing can overlap any more, in groups that overlap."""
        air, now = self.memory.air, self.engine.now_us
        air.sort()
        first = 0
        while first < len(air):
            end, behind = air[first][1], first + 1
            while behind < len(air) and air[behind][0] < end:
                end = max(end, air[behind][1])
                behind += 1
            if end > now:
                break
            self._show(air[first:behind], end - 1)
            first = behind
        del air[:first]

    def _show(self, group: list[list[int]], at_us: int) -> None:
        """Add a group to the timeline; `at_us` is its last moment."""
        carrying = any(kind in CARRYING for _, _, _, kind in group)
        collided = len(group) > 1 and carrying
        self.memory.collisions += collided
        if collided:
            stations = ", ".join(str(sent[2]) for sent in group[:6])
            more = ", ..." if len(group) > 6 else ""
            self.log.often("collision", at_us, f"collision of stations {stations}{more}")
        for start, end, station, kind in group:
            what = "collision" if collided and kind in CARRYING else KINDS.get(kind, "frame")
            box = {"station": station, "from_s": start / 1e6, "to_s": end / 1e6, "kind": what}
            self.history.add(TIMELINE, at_us, box)

    def points(self) -> dict[str, float | None]:
        """A point of every plot, for now."""
        memory, now = self.memory, self.engine.now_us
        took = max(1, now - memory.since_us)
        delays = memory.delays_us
        # A packet counts when it is known to be delivered: what is more than the time counts later.
        carried_us = min(memory.carried_us, took)
        found = {
            "throughput": round(100 * carried_us / took, 2),
            "collisions": round(1e6 * memory.collisions / took, 2),
            "delay": round(sum(delays) / len(delays) / 1e3, 3) if delays else None,
        }
        memory.carried_us -= carried_us
        memory.collisions = 0
        memory.delays_us, memory.since_us = [], now
        return found

    def arrays(self, flights: bool) -> dict[str, Any]:
        """The state's fields for nodes and links."""
        world, count = self.engine.world, self.plan.stations
        radios = world.radios[:count]
        waits = world.stations["queued"][:count] > 0
        now = np.where(waits, WAITING, IDLE)
        now = np.where(radios["present"] == 1, RECEIVING, now)
        now = np.where(radios["present"] > 1, SEVERAL, now)
        now = np.where(radios["deaf"] > 0, TURNING, now)
        now = np.where((radios["deaf"] > 0) & self._on_air(), SENDING, now)
        up, away = self._present()
        return {
            "node_up": up.astype(np.int64),
            "radio": {
                "now": np.where(up, now, IDLE).tolist(),
                "turn": self._turns(),
            },
            "load": (world.stations["queued"][:count] / 16).round(3),
            "unconnected": int(np.count_nonzero(~up & ~away)),
            "away": int(np.count_nonzero(away)),
            "absent": away.astype(np.int64),
            "flights": [],
        }

    def _present(self) -> tuple[Any, Any]:
        """Per station: it is on; it is not in the team. Who is not yet to come begins at 0."""
        radios, count = self.engine.world.radios[: self.plan.stations], self.plan.stations
        if self.engine.now_us == 0:
            away = np.array(self.plan.absent or [0] * count, np.bool_)
            return ~away, away
        up = radios["alive"] > 0
        return up, ~up & (radios["leaving"] > 0)

    def _on_air(self) -> Any:
        """Per station, true while a frame of it is on the air: not in the turnaround round it."""
        air, now = self.engine.world.air.reshape(-1, AIRS)[: self.plan.stations], self.engine.now_us
        return ((air["start"] <= now) & (now <= air["end"])).any(axis=1)

    def headline(self) -> Headline:
        """Is all well, and if not, what is wrong."""
        memory, engine, plan = self.memory, self.engine, self.plan
        found = facts(
            engine.world,
            plan,
            engine.now_us,
            memory.delivered_us,
            faults=engine.given,
            # A recording that was interrupted is shorter than its scenario, and has not ended.
            ended=engine.now_us >= duration_us(plan.scenario.model) or engine.running.is_complete(),
        )
        wrong = tuple(sorted(memory.wrong))
        believed = {"believed_us": [plan.params["dmin_us"], plan.params["dmax_us"]]}
        return headline(
            found._replace(bounds=believed if wrong else found.bounds, stations_wrong=wrong)
        )

    def _turns(self) -> list[int]:
        """Everybody's place in the round; -1 none."""
        stations = self.engine.world.stations
        for name in PLACES:
            if name in stations.dtype.names:
                found: list[int] = stations[name][: self.plan.stations].tolist()
                return found
        return [-1] * self.plan.stations

    def begin_fault(self, fault: Any) -> bool:
        """A team has nothing to recover: what matters is who waits, and that is shown."""
        changed = super().begin_fault(fault)
        self.memory.recovery = None
        return changed

    def words(self, fault: Any) -> str:
        """What a fault does, as "station 3 dies"."""
        return fault_words(fault)

    def cut(self, link: int, heal: bool) -> dict[str, int]:
        """The fault that cuts a link, or puts it back."""
        raise Refused("a radio team has no links to cut; switch a station off")

    def kill(self, node: int, revive: bool) -> dict[str, int]:
        """The fault that switches a node off, or on."""
        number("station", node, self.plan.stations)
        if bool(self._present()[0][node]) == revive:
            raise Refused("this station is on" if revive else "this station is off already")
        return {"action": JOIN if revive else KILL, "node": node}

    def event(self, fault: Any) -> dict[str, Any]:
        """The [[event]] table of a fault, without its time."""
        return {"station": fault.node}
