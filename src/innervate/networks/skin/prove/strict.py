"""Rule `strict`: numbers along a way to the PC only rise, as long as the PC's own does.

No feasible distance here. A cell takes a new parent only for a newer number than its own, and all
who reach the PC through it have numbers no newer than its own; so none of them is that parent.
Conditions: the PC is not restarted, and a cable keeps the order of its frames.
"""

from collections.abc import Callable
from functools import partial
from typing import Any

from innervate.dialect.source import Change
from innervate.networks.skin.protocol import constants as const
from innervate.networks.skin.prove.feasible import forgotten
from innervate.networks.skin.prove.neighbours import ENTRY, EVENTS, STARTS, Cell, Rule, View, moved
from innervate.networks.skin.prove.system import again, forgets
from innervate.prove.steps import Goal, Step, own_goals, sent
from innervate.prove.terms import Term
from innervate.prove.theory import source


def steps(change: Change | None = None) -> tuple[Callable[[], Step], ...]:
    """All that can happen to a cell, and to what it knows of its neighbours."""
    play = partial(RULE.play, source(ENTRY, change))
    moves = (("a neighbour's number rises", _rises), ("a neighbour loses its memory", forgets),
             ("a neighbour has a route again, after all gave it up", again))  # fmt: skip
    return (
        *(partial(play, name, _started if name == STARTS else _kept) for name in EVENTS),
        *(partial(moved, name, RULE, how) for name, how in moves),
    )


def invariants(view: View) -> list[Goal]:
    """What holds of every cell between any two events, under `strict`."""
    t, known = view.t, view.is_(view.sq_known, 1)
    has = view.has_parent()
    triggered = t.negated(view.is_(view.param("updates"), const.PERIODIC))
    taken, behind, kept, unheard = [], [], [], []
    for p, ghost in enumerate(view.ghosts):
        leads = view.is_parent(p)
        finite = t.less(view.at("dist", p), t.number(const.INFINITY))
        taken.append(t.implies(t.all(leads, finite), view.no_newer(view.sq_own, view.at("sq", p))))
        behind.append(t.implies(t.all(leads, ghost.known), view.no_newer(view.sq_own, ghost.sq)))
        kept.append(t.implies(t.all(view.has_route(p), ghost.known),
                              view.no_newer(view.at("sq", p), ghost.sq)))  # fmt: skip
        silent = t.negated(t.any(ghost.known, ghost.old))
        unheard.append(t.implies(silent, view.is_settled(p)))
    return [
        Goal("S1 who has a route has a number", t.implies(has, known)),
        Goal("S2 who waits after a restart has neither a route nor a number",
             t.implies(t.less(t.number(0), view.wait), t.negated(t.any(has, known)))),
        Goal("S3 the number is no newer than what the parent said last", t.all(*taken)),
        Goal("S4 no route kept is newer than its sender's number", t.all(*kept)),
        Goal("S5 the number is no newer than the parent's", t.all(*behind)),
        Goal("S6 nothing is kept of who never had a route", t.all(*unheard)),
        Goal("S7 the parent's port works", t.implies(has, view.works(view.parent))),
        Goal("S8 with triggered updates the number is the parent's",
             t.implies(t.all(has, triggered), t.same(view.sq_own, view.at("sq", view.parent)))),
    ]  # fmt: skip


def windowed(view: View) -> Term:
    """All numbers that may still be compared are among those in use."""
    return view.windowed("sq_known", "sq_own")


def said_by(cell: Cell) -> Term:
    """What a beacon may say that comes in: nothing older than what was taken from there before."""
    t, store, view = cell.t, cell.stage.store, cell.view(cell.stage.store)
    sq, dist = store[cell.frame, "sq", None], store[cell.frame, "dist", None]
    finite = t.less(dist, t.number(const.INFINITY))
    parts = [t.implies(finite, view.in_window(sq))]
    for p, ghost in enumerate(cell.ghosts):
        here = t.all(view.is_(cell.port, p), finite)
        parts.append(t.implies(t.all(here, view.is_parent(p)), view.no_newer(view.sq_own, sq)))
        parts.append(t.implies(t.all(here, ghost.known), view.no_newer(sq, ghost.sq)))
        parts.append(t.implies(here, t.any(ghost.known, ghost.old)))
    return t.all(*parts)


def _started(cell: Cell, step: Step) -> list[Goal]:
    t, after = cell.t, cell.view(step.after)
    again = after.is_(t.unknown("cause", 0, 1), const.MEMORY_LOST)
    waits = t.less(t.number(0), after.wait)
    return [Goal("W1 it waits after a restart", t.implies(again, waits))]


def _goals(cell: Cell, step: Step) -> list[Goal]:
    t, after = step.terms, cell.view(step.after)
    said = []
    for guard, _port, frame in sent(step, const.BEACON):
        route = step.after[frame, "sq", None], step.after[frame, "dist", None]
        finite = t.all(guard, t.less(route[1], t.number(const.INFINITY)))
        own = t.all(t.same(route[0], after.sq_own), after.is_(after.sq_known, 1))
        said.append(t.implies(finite, own))
    return [
        *own_goals(step, ("cell",), const.TIMERS, const.PORTS),
        *invariants(after),
        Goal("N no handler makes a number of its own", windowed(after)),
        Goal("B a route is announced with its sender's number", t.all(*said)),
    ]


def _kept(cell: Cell, step: Step) -> list[Goal]:
    """What a step that is no restart does to the number, and to the route."""
    t = step.terms
    before, after = cell.view(step.before), cell.view(step.after)
    forgot, had = forgotten(step), before.is_(before.sq_known, 1)
    rises = t.all(after.is_(after.sq_known, 1), before.no_newer(before.sq_own, after.sq_own))
    switched = t.all(after.has_parent(), t.negated(t.same(before.parent, after.parent)))
    newer = t.negated(before.no_newer(after.at("sq", after.parent), before.sq_own))
    free = t.any(t.negated(had), forgot)
    return [
        Goal("F the number only ever rises, unless it is forgotten",
             t.implies(had, t.any(rises, forgot))),
        Goal("F1 it is forgotten without a route only",
             t.implies(forgot, t.negated(before.has_parent()))),
        Goal("R1 a new parent's number is newer than the cell's was",
             t.implies(switched, t.any(free, newer))),
    ]  # fmt: skip


def _rises(view: View, old: Any, new: Any, p: int) -> Term:
    """F: it has one, and no older than before; or it has its first."""
    t = view.t
    had = t.all(old.known, view.no_newer(old.sq, new.sq), t.same(old.old, new.old))
    had_none = t.all(t.negated(t.any(old.known, old.old)), t.negated(new.old))
    return t.all(new.known, t.any(had, had_none))


RULE = Rule(const.RULE_STRICT, invariants, windowed, said_by, _goals)
