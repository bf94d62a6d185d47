"""What a simulated skin looks like."""

from dataclasses import dataclass, field
from typing import Any, ClassVar

import numpy as np
from msgspec import to_builtins

from innervate.analysis.headline import BEFORE_ALL, Headline
from innervate.analysis.ways import NOWHERE
from innervate.kernel.words import number_of
from innervate.networks.skin.analysis.headline import skin_headline
from innervate.networks.skin.analysis.load import balance_factor
from innervate.networks.skin.analysis.proved import sentence
from innervate.networks.skin.analysis.reach import world_facts
from innervate.networks.skin.plot.words import fault_words
from innervate.networks.skin.protocol import constants as c
from innervate.networks.skin.sim.counters import EARLY, LOOPED, NO_ROUTE
from innervate.networks.skin.sim.observer import APART, CUT_OFF, LOOP_OPEN, UNROUTED
from innervate.networks.skin.sim.orders import ORDER_CAME, ORDER_GIVEN
from innervate.networks.skin.sim.proved import OUTSIDE
from innervate.networks.skin.view import giving
from innervate.networks.skin.view.engine import SkinEngine
from innervate.networks.skin.view.scene import places
from innervate.networks.skin.view.state import SkinCables
from innervate.scenario.actions.cables import KILL, REVIVE
from innervate.sim.cables.wires import LOST_BROKEN, LOST_CUT, OFFERED
from innervate.sim.cables.world import DEAD
from innervate.topology import PORTS
from innervate.web.cables import CabledView
from innervate.web.engine import Engine, Rows
from innervate.web.errors import Refused
from innervate.web.history import History
from innervate.web.messages import Command, Give, Touch, number
from innervate.web.view import Memory

HZ_WITHOUT_DATA = 250.0  # load is shown as if cells sampled so often
FORCE_FULL_MN = 5_000  # shown as 255
STALE_US = 200_000  # of a cell not heard for so long nothing is known any more


@dataclass(slots=True)
class SkinMemory(Memory):
    """Besides: the observer's newest word, and what the PC received of every cell."""

    unrouted: int = 0
    settled: bool = False
    touch: Any = None
    touch_us: Any = None
    counted: tuple[int, int] = field(default=(0, 0))
    apart: int = 0  # cells that are cut off from the PC now
    apart_most: int = 0  # most cells that were cut off from the PC at the same time
    dead: set[int] = field(default_factory=set)  # cells that were switched off
    given: dict[int, giving.Given] = field(default_factory=dict)
    told: Any = None  # per cell the newest command that came, -1 none
    waited: tuple[int, int] = (0, 0)  # samples since the last point, the sum of their latencies, us


