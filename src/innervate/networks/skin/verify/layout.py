"""Where everything stands in a row: a state of a skin as bytes."""

from typing import Any

from innervate.networks.skin.protocol.constants import NONE, PORTS
from innervate.networks.skin.verify import world as w
from innervate.networks.skin.verify.graphs import symmetries

# A frame takes 0.06 to 0.2 ms, and news keeps 0.5 ms from the last beacon: a tick's beacon and one
# more can be in flight.
ROOM = 2
LEAN_ROOM = 10  # and as many as there can be where a search has room for it


def hold_periods(model: Any) -> int:
    """FD_HOLD: k + 4 times the greatest depth there can be, unless the model says otherwise."""
    return model.hold or 1 + 4 * model.graph.cells


class Layout:
    """Where things lie in a row."""

    def __init__(self, model: Any) -> None:
        graph, self.model = model.graph, model
        self.links = list(graph.links())
        self.ways = 2 * len(self.links)
        self.capacity = model.capacity or self._capacity()
        self.way_end = [end for a, b in self.links for end in (b, a)]
        ends = len(graph.peer)
        self.out_way, self.in_way = [NONE] * ends, [NONE] * ends
        for way, end in enumerate(self.way_end):
            self.in_way[end] = way
            self.out_way[graph.peer[end]] = way
        self.cell_at, self.port_at, at = [], [NONE] * (PORTS * graph.cells), 0
        for c in range(graph.cells):
            self.cell_at.append(at)
            at += w.HEAD_BYTES
            for end in graph.ends_of(c):
                if graph.peer[end] >= 0:
                    self.port_at[end] = at
                    at += w.PORT_BYTES
        self.pc_at = at
        self.link_at = self.pc_at + w.PC_BYTES
        self.budget_at = self.link_at + len(self.links)
        first = self.budget_at + w.BUDGETS
        size = 1 + w.FRAME_BYTES * self.capacity
        self.queue_at = [first + size * way for way in range(self.ways)]
        self.queue_bytes = size
        self.width = -(-(first + size * self.ways) // 8) * 8

    def _capacity(self) -> int:
        budget = self.model.budget
        if self.model.prompt:
            return 2
        most = max(budget.ticks, budget.counts)
        if self.model.updates == "periodic" and most < w.ANY:
            return most
        return LEAN_ROOM if self.model.lean else ROOM

    def settings(self) -> list[int]:
        """What `SkinWorld.at` holds: sizes, offsets in a row, flags of the model."""
        model = self.model
        at = [0] * w.SETTINGS
        at[w.CELLS], at[w.CAPACITY] = model.graph.cells, self.capacity
        at[w.DIRECTIONS], at[w.PC_AT], at[w.LINK_AT] = self.ways, self.pc_at, self.link_at
        at[w.BUDGET_AT], at[w.MERGE], at[w.PROMPT] = self.budget_at, model.merges, model.prompt
        at[w.FEASIBLE], at[w.KEEP] = model.rule == "feasible", model.keep
        at[w.UNREDUCED] = model.unreduced
        at[w.LEAN] = self._is_lean
        at[w.HELD] = self._held()
        at[w.RISING] = model.rule == "strict" and model.budget.restart == 0
        # Looking at the same ports again changes nothing, or nobody does before the next tick.
        at[w.STEADY] = at[w.FEASIBLE] or at[w.RISING] or model.updates == "periodic"
        return [int(value) for value in at]

    @property
    def _is_lean(self) -> bool:
        return self.model.lean and not self.model.prompt and not self.model.unreduced

    def _held(self) -> int:
        """For the fair schedule: how many values a time without a route can have, if it is
        forgotten. It may be where no feasible distance is before everybody has sent once more,
        which a restarted PC does in the second round.
        """
        model, most = self.model, hold_periods(self.model) - 3
        if model.budget.ticks < w.ANY:
            most = model.budget.ticks if model.budget.ticks <= most else -1
        return most + 1 if model.keep and self._is_lean else 0

    def body(self) -> list[int]:
        """255 for every byte but those that say how much may still happen."""
        mask = [255] * self.width
        if self.model.lean:
            tail = range(self.budget_at, self.budget_at + w.BUDGETS)
            for at in [at + w.TICKS for at in self.cell_at] + [self.pc_at + w.PC_COUNTS, *tail]:
                mask[at] = 0
        return mask

    def moves(self) -> list[tuple[int, int]]:
        """All moves: kind and cell, direction or cable."""
        model, cells, ways = self.model, range(self.model.graph.cells), range(self.ways)
        moves = [(w.TICK, c) for c in cells] + [(w.PC_TICK, 0)]
        if model.updates != "periodic":
            moves += [(w.SOON, c) for c in cells]
        if not model.merges:
            moves += [(w.DELIVER, way) for way in ways]
        if not model.merges and model.budget.loss:
            moves += [(w.LOSE, way) for way in ways]
        if model.budget.cut:
            moves += [(w.CUT_LINK, link) for link in range(len(self.links))]
        if model.budget.heal:
            moves += [(w.HEAL_LINK, link) for link in range(len(self.links))]
        return moves + ([(w.RESTART_PC, 0)] if model.budget.restart else [])

    def images(self) -> list[int]:
        """For each symmetry where every byte of the image comes from."""
        graph = self.model.graph
        # Prompt delivery looks at directions in the order of their numbers.
        found = symmetries(graph) if self.model.symmetric and not self.model.prompt else []
        flat: list[int] = []
        for ends in found or [list(range(len(graph.peer)))]:
            source = list(range(self.width))
            for c in range(graph.cells):
                first = next(end for end in graph.ends_of(c) if graph.peer[end] >= 0)
                to = self.cell_at[graph.node_of(ends[first])]
                self._carry(source, self.cell_at[c], to, w.HEAD_BYTES)
            for end, peer in enumerate(graph.peer):
                if peer < 0:
                    continue
                if end < len(self.port_at):
                    self._carry(source, self.port_at[end], self.port_at[ends[end]], w.PORT_BYTES)
                here, there = self.in_way[end], self.in_way[ends[end]]
                self._carry(source, self.queue_at[here], self.queue_at[there], self.queue_bytes)
                source[self.link_at + there // 2] = self.link_at + here // 2
            flat += source
        return flat

    @staticmethod
    def _carry(source: list[int], here: int, there: int, count: int) -> None:
        source[there : there + count] = range(here, here + count)
