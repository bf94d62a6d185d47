"""What the explorer's reduced search rests on, beside the rule's own lemmas.

Those say that a route which the rule refuses is never taken, so that it may be forgotten. These
say that beacons between periodic ticks are only stored, that the timer for news that are none
changes nothing, and, by two runs of a handler side by side, that without balancing no load decides
anything.
"""

from collections.abc import Callable, Iterable
from functools import partial
from typing import Any

from innervate.dialect.outbox import SEND
from innervate.dialect.source import Change
from innervate.networks.skin.protocol import constants as const
from innervate.networks.skin.protocol import fields
from innervate.networks.skin.prove import feasible, strict
from innervate.networks.skin.prove.neighbours import ROOM, Cell, View
from innervate.prove.execute import Machine
from innervate.prove.records import Outbox, Store, name_of
from innervate.prove.steps import Goal, Step
from innervate.prove.terms import Term, Terms
from innervate.prove.theory import source

LOADS = frozenset({"load", "size", "own_load"})
STORED = frozenset({"dist", "sq", "load", "size", "child", "heard"})
HANDLERS = {"a beacon": ("on_frame", "port", "frame"), "a period": ("on_timer", const.TICK),
            "the timer for news": ("on_timer", const.SOON)}  # fmt: skip
NOT_DRAWN = frozenset({"rng", "choice", "asked"})
SAID = ("kind", "dist", "sq", "load", "size", "parent")


def steps(rule: int, change: Change | None = None) -> tuple[Callable[[], Step], ...]:
    """Every lemma that a reduced search under a rule rests on."""
    known = source(feasible.ENTRY, change)
    return (
        partial(_stored, known, rule),
        partial(_no_news, known, rule),
        partial(_loads, known, rule, True),
        partial(_loads, known, rule, False),
    )


class Bare:
    """A cell in any state, without balancing, that can be run twice."""

    def __init__(self, known: dict[str, Any], rule: int) -> None:
        self.known = known
        self.cell = Cell(known, rule)
        self.stage = self.cell.stage
        self.t = self.stage.terms
        self.stage.fix(self.cell.frame, "kind", const.BEACON)
        self.port = self.cell.port
        self.clock = self.stage.clock()
        self.machines: list[Machine] = []
        self.facts: list[Term] = []
        self.stage.fix(self.cell.params, "balance_periods", 0)

    def view(self, store: Store) -> View:
        """The cell with these values."""
        return self.cell.view(store)

    def run(self, store: Store, handler: str, *told: Any) -> tuple[Store, Machine]:
        """The values after a handler, and the machine that ran it."""
        return self.play(Machine(self.known, self.t, Outbox(fields.FRAME, ROOM)), store, handler,
                         *told)  # fmt: skip

    def play(self, machine: Any, store: Store, handler: str, *told: Any) -> tuple[Store, Any]:
        """The same by a machine of one's own."""
        cell = self.cell
        args = [self.t.number(one) if isinstance(one, int) else one for one in told]
        given = [cell.cell, cell.params, self.clock, *args, machine.out]
        after, _ = machine.run(handler, given, store, self.t.true)
        self.machines.append(machine)
        return after, machine

    def hear(self, store: Store) -> tuple[Store, Machine]:
        """A beacon comes in on the port."""
        return self.run(store, "on_frame", self.port, self.cell.frame)

    def tick(self, store: Store) -> tuple[Store, Machine]:
        """The cell's beacon period ends."""
        return self.run(store, "on_timer", const.TICK)

    def step(self, name: str, goals: list[Goal], more: Iterable[Term] = ()) -> Step:
        """The runs as a step with goals."""
        first, *others = self.machines
        facts = [fact for machine in self.machines for fact in machine.facts]
        return Step(name, first, self.stage.records, self.stage.store, self.stage.store,
                    [*self.facts, *more, *facts], goals, others=others)  # fmt: skip

    def quiet(self, machine: Machine) -> Goal:
        """A run that sends nothing and sets no timer."""
        nothing = (self.t.negated(action.guard) for action in machine.out.actions)
        return Goal("nothing is sent", self.t.all(*nothing))

    def drawn_alike(self, a: Machine, b: Machine) -> list[Term]:
        """What two runs draw at the same place is the same."""
        return [self.t.same(x[0], y[0]) for x, y in zip(a.draws, b.draws, strict=True)]

    def same_drawn(self, a: Machine, b: Machine) -> Goal:
        """At each place both draw, out of as many, or neither does."""
        t = self.t
        pairs = [(one[1:], other[1:]) for one, other in zip(a.draws, b.draws, strict=True)]
        parts = [t.all(t.same(here, there), t.implies(here, t.same(many, others)))
                 for (many, here), (others, there) in pairs]  # fmt: skip
        return Goal("as much is drawn", t.all(*parts))

    def same_state(self, a: Store, b: Store, but: Callable[[str, int | None], Term]) -> Goal:
        """All fields of the cell are equal, but where they need not be."""
        t = self.t
        parts = []
        for key, _low, _high in self.cell.cell.places():
            if key[1] not in NOT_DRAWN:
                parts.append(t.any(but(key[1], key[2]), t.same(a[key], b[key])))
        return Goal("the same state", t.all(*parts))

    def same_sent(self, a: Machine, b: Machine, stores: tuple[Store, Store], but: Any) -> Goal:
        """All actions are equal, but for some fields of frames."""
        t = self.t
        parts = []
        for one, other in zip(a.out.actions, b.out.actions, strict=True):
            parts.append(t.same(one.guard, other.guard))
            alike = [t.same(one.a, other.a), t.same(one.b, other.b), t.same(one.c, other.c)]
            if one.kind == SEND:
                pairs = zip(one.frame.places(), other.frame.places(), strict=True)
                alike += [t.same(stores[0][x], stores[1][y]) for (x, _, _), (y, _, _) in pairs
                          if x[1] in SAID and x[1] not in but]  # fmt: skip
            parts.append(t.implies(one.guard, t.all(*alike)))
        return Goal("the same is sent", t.all(*parts))


