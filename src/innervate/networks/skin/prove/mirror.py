"""A cell's ports are alike: a handler does with ports changed about what it does without.

Two ports change places, or all move on by one, with all that they said; any other order of ports
comes of these two. That is what lets the explorer keep one of the states that a symmetry of the
graph turns into each other. A draw among equals counts them in the order of ports, so it is claimed
that some number can be drawn that chooses the image of what was chosen.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any

from innervate.dialect.outbox import SEND, SET_TIMER
from innervate.dialect.source import Change, Function
from innervate.networks.skin.protocol import fields
from innervate.networks.skin.protocol.constants import PORTS
from innervate.networks.skin.prove.neighbours import ENTRY, ROOM
from innervate.networks.skin.prove.reductions import (
    HANDLERS,
    NOT_DRAWN,
    Bare,
    same_action,
    same_state,
)
from innervate.prove.execute import Machine
from innervate.prove.records import Demand, Outbox, Record, State, Store, name_of
from innervate.prove.steps import Goal, Step
from innervate.prove.terms import Term, Terms
from innervate.prove.theory import source

ORDERS = {"two ports change places": (1, 0, 2, 3), "all ports move on": (1, 2, 3, 0)}
CHOICE, DRAWN = "select", "pick"  # of all ports, and of those that are equally near
CHOSEN = ("parent", "hold", "sq_known", "sq_own", "fd_known", "fd_sq", "fd_dist")
MADE = "M1 what is chosen is the image"


class First(Machine):
    """Notes what is chosen; where a choice is made it may come out in any way.

    Args:
        whole: follow a choice, too.
    """

    def __init__(self, functions: Any, terms: Terms, whole: bool) -> None:
        super().__init__(functions, terms, Outbox(fields.FRAME, ROOM))
        self.whole = whole
        self.drawn: list[Term] = []  # among equals, in order
        # where, the values at that, values that may come of it: of all choices, in order
        self.choices: list[tuple[Term, Store, Store]] = []

    def call(
        self, function: Function, args: list[Any], store: Store, under: Term
    ) -> tuple[Store, Any]:
        """Follow a call, but not a choice unless that is wanted; what is drawn is noted."""
        if function.name == CHOICE and not self.whole:
            found = {key: self.terms.fresh(name_of(key), low, high)
                     for key, low, high in args[0].places() if key[1] in CHOSEN}  # fmt: skip
            self.choices.append((under, store, found))
            return {**store, **found}, self.terms.number(0)
        after, value = super().call(function, args, store, under)
        if function.name == DRAWN:
            self.drawn.append(self.terms.as_number(value))
        return after, value


class Second(Machine):
    """Chooses the image of what was chosen, and demands that this can be."""

    def __init__(self, first: First, mirror: Mirror) -> None:
        super().__init__(first.functions, first.terms, Outbox(fields.FRAME, ROOM))
        self.mirror = mirror
        self.images = [mirror.of(one) for one in first.drawn]
        self.choices = list(first.choices)
        self.number: Term | None = None
        self.can_be: list[Term] = []

    def call(
        self, function: Function, args: list[Any], store: Store, under: Term
    ) -> tuple[Store, Any]:
        """Follow a call, but where it is known what comes of it."""
        if function.name == CHOICE and self.choices:
            return self.choose(args[0], store, under)
        if function.name != DRAWN:
            return super().call(function, args, store, under)
        t, image, ways = self.terms, self.images.pop(0), []
        for number in range(PORTS):
            self.number, self.can_be = t.number(number), []
            after, value = super().call(function, args, store, under)
            unchanged = t.truth_of(all(after[key] is value for key, value in store.items()))
            ways.append(t.all(*self.can_be, unchanged, t.same(t.as_number(value), image)))
        self.number = None
        self.demands.append(Demand(MADE, under, t.any(*ways), DRAWN))
        return store, image

    def choose(self, cell: Record, store: Store, under: Term) -> tuple[Store, Any]:
        """It is asked where it was asked before, of the image, and the image comes of it."""
        t, (where, before, found) = self.terms, self.choices.pop(0)
        alike = same_state(t, cell, self.mirror.of_store(before), store)
        self.demands.append(Demand(MADE, t.true, t.same(where, under), CHOICE))
        self.demands.append(Demand(MADE, under, alike, CHOICE))
        return {**store, **self.mirror.of_store(found)}, t.number(0)

    def draw(self, many: Term, state: State) -> Term:
        """The number that is tried, if it is among so many."""
        if self.number is None:
            return super().draw(many, state)
        under = self.here(state)
        self.can_be.append(self.terms.implies(under, self.terms.less(self.number, many)))
        return self.number


def steps(rule: int, change: Change | None = None) -> tuple[Callable[[], Step], ...]:
    """That ports are alike, under a rule."""
    known = source(ENTRY, change)
    return tuple(
        step for how in ORDERS
        for step in (partial(_choice, known, rule, how),
                     *(partial(_alike, known, rule, name, how) for name in HANDLERS))
    )  # fmt: skip


class Mirror:
    """Ports in another order.

    Args:
        order: where each goes.
    """

    def __init__(self, terms: Terms, order: tuple[int, ...]) -> None:
        self.t = terms
        self.order = order

    def of(self, port: Term) -> Term:
        """Where a port goes; -1 is none and stays."""
        t, found = self.t, port
        for p, there in enumerate(self.order):
            found = t.pick(t.same(port, t.number(p)), t.number(there), found)
        return found

    def of_store(self, store: Store) -> Store:
        """A cell's values as they are then."""
        found = {}
        for (record, name, index), value in store.items():
            moved = self.order[index] if record.name == "cell" and index is not None else index
            if record.name == "cell" and name in ("parent", "sent_parent"):
                value = self.of(value)
            found[record, name, moved] = value
        return found


