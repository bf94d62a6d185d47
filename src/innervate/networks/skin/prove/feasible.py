"""Rule `feasible`: every handler of a cell keeps the invariants, and announces what it may.

Each step starts from any state that satisfies the invariants, with whatever a neighbour may have
sent, and has to end in such a state. What neighbours meanwhile do to it is a step of its own.
"""

from collections.abc import Callable
from functools import partial

from innervate.dialect.outbox import REPORT
from innervate.dialect.source import Change
from innervate.networks.skin.protocol import constants as const
from innervate.networks.skin.prove import neighbours as near
from innervate.networks.skin.prove.neighbours import Cell, Rule, View
from innervate.prove.steps import Goal, Step, own_goals, sent
from innervate.prove.terms import Term
from innervate.prove.theory import source

OTHERS = {  # kinds of frames that are no beacons
    "a cell is given data": (const.DATA, const.DATA),
    "a cell is given a command": (const.COMMAND, const.COMMAND),
    "a cell is given something unknown": (const.COMMAND + 1, 15),
}


def steps(change: Change | None = None) -> tuple[Callable[[], Step], ...]:
    """All that can happen to a cell."""
    play, hears = partial(RULE.play, source(near.ENTRY, change)), near.EVENTS[near.HEARS]
    others = {name: hears._replace(kinds=kinds) for name, kinds in OTHERS.items()}
    others["a cell reads its sensors"] = near.Event("on_input", (const.SAMPLE, "frame"))
    return (
        partial(play, near.STARTS, _started),
        partial(play, near.HEARS, _kept),
        partial(play, near.TICKS, _ticked),
        partial(play, near.TELLS, _kept, more=lambda view: view.is_(view.soon, 1)),
        *(partial(play, name, _kept, event) for name, event in others.items()),
    )


def said_by(cell: Cell) -> Term:
    """What a beacon may say that comes in, of those that its sender ever may have sent."""
    t, store, view = cell.t, cell.stage.store, cell.view(cell.stage.store)
    route = store[cell.frame, "sq", None], store[cell.frame, "dist", None]
    finite = t.less(route[1], t.number(const.INFINITY))
    parts = [t.implies(finite, view.in_window(route[0]))]
    for p, ghost in enumerate(cell.ghosts):
        here = t.all(view.is_(cell.port, p), finite)
        fd = ghost.sq, ghost.dist
        parts.append(t.implies(t.all(here, ghost.known), t.negated(view.nearer(route, fd))))
        parts.append(t.implies(here, t.any(ghost.known, ghost.old)))
    return t.all(*parts)


def _started(cell: Cell, step: Step) -> list[Goal]:
    """Switched on, for the first time or anew."""
    t, after = cell.t, cell.view(step.after)
    k = after.param("k")
    least = t.add(t.add(k, t.number(3)), t.div(k, t.number(8)))
    again = after.is_(t.unknown("cause", 0, 1), const.MEMORY_LOST)
    return [
        Goal("W1 after a restart it waits for k + 3 + k/8 periods",
             t.implies(again, t.at_most(least, after.wait))),
        Goal("W2 it knows nothing", t.all(after.is_(after.fd_known, 0), after.is_(after.hold, 0),
                                          after.is_(after.parent, const.NONE))),
    ]  # fmt: skip


def _ticked(cell: Cell, step: Step) -> list[Goal]:
    """A cell's beacon period ends."""
    t, before, after = cell.t, cell.view(step.before), cell.view(step.after)
    lost = t.negated(before.has_parent())
    over = t.at_most(before.param("hold_periods"), t.add(before.hold, t.number(1)))
    counted = t.any(t.same(after.hold, t.add(before.hold, t.number(1))), before.is_(after.hold, 0),
                    t.all(before.has_parent(), t.same(after.hold, before.hold)))  # fmt: skip
    return [
        *_kept(cell, step, may_forget=t.all(lost, over)),
        Goal("F2 periods without a route are counted one by one", counted),
        Goal("W3 periods of waiting are counted one by one",
             t.at_most(t.sub(before.wait, t.number(1)), after.wait)),
    ]  # fmt: skip


def _always(cell: Cell, step: Step) -> list[Goal]:
    """What every step has to leave behind."""
    after = cell.view(step.after)
    t = step.terms
    return [
        *own_goals(step, ("cell",), const.TIMERS, const.PORTS),
        *near.invariants(after),
        Goal("N no handler makes a number of its own", after.windowed()),
        Goal("B no beacon is nearer than its sender's fd", t.all(*_beacons(after, step))),
        Goal("C it tells its parent, and nobody else, that it is", t.all(*_told(after, step))),
    ]


def _told(after: View, step: Step) -> list[Term]:
    t = step.terms
    return [
        t.implies(guard, t.same(
            t.same(step.after[frame, "parent", None], t.number(1)), t.same(port, after.parent)))
        for guard, port, frame in sent(step, const.BEACON)
    ]  # fmt: skip


def _beacons(after: View, step: Step) -> list[Term]:
    t = step.terms
    found = []
    for guard, _port, frame in sent(step, const.BEACON):
        route = step.after[frame, "sq", None], step.after[frame, "dist", None]
        finite = t.less(route[1], t.number(const.INFINITY))
        may = t.all(
            after.is_(after.fd_known, 1),
            t.negated(after.nearer(route, after.fd())),
            t.less(t.number(0), route[1]),
            after.in_window(route[0]),
        )
        found.append(t.implies(t.all(guard, finite), may))
    return found


def _kept(cell: Cell, step: Step, may_forget: Term | None = None) -> list[Goal]:
    """What a step that is no restart does to the feasible distance, and to the route."""
    t = step.terms
    before, after = cell.view(step.before), cell.view(step.after)
    forgot = forgotten(step)
    had = before.is_(before.fd_known, 1)
    better = t.all(after.is_(after.fd_known, 1), t.negated(before.nearer(before.fd(), after.fd())))
    switched = t.all(after.has_parent(), t.negated(t.same(before.parent, after.parent)))
    route = after.at("sq", after.parent), after.at("dist", after.parent)
    allowed = t.any(t.negated(had), forgot, before.nearer(route, before.fd()))
    usable = t.all(
        after.is_(after.at("child", after.parent), 0), t.less(route[1], after.param("max_depth"))
    )
    return [
        Goal("F fd only ever gets nearer, unless it is forgotten", t.implies(
            had, t.any(better, forgot))),
        Goal("F1 it is forgotten without a route only, after FD_HOLD", t.implies(
            forgot, may_forget if may_forget is not None else t.false)),
        Goal("R1 a new parent's route is nearer than fd was", t.implies(switched, allowed)),
        Goal("R2 a new parent has a route, and is no child", t.implies(switched, usable)),
        Goal("R3 who waits takes no parent",
             t.implies(after.has_parent(), after.is_(after.wait, 0))),
    ]  # fmt: skip


def forgotten(step: Step) -> Term:
    """The cell reports that it has forgotten."""
    t = step.terms
    told = [t.all(action.guard, t.same(action.a, t.number(const.REPORT_FORGET)))
            for action in step.machine.out.actions if action.kind == REPORT]  # fmt: skip
    return t.any(*told)


RULE = Rule(const.RULE_FEASIBLE, near.invariants, View.windowed, said_by, _always)