def kept(bare: Bare, rule: int) -> list[Term]:
    """A rule's invariants of the cell's first state, and what it may be told on the port."""
    view = bare.view(bare.stage.store)
    if rule == const.RULE_FEASIBLE:
        return [*feasible.facts(view), feasible.said_by(bare.cell, bare.port)]
    return [*strict.facts(view), strict.said_by(bare.cell, bare.port)]


def _stored(known: dict[str, Any], rule: int) -> Step:
    """With periodic updates a beacon is stored, and that is all."""
    pair = Bare(known, rule)
    t, cell = pair.t, pair.cell
    pair.stage.fix(cell.params, "updates", const.PERIODIC)
    after, machine = pair.hear(pair.stage.store)

    def may_differ(field: str, index: int | None) -> Term:
        if field in STORED and index is not None:
            return t.same(pair.port, t.number(index))
        return t.false

    goals = [pair.same_state(pair.stage.store, after, may_differ), pair.quiet(machine)]
    return pair.step("a beacon between ticks, periodic", goals)


def _no_news(known: dict[str, Any], rule: int) -> Step:
    """The timer for news that are none any more changes nothing but itself."""
    pair = Bare(known, rule)
    t = pair.t
    view = pair.view(pair.stage.store)
    after, machine = pair.run(pair.stage.store, "on_timer", const.SOON)
    own = t.pick(view.has_parent(), view.own_route()[1], t.number(const.INFINITY))
    more = [
        t.same(own, view.sent_dist),
        t.same(view.parent, view.sent_parent),
        t.negated(view.is_(view.param("updates"), 2)),
    ]
    goals = [pair.same_state(pair.stage.store, after, lambda field, _: t.truth_of(field == "soon")),
             pair.quiet(machine)]  # fmt: skip
    return pair.step("the timer for news that are none", goals, more)


def _loads(known: dict[str, Any], rule: int, hears: bool) -> Step:
    """Without balancing no load and no size decides anything."""
    pair = Bare(known, rule)
    t, cell = pair.t, pair.cell
    before = pair.stage.store
    other = {
        key: t.unknown(f"{name_of(key)}'", 0, 4095) if key[1] in LOADS else value
        for key, value in before.items()
    }
    other[cell.cell, "own_load", None] = t.unknown("cell.own_load'", 1, 4095)
    run = pair.hear if hears else pair.tick
    (a, first), (b, second) = run(before), run(other)
    goals = [pair.same_state(a, b, lambda field, _: t.truth_of(field in LOADS)),
             pair.same_sent(first, second, (a, b), {"load", "size"}),
             Goal("load 0 is the same", _none(t, (a, first), (b, second))),
             pair.same_drawn(first, second)]  # fmt: skip
    what = "a beacon" if hears else "a period"
    return pair.step(f"{what} with other loads", goals, pair.drawn_alike(first, second))


def _none(t: Terms, one: tuple[Store, Machine], other: tuple[Store, Machine]) -> Term:
    """Beacons say load 0 in both runs, or in neither."""
    none = [[t.same(store[action.frame, "load", None], t.number(0))
             for action in machine.out.actions if action.kind == SEND]
            for store, machine in (one, other)]  # fmt: skip
    return t.all(*(t.same(a, b) for a, b in zip(*none, strict=True)))
