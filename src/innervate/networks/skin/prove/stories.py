"""Two cells, A and B, side by side: can their parents close a ring?

Both run the protocol's own handlers. Under `paper` they can with nothing but two cut cables; under
`strict` only where the PC's number goes back; under `feasible` not at all.
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import Any

from innervate.dialect.arith import HALF16, MASK16
from innervate.dialect.source import Change
from innervate.networks.skin.protocol import constants as const
from innervate.networks.skin.protocol import fields
from innervate.networks.skin.prove.neighbours import ENTRY, ROOM
from innervate.prove.records import Record, Store
from innervate.prove.solve import Question
from innervate.prove.steps import Goal, Stage, Step
from innervate.prove.terms import Term
from innervate.prove.theory import source

PC, OTHER = 0, 1  # ports: of both cells one leads to the PC, one to the other cell
GOAL = "A and B are not each other's parents"
BOTH_LOSE = "both cells lose their cables to the PC"
PC_GOES_BACK = "the PC's number goes back, and A loses its cable to it"


@dataclass(slots=True)
class Two:
    """Two cells on a stage."""

    stage: Stage
    a: Record
    b: Record
    params: Record
    frame: Record


def both_lose(change: Change | None = None, rule: int = const.RULE_PAPER) -> Callable[[], Step]:
    """Both cells have the PC as parent and know of each other's route; both cables are cut."""
    return partial(_both_lose, source(ENTRY, change), rule)


def goes_back(
    change: Change | None = None, rule: int = const.RULE_STRICT, only_rises: bool = False
) -> Callable[[], Step]:
    """B follows A and A the PC, whose next beacon has any number: then A's cable is cut.

    If it `only_rises`, that number is no older.
    """
    return partial(_goes_back, source(ENTRY, change), rule, only_rises)


def _two(known: dict[str, Any], rule: int) -> Two:
    stage = Stage(known, fields.FRAME, 4 * ROOM)
    made = Two(
        stage,
        stage.record("A", fields.CELL),
        stage.record("B", fields.CELL),
        stage.record("params", fields.PARAMS),
        stage.record("frame", fields.FRAME),
    )
    for name, value in (
        ("rule", rule), ("updates", const.PERIODIC), ("k", 1), ("r_f", const.ONE),
        ("r_r", const.ONE), ("max_depth", 64), ("balance_periods", 0), ("hold_periods", 129),
    ):  # fmt: skip
        stage.fix(made.params, name, value)
    for cell in (made.a, made.b):
        for name, values in (("dist", const.INFINITY), ("child", 0), ("pf", 0), ("heard", 1)):
            for p in range(const.PORTS):
                stage.fix(cell, name, values, p)
        for name, value in (("wait", 0), ("hold", 0), ("sq_known", 1), ("soon", 0)):
            stage.fix(cell, name, value)
    return made


def _routed(two: Two, cell: Record, port: int, dist: int, sq: Term) -> None:
    """A cell has a route by a port, and announced it when it took it."""
    stage = two.stage
    stage.fix(cell, "parent", port)
    stage.fix(cell, "dist", dist, port)
    stage.store[cell, "sq", port] = stage.store[cell, "sq_own", None] = sq
    stage.fix(cell, "fd_known", 1)
    stage.store[cell, "fd_sq", None] = sq
    stage.fix(cell, "fd_dist", dist + 1)


def _ticks(two: Two, cell: Record, store: Store, heard: bool) -> Store:
    """A cell's period ends; whether a beacon of the PC came in it. The other's last comes again."""
    flags = {PC: int(heard), OTHER: 1}
    store = {**store, **{(cell, "heard", p): two.stage.number(flags[p]) for p in flags}}
    args = [cell, two.params, two.stage.clock(), const.TICK, two.stage.out]
    after, _ = two.stage.machine.run("on_timer", args, store)
    return after


