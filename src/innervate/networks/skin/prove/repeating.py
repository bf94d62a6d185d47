"""With triggered updates a beacon that says what its receiver heard last changes nothing.

That is so because a cell's choice is up to date between any two events (K1 .. K4), which every
handler that the explorer calls keeps; so there is nothing that hearing the same again could bring.
"""

from collections.abc import Callable, Iterable
from functools import partial
from typing import Any

from innervate.dialect.source import Change
from innervate.networks.skin.protocol import constants as const
from innervate.networks.skin.protocol import fields
from innervate.networks.skin.prove.feasible import ENTRY
from innervate.networks.skin.prove.neighbours import ROOM
from innervate.networks.skin.prove.reductions import Bare, kept
from innervate.prove.execute import Machine
from innervate.prove.records import Outbox, Store
from innervate.prove.steps import Goal, Step
from innervate.prove.terms import Term
from innervate.prove.theory import source

EVENTS = {
    "a cell is switched on": ("on_start", "cause"),
    "a cell hears a beacon": ("on_frame", "port", "frame"),
    "a cell's period ends": ("on_timer", const.TICK),
    "a cell announces what is new": ("on_timer", const.SOON),
}
SAID = (("dist", "dist"), ("sq", "sq"), ("load", "load"), ("size", "size"), ("child", "parent"))


def steps(rule: int, change: Change | None = None) -> tuple[Callable[[], Step], ...]:
    """That a cell's choice is up to date, and what follows for a beacon that repeats the last."""
    known = source(ENTRY, change)
    return (
        *(partial(_kept, known, rule, name) for name in EVENTS),
        partial(_repeated, known, rule),
    )


def _pair(known: dict[str, Any], rule: int) -> Bare:
    pair = Bare(known, rule)
    pair.facts = kept(pair, rule)
    any_ = pair.view(pair.stage.store).param("updates")  # what the facts speak of
    pair.facts.append(pair.t.same(any_, pair.t.number(const.TRIGGERED)))
    pair.stage.fix(pair.cell.params, "updates", const.TRIGGERED)
    return pair


def up_to_date(pair: Bare, store: Store, ports: Iterable[int] = range(const.PORTS)) -> list[Goal]:
    """What holds of a cell's choice between any two events, as far as these ports go."""
    t, view, cell = pair.t, pair.view(store), pair.cell

    def asks(question: str, *args: Any) -> Term:
        machine = Machine(pair.known, t, Outbox(fields.FRAME, ROOM))
        _, answer = machine.run(question, [cell.cell, cell.params, *args], store, t.true)
        return t.as_truth(answer)

    has, best = view.has_parent(), []
    usable = []
    for p in ports:
        can = t.all(asks("is_usable", t.number(p)), asks("is_allowed", t.number(p)))
        farther = t.all(has, t.at_most(view.at("dist", view.parent), view.at("dist", p)))
        best.append(
            t.implies(can, t.any(view.is_parent(p), farther, t.less(t.number(0), view.wait)))
        )
        usable.append(t.implies(view.is_parent(p), asks("is_usable", t.number(p))))
    told = t.any(view.is_(view.soon, 1), t.negated(asks("is_news")))
    return [
        Goal("K1 no port that may be taken is nearer than the parent", t.all(*best)),
        Goal("K2 the parent can be had", t.all(*usable)),
        Goal("K3 who has a route has announced it, or is about to", t.implies(has, told)),
        Goal("K4 who has a route counts no time without", t.implies(has, view.is_(view.hold, 0))),
    ]


def _kept(known: dict[str, Any], rule: int, name: str) -> Step:
    """A handler keeps the choice up to date."""
    pair = _pair(known, rule)
    before = pair.stage.store
    handler, *told = EVENTS[name]
    cause = pair.t.unknown("cause", 0, 1)
    given = {"port": pair.port, "frame": pair.cell.frame, "cause": cause}
    facts = [one.holds for one in up_to_date(pair, before) if handler != "on_start"]
    after, _ = pair.run(before, handler, *(given.get(one, one) for one in told))
    ports = range(
        const.PORTS if handler == "on_start" else 1
    )  # to all else ports are alike: mirror.py
    return pair.step(name, up_to_date(pair, after, ports), facts)


def _repeated(known: dict[str, Any], rule: int) -> Step:
    """A beacon says what was heard last."""
    port = 0  # ports are alike (mirror.py)
    pair = _pair(known, rule)
    before, cell = pair.stage.store, pair.cell
    pair.port = pair.t.number(port)
    for field, said in SAID:
        before[cell.frame, said, None] = before[cell.cell, field, port]
    facts = [one.holds for one in up_to_date(pair, before)]
    after, machine = pair.hear(before)
    unread = {"heard"} if rule == const.RULE_FEASIBLE else {"heard", "fd_known", "fd_sq", "fd_dist"}
    same = pair.same_state(before, after, lambda field, _: pair.t.truth_of(field in unread))
    return pair.step("a port hears again what it heard last", [same, pair.quiet(machine)], facts)
