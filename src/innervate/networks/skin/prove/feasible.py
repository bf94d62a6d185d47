"""Rule `feasible`: every handler of a cell keeps the invariants, and announces what it may.

Each step starts from any state that satisfies the invariants, with whatever a neighbour may have
sent, and has to end in such a state. What neighbours meanwhile do to it is a step of its own.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any

from innervate.dialect.outbox import REPORT
from innervate.dialect.source import Change
from innervate.networks.skin.protocol import fields
from innervate.networks.skin.protocol.constants import (
    BEACON,
    COMMAND,
    DATA,
    INFINITY,
    MEMORY_LOST,
    NONE,
    PORTS,
    REPORT_FORGET,
    RULE_FEASIBLE,
    SAMPLE,
    SOON,
    TICK,
    TIMERS,
)  # fmt: skip
from innervate.networks.skin.prove.neighbours import (
    ROOM,
    Cell,
    View,
    invariants,
    true_ghosts,
)  # fmt: skip
from innervate.prove.steps import Goal, Stage, Step, own_goals, sent
from innervate.prove.terms import Term
from innervate.prove.theory import source

ENTRY = "innervate.networks.skin.protocol.cell"
Known = dict[str, Any]


def steps(change: Change | None = None) -> tuple[Callable[[], Step], ...]:
    """All that can happen to a cell."""
    known = source(ENTRY, change)
    events = (start, hear, tick, soon, data, command, unknown, sample)
    return tuple(partial(make, known) for make in events)


def _cell(known: Known) -> Cell:
    return Cell(Stage(known, fields.FRAME, ROOM), RULE_FEASIBLE)


def facts(cell: Cell) -> list[Term]:
    """What is known of a cell before any event."""
    view = cell.view(cell.stage.store)
    return [goal.holds for goal in invariants(view)] + [view.windowed(), true_ghosts(view)]


def start(known: Known) -> Step:
    """Switched on, for the first time or anew."""
    cell = _cell(known)
    stage, t = cell.stage, cell.stage.terms
    cause = t.unknown("cause", 0, 1)
    view = cell.view(stage.store)
    step = stage.play("a cell is switched on", "on_start",
                      [cell.cell, cell.params, stage.clock(), cause, stage.out],
                      [view.windowed(), true_ghosts(view)])  # fmt: skip
    after = cell.view(step.after)
    k = after.param("k")
    least = t.add(t.add(k, t.number(3)), t.div(k, t.number(8)))
    waits = t.implies(view.is_(cause, MEMORY_LOST), t.at_most(least, after.wait))
    step.goals = [
        *_always(cell, step),
        Goal("W1 after a restart it waits for k + 3 + k/8 periods", waits),
        Goal("W2 it knows nothing", t.all(view.is_(after.fd_known, 0), view.is_(after.hold, 0),
                                          view.is_(after.parent, NONE))),
    ]  # fmt: skip
    return step


def hear(known: Known) -> Step:
    """A beacon comes in on any port, of those that its sender ever may have sent."""
    cell = _cell(known)
    stage, t = cell.stage, cell.stage.terms
    port = t.unknown("port", 0, PORTS - 1)
    stage.fix(cell.frame, "kind", BEACON)
    may = said_by(cell, port)
    step = stage.play("a cell hears a beacon", "on_frame",
                      [cell.cell, cell.params, stage.clock(), port, cell.frame, stage.out],
                      [*facts(cell), may])  # fmt: skip
    step.goals = [*_always(cell, step), *_kept(cell, step)]
    return step


def said_by(cell: Cell, port: Term) -> Term:
    """What a beacon on a port may say, given the neighbour there."""
    stage = cell.stage
    t, view = stage.terms, cell.view(stage.store)
    route = stage.store[cell.frame, "sq", None], stage.store[cell.frame, "dist", None]
    finite = t.less(route[1], t.number(INFINITY))
    parts = [t.implies(finite, view.in_window(route[0]))]
    for p, ghost in enumerate(cell.ghosts):
        here = t.all(view.is_(port, p), finite)
        fd = ghost.sq, ghost.dist
        parts.append(t.implies(t.all(here, ghost.known), t.negated(view.nearer(route, fd))))
        parts.append(t.implies(here, t.any(ghost.known, ghost.old)))
    return t.all(*parts)


def tick(known: Known) -> Step:
    """A cell's beacon period ends."""
    cell = _cell(known)
    stage = cell.stage
    step = stage.play("a cell's period ends", "on_timer",
                      [cell.cell, cell.params, stage.clock(), TICK, stage.out],
                      facts(cell))  # fmt: skip
    before, after = cell.view(step.before), cell.view(step.after)
    t = stage.terms
    lost = t.negated(before.has_parent())
    over = t.at_most(before.param("hold_periods"), t.add(before.hold, t.number(1)))
    counted = t.any(t.same(after.hold, t.add(before.hold, t.number(1))), before.is_(after.hold, 0),
                    t.all(before.has_parent(), t.same(after.hold, before.hold)))  # fmt: skip
    step.goals = [
        *_always(cell, step),
        *_kept(cell, step, may_forget=t.all(lost, over)),
        Goal("F2 periods without a route are counted one by one", counted),
        Goal("W3 periods of waiting are counted one by one",
             t.at_most(t.sub(before.wait, t.number(1)), after.wait)),
    ]  # fmt: skip
    return step


