"""A cell and what it may know of its neighbours, as unknowns.

Of whom a port leads to no more is known than four ghosts: whether it has a feasible distance, which
one, and whether what this cell has of it may be older than that it forgot one. Nothing is said of
how many cells there are, nor of how they are joined.
"""

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import Any, NamedTuple

from innervate.dialect.arith import HALF16, MASK16
from innervate.networks.skin.protocol import constants as const
from innervate.networks.skin.protocol import fields
from innervate.networks.skin.protocol.constants import INFINITY, NONE, ONE, PERIODIC, PORTS
from innervate.prove.execute import Machine
from innervate.prove.express import chosen
from innervate.prove.records import Array, Outbox, Record, Store, name_of
from innervate.prove.steps import Goal, Stage, Step
from innervate.prove.terms import Term, Terms

ENTRY = "innervate.networks.skin.protocol.cell"
ROOM = 12  # a cell's outbox
ANY_RULE = -1
STARTS = "a cell is switched on"
HEARS = "a cell hears a beacon"
TICKS = "a cell's period ends"
TELLS = "a cell announces what is new"


class Event(NamedTuple):
    """A call of a cell."""

    handler: str
    told: tuple[Any, ...]  # besides the time; "cause", "port", "frame" are any
    kinds: tuple[int, int] = (const.BEACON, const.BEACON)  # from which to which, of the frame


# What the explorer has happen to a cell.
EVENTS = {
    STARTS: Event("on_start", ("cause",)),
    HEARS: Event("on_frame", ("port", "frame")),
    TICKS: Event("on_timer", (const.TICK,)),
    TELLS: Event("on_timer", (const.SOON,)),
}


@dataclass(frozen=True, slots=True)
class Ghost:
    """The neighbour on a port.

    Attributes:
        known: it has a feasible distance.
        sq, dist: that.
        old: it has forgotten one, and what this cell has of it may be from before. The PC is one
            of these for ever: it leads to nobody, and nothing is claimed of it.
    """

    known: Term
    sq: Term
    dist: Term
    old: Term


NUMBERS = (("cell", "sq", PORTS), ("cell", "sq_own", 0), ("cell", "fd_sq", 0),
           ("cell", "sent_sq", 0), ("frame", "sq", 0))  # fmt: skip


def base_of(terms: Terms) -> Term:
    """The oldest number in use: any."""
    return terms.unknown("base", 0, MASK16)


def number(terms: Terms, name: str) -> Term:
    """Any number, counted from the oldest in use, so that the solver need not wrap it."""
    return terms.wrapped(base_of(terms), terms.unknown(f"{name}.ahead", 0, MASK16), MASK16)


class View:
    """A cell's record at one moment, beside its neighbours' feasible distances.

    Args:
        ghosts: its neighbours by port.
    """

    def __init__(
        self, terms: Terms, cell: Record, params: Record, store: Store, ghosts: list[Ghost]
    ) -> None:
        self.t = terms
        self.cell = cell
        self.params = params
        self.store = store
        self.ghosts = ghosts
        self.base = base_of(terms)

    def __getattr__(self, name: str) -> Term:
        """A single field of the cell."""
        return self.store[self.__dict__["cell"], name, None]

    def at(self, name: str, index: Term | int) -> Term:
        """An element of one of the cell's arrays."""
        if isinstance(index, int):
            return self.store[self.cell, name, index]
        return chosen(self.t, Array(self.cell, name, PORTS), index, self.store)

    def param(self, name: str) -> Term:
        """One of the protocol's parameters."""
        return self.store[self.params, name, None]

    def is_(self, value: Term, number: int) -> Term:
        """A value is a number."""
        return self.t.same(value, self.t.number(number))

    def offset(self, sq: Term) -> Term:
        """How far a number is ahead of the oldest that is in use."""
        return self.t.bits_and(self.t.sub(sq, self.base), self.t.number(MASK16))

    def nearer(self, a: tuple[Term, Term], b: tuple[Term, Term]) -> Term:
        """(number, hops) a is newer, or as new and nearer, than b."""
        t = self.t
        newer = t.less(self.offset(b[0]), self.offset(a[0]))
        return t.any(newer, t.all(t.same(a[0], b[0]), t.less(a[1], b[1])))

    def in_window(self, sq: Term) -> Term:
        """A number is among those in use: all of them lie within half of all numbers."""
        return self.t.less(self.offset(sq), self.t.number(HALF16))

    def no_newer(self, a: Term, b: Term) -> Term:
        """Number a is no newer than number b."""
        return self.t.at_most(self.offset(a), self.offset(b))

    # -- words of the invariants

    def fd(self) -> tuple[Term, Term]:
        """Number and hops of the cell's feasible distance."""
        return self.fd_sq, self.fd_dist

    def has_parent(self) -> Term:
        """The cell has a route."""
        return self.t.negated(self.is_(self.parent, NONE))

    def is_parent(self, p: int) -> Term:
        """Port p leads to the parent."""
        return self.is_(self.parent, p)

    def works(self, p: Term | int) -> Term:
        """The cable at port p works."""
        return self.t.less(self.at("pf", p), self.t.number(ONE))

    def has_route(self, p: int) -> Term:
        """Port p has said a distance, and what it said may be used."""
        t = self.t
        finite = t.less(self.at("dist", p), t.number(INFINITY))
        return t.all(finite, t.any(self.works(p), self.is_(self.at("heard", p), 1)))

    def route(self, p: int) -> tuple[Term, Term]:
        """What port p said last."""
        return self.at("sq", p), self.at("dist", p)

    def own_route(self) -> tuple[Term, Term]:
        """What the cell would announce."""
        t = self.t
        hops = t.add(self.at("dist", self.parent), t.number(1))
        most = t.number(INFINITY)
        return self.sq_own, t.pick(t.less(hops, most), hops, most)

    def is_settled(self, p: int) -> Term:
        """Nothing is left here of what port p ever said, nor on its way."""
        return self.t.all(self.t.negated(self.has_route(p)), self.t.negated(self.is_parent(p)))

    def windowed(self, known: str = "fd_known", sq: str = "fd_sq") -> Term:
        """All numbers that may still be compared are among those in use: the cell's own, too."""
        t = self.t
        parts = [t.implies(self.is_(getattr(self, known), 1), self.in_window(getattr(self, sq)))]
        for p, ghost in enumerate(self.ghosts):
            parts.append(t.implies(self.has_route(p), self.in_window(self.at("sq", p))))
            parts.append(t.implies(ghost.known, self.in_window(ghost.sq)))
        return t.all(*parts)