def _bare(known: dict[str, Any], rule: int) -> Bare:
    bare = Bare(known, rule)
    for p in range(PORTS):
        for field in ("load", "size"):  # none decides anything: reductions.py
            bare.stage.fix(bare.cell, field, 0, p)
    return bare


def _choice(known: dict[str, Any], rule: int, how: str) -> Step:
    """A choice, and the same of ports in another order."""
    bare = _bare(known, rule)
    t, mirror, before = bare.t, Mirror(bare.t, ORDERS[how]), bare.stage.store
    first = First(known, t, True)
    given = [bare.cell, bare.params, 0]
    after, _ = first.run(CHOICE, [*given, first.out], before)
    second = Second(first, mirror)
    image, _ = second.run(CHOICE, [*given, second.out], mirror.of_store(before))
    bare.machines = [first, second]
    others = [t.same(before[key], after[key]) for key, _, _ in bare.cell.places()
              if key[1] not in (*CHOSEN, *NOT_DRAWN)]  # fmt: skip
    quiet = [t.negated(one.guard) for one in first.out.actions if one.kind in (SEND, SET_TIMER)]
    goals = [
        *_image(bare, second, mirror.of_store(after), image),
        Goal("M4 a choice changes no more than the route, and sends nothing",
             t.all(*others, *quiet)),
    ]  # fmt: skip
    return bare.step(f"a choice, where {how}", goals)


def _alike(known: dict[str, Any], rule: int, name: str, how: str) -> Step:
    """A handler, and the same with its ports in another order."""
    bare = _bare(known, rule)
    mirror, before = Mirror(bare.t, ORDERS[how]), bare.stage.store
    first = First(known, bare.t, False)
    after, _ = bare.by(first, before, *HANDLERS[name])
    second = Second(first, mirror)
    bare.port = mirror.of(bare.port)
    image, _ = bare.by(second, mirror.of_store(before), *HANDLERS[name])
    sent = _same_sent(bare.t, mirror, (after, first), (image, second))
    goals = [*_image(bare, second, mirror.of_store(after), image),
             Goal("M3 what is sent is the image", bare.t.all(*sent))]  # fmt: skip
    return bare.step(f"{name}, where {how}", goals)


def _image(bare: Bare, second: Second, wanted: Store, image: Store) -> list[Goal]:
    """What was chosen, and all that is left behind, is the image."""
    t = bare.t
    demanded = [t.implies(one.guard, one.holds) for one in second.demands if one.what == MADE]
    return [Goal(MADE, t.all(*demanded)),
            Goal("M2 the state is the image", same_state(t, bare.cell, wanted, image))]  # fmt: skip


def _same_sent(
    t: Terms, mirror: Mirror, one: tuple[Store, Machine], other: tuple[Store, Machine]
) -> list[Term]:
    """What goes out on a port goes out on its image; timers are set alike."""
    found = []
    actions, images = one[1].out.actions, other[1].out.actions
    for place, action in enumerate(actions):
        if action.kind not in (SEND, SET_TIMER):
            continue  # a report moves nothing
        partner = images[place]
        if action.kind == SEND:
            port = action.a.value
            assert port is not None
            partner = images[place + mirror.order[port] - port]
            assert partner.a.value == mirror.order[port]
        found.append(same_action(t, (one[0], action), (other[0], partner), any_port=True))
    return found
