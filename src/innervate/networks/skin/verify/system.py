"""A skin for the explorer: from a graph and budgets to a world, and how it is searched."""

from __future__ import annotations

import functools
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from typing import Any, NamedTuple

from innervate.kernel import records
from innervate.networks.skin.protocol import cell as skin
from innervate.networks.skin.protocol import fields as skin_fields
from innervate.networks.skin.protocol import sink as skin_sink
from innervate.networks.skin.protocol.constants import (
    NONE,
    ONE,
    PORTS,
    RULE_FEASIBLE,
    RULE_PAPER,
    RULE_PAPER_LAX,
    RULE_STRICT,
)
from innervate.networks.skin.verify import check as skin_check
from innervate.networks.skin.verify import moves as skin_moves
from innervate.networks.skin.verify import reduction
from innervate.networks.skin.verify import row as skin_row
from innervate.networks.skin.verify import world as skin_world
from innervate.networks.skin.verify import world as w
from innervate.networks.skin.verify.graphs import symmetries
from innervate.topology import Graph
from innervate.verify.errors import VerifyError

RULES = ("feasible", "strict", "paper", "paper-lax")
UPDATES = ("periodic", "triggered")
_NUMBERS = dict(zip(RULES, (RULE_FEASIBLE, RULE_STRICT, RULE_PAPER, RULE_PAPER_LAX), strict=True))
ANY = w.ANY
FAULTS = ("loss", "cut", "heal", "false", "restart")
SETTLED_M = 3  # the fair schedule counts the PC's number every so many rounds
# A frame takes 0.06 to 0.2 ms, and news keeps 0.5 ms from the last beacon: a tick's beacon and one
# more can be in flight.
ROOM = 2
LEAN_ROOM = 10  # and as many as there can be where a search has room for it


@dataclass(frozen=True, slots=True)
class Budget:
    """How often what may happen.

    Attributes:
        ticks: periods of every cell; ANY as many as it takes, but no cell without a route for as
            many as FD_HOLD.
        counts: beacons of the PC, each with a new number.
        loss, cut, heal, false, restart: lost frames, cut and mended cables, ports found broken
            without a reason, restarts of the PC.
        faults: all of these together.
    """

    ticks: int = 3
    counts: int = 2
    loss: int = 1
    cut: int = 1
    heal: int = 1
    false: int = 1
    restart: int = 1
    faults: int = 2


@dataclass(frozen=True)
class SkinModel:
    """What is explored.

    Attributes:
        graph: cells, PC and cables.
        rule: one of RULES.
        updates: "periodic" or "triggered".
        budget: how often what may happen.
        hold: FD_HOLD, in periods.
        prompt: every frame arrives, or is lost, before anything else happens.
        merge: use that periodic beacons are only looked at in a tick (see moves.py).
        keep: keep what only a later fair schedule would see.
        symmetric: take states that differ by a symmetry of the graph as one.
        capacity: most frames in flight per direction; states with more are left out, and counted.
            0 = what periodic cells can send within their budget; of triggered ones ROOM, or
            LEAN_ROOM.
        whole: leave no beacon out, though it changes nothing.
        lean: forget what can no longer matter (see reduction.py), and follow no state of which a
            known one differs only in that more may still happen.
    """

    graph: Graph
    rule: str = "feasible"
    updates: str = "periodic"
    budget: Budget = field(default_factory=Budget)
    hold: int = 0
    prompt: bool = False
    merge: bool = True
    keep: bool = False
    symmetric: bool = True
    capacity: int = 0
    whole: bool = False
    lean: bool = False

    @property
    def merges(self) -> bool:
        """Whether beacons are taken in by ticks only."""
        return self.merge and self.updates == "periodic" and not self.prompt

    def changed(self, **keys: Any) -> SkinModel:
        """The same with some things different."""
        return replace(self, **keys)

    def system(self) -> System:
        """The protocol that is explored."""
        return system_of()

    @property
    def compiled_parts(self) -> Callable[[], System]:
        """Makes its system ready for compiled code."""
        return compiled_parts

    def layout(self) -> _Layout:
        """Where in a row everything stands."""
        return layout(self)

    def world(self, plain: bool) -> w.SkinWorld:
        """Empty tables to work in."""
        return world_of(self, plain)

    def first_row(self, system: System) -> list[int]:
        """The state that everything begins with."""
        return first_row(self, system)


class System(NamedTuple):
    """What the search needs of a protocol (see search.py)."""

    parts: tuple[Callable[..., Any], ...]
    start: Callable[..., Any]
    variants: Callable[..., Any]
    step: Callable[..., Any]
    check: Callable[..., Any]
    settle: Callable[..., Any]
    turn: Callable[..., Any]
    is_settled: Callable[..., Any]


def system_of(cell: Any = skin, sink: Any = skin_sink) -> System:
    """The skin's system; of a copy of the protocol if modules are given."""
    moves = skin_moves.bind(cell, sink)
    return System(
        moves.parts,
        moves.start,
        moves.variants,
        moves.step,
        skin_check.check,
        moves.settle,
        moves.turn,
        skin_check.is_settled,
    )


@functools.cache
def compiled_parts() -> System:
    """The system with all its functions registered for the compiler."""
    from innervate.dialect import arith, outbox, rng
    from innervate.kernel import compilation
    from innervate.networks.skin import invariants
    from innervate.networks.skin.protocol import command_window
    from innervate.networks.skin.protocol import route as skin_route

    compilation.register(arith, outbox, rng, invariants)
    compilation.register(skin_route, command_window, skin, skin_sink, hot=False)
    compilation.register(skin_row, reduction, skin_check, hot=False)
    plain = [f for f in vars(skin_moves).values() if callable(f)]
    own = [f for f in plain if getattr(f, "__module__", "") == skin_moves.__name__]
    system = system_of()
    helpers = [f for f in own if f not in (skin_moves.bind, skin_moves.Moves)]
    compilation.register_functions(*helpers, *system.parts, hot=False)
    return system


