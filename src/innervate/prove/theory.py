"""What is proved of a network: theories, each of steps and lemmas, and how they come out."""

import ast
import inspect
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from functools import cache
from typing import Any

from innervate.dialect.source import Change, Function, functions, reached
from innervate.kernel.stop import ends_at_once
from innervate.prove.check import Checked, Explainer, Way, check, unreached
from innervate.prove.errors import ProveError
from innervate.prove.steps import Step
from innervate.prove.tell import changes
from innervate.prove.terms import Term


class Source(dict[str, Function]):
    """The functions of a protocol, which know who was asked for them."""

    def __init__(self, found: dict[str, Function], changed: frozenset[str]) -> None:
        super().__init__(found)
        self.changed = changed  # names of those that a planted mistake is in
        self.asked: set[str] = set()  # that were called since this was emptied last

    def __getitem__(self, name: str) -> Function:
        self.asked.add(name)
        return super().__getitem__(name)

    def get(self, name: str, default: Any = None) -> Any:
        """A function, if there is one of this name."""
        self.asked.add(name)
        return super().get(name, default)


def source(entry: str, change: Change | None) -> Source:
    """The functions of a protocol, with a mistake if its text is one of theirs."""
    planted = change if change is not None and is_in(entry, change) else None
    found: dict[str, Function] = functions(entry, change=planted, shared=True)
    if planted is None:
        return Source(found, frozenset())
    shipped = _texts(entry)
    changed = (name for name, one in found.items() if ast.dump(one.node) != shipped.get(name))
    return Source(found, frozenset(changed))


@cache
def _texts(entry: str) -> dict[str, str]:
    """What every function of a protocol says as it is shipped."""
    return {name: ast.dump(one.node) for name, one in functions(entry, shared=True).items()}


def is_touched(step: Step) -> bool:
    """True if a function with a planted mistake was called since this was asked last.

    Where none was, a step is what it is of the shipped source. Without a mistake it is always true.
    """
    known = step.machine.functions
    if not isinstance(known, Source):
        return True
    asked = known.asked & known.changed
    known.asked.clear()
    return bool(asked) or not known.changed


def check_change(change: Change | None, *entries: str) -> None:
    """Nothing is proved of a mistake that none of these entries' functions has.

    Raises:
        ProveError: the mistake to plant is in none of the sources.
    """
    if change is not None and not any(is_in(entry, change) for entry in entries):
        raise ProveError(f"{change[0]!r} is in no source that is proved")


def whole_source(entry: str, change: Change | None) -> Source:
    """As `source`, of the only protocol that is proved: a mistake is in it (or ProveError)."""
    check_change(change, entry)
    return source(entry, change)


def is_in(entry: str, change: Change) -> bool:
    """True if the text of a mistake is in what an entry's functions can reach."""
    return any(change[0] in inspect.getsource(module) for module in reached(entry))


Progress = Callable[[str, int, int], bool]  # what, part, of; True to stop


@dataclass(frozen=True, slots=True)
class Theory:
    """Something that is claimed of a protocol, for any number of nodes."""

    name: str  # like "skin, rule feasible"
    claim: str  # what follows from its steps, in a sentence
    assumed: tuple[str, ...]  # what it rests on besides the protocol, a sentence each
    steps: tuple[Callable[[], Step], ...]  # make its steps, one after the other
    # (function, part of the line, taken) of branches that no state takes, with why
    unreachable: dict[tuple[str, str, bool], str] = field(default_factory=dict)
    # "" for one that holds, else the step that must refute it: a claim that is false
    refuted_by: str = ""
    is_example: bool = False  # it plays one story, so that branches are left out on purpose
    tell: Explainer = changes  # says in sentences what happens with values that refute a goal
    # what counterexamples should keep to, of a step
    simple: Callable[[Step], list[Term]] | None = None


