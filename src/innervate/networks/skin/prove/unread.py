"""What decides nothing though it is kept: two runs of a handler from states that differ there.

For how long a cell has had no route, while FD_HOLD is not reached; fields that the rule at hand
does not read; the number of a cell without a route; the penalty of a port that offers none; and
what a PC hears that it knows already.
"""

from collections.abc import Callable, Iterable
from functools import partial
from typing import Any

from innervate.dialect.outbox import SEND, SET_TIMER
from innervate.dialect.source import Change
from innervate.networks.skin.protocol import constants as const
from innervate.networks.skin.prove import pc
from innervate.networks.skin.prove.neighbours import ANY_RULE, ENTRY, View
from innervate.networks.skin.prove.reductions import HANDLERS, Bare, kept, same_action
from innervate.networks.skin.prove.repeating import up_to_date
from innervate.prove.execute import Machine
from innervate.prove.records import Store, name_of
from innervate.prove.steps import Goal, Step
from innervate.prove.terms import Term
from innervate.prove.theory import source

FREE = "sent_sq"  # read with updates `wave` only
DISTANCE = ("fd_known", "fd_sq", "fd_dist")
NO_ROUTE, NO_DISTANCE = "no route", "no feasible distance"


class Twice(Bare):
    """A cell in two states that differ in some fields.

    Args:
        words: what is different.
        names: fields that are; of an array those of a port.
        port: that, if any.
    """

    def __init__(
        self,
        known: dict[str, Any],
        rule: int,
        words: str,
        names: Iterable[str],
        port: int = const.NONE,
    ) -> None:
        super().__init__(known, rule)
        self.words, self.names, self.dead = words, frozenset(names), port
        self.store = dict(self.stage.store)
        for key, low, high in self.cell.places():
            if key[1] in self.names and key[2] in (None, port):
                self.store[key] = self.t.unknown(f"{name_of(key)}'", low, high)
        self.until = ""  # but for FREE, afterwards they may differ only where this is so
        self.unsent: frozenset[str] = frozenset()  # fields of beacons without a route

    def may_differ(self, after: Store) -> Callable[[str, int | None], Term]:
        """What is different may stay so."""
        view, no = self.view(after), self.t.false
        may = {
            "": self.t.true,
            NO_ROUTE: self.t.negated(view.has_parent()),
            NO_DISTANCE: view.is_(view.fd_known, 0),
        }[self.until]

        def says(field: str, index: int | None) -> Term:
            if field in DISTANCE and self.rule == const.RULE_STRICT:
                return self.t.true
            if field not in self.names or index not in (None, self.dead):
                return no
            return self.t.true if field == FREE else may

        return says

    def sent_alike(self, one: tuple[Store, Machine], other: tuple[Store, Machine]) -> Term:
        """Frames and timers are the same; nobody hears what goes to the port."""
        t, found = self.t, []
        for a, b in zip(one[1].out.actions, other[1].out.actions, strict=True):
            if a.kind not in (SEND, SET_TIMER) or (a.kind == SEND and a.a.value == self.dead):
                continue
            free: dict[str, Term] = {}
            if a.kind == SEND:
                none = t.same(one[0][a.frame, "dist", None], t.number(const.INFINITY))
                free = dict.fromkeys(self.unsent, none)
            found.append(same_action(t, (one[0], a), (other[0], b), free=free))
        return t.all(*found)


Make = Callable[[dict[str, Any], int], Twice]


def steps(rule: int, change: Change | None = None) -> tuple[Callable[[], Step], ...]:
    """Under any rule; or what more there is under one whose invariants hold."""
    known = source(ENTRY, change)
    makes: list[Make] = [partial(_penalty, const.TRIGGERED)]
    if rule == const.RULE_FEASIBLE:
        makes += [_fields, _number]
    if rule == ANY_RULE:
        makes = [_time, _fields, partial(_penalty, const.PERIODIC)]
    return (
        *(pc.unread(change) if rule == ANY_RULE else ()),
        *(partial(_same, make, known, rule, name) for make in makes for name in HANDLERS),
    )


def _same(make: Make, known: dict[str, Any], rule: int, name: str) -> Step:
    """A handler does the same in both states."""
    twice = make(known, rule)
    t, before = twice.t, twice.view(twice.stage.store)
    (a, first), (b, second) = (
        twice.run(store, *HANDLERS[name]) for store in (twice.stage.store, twice.store)
    )
    goals = [
        twice.same_state(a, b, twice.may_differ(a)),
        Goal("the same is sent", twice.sent_alike((a, first), (b, second))),
        twice.same_drawn(first, second),
    ]
    if "hold" in twice.names:
        once = t.at_most(twice.view(a).hold, t.add(before.hold, t.number(1)))
        goals.append(Goal("periods without a route are counted singly", once))
    return twice.step(f"{name}, where {twice.words}", goals, twice.drawn_alike(first, second))


def _time(known: dict[str, Any], rule: int) -> Twice:
    """How long there was no route."""
    twice = Twice(known, rule, "time without a route is other", ["hold"])
    t = twice.t
    for store in (twice.stage.store, twice.store):
        view = twice.view(store)
        below = t.less(t.add(view.hold, t.number(1)), view.param("hold_periods"))
        twice.facts.append(below)
    return twice


def _fields(known: dict[str, Any], rule: int) -> Twice:
    """What only other rules and kinds of updates read."""
    twice = Twice(known, rule, "fields of other rules are other", [*DISTANCE, FREE])
    view = twice.view(twice.stage.store)
    twice.facts.append(not_wave(view))
    if rule == const.RULE_FEASIBLE:
        twice.facts.append(view.is_(view.fd_known, 0))
        twice.store[twice.cell, "fd_known", None] = view.fd_known
        twice.until = NO_DISTANCE
    else:
        twice.facts.append(view.t.negated(view.is_(view.param("rule"), const.RULE_FEASIBLE)))
    return twice


def not_wave(view: View) -> Term:
    """The explorer's kinds of updates."""
    return view.t.negated(view.is_(view.param("updates"), const.WAVE))


def _number(known: dict[str, Any], rule: int) -> Twice:
    """The number of a cell without a route."""
    twice = Twice(known, rule, "the number of who has no route is other", ["sq_own", FREE])
    view = twice.view(twice.stage.store)
    twice.facts += [twice.t.negated(view.has_parent()), not_wave(view)]
    twice.until, twice.unsent = NO_ROUTE, frozenset({"sq"})
    return twice


def _penalty(updates: int, known: dict[str, Any], rule: int) -> Twice:
    """The penalty of a port that says "no route", and is heard no more."""
    words = f"the penalty of a port is other, {('periodic', 'triggered')[updates]}"
    port, other = 0, 1  # ports are alike (mirror.py)
    twice = Twice(known, rule, words, ["pf", "heard"], port)
    t = twice.t
    twice.port = t.number(other)
    for store in (twice.stage.store, twice.store):
        store[twice.cell, "dist", port] = t.number(const.INFINITY)
        store[twice.cell, "child", port] = t.number(0)
    view = twice.view(twice.stage.store)
    twice.facts.append(t.negated(view.is_parent(port)))
    if updates == const.TRIGGERED:  # a choice is made anew, which is up to date
        twice.facts += kept(twice)
        twice.facts += [one.holds for one in up_to_date(twice, twice.stage.store)]
    twice.facts.append(view.is_(view.param("updates"), updates))
    return twice