def world_of(model: SkinModel, plain: bool) -> w.SkinWorld:
    """The world of a model, all bytes of its row 0.

    Raises:
        VerifyError: a number does not fit.
    """
    if model.rule not in RULES or model.updates not in UPDATES:
        raise VerifyError(
            f"rule is one of {', '.join(RULES)} and updates one of {', '.join(UPDATES)}"
        )
    forms = w.Forms(plain)
    lay = _Layout(model)
    work, work_words = forms.row(lay.width)
    trial, trial_words = forms.row(lay.width)
    best, best_words = forms.row(lay.width)
    cells = forms.states(skin_fields.CELL, 2)
    low, high = records.bounds(skin_fields.CELL)
    world = w.SkinWorld(
        at=forms.numbers(lay.settings()),
        cell_at=forms.numbers(lay.cell_at),
        port_at=forms.numbers(lay.port_at),
        out_way=forms.numbers(lay.out_way),
        in_way=forms.numbers(lay.in_way),
        way_end=forms.numbers(lay.way_end),
        way_link=forms.numbers(way // 2 for way in range(lay.ways)),
        queue_at=forms.numbers(lay.queue_at),
        link_way=forms.numbers(range(0, lay.ways, 2)),
        depth=forms.numbers([0] * model.graph.nodes),
        move_kind=forms.numbers(kind for kind, _ in lay.moves()),
        move_arg=forms.numbers(arg for _, arg in lay.moves()),
        image=forms.numbers(lay.images()),
        params=forms.states(skin_fields.PARAMS, 2),
        cells=cells,
        words=forms.words(cells, skin_fields.CELL),
        low=forms.numbers(low.tolist()),
        high=forms.numbers(high.tolist()),
        pc=w.Sink(forms.states(skin_fields.SINK, 1), forms.numbers([0] * model.graph.interfaces)),
        out=forms.outbox(),
        frame=forms.states(skin_fields.FRAME, 1),
        found=forms.numbers([0, 0]),
        work=work,
        work_words=work_words,
        trial=trial,
        trial_words=trial_words,
        best=best,
        best_words=best_words,
    )
    for i, seq_every in enumerate((1, SETTLED_M)):
        _put(world.params, i, **_parameters(model, seq_every))
    _put(world.pc.own, 0, ports=model.graph.interfaces)
    return world


def first_row(model: SkinModel, system: System) -> list[int]:
    """The bytes of the state in which everything has just been switched on."""
    world = world_of(model, plain=True)
    lay = _Layout(model)
    for c in range(model.graph.cells):
        world.work[lay.cell_at[c] + w.TICKS] = model.budget.ticks
    world.work[lay.pc_at + w.PC_COUNTS] = model.budget.counts
    given = [getattr(model.budget, name) for name in FAULTS] + [model.budget.faults]
    for i, count in enumerate(given):
        world.work[lay.budget_at + i] = count if model.budget.faults else 0
    system.start(world)
    if world.at[w.LEAN]:
        reduction.tidy(world)
    return list(world.work)


def _parameters(model: SkinModel, seq_every: int) -> dict[str, int]:
    return {
        "rule": _NUMBERS[model.rule],
        "updates": UPDATES.index(model.updates),
        "beacon_us": 4000,
        "r_f": ONE,
        "r_r": ONE,
        "k": 1,
        "max_depth": 64,
        "seq_every": seq_every,
        "balance_periods": 0,
        "balance_rule": 0,
        "hold_periods": hold_periods(model),
        "gap_us": 500,
        "skip_us": 2400,
        "restart_us": 0,
        "forward_min_us": 0,
        "forward_max_us": 0,
    }


def hold_periods(model: SkinModel) -> int:
    """FD_HOLD: k + 4 times the greatest depth there can be, unless the model says otherwise."""
    return model.hold or 1 + 4 * model.graph.cells


def _put(table: Any, place: int, **values: int) -> None:
    for name, value in values.items():
        if isinstance(table, list):
            setattr(table[place], name, value)
        else:
            table[name][place] = value


class _Layout:
    """Where things lie in a row."""

    def __init__(self, model: SkinModel) -> None:
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
        at[w.CELLS], at[w.LINKS], at[w.CAPACITY] = model.graph.cells, self.ways // 2, self.capacity
        at[w.DIRECTIONS], at[w.PC_AT], at[w.LINK_AT] = self.ways, self.pc_at, self.link_at
        at[w.BUDGET_AT], at[w.MERGE], at[w.PROMPT] = self.budget_at, model.merges, model.prompt
        at[w.FEASIBLE], at[w.KEEP] = model.rule == "feasible", model.keep
        at[w.WHOLE] = model.whole
        at[w.LEAN] = self._is_lean
        at[w.HELD] = self._held()
        at[w.RISING] = model.rule == "strict" and model.budget.restart == 0
        # Looking at the same ports again changes nothing, or nobody does before the next tick.
        at[w.STEADY] = at[w.FEASIBLE] or at[w.RISING] or model.updates == "periodic"
        at[w.IMAGES], at[w.WIDTH] = len(self.images()) // self.width, self.width
        return [int(value) for value in at]

    @property
    def _is_lean(self) -> bool:
        return self.model.lean and not self.model.prompt and not self.model.whole

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


def layout(model: SkinModel) -> _Layout:
    """Where things lie in a row of this model."""
    return _Layout(model)


__all__ = ["Budget", "SkinModel", "System", "first_row", "layout", "skin_world", "system_of"]