@dataclass(slots=True)
class Outcome:
    """What came of a theory."""

    theory: Theory  # that was tried
    checked: list[Checked]  # its steps
    unreached: list[Way]  # ways of branches that no step takes and that are not named as such
    named: list[Way]  # those that are named
    ended: str = "complete"  # complete, or stopped

    @property
    def is_refuted(self) -> bool:
        """True if some goal does not hold."""
        return any(one.refuted for one in self.checked)

    @property
    def is_as_expected(self) -> bool:
        """True if it holds and nothing is vacuous; or it is refuted, and was said to be."""
        if self.theory.refuted_by:
            return any(one.refuted and one.name == self.theory.refuted_by for one in self.checked)
        return self.ended == "complete" and not self.is_refuted and not self.unreached

    @property
    def lemmas(self) -> int:
        """How many goals there are."""
        return sum(len(one.goals) for one in self.checked)

    def as_dict(self) -> dict[str, Any]:
        """The outcome as `innervate prove --json` prints it."""
        return {
            "theory": self.theory.name,
            "claim": self.theory.claim,
            "assumed": list(self.theory.assumed),
            "ended": self.ended,
            "holds": self.ended == "complete" and not self.is_refuted and not self.unreached,
            "expected": self.is_as_expected,
            "lemmas": self.lemmas,
            "unreached": [list(way) for way in self.unreached],
            "steps": [_step_dict(one) for one in self.checked],
        }


def _step_dict(one: Checked) -> dict[str, Any]:
    refuted = {bad.goal: bad for bad in one.refuted}
    return {
        "name": one.name,
        "wall_s": round(one.wall_s, 3),
        "branches": len(one.reached),
        "lemmas": [{"name": name, "answer": "sat" if name in refuted else "unsat"}
                   for name in one.goals],
        "refuted": [{"lemma": bad.goal, "story": bad.sentences, "values": bad.values}
                    for bad in one.refuted],
    }  # fmt: skip


def prove(theory: Theory, tell: Progress | None = None, first_only: bool = False) -> Outcome:
    """Try to refute a theory.

    Args:
        theory: what is claimed.
        tell: is told how far it is; says if to stop. With it Ctrl-C ends a theory where it is, and
            what was done of it is kept.
        first_only: end with the first step that is refuted; leave out those that a planted mistake
            does not touch.
    """
    checked: list[Checked] = []
    lines: dict[Way, str] = {}
    try:
        with ends_at_once():
            ended = _steps(theory, tell, first_only, checked, lines)
    except KeyboardInterrupt:
        if tell is None:
            raise
        ended = "stopped"
    missing = list(unreached(checked)) if ended == "complete" and not theory.is_example else []
    named = [way for way in missing if _is_named(theory, way, lines.get(way, ""))]
    return Outcome(theory, checked, [way for way in missing if way not in named], named, ended)


def _steps(
    theory: Theory,
    tell: Progress | None,
    first_only: bool,
    checked: list[Checked],
    lines: dict[Way, str],
) -> str:
    """Try its steps in turn, adding to `checked` and to branches' `lines`; how it ended."""
    reach = not (first_only or theory.is_example)
    for number, make in enumerate(theory.steps):
        step = make()
        if tell is not None and tell(f"{theory.name}: {step.name}", number, len(theory.steps)):
            return "stopped"
        if first_only and not is_touched(step):
            continue
        lines.update(_lines(step))
        simple = theory.simple(step) if theory.simple is not None else []
        known = {way for one in checked for way in one.reached}
        checked.append(check(step, theory.tell, simple, first_only, reach, known))
        if first_only and checked[-1].refuted:
            return "stopped"
    return "complete"


def _lines(step: Step) -> Iterator[tuple[Way, str]]:
    """The text of every branch's line."""
    texts: dict[str, list[str]] = {}
    for way in step.all_ways():
        path = step.machine.functions[way[0]].path
        if path not in texts:
            with open(path, encoding="utf-8") as file:
                texts[path] = file.read().splitlines()
        yield way, texts[path][way[1] - 1]


def _is_named(theory: Theory, way: Way, line: str) -> bool:
    """True if a branch is named as one that no state takes."""
    return any(
        function == way[0] and part in line and taken == way[2]
        for function, part, taken in theory.unreachable
    )
