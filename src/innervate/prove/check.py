"""Has the solver try to refute what is to hold, and sees that nothing holds for want of cases."""

from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass, field

from innervate.kernel.clock import wall_s
from innervate.prove.errors import ProveError, UnsureError
from innervate.prove.solve import Formulas, Question
from innervate.prove.steps import Step
from innervate.prove.terms import Term

Way = tuple[str, int, bool]  # function, line, taken: one way of a branch


@dataclass(slots=True)
class Refuted:
    """A goal that does not hold."""

    goal: str  # its name
    values: dict[str, int]  # of all unknowns before the step
    sentences: list[str] = field(default_factory=list)  # what happens with these values


@dataclass(slots=True)
class Checked:
    """What came of a step."""

    name: str  # of the step
    goals: list[str]  # names of what was to hold
    refuted: list[Refuted] = field(default_factory=list)  # those that do not
    reached: set[Way] = field(default_factory=set)  # ways of branches that some state takes
    missed: set[Way] = field(default_factory=set)  # ways that none takes in this step
    wall_s: float = 0.0  # how long it took


Explainer = Callable[[Step, Question, str], list[str]]


def check(
    step: Step,
    tell: Explainer | None = None,
    simple: Iterable[Term] = (),
    first_only: bool = False,
    reach: bool = True,
    known: Iterable[Way] = (),
) -> Checked:
    """Try to refute a step's goals.

    Args:
        step: that was played, with goals.
        tell: says in sentences what happens with the values that refute one.
        simple: what counterexamples should keep to if they can, so that they are easy to read.
        reach: see which branches some state takes, too.
        known: ways of branches that other steps have taken: they need not be asked for.
        first_only: one goal that is refuted is enough, and no story of it.

    Raises:
        ProveError: nothing can be as the facts say, so that everything would hold; or the solver
            could not say.
    """
    begun, simple = wall_s(), tuple(simple)
    found = Checked(step.name, [goal.name for goal in step.goals])
    with _called(step.name):
        question = Question(Formulas(), step.facts)
        if question.values() is None:
            raise ProveError(f"{step.name}: no state is as assumed, so all would hold")
        if reach:
            found.reached, found.missed = reached(step, question, known)
        if _is_refuted(step, question):
            if first_only:
                bad = next(goal for goal in step.goals if not question.holds(goal.holds))
                found.refuted = [Refuted(bad.name, question.values_found)]
            else:
                found.refuted = list(_all_refuted(step, question, tell, simple))
    found.wall_s = wall_s() - begun
    return found


@contextmanager
def _called(name: str) -> Iterator[None]:
    """Says of what the solver could not say."""
    try:
        yield
    except UnsureError as error:
        raise UnsureError(f"{name}: {error}") from None


def _is_refuted(step: Step, question: Question) -> bool:
    """Some goal does not hold: asked of all at once, or of each where that is too much."""
    wrong = [step.terms.negated(goal.holds) for goal in step.goals]
    if not step.singly:
        with suppress(UnsureError):
            return question.values(step.terms.any(*wrong)) is not None
    for one, goal in zip(wrong, step.goals, strict=True):
        with _called(goal.name):
            if question.values(one) is not None:
                return True
    return False


def _all_refuted(
    step: Step, question: Question, tell: Explainer | None, simple: tuple[Term, ...]
) -> Iterator[Refuted]:
    """All goals that do not hold, with values that refute them, as simple as they can be had."""
    for goal in step.goals:
        can_be = question.together([step.terms.negated(goal.holds), *simple])
        if not can_be(0):
            continue
        wanted = [0]
        for place, wish in enumerate(simple, 1):
            if question.holds(wish) or can_be(*wanted, place):
                wanted.append(place)
        values = question.found()
        yield Refuted(goal.name, values, tell(step, question, goal.name) if tell else [])


def reached(step: Step, question: Question, known: Iterable[Way] = ()) -> tuple[set[Way], set[Way]]:
    """The ways of branches that some state takes, and those that none does."""
    terms, seen = step.terms, set(known)
    open_ = {way: terms.any(*guards) for way, guards in step.all_ways().items() if way not in seen}
    missed = {way for way, guard in open_.items() if guard is terms.false}
    for way in missed:
        del open_[way]
    ways, guards = list(open_), list(open_.values())
    can_be = question.together(guards)
    found: set[Way] = set()
    for k in reversed(range(len(ways))):  # who comes so far has taken others on the way
        if ways[k] in found:
            continue
        if can_be(k):
            taken = question.which(guards)
            found |= {way for way, holds in zip(ways, taken, strict=True) if holds}
        else:
            missed.add(ways[k])
    return found, missed


def unreached(checked: Iterable[Checked]) -> Iterator[Way]:
    """Ways of branches that no step takes, though one comes to the branch's function."""
    reached_: set[Way] = set()
    missed: set[Way] = set()
    for one in checked:
        reached_ |= one.reached
        missed |= one.missed
    yield from sorted(missed - reached_)
