"""What the explorer forgets of a port changes no future: two runs of a handler side by side.

A port is *dead* if it said "no route" or "you are my parent", or, and is not the parent's, a route
that the rule refuses, or if its cable does not work. It stays so until it says something else,
since what is refused stays refused (F, T3), or until it works again. So in both runs a dead port
may be taken for one that cannot be had, wherever the handler asks; that it is so at each of these
places is a goal, too.
"""

import ast
from collections.abc import Callable
from functools import partial
from typing import Any

from innervate.dialect.source import Change, Function
from innervate.networks.skin.protocol import constants as const
from innervate.networks.skin.protocol import fields
from innervate.networks.skin.prove.neighbours import ANY_RULE, ENTRY, ROOM
from innervate.networks.skin.prove.reductions import LOADS, STORED, Bare
from innervate.prove.execute import Machine
from innervate.prove.records import Array, Demand, Outbox, State, Store
from innervate.prove.steps import Goal, Step
from innervate.prove.terms import Term, Terms
from innervate.prove.theory import source

SAYS = frozenset({"dist", "sq", "child", "load", "size"})
NO_ROUTE, REFUSED = "says that it cannot be had", "says what the rule refuses"
BROKEN = "does not work"
PORT = 0  # ports are alike (mirror.py), so that one stands for all, and for all others the next
QUESTIONS = {NO_ROUTE: "is_usable", REFUSED: "is_allowed", BROKEN: "is_usable"}


class Asked(Machine):
    """Answers a question about a port with no, and demands that this be the answer.

    Args:
        question: a function of cell, parameters and port.
        event: that is run; of the same in two runs the same is drawn.
    """

    def __init__(self, functions: Any, terms: Terms, question: str, port: int, event: str) -> None:
        super().__init__(functions, terms, Outbox(fields.FRAME, ROOM))
        self.event = event
        self.question = question
        self.port = terms.number(port)

    def call(
        self, function: Function, args: list[Any], store: Store, under: Term
    ) -> tuple[Store, Any]:
        """Follow a call; the answer to the question is known."""
        after, value = super().call(function, args, store, under)
        if function.name == self.question and args[2] is self.port:
            no = self.terms.negated(self.terms.as_truth(value))
            self.demands.append(Demand("a dead port cannot be had", under, no, self.question))
            return after, self.terms.false
        return after, value

    def element(self, array: Array, index: Term, node: ast.AST, state: State) -> Term:
        """An element of an array: at an unknown index it is not the dead port's."""
        if index.value is not None or array.name not in SAYS:
            return super().element(array, index, node, state)
        t = self.terms
        others = [k for k in range(max(index.low, 0), array.length) if k != self.port.value]
        other = t.negated(t.same(index, self.port))
        guard = self.here(state)
        self.demands.append(Demand("a dead port is not looked at", guard, other, self.question))
        found = state.store[array.record, array.name, others[0]]
        for k in others[1:]:
            here = t.same(index, t.number(k))
            found = t.pick(here, state.store[array.record, array.name, k], found)
        return found

    def draw(self, many: Term, state: State) -> Term:
        """The same draw of both runs returns the same number."""
        t = self.terms
        drawn = t.unknown(f"{self.event}: draw {len(self.draws)}", 0, const.PORTS - 1)
        under = t.all(self.here(state), t.at_most(t.number(1), many))
        self.facts.append(t.implies(under, t.less(drawn, many)))
        self.draws.append((drawn, many, under))
        return drawn


def steps(rule: int, change: Change | None = None) -> tuple[Callable[[], Step], ...]:
    """That what a dead port said decides nothing: under any rule, or what one refuses for good."""
    known = source(ENTRY, change)
    return tuple(
        partial(_dead, known, rule, PORT, parent, why)
        for parent in (const.NONE, PORT, PORT + 1)
        for why in ((NO_ROUTE, BROKEN) if rule == ANY_RULE else (REFUSED,))
        if parent != PORT or why == NO_ROUTE
    )


