"""What is between the cells: neighbours' steps, numbers that wrap, and why no ring closes.

A cell's handlers see its neighbours only as ghosts. Here the ghosts move: whatever a neighbour's
own step does to its feasible distance leaves this cell's invariants standing. That those are all
the ways in which it moves is what F, F1 and W1 .. W3 say of the neighbour's handlers.
"""

from collections.abc import Callable
from functools import partial
from typing import Any

from innervate.dialect.arith import MASK16
from innervate.dialect.source import Change
from innervate.networks.skin.protocol.constants import INFINITY, RULE_FEASIBLE
from innervate.networks.skin.prove.feasible import RULE
from innervate.networks.skin.prove.neighbours import ENTRY, Cell, Ghost, View, moved, number
from innervate.prove.steps import Goal, Step
from innervate.prove.terms import Term
from innervate.prove.theory import source


def steps(change: Change | None = None) -> tuple[Callable[[], Step], ...]:
    """What neighbours do, and what makes a ring impossible."""
    known = source(ENTRY, change)
    moves = (("a neighbour gets nearer", nearer),
             ("a neighbour loses its memory, or forgets in time", forgets),
             ("a neighbour has its first route", first),
             ("a neighbour has a route again, after all gave it up", again))  # fmt: skip
    return (
        *(partial(moved, name, RULE, how) for name, how in moves),
        partial(compared, known),
        ring,
    )


def nearer(view: View, old: Ghost, new: Ghost, p: int) -> Term:
    """F: it has one and it is not farther than before."""
    t = view.t
    worse = view.nearer((old.sq, old.dist), (new.sq, new.dist))
    return t.all(old.known, new.known, t.same(old.old, new.old), t.negated(worse))


def forgets(view: View, old: Ghost, new: Ghost, p: int) -> Term:
    """A restart, or F1: it has none any more, and what is kept of it may be older."""
    return view.t.all(view.t.negated(new.known), new.old)


def first(view: View, old: Ghost, new: Ghost, p: int) -> Term:
    """It never had a feasible distance."""
    t = view.t
    return t.all(t.negated(t.any(old.known, old.old)), new.known, t.negated(new.old))


def again(view: View, old: Ghost, new: Ghost, p: int) -> Term:
    """The timing assumptions: nothing is left here of what it said before it forgot."""
    return view.t.all(view.is_settled(p), new.known, view.t.negated(new.old))


def compared(known: dict[str, Any]) -> Step:
    """The protocol's `later` is the order of numbers in use, however they wrap."""
    cell = Cell(known, RULE_FEASIBLE)
    stage, t = cell.stage, cell.stage.terms
    view = cell.view(stage.store)
    a, b = t.unknown("a", 0, MASK16), t.unknown("b", 0, MASK16)
    both = [view.in_window(a), view.in_window(b)]
    step = stage.play("numbers are compared", "later", [a, b], both)
    ahead = t.less(view.offset(b), view.offset(a))
    step.goals = [Goal("T1 later is the order of numbers", t.same(t.as_truth(step.result), ahead))]
    return step


def ring() -> Step:
    """Nearer is an order: whoever follows parents from a cell never comes back to it."""
    cell = Cell({}, RULE_FEASIBLE)
    stage, t = cell.stage, cell.stage.terms
    view = cell.view(stage.store)
    fds = [(number(t, f"sq{i}"), t.unknown(f"dist{i}", 0, INFINITY)) for i in range(3)]
    a, b, c = fds
    both = t.all(view.nearer(a, b), view.nearer(b, c))
    goals = [
        Goal("T2 nothing is nearer than itself", t.negated(view.nearer(a, a))),
        Goal("T3 what is nearer than what is nearer is nearer", t.implies(both, view.nearer(a, c))),
    ]
    known = [view.in_window(sq) for sq, _ in fds]
    return Step("a way along parents", stage.machine, {}, {}, {}, known, goals)