def invariants(view: View) -> list[Goal]:
    """What holds of every cell between any two events, under `feasible`."""
    t, known = view.t, view.is_(view.fd_known, 1)
    triggered = t.negated(view.is_(view.param("updates"), PERIODIC))
    has = view.has_parent()
    own = view.own_route()
    waits = t.less(t.number(0), view.wait)
    infinite = view.is_(own[1], INFINITY)
    kept, behind, unheard = [], [], []
    for p, ghost in enumerate(view.ghosts):
        fd = ghost.sq, ghost.dist
        silent = t.negated(t.any(ghost.known, ghost.old))
        kept.append(t.implies(t.all(view.has_route(p), ghost.known),
                              t.negated(view.nearer(view.route(p), fd))))  # fmt: skip
        behind.append(t.implies(t.all(view.is_parent(p), ghost.known),
                                view.nearer(fd, view.fd())))  # fmt: skip
        unheard.append(t.implies(silent, view.is_settled(p)))
    return [
        Goal("I1 who has a route has a feasible distance, and no time without one",
             t.implies(has, t.all(known, view.is_(view.sq_known, 1), view.is_(view.hold, 0)))),
        Goal("I2 who waits after a restart has neither a route nor a feasible distance",
             t.implies(waits, t.negated(t.any(has, known)))),
        Goal("I3 what is announced next is the parent's, and not nearer than fd",
             t.all(t.implies(t.negated(triggered), view.is_(view.soon, 0)),
                   t.implies(t.all(has, triggered), t.all(
                       t.same(view.sq_own, view.at("sq", view.parent)),
                       t.any(infinite, t.negated(view.nearer(own, view.fd()))))))),
        Goal("I4 no route kept is nearer than its sender's fd", t.all(*kept)),
        Goal("I5 fd is strictly worse than the parent's", t.all(*behind)),
        Goal("I6 nothing is kept of who never had a route", t.all(*unheard)),
        Goal("I7 the parent's port works", t.implies(has, view.works(view.parent))),
    ]  # fmt: skip


def ghosts(stage: Stage, mark: str = "") -> list[Ghost]:
    """Any neighbours, one for every port."""
    t = stage.terms
    return [
        Ghost(
            t.as_truth(t.unknown(f"ghost{p}.known{mark}", 0, 1)),
            number(t, f"ghost{p}.sq{mark}"),
            t.unknown(f"ghost{p}.dist{mark}", 0, INFINITY),
            t.as_truth(t.unknown(f"ghost{p}.old{mark}", 0, 1)),
        )
        for p in range(PORTS)
    ]


def true_ghosts(view: View) -> Term:
    """Of whom a feasible distance is known nothing older is left: it waited for that."""
    t = view.t
    return t.all(*(t.negated(t.all(ghost.known, ghost.old)) for ghost in view.ghosts))