class Runs(Bare):
    """Runs of a cell one of whose ports is dead.

    Args:
        p: the port that is dead.
        parent: the cell's.
        why: NO_ROUTE, REFUSED or BROKEN.
    """

    def __init__(self, known: dict[str, Any], rule: int, p: int, parent: int, why: str) -> None:
        super().__init__(known, rule)
        self.p, self.why = p, why
        self.stage.fix(self.cell, "parent", parent)
        if parent == p:  # only until the next tick
            self.stage.fix(self.params, "updates", const.PERIODIC)
        if parent != const.NONE:
            self.stage.fix(self.cell, "wait", 0)  # I2
        self.goals: list[Term] = []

    def dead(self, sq: Term, dist: Term, child: Term) -> Term:
        """Who says this is dead, unless a feasible distance is forgotten."""
        t, store = self.t, self.stage.store
        view = self.view(store)
        if self.why == NO_ROUTE:
            return t.any(view.is_(dist, const.INFINITY), view.is_(child, 1))
        if self.why == BROKEN:
            return t.negated(view.works(self.p))
        if self.rule == const.RULE_FEASIBLE:
            known, better = view.fd_known, self.asks("nearer_than_fd", [self.cell, sq, dist], store)
        else:
            known, better = view.sq_known, self.asks("later", [sq, view.sq_own], store)
        return t.all(view.is_(known, 1), t.negated(better))

    def forgotten(self, store: Store) -> Store:
        """The same where the port has said "no route"; of one that is broken, any penalty of it."""
        words = {"dist": const.INFINITY, "sq": 0, "child": 0, "load": 0, "size": 0}
        found = dict(store)
        for name, value in words.items():
            found[self.cell, name, self.p] = self.t.number(value)
        if self.why == BROKEN:
            any_ = self.t.unknown("other penalty", const.ONE, 2 * const.ONE)
            found[self.cell, "pf", self.p] = any_
        return found

    def asked(self, store: Store, handler: str, *told: Any) -> tuple[Store, Asked]:
        """The values after a handler, where the question is answered."""
        event = " ".join([handler, *(str(one) for one in told if isinstance(one, int))])
        machine = Asked(self.known, self.t, QUESTIONS[self.why], self.p, event)
        after, _ = self.by(machine, store, handler, *told)
        self.goals += [self.t.implies(one.guard, one.holds) for one in machine.demands
                       if one.where == machine.question]  # fmt: skip
        return after, machine

    def compare(self, handler: str, *told: Any) -> list[Store]:
        """A handler leaves the same in both runs, but for the port's words and for loads."""
        before = self.stage.store
        (a, first), (b, second) = (
            self.asked(store, handler, *told) for store in (before, self.forgotten(before))
        )
        state = self.same_state(a, b, self.may_differ)
        same = (state, self.same_sent((a, first), (b, second)), self.same_drawn(first, second))
        self.goals += [goal.holds for goal in same]
        return [a, b]

    def may_differ(self, field: str, index: int | None) -> Term:
        """What is forgotten may differ: the port's words, and loads."""
        words = {*STORED, "pf"} if self.why == BROKEN else STORED
        return self.t.truth_of(field in LOADS or (field in words and index == self.p))


def _dead(known: dict[str, Any], rule: int, p: int, parent: int, why: str) -> Step:
    """What a dead port said decides nothing at a tick, and at no beacon."""
    two = Runs(known, rule, p, parent, why)
    t, view = two.t, two.view(two.stage.store)
    forgets = t.at_most(view.param("hold_periods"), t.add(view.hold, t.number(1)))
    now = two.dead(view.at("sq", p), view.at("dist", p), view.at("child", p))
    ticked = two.compare("on_timer", const.TICK)
    if why == REFUSED:
        two.goals = [t.any(forgets, one) for one in two.goals]
    if why == BROKEN:
        works = t.any(*(two.view(after).works(p) for after in ticked))
        two.goals = [t.any(works, one) for one in two.goals]
    if p != parent:
        two.compare("on_timer", const.SOON)
    for q in range(const.PORTS):
        if q != p:
            two.compare("on_frame", q, "frame")
    two.goals = [t.implies(now, one) for one in two.goals]
    if p != parent:
        two.goals.append(_hears(two))
    words = f"a port {why}: {p}, the parent's {parent if parent >= 0 else 'none'}"
    return two.step(words, [Goal("it may be forgotten", t.all(*two.goals))])


def _hears(two: Runs) -> Term:
    """A port that is not the parent's hears something dead: that is stored, and that is all."""
    t, before = two.t, two.stage.store
    place = len(two.goals)
    after, machine = two.asked(before, "on_frame", two.p, "frame")
    asked, two.goals = two.goals[place:], two.goals[:place]
    said = [before[two.frame, name, None] for name in ("sq", "dist", "parent")]
    same = two.same_state(before, after, two.may_differ).holds
    return t.implies(two.dead(*said), t.all(*asked, two.quiet(machine).holds, same))