class SkinView(CabledView):
    """Cells and interface ports; the links are the cables, in order of their lower end."""

    noun: ClassVar[str] = "cell"
    cables: SkinCables

    def __init__(self, engine: Engine, history: History) -> None:
        super().__init__(engine, history)
        graph = self.plan.graph
        self.cells, self.ports = graph.cells, graph.interfaces
        self.cables = SkinCables(self.plan)
        self.rate_hz = (
            1e6 / self.plan.data_period_us if self.plan.data_period_us else HZ_WITHOUT_DATA
        )
        self._planned = {fault.index: fault for fault in self.plan.faults}
        touch_us = np.full(self.cells, -STALE_US, np.int64)
        self.memory = SkinMemory(touch=np.zeros(self.cells, np.int64), touch_us=touch_us,
                                 told=np.full(self.cells, -1))  # fmt: skip
        if self.plan.data_period_us:
            self.can = (*self.can, "touch")
        if isinstance(engine, SkinEngine) and engine.takes_orders:
            self.can = (*self.can, "command")

    def scene(self) -> dict[str, Any]:
        """Nodes, links and what else stands still."""
        graph, where = self.plan.graph, places(self.plan.graph).round(3).tolist()
        nodes = [
            {"id": i, "label": graph.label(i), "x": x, "y": y, "role": "cell"}
            for i, (x, y) in enumerate(where[: self.cells])
        ]
        nodes += [
            {"id": self.cells + i, "label": f"pc.{i}", "x": x, "y": y, "role": "port", "port": i}
            for i, (x, y) in enumerate(where[self.cells :])
        ]
        series = [
            {"id": "unconnected", "label": "cells without a way", "unit": "cells"},
            {"id": "balance", "label": "balance of the ports", "unit": ""},
        ]
        if self.plan.data_period_us:
            series.append({"id": "loss", "label": "samples lost", "unit": "%"})
            series.append({"id": "latency", "label": "latency of samples", "unit": "ms"})
        return {
            "nodes": nodes, "links": self.cables.scene(), "ports": self.ports, "fence": None,
            "series": series,
        }  # fmt: skip

    def note(self, rows: Rows) -> None:
        """Take in what happened since the last call."""
        memory = self.memory
        told = rows["deliveries"]
        if len(told):
            force = told["force"].mean(axis=1)
            memory.touch[told["cell"]] = np.minimum(255, force * 255 / FORCE_FULL_MN)
            memory.touch_us[told["cell"]] = told["time"]
            memory.waited = (
                memory.waited[0] + len(told), memory.waited[1] + int(told["latency"].sum())
            )  # fmt: skip
        codes = (APART, CUT_OFF, UNROUTED, LOOP_OPEN, ORDER_GIVEN, ORDER_CAME, OUTSIDE,
                 c.REPORT_BROKEN, c.REPORT_PARENT, c.REPORT_BALANCE)  # fmt: skip
        found = rows["rows"]
        found = found[np.isin(found["code"], codes)]
        for at, node, code, a, b in found.tolist():
            if code == CUT_OFF and a >= 0:
                self._fault(a, b)
            elif code == APART:
                self._apart(at, a)
            elif code == UNROUTED:
                self._unrouted(at, a)
            elif code == OUTSIDE:
                self._outside(at, node, a, b)
            elif code == ORDER_GIVEN:
                memory.given[a] = giving.begin(self.log, self.plan.graph, at, a, b)
            elif code == ORDER_CAME and a in memory.given:
                memory.told[node] = a
                giving.reached(self.log, self.plan.graph, memory.given[a], at, a, node)
            elif code == c.REPORT_BROKEN:
                self._broken(at, PORTS * node + a, b)
            elif code == LOOP_OPEN:
                self.log.often("loop", at, f"a forwarding loop of {number_of(a, 'cell')}", "bad")
            elif code == c.REPORT_PARENT and b == c.NONE and memory.settled:
                label = self.plan.graph.label(node)
                self.log.often("lost", at, f"{label} lost its parent", "bad")

    def _outside(self, at_us: int, node: int, what: int, other: int) -> None:
        """An assumption of the proofs is left."""
        label = self.plan.graph.label
        said = sentence(at_us, what, label(node), label(other) if other >= 0 else "")
        self.log.often("outside", at_us, said, "bad")

    def apart(self) -> int:
        """Cells that are cut off from the PC now."""
        found: int = self.memory.apart
        return found

    def _apart(self, at_us: int, cells: int) -> None:
        """So many cells are cut off from the PC from now on."""
        memory, recovery = self.memory, self.memory.recovery
        memory.apart, memory.apart_most = cells, max(memory.apart_most, cells)
        if recovery is None:
            return
        recovery.cut_off(cells)
        were_none, recovery.nobody = recovery.nobody, self._nobody()
        if recovery.nobody and at_us == recovery.at_us:
            recovery.recovered_ms = None  # what seemed to hurt nobody has cut everybody off
        if were_none and not recovery.nobody and not memory.unrouted:
            recovery.recovered_ms = (at_us - recovery.at_us) / 1e3

    def _nobody(self) -> bool:
        """No cell is left that is on and that cables join with the PC."""
        left: int = self.cells - self.memory.apart - len(self.memory.dead)
        return left <= 0

    def _fault(self, index: int, cut_off: int) -> None:
        """A mark of the observer: something was done to the skin."""
        given = index - len(self.plan.scenario.model.event)
        fault = self._planned[index] if given < 0 else self.engine.given[given]
        if not self.begin_fault(fault):
            return
        if fault.action in (KILL, REVIVE):
            (self.memory.dead.add if fault.action == KILL else self.memory.dead.discard)(fault.node)
        recovery = self.memory.recovery
        if recovery is not None:
            recovery.cut_off(self.memory.apart)
            recovery.nobody = self._nobody()
            if self.memory.unrouted == 0 and self.takes(fault) and not recovery.nobody:
                recovery.recovered_ms = 0.0
        if cut_off:
            text = f"{number_of(cut_off, 'cell')} lost the way to the PC"
            self.log.say(fault.at_us, text, "bad")

    def _unrouted(self, at_us: int, cells: int) -> None:
        """So many cells that are connected to the PC have no way to it from now on."""
        memory, recovery = self.memory, self.memory.recovery
        memory.unrouted = cells
        if recovery is not None and not recovery.closed:
            is_open = cells > 0 or self._nobody()
            recovery.recovered_ms = None if is_open else (at_us - recovery.at_us) / 1e3
            recovery.closed = not is_open and memory.event_us > recovery.at_us
        after_us = at_us - memory.event_us
        if cells == 0 and memory.apart < self.cells:
            who = "all other cells" if memory.apart else "all cells"
            what = "again after" if memory.settled else "after"
            self.log.often("routed", at_us, f"{who} have a way {what} {after_us / 1e3:.1f} ms",
                           "info" if memory.apart else "good")  # fmt: skip
            memory.settled = True

    def _broken(self, at_us: int, end: int, broken: int) -> None:
        """A cell finds a port broken, or working again."""
        recovery = self.memory.recovery
        label = self.plan.graph.label_end(end)
        if recovery is not None and broken and recovery.detected_ms is None:
            graph, fault = self.plan.graph, self.memory.fault
            own = [fault.end] if fault.end >= 0 else list(graph.ends_of(fault.node))
            if end in own or graph.peer[end] in own:
                recovery.detected_ms = (at_us - recovery.at_us) / 1e3
        self.log.often("broken", at_us, f"{label} {'found broken' if broken else 'works again'}")

    def headline(self) -> Headline:
        """Is all well, and if not, what is wrong."""
        if self.engine.now_us == 0:
            return BEFORE_ALL
        found, most = world_facts(self.engine.world, self.cells), self.memory.apart_most
        sent, lost = self._samples()
        return skin_headline(
            found._replace(
                cut_off_before=most if most > len(found.cut_off) else 0,
                sent=sent,
                lost=lost,
                early=int(self.engine.world.counters[EARLY]),
            ),
            self.plan.graph.label,
        )

    def _samples(self) -> tuple[int, int]:
        """Tactile samples so far: taken, lost."""
        counters = self.engine.world.counters
        lost = counters[LOST_CUT : LOST_BROKEN + 1].sum() + counters[NO_ROUTE : LOOPED + 1].sum()
        return int(counters[OFFERED]), int(lost)

    def points(self) -> dict[str, float | None]:
        """A point of every plot, for now."""
        ways = self.cables.ways(self.engine.world)
        port = ways["port"][: self.cells]  # behind them the PC's own
        loads = np.bincount(port[port >= 0], minlength=self.ports)
        balance = balance_factor(loads.tolist())
        found: dict[str, float | None] = {
            "unconnected": float(ways["unconnected"]),
            "balance": None if balance is None else round(balance, 4),
        }
        if self.plan.data_period_us:
            now = self._samples()
            offered, gone = (a - b for a, b in zip(now, self.memory.counted, strict=True))
            self.memory.counted = now
            found["loss"] = round(100 * gone / offered, 3) if offered else 0.0
            count, total_us = self.memory.waited
            self.memory.waited = (0, 0)
            found["latency"] = round(total_us / count / 1e3, 3) if count else None
        return found

    def arrays(self, flights: bool) -> dict[str, Any]:
        """The state's fields for nodes and links."""
        world, memory = self.engine.world, self.memory
        ways = self.cables.ways(self.engine.world)
        share = world.cells["own_load"] * self.rate_hz * self.plan.wire_us * 1e-6
        there = ways["port"][: self.cells] != NOWHERE
        load = np.where(there, np.minimum(share, 1.0), 0.0).round(3)
        up = (world.alive[: self.cells] != DEAD).astype(np.int64)
        none = np.zeros(self.ports, np.int64)
        fields = {
            "node_up": np.concatenate([up, none + 1]),
            "link_up": self.cables.up(world),
            **ways,
            "apart": int(np.count_nonzero(np.array(world.watch.apart) >= 0)),
            "load": np.concatenate([load, none]),
            "flights": self.cables.flights(world, self.engine.now_us) if flights else [],
        }
        if "command" in self.can:
            fields["told"] = np.concatenate([memory.told, none - 1])
        if self.plan.data_period_us:
            heard = self.engine.now_us - memory.touch_us < STALE_US
            fields["touch"] = np.concatenate([np.where(heard, memory.touch, 0), none])
        return fields

    def apply(self, command: Command) -> None:
        """Have a command happen at the earliest moment."""
        if isinstance(command, Give) and "command" in self.can:
            assert isinstance(self.engine, SkinEngine)
            self.engine.give(giving.order_of(command, self.engine.earliest_us, self.cells))
            return
        if not isinstance(command, Touch):
            super().apply(command)
            return
        cell = number("cell", command.node, self.cells)
        assert isinstance(self.engine, SkinEngine)
        self.engine.touch(cell if command.value else None)
        what = f"{self.plan.graph.label(cell)} touched" if command.value else "let go"
        self.log.often("touch", self.engine.now_us, what)

    def extra(self) -> dict[str, Any]:
        """The touch, as a hand has led it, and the commands that were given by hand."""
        assert isinstance(self.engine, SkinEngine)
        finger, orders = self.engine.finger, self.engine.orders
        found: dict[str, Any] = {} if finger is None else {"touch": finger.table()}
        if orders:
            told = to_builtins(self.plan.scenario.model.command)
            told += [giving.table(order, self._target(order.cell)) for order in orders]
            found["command"] = told
        return found

    def words(self, fault: Any) -> str:
        """What a fault does, as "cut 3-4"."""
        return fault_words(self.plan.graph, fault)

    def kill(self, node: int, revive: bool) -> dict[str, int]:
        """The fault that switches a node off, or on."""
        if number("node", node, self.cells + self.ports) >= self.cells:
            raise Refused("the PC cannot be switched off; cut the cable of this port")
        return super().kill(node, revive)

    def event(self, fault: Any) -> dict[str, Any]:
        """The [[event]] table of a fault, without its time."""
        graph = self.plan.graph
        if fault.end >= PORTS * self.cells:
            return {"interface": fault.end - PORTS * self.cells}
        cell = fault.node if fault.end < 0 else fault.end // PORTS
        if cell == graph.sink:
            return {"pc": True}
        port = {} if fault.end < 0 else {"port": fault.end % PORTS}
        return {**self._target(cell), **port}

    def _target(self, cell: int) -> dict[str, Any]:
        """A cell as a scenario names it; nothing for all of them."""
        if cell < 0:
            return {}
        graph = self.plan.graph
        patch = graph.patch_of(cell)
        if patch < 0:
            return {"node": graph.label(cell)}
        row, column = graph.patches[patch].row_column(cell)
        return {"cell": {"patch": patch, "row": row, "column": column}}