def _ring(two: Two, name: str, after: Store, facts: list[Term]) -> Step:
    t = two.stage.terms
    closed = t.all(*(t.same(after[cell, "parent", None], t.number(OTHER))
                     for cell in (two.a, two.b)))  # fmt: skip
    known = [*facts, *two.stage.machine.facts]
    return two.stage.step(name, after, known, [Goal(GOAL, t.negated(closed))])


def _both_lose(known: dict[str, Any], rule: int) -> Step:
    two = _two(known, rule)
    stage, t = two.stage, two.stage.terms
    sq = t.unknown("number", 0, MASK16)
    for cell in (two.a, two.b):
        _routed(two, cell, PC, 0, sq)
        stage.fix(cell, "dist", 1, OTHER)
        stage.store[cell, "sq", OTHER] = sq
    after = _ticks(two, two.b, _ticks(two, two.a, stage.store, False), False)
    return _ring(two, BOTH_LOSE, after, [])


def _goes_back(known: dict[str, Any], rule: int, only_rises: bool) -> Step:
    two = _two(known, rule)
    stage, t = two.stage, two.stage.terms
    sq, early = t.unknown("number", 0, MASK16), t.unknown("early", 0, MASK16)
    _routed(two, two.a, PC, 0, sq)
    _routed(two, two.b, OTHER, 1, sq)
    # What A keeps of B is from before B took A: B had a route of its own then.
    stage.fix(two.a, "dist", 1, OTHER)
    stage.store[two.a, "sq", OTHER] = early
    stage.fix(two.frame, "kind", const.BEACON)
    for name in ("dist", "load", "size", "parent"):
        stage.fix(two.frame, name, 0)
    new = stage.store[two.frame, "sq", None]
    oldest = t.unknown("oldest", 0, MASK16)
    facts = [_ahead(two, early, sq), *(_ahead(two, oldest, one) for one in (early, sq, new))]
    if only_rises:
        facts.append(_ahead(two, sq, new))
    args = [two.a, two.params, stage.clock(), PC, two.frame, stage.out]
    heard, _ = stage.machine.run("on_frame", args, stage.store)
    followed = _ticks(two, two.a, heard, True)
    after = _ticks(two, two.a, followed, False)
    return _ring(two, PC_GOES_BACK, after, facts)


def _ahead(two: Two, a: Term, b: Term) -> Term:
    """Number b is as new as a or newer, by less than half of all numbers."""
    t = two.stage.terms
    return t.less(t.bits_and(t.sub(b, a), t.number(MASK16)), t.number(HALF16))


def tell(step: Step, question: Question, _goal: str) -> list[str]:
    """The ring in sentences, with the numbers that close it."""
    number = question.value(step.was("A", "sq_own"))
    if step.name == BOTH_LOSE:
        return [
            f"Cells A and B are joined, and each has a cable to the PC: 1 hop, number {number}.",
            f"Each has heard the other say: 1 hop, number {number}, you are not my parent.",
            "Both cables to the PC are cut.",
            f"A's period ends: it takes B, whose {number} is not older than its own.",
            f"B's ends before it hears of that: it takes A, whose {number} is not older either.",
            "Now A's parent is B and B's is A.",
        ]
    early = question.value(step.was("A", "sq", OTHER))
    again = question.value(step.was("frame", "sq"))
    return [
        f"A has a cable to the PC: 1 hop, number {number}. B's parent is A: 2 hops, {number}.",
        f"A has last heard B when that had a route of its own: 1 hop, number {early}.",
        f"The PC restarts and counts from {again}. A hears it, and follows: {again} is its number.",
        f"A's cable to the PC is cut. Its period ends: B's {early} is newer than {again}; "
        "it takes B.",
        "B has heard nothing of all this: its parent is A, and A's is B.",
    ]


def simple(step: Step) -> list[Term]:
    """Small numbers in both stories."""
    t = step.terms
    wishes = []
    for name, value in (("number", 7), ("early", 6), ("number", 5)):
        wishes.append(t.same(t.unknown(name, 0, MASK16), t.number(value)))
    frame = step.records["frame"]
    wishes.append(t.same(step.before[frame, "sq", None], t.number(1)))
    return wishes
