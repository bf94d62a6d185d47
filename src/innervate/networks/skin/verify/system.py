"""A skin for the explorer: from a graph and budgets to a world, and how it is searched."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from functools import cache, partial
from typing import Any

import numpy as np

from innervate.kernel import records
from innervate.networks.skin.protocol import cell as skin
from innervate.networks.skin.protocol import fields as skin_fields
from innervate.networks.skin.protocol import sink as skin_sink
from innervate.networks.skin.scenario.model import ProtocolTable
from innervate.networks.skin.scenario.plan import parameters
from innervate.networks.skin.verify import check as skin_check
from innervate.networks.skin.verify import moves as skin_moves
from innervate.networks.skin.verify import reduction
from innervate.networks.skin.verify import row as skin_row
from innervate.networks.skin.verify import world as w
from innervate.networks.skin.verify.layout import Layout
from innervate.networks.skin.verify.layout import hold_periods as hold_periods
from innervate.networks.skin.verify.moves import System as System
from innervate.sim.tables import Tables, put
from innervate.topology import Graph
from innervate.verify.errors import VerifyError
from innervate.verify.table import row

RULES = ("feasible", "strict", "paper", "paper-lax")
UPDATES = ("periodic", "triggered")
ANY = w.ANY
FAULTS = ("loss", "cut", "heal", "false", "restart")
SETTLED_M = 3  # the fair schedule counts the PC's number every so many rounds


@dataclass(frozen=True, slots=True)
class Budget:
    """How often what may happen."""

    # periods of every cell; ANY as many as it takes, but no cell without a route for as many
    # as FD_HOLD
    ticks: int = 3
    counts: int = 2  # beacons of the PC, each with a new number
    # loss, cut, heal, false, restart: lost frames, cut and mended cables, ports found broken
    # without a reason, restarts of the PC
    loss: int = 1
    cut: int = 1
    heal: int = 1
    false: int = 1
    restart: int = 1
    faults: int = 2  # all of these together


@dataclass(frozen=True)
class SkinModel:
    """What is explored of a skin."""

    graph: Graph  # cells, PC and cables
    rule: str = "feasible"  # one of RULES
    updates: str = "periodic"  # "periodic" or "triggered"
    budget: Budget = field(default_factory=Budget)  # how often what may happen
    hold: int = 0  # FD_HOLD, in periods
    prompt: bool = False  # every frame arrives, or is lost, before anything else happens
    merge: bool = True  # use that periodic beacons are only looked at in a tick (see moves.py)
    keep: bool = False  # keep what only a later fair schedule would see
    symmetric: bool = True  # take states that differ by a symmetry of the graph as one
    # most frames in flight per direction; states with more are left out, and counted. 0 =
    # what periodic cells can send within their budget; of triggered ones ROOM, or LEAN_ROOM
    capacity: int = 0
    unreduced: bool = False  # leave no beacon out, though it changes nothing
    # forget what can no longer matter (see reduction.py), and follow no state of which a
    # known one differs only in that more may still happen
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

    def layout(self) -> Layout:
        """Where in a row everything stands."""
        return Layout(self)

    def world(self, plain: bool) -> w.SkinWorld:
        """Tables to work in, all bytes of their row 0.

        Raises:
            VerifyError: there is no such rule, or no such kind of updates.
        """
        if self.rule not in RULES or self.updates not in UPDATES:
            raise VerifyError(
                f"rule is one of {', '.join(RULES)} and updates one of {', '.join(UPDATES)}"
            )
        lay, tables = self.layout(), Tables(plain)
        numbers = partial(tables.given, kind=np.int32)
        rows = {}
        for name in ("work", "trial", "best"):
            rows[name], rows[f"{name}_words"] = row(lay.width, plain)
        cells = tables.states(skin_fields.CELL, 2)
        low, high = records.bounds(skin_fields.CELL)
        moves, graph = lay.moves(), self.graph
        places = ("cell_at", "port_at", "out_way", "in_way", "way_end", "queue_at")
        world = w.SkinWorld(
            at=numbers(lay.settings()),
            **{name: numbers(getattr(lay, name)) for name in places},
            depth=tables.numbers(graph.nodes),
            orders=numbers([]),
            move_kind=numbers([kind for kind, _ in moves]),
            move_arg=numbers([arg for _, arg in moves]),
            image=numbers(lay.images()),
            params=tables.states(skin_fields.PARAMS, 2),
            cells=cells,
            words=tables.words(cells, skin_fields.CELL),
            low=numbers(low),
            high=numbers(high),
            pc=w.Sink(tables.states(skin_fields.SINK, 1), tables.numbers(graph.interfaces)),
            out=tables.outbox(w.OUTBOX, skin_fields.FRAME),
            frame=tables.states(skin_fields.FRAME, 1),
            found=tables.numbers(1),
            draws=tables.numbers(1 + 2 * w.DRAWS),
            **rows,
        )
        for i, seq_every in enumerate((1, SETTLED_M)):
            put(world.params, i, **_parameters(self, seq_every))
        put(world.pc.own, 0, ports=graph.interfaces)
        return world

    def first_row(self, system: System) -> list[int]:
        """The bytes of the state in which everything has just been switched on."""
        world, lay, budget = self.world(plain=True), self.layout(), self.budget
        for at in lay.cell_at:
            world.work[at + w.TICKS] = budget.ticks
        world.work[lay.pc_at + w.PC_COUNTS] = budget.counts
        given = [getattr(budget, name) for name in FAULTS] + [budget.faults]
        for i, count in enumerate(given):
            world.work[lay.budget_at + i] = count if budget.faults else 0
        system.start(world)
        if world.at[w.LEAN]:
            reduction.tidy(world)
        return list(world.work)


def system_of(cell: Any = skin, sink: Any = skin_sink) -> System:
    """The skin's system; of a copy of the protocol if modules are given."""
    return skin_moves.bind(cell, sink)


@cache
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
    helpers = [f for f in own if f not in (skin_moves.bind, System)]
    compilation.register_functions(*helpers, *system.parts, hot=False)
    return system


def _parameters(model: SkinModel, seq_every: int) -> dict[str, int]:
    asked: Any = {"rule": model.rule, "updates": model.updates}
    table = ProtocolTable(**asked, k=1, m=seq_every, balancing=False)
    return {**parameters(table, model.graph.cells), "hold_periods": hold_periods(model)}