class Cell:
    """A cell on a stage, with its parameters, a frame, a port and its neighbours."""

    def __init__(self, known: dict[str, Any], rule: int) -> None:
        self.known = known
        self.stage = stage = Stage(known, fields.FRAME, ROOM)
        self.t = stage.terms
        self.cell = stage.record("cell", fields.CELL)
        self.params = stage.record("params", fields.PARAMS)
        self.frame = stage.record("frame", fields.FRAME)
        if rule != ANY_RULE:
            stage.fix(self.params, "rule", rule)
        self.port = stage.terms.unknown("port", 0, PORTS - 1)
        self.ghosts = ghosts(stage)
        for record, name, length in NUMBERS:
            for index in range(length) if length else (None,):
                key = stage.records[record], name, index
                stage.store[key] = number(stage.terms, name_of(key))

    def view(self, store: Store) -> View:
        """The cell with these values."""
        return View(self.stage.terms, self.cell, self.params, store, self.ghosts)

    def arguments(self, told: Iterable[Any], out: Outbox) -> list[Any]:
        """All that a handler is given; "cause", "port", "frame" among what it is told are any."""
        cause = self.t.unknown("cause", 0, 1)
        given = {"cause": cause, "port": self.port, "frame": self.frame}
        args = (given.get(one, one) for one in told)
        return [self.cell, self.params, self.stage.clock(), *args, out]

    def asks(self, question: str, args: list[Any], store: Store) -> Term:
        """What a function of the protocol answers, as a truth."""
        _, answer = blank(self.known, self.t).run(question, args, store)
        return self.t.as_truth(answer)


def blank(functions: Any, terms: Terms) -> Machine:
    """A machine with an empty outbox of a cell."""
    return Machine(functions, terms, Outbox(fields.FRAME, ROOM))


class Rule(NamedTuple):
    """What is claimed of cells under a rule."""

    number: int
    invariants: Callable[[View], list[Goal]]  # hold of every cell between any two events
    windowed: Callable[[View], Term]  # all numbers that may be compared are among those in use
    said_by: Callable[[Cell], Term]  # what a beacon on the cell's port may say
    always: Callable[[Cell, Step], list[Goal]]  # what every step has to leave behind

    def facts(self, view: View) -> list[Term]:
        """What is known of a cell before any event."""
        held = [goal.holds for goal in self.invariants(view)]
        return [*held, self.windowed(view), true_ghosts(view)]

    def play(
        self,
        known: dict[str, Any],
        name: str,
        then: Callable[[Cell, Step], list[Goal]],
        event: Event | None = None,
        more: Callable[[View], Term] | None = None,
    ) -> Step:
        """An event at a cell in any state.

        Args:
            known: the functions of the protocol.
            name: of the step.
            then: goals besides those of every step.
            event: if it is none of EVENTS, such a one.
            more: what else is known before.
        """
        handler, told, kinds = event or EVENTS[name]
        cell = Cell(known, self.number)
        view = cell.view(cell.stage.store)
        if handler == "on_frame":
            cell.stage.store[cell.frame, "kind", None] = cell.t.unknown("frame.kind", *kinds)
        assumed = self.facts(view)
        if handler == "on_start":
            assumed = [self.windowed(view), true_ghosts(view)]
        if handler == "on_frame" and kinds == (const.BEACON, const.BEACON):
            assumed.append(self.said_by(cell))
        if more is not None:
            assumed.append(more(view))
        step = cell.stage.play(name, handler, cell.arguments(told, cell.stage.out), assumed)
        step.goals = [*self.always(cell, step), *then(cell, step)]
        return step


Moves = Callable[[View, Ghost, Ghost, int], Term]


def ghosts_after(cell: Cell, moves: Moves) -> tuple[list[Ghost], list[Term]]:
    """The neighbours after the one on some port has moved, and what is known of that."""
    stage, t = cell.stage, cell.stage.terms
    view = cell.view(stage.store)
    after = ghosts(stage, "'")
    known = []
    for p, (old, new) in enumerate(zip(cell.ghosts, after, strict=True)):
        here = view.is_(cell.port, p)
        known.append(t.implies(here, moves(view, old, new, p)))
        stays = t.all(t.same(old.known, new.known), t.same(old.sq, new.sq),
                      t.same(old.dist, new.dist), t.same(old.old, new.old))  # fmt: skip
        known.append(t.any(here, stays))
        known.append(t.implies(new.known, view.in_window(new.sq)))
    return after, known


def moved(name: str, rule: Rule, moves: Moves) -> Step:
    """What some neighbour has moves: a rule's invariants of this cell stand."""
    cell = Cell({}, rule.number)
    stage = cell.stage
    after, known = ghosts_after(cell, moves)
    now = View(stage.terms, cell.cell, cell.params, stage.store, after)
    goals = [*rule.invariants(now), Goal("what neighbours have is true", true_ghosts(now))]
    assumed = [*rule.facts(cell.view(stage.store)), *known]
    return stage.step(name, stage.store, assumed, goals)
