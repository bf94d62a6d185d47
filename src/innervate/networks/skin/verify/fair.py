"""Liveness: from every state found, without further faults, routes become shortest in time.

The schedule is fair: in every round each node ticks once, in any order, and everything in flight
arrives before the next one ticks. A round leads from a set of states to the set of those that
are not settled yet, by every order of the nodes; the set has to be empty after the bound.
"""

from collections.abc import Callable
from dataclasses import dataclass, field
from functools import cache
from itertools import permutations
from typing import Any, NamedTuple

import numpy as np

from innervate.kernel import compilation, tables
from innervate.kernel.clock import wall_s
from innervate.kernel.compilation import bound
from innervate.networks.skin.verify import calm as skin_calm
from innervate.networks.skin.verify import system as skin_system
from innervate.networks.skin.verify import world as w
from innervate.sim.tables import Tables
from innervate.verify import explore as ex
from innervate.verify import search as s
from innervate.verify.table import Table

CHUNK = 2_000
PLAIN_CHUNK = 50
# What is played, if not a round of so many nodes: what comes before the first one; what comes
# before that, where beacons may have been lost; what comes before one in which cells may forget.
CALM, LOST, EXPIRY = 0, -1, -2


@dataclass(slots=True)
class Fair:
    """What came of the fair schedule."""

    bound: int  # rounds that routes may take
    starts: int = 0  # states it was tried from
    of: int = 0  # states there were
    calm: int = 0  # different states when faults have ended and nothing is in flight
    rounds: int = 0  # until everything was settled; the bound if it was not
    left: list[int] = field(default_factory=list)  # states not settled after each round
    played: int = 0  # rounds played in all
    left_out: int = 0  # of these, with more in flight than there is room for; they prove nothing
    wall_s: float = 0.0
    # rows from the state in question to the one that is not settled at the bound
    path: list[bytes] = field(default_factory=list)
    ended: str = "interrupted"  # "complete", "broken", "memory" or "interrupted"
    # what was under way set off more without end; `path` may be empty then
    is_endless: bool = False

    @property
    def broken(self) -> str:
        """What does not hold, in one line; "" nothing."""
        if self.ended != "broken":
            return ""
        if self.is_endless:
            return f"what is under way sets off more without end, after {self.rounds} fair rounds"
        return f"routes are not shortest after {self.bound} fair rounds"


def calm(world, do, source, target, index):
    """No more faults, and what is in flight arrives, before the first round."""
    skin_calm.draw_first(world)
    is_open = True
    while is_open:
        s.fetch_row(world, source, index)
        skin_calm.forget_budgets(world)
        world.found[0] = 0
        if not do.settle(world):
            target.run[s.BROKEN] = 1
        if world.found[0] == s.TOO_MANY:
            target.run[s.LEFT_OUT] += 1
        s.insert(world, target, index)
        is_open = skin_calm.draw_otherwise(world) and target.run[s.BROKEN] == 0


def round_of(world, do, source, target, index, order):
    """One round in one order, with all that it can draw; what is not settled then is kept."""
    run = target.run
    skin_calm.draw_first(world)
    is_open = True
    while is_open:
        s.fetch_row(world, source, index)
        world.found[0] = 0
        for k in range(world.at[w.CELLS] + 1):
            if not do.turn(world, world.orders[order + k]):
                run[s.BROKEN] = 1
        run[s.GENERATED] += 1
        if world.found[0] == s.TOO_MANY:
            run[s.LEFT_OUT] += 1
        if not do.is_settled(world):
            s.insert(world, target, index)
        is_open = skin_calm.draw_otherwise(world) and target.run[s.BROKEN] == 0


def build(system: Any) -> Callable[..., None]:
    """What plays a round from rows begin .. end - 1 of `source`."""
    do = bound("system", settle=system.settle, turn=system.turn, is_settled=system.is_settled)

    def play(world, source, target, nodes, begin, end):  # type: ignore[no-untyped-def]
        """A round from each state, or CALM, LOST, or EXPIRY."""
        run = target.run
        for index in range(begin, end):
            run[s.STATUS] = s.room_left(run)
            if run[s.STATUS] == s.GROW or run[s.STATUS] == s.FULL:
                run[s.NEXT] = -index  # how far it came, out of the way of `room_left`
                return
            if nodes == CALM:
                calm(world, do, source, target, index)
            elif nodes == LOST:
                skin_calm.insert_lost(world, source, target, index)
            elif nodes == EXPIRY:
                skin_calm.insert_expiring(world, source, target, index)
            else:
                for order in range(0, len(world.orders), nodes):
                    round_of(world, do, source, target, index, order)
        run[s.NEXT] = -end

    return play


@cache
def _compiled() -> Callable[..., None]:
    ex.compiled_engine(skin_system.compiled_parts)  # registers what keeps states
    compilation.register(skin_calm, hot=False)
    compilation.register_functions(calm, round_of, hot=False)
    return compilation.compiled_as_one(build(skin_system.compiled_parts()))


