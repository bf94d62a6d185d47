"""What the explorer's reduced search rests on, beside the rule's own lemmas.

Those say that a route which the rule refuses is never taken, so that it may be forgotten. These
say that beacons between periodic ticks are only stored, that the timer for news that are none
changes nothing, and, by two runs of a handler side by side, that without balancing no load decides
anything.
"""

from collections.abc import Callable, Iterable, Mapping
from functools import partial
from typing import Any

from innervate.dialect.outbox import SEND
from innervate.dialect.source import Change
from innervate.networks.skin.protocol import constants as const
from innervate.networks.skin.prove import feasible, strict
from innervate.networks.skin.prove.neighbours import ENTRY, Cell, blank
from innervate.prove.execute import Machine
from innervate.prove.records import Action, Record, Store, name_of
from innervate.prove.steps import Goal, Step
from innervate.prove.terms import Term, Terms
from innervate.prove.theory import source

LOADS = frozenset({"load", "size", "own_load"})
STORED = frozenset({"dist", "sq", "load", "size", "child", "heard"})
HANDLERS = {"a beacon": ("on_frame", "port", "frame"), "a period": ("on_timer", const.TICK),
            "the timer for news": ("on_timer", const.SOON)}  # fmt: skip
NOT_DRAWN = frozenset({"rng", "choice", "asked"})
SAID = ("kind", "dist", "sq", "load", "size", "parent")
But = Callable[[str, int | None], Term]  # where a field, or an element of one, need not be equal


def steps(rule: int, change: Change | None = None) -> tuple[Callable[[], Step], ...]:
    """Every lemma that a reduced search under a rule rests on."""
    known = source(ENTRY, change)
    return (
        partial(_stored, known, rule),
        partial(_no_news, known, rule),
        partial(_loads, known, rule, "a beacon"),
        partial(_loads, known, rule, "a period"),
    )


class Bare(Cell):
    """A cell in any state, without balancing, that can be run twice."""

    def __init__(self, known: dict[str, Any], rule: int) -> None:
        super().__init__(known, rule)
        self.rule = rule
        self.stage.fix(self.frame, "kind", const.BEACON)
        self.stage.fix(self.params, "balance_periods", 0)
        self.machines: list[Machine] = []
        self.facts: list[Term] = []

    def run(self, store: Store, handler: str, *told: Any) -> tuple[Store, Machine]:
        """The values after a handler, and the machine that ran it."""
        return self.by(blank(self.known, self.t), store, handler, *told)

    def by(self, machine: Any, store: Store, handler: str, *told: Any) -> tuple[Store, Any]:
        """The same by a machine of one's own."""
        after, _ = machine.run(handler, self.arguments(told, machine.out), store)
        self.machines.append(machine)
        return after, machine

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

    def same_sent(self, one: tuple[Store, Machine], other: tuple[Store, Machine]) -> Goal:
        """All actions are equal, but for the loads that frames say."""
        pairs = zip(one[1].out.actions, other[1].out.actions, strict=True)
        said = [name for name in SAID if name not in LOADS]
        alike = (same_action(self.t, (one[0], a), (other[0], b), said) for a, b in pairs)
        return Goal("the same is sent", self.t.all(*alike))

    def same_state(self, a: Store, b: Store, but: But) -> Goal:
        """All fields of the cell are equal, but where they need not be."""
        return Goal("the same state", same_state(self.t, self.cell, a, b, but))


def same_state(t: Terms, cell: Record, a: Store, b: Store, but: But | None = None) -> Term:
    """A cell has the same values, but where it need not."""
    return t.all(*(t.any(but(*key[1:]) if but else t.false, t.same(a[key], b[key]))
                   for key, _, _ in cell.places() if key[1] not in NOT_DRAWN))  # fmt: skip


def same_action(
    t: Terms,
    one: tuple[Store, Action],
    other: tuple[Store, Action],
    fields: Iterable[str] = SAID,
    free: Mapping[str, Term] | None = None,
    any_port: bool = False,
) -> Term:
    """Two actions, with the values behind them, are the same, and happen where the other does.

    Of a frame those fields must be equal, but for where one of them is `free`; what is sent may go
    to another port if it may to any.
    """
    (store, a), (image, b) = one, other
    alike = [t.same(a.b, b.b), t.same(a.c, b.c)]
    if not any_port or a.kind != SEND:
        alike.append(t.same(a.a, b.a))
    if a.kind == SEND:
        for name in fields:
            same = t.same(store[a.frame, name, None], image[b.frame, name, None])
            alike.append(t.any((free or {}).get(name, t.false), same))
    return t.all(t.same(a.guard, b.guard), t.implies(a.guard, t.all(*alike)))


def kept(bare: Bare) -> list[Term]:
    """A rule's invariants of the cell's first state, and what it may be told on the port."""
    rule = feasible.RULE if bare.rule == const.RULE_FEASIBLE else strict.RULE
    return [*rule.facts(bare.view(bare.stage.store)), rule.said_by(bare)]


def _stored(known: dict[str, Any], rule: int) -> Step:
    """With periodic updates a beacon is stored, and that is all."""
    bare = Bare(known, rule)
    t, before = bare.t, bare.stage.store
    bare.stage.fix(bare.params, "updates", const.PERIODIC)
    after, machine = bare.run(before, *HANDLERS["a beacon"])

    def may_differ(field: str, index: int | None) -> Term:
        if field in STORED and index is not None:
            return t.same(bare.port, t.number(index))
        return t.false

    goals = [bare.same_state(before, after, may_differ), bare.quiet(machine)]
    return bare.step("a beacon between ticks, periodic", goals)


def _no_news(known: dict[str, Any], rule: int) -> Step:
    """The timer for news that are none any more changes nothing but itself."""
    bare = Bare(known, rule)
    t, before = bare.t, bare.stage.store
    view = bare.view(before)
    after, machine = bare.run(before, *HANDLERS["the timer for news"])
    own = t.pick(view.has_parent(), view.own_route()[1], t.number(const.INFINITY))
    more = [
        t.same(own, view.sent_dist),
        t.same(view.parent, view.sent_parent),
        t.negated(view.is_(view.param("updates"), const.WAVE)),
    ]
    goals = [bare.same_state(before, after, lambda field, _: t.truth_of(field == "soon")),
             bare.quiet(machine)]  # fmt: skip
    return bare.step("the timer for news that are none", goals, more)


def _loads(known: dict[str, Any], rule: int, what: str) -> Step:
    """Without balancing no load and no size decides anything."""
    bare = Bare(known, rule)
    t, before = bare.t, bare.stage.store
    other = {
        key: t.unknown(f"{name_of(key)}'", 0, 4095) if key[1] in LOADS else value
        for key, value in before.items()
    }
    other[bare.cell, "own_load", None] = t.unknown("cell.own_load'", 1, 4095)
    (a, first), (b, second) = (bare.run(store, *HANDLERS[what]) for store in (before, other))
    none = [[t.same(store[action.frame, "load", None], t.number(0))
             for action in machine.out.actions if action.kind == SEND]
            for store, machine in ((a, first), (b, second))]  # fmt: skip
    goals = [
        bare.same_state(a, b, lambda field, _: t.truth_of(field in LOADS)),
        bare.same_sent((a, first), (b, second)),
        Goal("load 0 is the same", t.all(*map(t.same, *none))),
        bare.same_drawn(first, second),
    ]
    return bare.step(f"{what} with other loads", goals, bare.drawn_alike(first, second))
