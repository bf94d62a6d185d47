"""What holds of a declared protocol besides its ranges: its frames have layouts, draws are its own.

A kind without a layout is in range, and cannot go over a wire. A draw is taken for any number below
its n, which it is not where a handler writes what the generator lives on.
"""

from collections.abc import Iterable, Iterator, Mapping
from functools import partial
from typing import Any

from innervate.dialect.outbox import SEND
from innervate.prove.execute import RANDOM
from innervate.prove.steps import Goal, Step
from innervate.prove.terms import Term, Terms

KIND = "kind"
GENERATOR = ("rng", "choice")


def beside_ranges(step: Step, known: Mapping[str, Any], kinds: frozenset[int]) -> list[Goal]:
    """The goals of a step.

    Args:
        step: that was played.
        known: the functions of its protocol.
        kinds: that have a layout; none where layouts are not what goes over a wire.
    """
    goals = [*_sent(step, kinds), *_handled(step, kinds)] if kinds else []
    if any(one.module == RANDOM for one in known.values()):
        goals += _drawn(step)
    return goals


def _sent(step: Step, kinds: frozenset[int]) -> Iterator[Goal]:
    """Each function sends kinds that have layouts, but for those that a node keeps or hands on."""
    terms, by_name = step.terms, dict[str, list[Term]]()
    laid = partial(_is_laid, terms, sorted(kinds), {})
    for action in step.machine.out.actions:
        kind = step.after.get((action.frame, KIND, None))
        if action.kind == SEND and kind is not None:
            by_name.setdefault(action.where, []).append(terms.implies(action.guard, laid(kind)))
    for where, holds in by_name.items():
        yield Goal(f"every kind of frame that {where} sends has a layout", terms.all(*holds))


def _is_laid(terms: Terms, kinds: list[int], known: dict[Term, Term], kind: Term) -> Term:
    if kind not in known:
        if kind.op != "pick" and _is_kept(kind):  # what was before the step is not known
            known[kind] = terms.true
        elif kind.op == "pick" and not kind.is_leafy:
            if_, a, b = (one for one in kind.args if isinstance(one, Term))
            laid = (_is_laid(terms, kinds, known, one) for one in (a, b))
            known[kind] = terms.pick(if_, *laid)
        else:
            known[kind] = terms.any(*(terms.same(kind, terms.number(one)) for one in kinds))
    return known[kind]


def _is_kept(kind: Term) -> bool:
    """True if a number is made from what was before the step, and not only chosen by it."""
    made = [one for one in kind.args if isinstance(one, Term) and not one.is_truth]
    return kind.op == "var" or any(map(_is_kept, made))


def _handled(step: Step, kinds: frozenset[int]) -> Iterator[Goal]:
    """No branch asks for a kind that has no layout, as none such comes."""
    kind = step.before.get((step.records["frame"], KIND, None)) if "frame" in step.records else None
    if kind is None:
        return
    asked: dict[int, str] = {}
    for (function, _line, _taken), guards in step.all_ways().items():
        for value in _compared(kind, guards):
            asked.setdefault(value, function)
    for value in sorted(asked.keys() - kinds):
        name = f"kind {value}, which {asked[value]} asks for, has a layout"
        yield Goal(name, step.terms.negated(step.terms.same(kind, step.terms.number(value))))


def _compared(kind: Term, guards: Iterable[Term]) -> Iterator[int]:
    """The numbers that a kind itself is compared with, not what is looked up by it."""
    waiting, seen = list(guards), set[int]()
    while waiting:
        term = waiting.pop()
        if id(term) in seen or not term.is_truth:
            continue
        seen.add(id(term))
        args = [one for one in term.args if isinstance(one, Term)]
        if term.op != "eq":
            waiting += args
        elif args[0] is kind and args[1].value is not None:
            yield args[1].value


def _drawn(step: Step) -> Iterator[Goal]:
    """What the generator lives on is not written; only `draw` is, and it is not looked into."""
    terms = step.terms
    state = step.records["state"]
    for name in GENERATOR:
        before = step.before.get((state, name, None))
        if before is not None:
            holds = terms.same(step.after[state, name, None], before)
            if holds is not terms.true:
                yield Goal(f"{name} is written by draws alone, which stand for any number", holds)