def soon(known: Known) -> Step:
    """The timer for a beacon that had to keep the gap."""
    cell = _cell(known)
    stage = cell.stage
    view = cell.view(stage.store)
    step = stage.play("a cell announces what is new", "on_timer",
                      [cell.cell, cell.params, stage.clock(), SOON, stage.out],
                      [*facts(cell), view.is_(view.soon, 1)])  # fmt: skip
    step.goals = [*_always(cell, step), *_kept(cell, step)]
    return step


def data(known: Known) -> Step:
    """A data frame comes in on any port."""
    cell = _cell(known)
    cell.stage.fix(cell.frame, "kind", DATA)
    return _other(cell, "a cell is given data")


def unknown(known: Known) -> Step:
    """A frame of a type that this rule does not know."""
    cell = _cell(known)
    kind = cell.stage.terms.unknown("frame.kind", COMMAND + 1, 15)
    cell.stage.store[cell.frame, "kind", None] = kind
    return _other(cell, "a cell is given something unknown")


def command(known: Known) -> Step:
    """A command of the PC."""
    cell = _cell(known)
    cell.stage.fix(cell.frame, "kind", COMMAND)
    return _other(cell, "a cell is given a command")


def _other(cell: Cell, name: str) -> Step:
    stage = cell.stage
    port = stage.terms.unknown("port", 0, PORTS - 1)
    step = stage.play(name, "on_frame",
                      [cell.cell, cell.params, stage.clock(), port, cell.frame, stage.out],
                      facts(cell))  # fmt: skip
    step.goals = [*_always(cell, step), *_kept(cell, step)]
    return step


def sample(known: Known) -> Step:
    """A cell's own sensors were read."""
    cell = _cell(known)
    stage = cell.stage
    step = stage.play("a cell reads its sensors", "on_input",
                      [cell.cell, cell.params, stage.clock(), SAMPLE, cell.frame, stage.out],
                      facts(cell))  # fmt: skip
    step.goals = [*_always(cell, step), *_kept(cell, step)]
    return step


def _always(cell: Cell, step: Step) -> list[Goal]:
    """What every step has to leave behind."""
    after = cell.view(step.after)
    t = step.terms
    return [
        *own_goals(step, ("cell",), TIMERS, PORTS),
        *invariants(after),
        Goal("N no handler makes a number of its own", after.windowed()),
        Goal("B no beacon is nearer than its sender's fd", t.all(*_beacons(after, step))),
        Goal("C it tells its parent, and nobody else, that it is", t.all(*_told(after, step))),
    ]


def _told(after: View, step: Step) -> list[Term]:
    t = step.terms
    return [
        t.implies(guard, t.same(
            t.same(step.after[frame, "parent", None], t.number(1)), t.same(port, after.parent)))
        for guard, port, frame in sent(step, BEACON)
    ]  # fmt: skip


def _beacons(after: View, step: Step) -> list[Term]:
    t = step.terms
    found = []
    for guard, _port, frame in sent(step, BEACON):
        route = step.after[frame, "sq", None], step.after[frame, "dist", None]
        finite = t.less(route[1], t.number(INFINITY))
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
        after.is_(after.at("child", after.parent), 0),
        t.less(route[1], after.param("max_depth")),
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
    told = [t.all(action.guard, t.same(action.a, t.number(REPORT_FORGET)))
            for action in step.machine.out.actions if action.kind == REPORT]  # fmt: skip
    return t.any(*told)
