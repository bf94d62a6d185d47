"""What `innervate prove` claims of a skin, and what it must refute."""

from collections.abc import Callable
from functools import partial
from typing import Any

from innervate.dialect.source import Change
from innervate.networks.skin.protocol import constants as const
from innervate.networks.skin.prove import (
    feasible,
    forgetting,
    mirror,
    pc,
    reductions,
    repeating,
    stories,
    strict,
    system,
    unread,
)
from innervate.networks.skin.prove.faults import EXPLORERS, MUTANTS
from innervate.networks.skin.prove.neighbours import ANY_RULE, ENTRY, base_of
from innervate.networks.skin.prove.words import tell
from innervate.prove.steps import Step
from innervate.prove.terms import Term
from innervate.prove.theory import Theory, check_change

__all__ = ["EXPLORERS", "MUTANTS", "theories"]

ASSUMED = (
    "A frame arrives as it was sent or not at all; late, doubled and out of order as it may.",
    "Numbers: those in use (feasible distances, routes kept of working ports, beacons on their "
    "way) differ by less than 2^15.",
    "Restart: when a cell's wait is over, no neighbour has it as parent, keeps a route of it on "
    "a working port, or has one of its old routes on the way.",
    "FD_HOLD: the same when a cell forgets its feasible distance.",
    "First start: a cell is switched on with cause 0 only if it never was on before.",
    "A cable joins the same two ends for ever; it may be cut and mended.",
)
STRICT = (
    "The PC is not restarted, and a cable keeps the order of its frames: a route is announced with "
    "no older number than before.",
    *ASSUMED[1:],
)
OTHER_FRAMES = "only data and commands are copied"
UNREACHABLE = {
    ("copy_frame", "kind == DATA or kind == COMMAND", False): OTHER_FRAMES,
    ("is_allowed", "params.rule == RULE_FEASIBLE", False): "another rule",
}
UNREACHABLE_STRICT = {
    ("is_allowed", "params.rule == RULE_FEASIBLE", True): "another rule",
    ("is_allowed", "params.rule == RULE_PAPER", True): "another rule",
    ("on_frame", "frame.kind == BEACON", False): "data and commands are proved under feasible",
}

BALANCING = "the explorer does without balancing"
NOT_EXPLORED = {
    ("is_worth_moving", "params.balance_rule == BALANCE_PAPER", True): BALANCING,
    ("is_worth_moving", "params.balance_rule == BALANCE_PAPER", False): BALANCING,
    ("select", "elif lightest != NONE:", True): BALANCING,
    ("select", "if is_worth_moving(", True): BALANCING,
    ("select", "if is_worth_moving(", False): BALANCING,
    ("on_start", "params.balance_periods > 0", True): BALANCING,
    ("tick", "params.balance_periods > 0", True): BALANCING,
    ("tick", "if cell.countdown <= 0:", True): BALANCING,
    ("tick", "if cell.countdown <= 0:", False): BALANCING,
    ("tick", "if may_balance and cell.parent != before:", True): BALANCING,
    ("on_frame", "frame.kind == BEACON", False): "the explorer's frames are beacons",
    ("on_frame", "if frame.kind == DATA:", True): "the explorer's frames are beacons",
    ("on_frame", "if frame.kind != BEACON:", True): "the explorer's frames are beacons",
    ("on_timer", "if is_news(cell, params):", True): "of news that are none",
    ("select", "if cell.size[p] < cell.size[lightest]:", True): "sizes decide nothing",
    ("tick", "if not silent:", False): "triggered updates only",
}


def theories(_network: Any, change: Change | None = None) -> list[Theory]:
    """All claims, smallest first; then those that must be refuted, told as stories.

    Raises:
        ProveError: the mistake to plant is in none of the sources.
    """
    check_change(change, ENTRY, pc.ENTRY)
    return [
        Theory("skin, the PC", "It announces distance 0 and its number, which only rises.",
               (), pc.steps(change), UNREACHABLE, tell=tell, simple=simple),
        Theory("skin, rule feasible", "At no moment parents close a ring, of any number of cells.",
               ASSUMED, feasible.steps(change) + system.steps(change), UNREACHABLE,
               tell=tell, simple=simple),
        Theory("skin, rule strict", "The same, while the PC's number never goes back.",
               STRICT, strict.steps(change), UNREACHABLE_STRICT, tell=tell, simple=simple),
        *_stories(change),
    ]  # fmt: skip


def resting(rule: int, change: Change | None = None) -> list[Theory]:
    """What a reduced search rests on, of the source at hand.

    Args:
        rule: ANY_RULE: what is so under all; else what more there is under one that refuses for
            good, so that what it refuses is forgotten, too.
        change: a mistake to plant.
    """
    own = feasible.steps if rule == const.RULE_FEASIBLE else strict.steps
    parts: list[tuple[str, Callable[..., Any]]] = [
        ("the rule", own),
        ("what the rule refuses", partial(forgetting.steps, rule)),
        ("beacons that repeat the last", partial(repeating.steps, rule)),
        ("what the rule does not read", partial(unread.steps, rule)),
    ]
    if rule == ANY_RULE:
        parts = [
            ("what is only stored, news, loads", partial(reductions.steps, rule)),
            ("what dead ports said", partial(forgetting.steps, rule)),
            ("what is not read", partial(unread.steps, rule)),
            ("ports are alike", partial(mirror.steps, rule)),
        ]
    unreachable = UNREACHABLE_STRICT if rule == const.RULE_STRICT else UNREACHABLE
    return [Theory(name, "What the explorer forgets of a state decides nothing.", (),
                   steps(change=change),
                   unreachable if steps is own else unreachable | NOT_EXPLORED)
            for name, steps in parts]  # fmt: skip


def _stories(change: Change | None) -> list[Theory]:
    """Two cells that close a ring where a rule or its condition is given up, and do not else."""
    lose, back = stories.BOTH_LOSE, stories.PC_GOES_BACK
    rows = (
        ("paper", "two cells close no ring", stories.both_lose(change), lose),
        ("paper-lax", "two cells close no ring",
         stories.both_lose(change, const.RULE_PAPER_LAX), lose),
        ("feasible, two cells", "both lose the PC and close no ring",
         stories.both_lose(change, const.RULE_FEASIBLE), ""),
        ("strict, the PC restarts", "two cells close no ring", stories.goes_back(change), back),
        ("strict, the PC does not", "the same two close none",
         stories.goes_back(change, only_rises=True), ""),
        ("feasible, the PC restarts", "the same two close none",
         stories.goes_back(change, const.RULE_FEASIBLE), ""),
    )  # fmt: skip
    return [
        Theory(f"skin, rule {name}", claim[0].upper() + claim[1:] + ".", (), (step,),
               refuted_by=by, tell=stories.tell, simple=stories.simple, is_example=True)
        for name, claim, step, by in rows
    ]  # fmt: skip


def simple(step: Step) -> list[Term]:
    """Counterexamples with small numbers, on few ports."""
    t = step.terms
    wishes = [t.same(base_of(t), t.number(1))]
    for record in step.records.values():
        for key, low, high in record.places():
            value = step.before[key]
            if key[1] == "dist" and key[0].name == "cell":
                wishes.append(t.same(value, t.number(const.INFINITY)))
            elif value.op == "wrap":
                wishes.append(t.less(value.args[1], t.number(8)))  # type: ignore[arg-type]
            elif value.op == "var":
                wishes.append(t.same(value, t.number(min(max(0, low), high))))
    return wishes