def bound_of(model: Any) -> int:
    """Rounds within which every connected cell has to have a shortest route."""
    return 4 * int(model.graph.cells) + skin_system.hold_periods(model)


def check(
    result: ex.Result,
    *,
    plain: bool = False,
    system: Any = None,
    starts: int = 0,
    memory: int = ex.MEMORY,
    progress: Callable[[Fair], bool] | None = None,
) -> Fair:
    """Play the fair schedule from all states of a search, or from `starts` evenly spaced ones."""
    space = _Space(result.model, plain, memory)
    first = space.rows(_starts(result, starts, plain))
    fair = Fair(bound_of(result.model), starts=first.count, of=result.tally.states)
    play = build(system or skin_system.system_of()) if plain else _compiled()
    _settle(_Player(space, play, fair, progress), first)
    return fair


class _Space(NamedTuple):
    """Where the states of a model are kept: by compiled code or plain, in so many bytes."""

    model: Any
    plain: bool
    memory: int

    def rows(self, rows: Any = None) -> Table:
        """The states of a round, with none in it yet unless they are given."""
        lay, plain = self.model.layout(), self.plain
        limit = self.memory // (lay.width + 32) if rows is None else len(rows) // (lay.width // 8)
        limit = min(limit, 1 << 19) if plain and rows is None else limit
        return Table(lay, plain, limit, [255] * lay.width, rows)

    def refill(self) -> Callable[[Any], None]:
        """What enters all rows into a new table."""
        if self.plain:
            return s.refill
        return ex.compiled_engine(skin_system.compiled_parts).refill


class _Player:
    """What plays rounds, and notes what came of them.

    Attributes:
        fair: what came of it.
        chain: the states before each round that was played.
    """

    def __init__(self, space: _Space, play: Any, fair: Fair, progress: Any) -> None:
        model, plain = space.model, space.plain
        self.model, self.space, self.fair, self.chain = model, space, fair, list[Table]()
        self.nodes = int(model.graph.nodes)
        self._play, self._progress, self._begun = play, progress, wall_s()
        flat = [node for order in permutations(range(self.nodes)) for node in order]
        world = model.changed(keep=True).world(plain)
        world = world._replace(orders=Tables(plain).given(flat, np.int32))
        world.at[w.FAIR] = 1
        self.held = int(world.at[w.HELD])
        self._world = world if plain else tables.borrowed(world)
        self._made = world  # what is borrowed lives as long

    def round(self, source: Table, nodes: int) -> Table | None:
        """What one round from all rows of `source` leaves; None if it was ended early."""
        target, fair = self.space.rows(), self.fair
        at, chunk = 0, PLAIN_CHUNK if target.plain else CHUNK
        while at < source.count:
            end = min(at + chunk, source.count)
            target.search.run[s.NEXT] = -end
            self._play(self._world, source.seen, target.seen, nodes, at, end)
            at = -int(target.search.run[s.NEXT])
            status = int(target.search.run[s.STATUS])
            if status == s.GROW:
                target.grow(self.space.refill())
            fair.wall_s = wall_s() - self._begun
            if status == s.FULL:
                fair.ended = "memory"
                return None
            if self._progress is not None and self._progress(fair):
                return None
        fair.played += int(target.search.run[s.GENERATED])
        fair.left_out += int(target.search.run[s.LEFT_OUT])
        self.chain.append(source)
        return target


def _settle(player: _Player, source: Table) -> None:
    """Round after round, until nothing is left that is not settled, or too many were played."""
    model, fair = player.model, player.fair
    here: Table | None = source
    for _ in range(model.budget.loss if model.merges else 0):
        here = here and player.round(here, LOST)
    for turn in range(fair.bound + 1):
        here = here and player.round(here, player.nodes if turn else CALM)
        if here is None:
            return
        if turn:
            fair.rounds += 1
            fair.left.append(here.count)
        else:
            fair.calm = here.count
        if int(here.search.run[s.BROKEN]):
            fair.is_endless = True
            break
        if here.count == 0:
            fair.ended = "complete"
            return
        if turn + player.held >= skin_system.hold_periods(model):
            here = player.round(here, EXPIRY)
    if here is not None:
        fair.ended = "broken"
        fair.path = _way_to(here, player.chain) if here.count else []


def _way_to(last: Table, chain: list[Table]) -> list[bytes]:
    """The rows that lead to the first of the last ones."""
    path, index = [], 0
    for place in [last, *reversed(chain)]:
        path.append(place.row(index))
        index = int(place.search.before[index])
    path.reverse()
    return path


def _starts(result: ex.Result, starts: int, plain: bool) -> Any:
    words = result.model.layout().width // 8
    count = len(result.rows) // words
    if not starts or starts >= count:
        return result.rows
    places = [count * i // starts for i in range(starts)]
    picked = np.asarray(result.rows).reshape(-1, words)[places].reshape(-1)
    return picked.data if plain else picked
