"""A skin at any moment of a run, put together again from the run's rows."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from innervate.analysis.ways import follow
from innervate.networks.skin.analysis import load, recovery, rows
from innervate.networks.skin.analysis.rows import Numbers
from innervate.networks.skin.protocol.constants import NONE, PORTS
from innervate.scenario.actions.cables import CUT, KILL, RESTART, RESTORE, REVIVE
from innervate.scenario.cables import Fault

Flags = np.ndarray[Any, np.dtype[np.bool_]]


@dataclass(frozen=True, slots=True)
class Moment:
    """The skin at one moment."""

    time_us: int  # when
    parent: Numbers  # parent port of every cell, -1 none
    hop: Numbers  # node on the parent port's cable; -1 without a parent or where that cable is down
    server: Numbers  # interface port that a cell's data leave through; -1 without a route
    down: frozenset[int]  # lower ends of the cables that are cut or have a dead end
    dead: frozenset[int]  # cells that are switched off


class History:
    """Looks up any moment of a run."""

    def __init__(self, result: Any) -> None:
        self.result = result
        self.graph = result.plan.graph
        self._changes = rows.parent_changes(result)
        self._marks = rows.marks(result)
        self._apart = rows.apart_steps(result)
        self._lacking = together(rows.unrouted_steps(result), self._apart)
        self._faults: dict[int, Fault] = {fault.index: fault for fault in result.plan.faults}

    def steps(self) -> tuple[Numbers, Numbers]:
        """(times in us, cells that are on and have no way to the PC from then on)."""
        return self._lacking

    def lacking_max(self, first_us: int, last_us: int) -> tuple[int, int]:
        """(when, how many) most cells lacked a way, within first_us <= t <= last_us."""
        times, cells = self._lacking
        places = np.flatnonzero((times >= first_us) & (times <= last_us))
        if len(places) == 0:
            return first_us, self.lacking_at(first_us)
        worst = places[int(np.argmax(cells[places]))]
        return int(times[worst]), int(cells[worst])

    def lacking_at(self, time_us: int) -> int:
        """Cells that are on and have no way to the PC at a time, those cut off included."""
        return int(_step_at(*self._lacking, time_us))

    def cut_off_at(self, time_us: int) -> int:
        """Cells that are on, but that no cable joins with the PC at a time."""
        return int(_step_at(self._apart.time_us, self._apart.cells, time_us))

    def first_below(self, first_us: int, last_us: int, limit: float) -> tuple[int, int]:
        """(when, how many) no more than `limit` cells lacked a way for the first time."""
        times, cells = self._lacking
        places = np.flatnonzero((times >= first_us) & (times <= last_us) & (cells <= limit))
        if len(places) == 0:
            return last_us, self.lacking_at(last_us)
        return int(times[places[0]]), int(cells[places[0]])

    def at(self, time_us: int) -> Moment:
        """The skin after everything that happened up to and including `time_us`."""
        graph = self.graph
        down, dead, lost = self._damage(time_us)
        behind = int(np.searchsorted(self._changes.time_us, time_us, "right"))
        parent = rows.parents(self._changes, graph.cells, behind, lost)
        live = parent.copy()
        for end in down:
            for one in (end, graph.peer[end]):
                cell, port = divmod(one, PORTS)
                if cell < graph.cells and live[cell] == port:
                    live[cell] = NONE
        hop = recovery.next_hops(graph, live)
        server = load.interfaces_along(graph, live)
        return Moment(time_us, parent, hop, server, frozenset(down), frozenset(dead))

    def _damage(self, time_us: int) -> tuple[set[int], set[int], dict[int, int]]:
        """Cables down and cells dead at a time, and the rows at which cells lost their memory."""
        reasons: dict[int, int] = {}
        dead: set[int] = set()
        lost: dict[int, int] = {}
        for place in np.flatnonzero(self._marks.time_us <= time_us).tolist():
            fault = self._faults.get(int(self._marks.event[place]))
            if fault is None:
                continue
            row = int(self._marks.row[place])
            if fault.action in (CUT, RESTORE):
                self._shift(reasons, fault.end, 1 if fault.action == CUT else -1)
            elif fault.action == KILL and fault.node not in dead:
                dead.add(fault.node)
                self._shift_all(reasons, fault.node, 1)
                lost[fault.node] = row
            elif fault.action == REVIVE and fault.node in dead:
                dead.discard(fault.node)
                self._shift_all(reasons, fault.node, -1)
            elif fault.action == RESTART:
                lost[fault.node] = row
        lost.pop(self.graph.sink, None)
        return {end for end, count in reasons.items() if count > 0}, dead, lost

    def _shift_all(self, reasons: dict[int, int], node: int, by: int) -> None:
        for end in self.graph.ends_of(node):
            if self.graph.peer[end] >= 0:
                self._shift(reasons, end, by)

    def _shift(self, reasons: dict[int, int], end: int, by: int) -> None:
        """A cable is down for as long as it has a reason to be."""
        cable = min(end, self.graph.peer[end])
        reasons[cable] = max(0, reasons.get(cable, 0) + by)


def together(one: rows.Steps, other: rows.Steps) -> tuple[Numbers, Numbers]:
    """The sum of two step functions, after all that a moment brought: (times in us, cells)."""
    times = np.union1d(one.time_us, other.time_us)
    return times, sum(_step_at(steps.time_us, steps.cells, times) for steps in (one, other))


def _step_at(times_us: Numbers, cells: Numbers, at_us: Any) -> Any:
    """What a step function is after all that happened up to a time, or to each of several."""
    return np.append(0, cells)[np.searchsorted(times_us, at_us, "right")]


def hops_of(moment: Moment, sink: int) -> Numbers:
    """Hops of every cell along its chain of parents; 0 where the chain does not reach the PC."""
    _, hops = follow(moment.hop, moment.hop == sink)
    return np.where(moment.server >= 0, hops + 1, 0)
