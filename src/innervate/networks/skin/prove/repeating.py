"""With triggered updates a beacon that says what its receiver heard last changes nothing.

That is so because a cell's choice is up to date between any two events (K1 .. K4), which every
handler that the explorer calls keeps; so there is nothing that hearing the same again could bring.
"""

from collections.abc import Callable, Iterable
from functools import partial
from typing import Any

from innervate.dialect.source import Change
from innervate.networks.skin.protocol import constants as const
from innervate.networks.skin.prove.neighbours import ENTRY, EVENTS, STARTS
from innervate.networks.skin.prove.reductions import HANDLERS, Bare, kept
from innervate.prove.records import Store
from innervate.prove.steps import Goal, Step
from innervate.prove.terms import Term
from innervate.prove.theory import source

SAID = (("dist", "dist"), ("sq", "sq"), ("load", "load"), ("size", "size"), ("child", "parent"))


def steps(rule: int, change: Change | None = None) -> tuple[Callable[[], Step], ...]:
    """That a cell's choice is up to date, and what follows for a beacon that repeats the last."""
    known = source(ENTRY, change)
    return (
        *(partial(_kept, known, rule, name) for name in EVENTS),
        partial(_repeated, known, rule),
    )


def _triggered(known: dict[str, Any], rule: int) -> Bare:
    """A cell with triggered updates of which the rule's invariants hold."""
    bare = Bare(known, rule)
    any_ = bare.view(bare.stage.store).param("updates")  # what the facts speak of
    bare.facts = [*kept(bare), bare.t.same(any_, bare.t.number(const.TRIGGERED))]
    bare.stage.fix(bare.params, "updates", const.TRIGGERED)
    return bare


def up_to_date(bare: Bare, store: Store, ports: Iterable[int] = range(const.PORTS)) -> list[Goal]:
    """What holds of a cell's choice between any two events, as far as these ports go."""
    t, view = bare.t, bare.view(store)

    def asks(question: str, *args: Any) -> Term:
        return bare.asks(question, [bare.cell, bare.params, *args], store)

    has, best, usable = view.has_parent(), [], []
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
    bare = _triggered(known, rule)
    before, starts = bare.stage.store, name == STARTS
    facts = [] if starts else [one.holds for one in up_to_date(bare, before)]
    handler, told, _kinds = EVENTS[name]
    after, _ = bare.run(before, handler, *told)
    ports = range(const.PORTS if starts else 1)  # to all else ports are alike: mirror.py
    return bare.step(name, up_to_date(bare, after, ports), facts)


def _repeated(known: dict[str, Any], rule: int) -> Step:
    """A beacon says what was heard last."""
    port = 0  # ports are alike (mirror.py)
    bare = _triggered(known, rule)
    before = bare.stage.store
    bare.port = bare.t.number(port)
    for field, said in SAID:
        before[bare.frame, said, None] = before[bare.cell, field, port]
    facts = [one.holds for one in up_to_date(bare, before)]
    after, machine = bare.run(before, *HANDLERS["a beacon"])
    unread = {"heard"} if rule == const.RULE_FEASIBLE else {"heard", "fd_known", "fd_sq", "fd_dist"}
    same = bare.same_state(before, after, lambda field, _: bare.t.truth_of(field in unread))
    return bare.step("a port hears again what it heard last", [same, bare.quiet(machine)], facts)
