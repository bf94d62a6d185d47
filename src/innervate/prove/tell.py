"""A refuted goal in sentences: what was, what happened, what is."""

from collections.abc import Iterable, Iterator

from innervate.dialect.arith import MASK30
from innervate.dialect.outbox import SEND, SET_TIMER
from innervate.prove.records import Key, name_of
from innervate.prove.solve import Question
from innervate.prove.steps import SENT, Step

FIELDS_MAX = 12  # that a sentence lists


def changes(step: Step, question: Question, goal: str) -> list[str]:
    """What a step does to the fields that it changes, with the values that refute a goal."""
    which = next(beyond(step, question), "") if goal == SENT else ""
    return [
        f"Before: {_listed(step, question, before=True)}.",
        f"Then: {step.name}.",
        f"Afterwards: {_listed(step, question, before=False)}.",
        f"This breaks: {goal}{which and f': {which}'}.",
    ]


def beyond(step: Step, question: Question) -> Iterator[str]:
    """What the values have the step send and set that cannot be."""
    for action in step.machine.out.actions:
        if not question.holds(action.guard):
            continue
        does = "sends" if action.kind == SEND else "delivers"
        for key, low, high in action.frame.places():
            value = question.value(step.after[key]) if key in step.after else low
            if not low <= value <= high:
                field = name_of(key).partition(".")[2]
                yield (f"{field} of a frame that {action.where} {does} is {value}, "
                       f"declared {low} to {high}")  # fmt: skip
        a, b = question.value(action.a), question.value(action.b)
        if action.kind == SEND and step.ports and not 0 <= a < step.ports:
            yield f"{action.where} sends a frame on port {a}"
        if action.kind == SET_TIMER and not 0 <= a < step.timers:
            yield f"{action.where} sets timer {a}, and there are {step.timers}"
        if action.kind == SET_TIMER and not 0 <= b <= MASK30:
            yield f"{action.where} sets timer {a} to {b}, which is no reading of a clock"


def _listed(step: Step, question: Question, before: bool) -> str:
    values = step.before if before else step.after
    keys = list(_changed(step, question))
    parts = [f"{name_of(key)} {question.value(values[key])}" for key in keys[:FIELDS_MAX]]
    if len(keys) > FIELDS_MAX:
        parts.append(f"{len(keys) - FIELDS_MAX} more")
    return ", ".join(parts) or "nothing changes"


def _changed(step: Step, question: Question) -> Iterable[Key]:
    """Places whose value the step changes; those of declared records, in their order."""
    value = question.value
    for record in step.records.values():
        for key, _low, _high in record.places():
            if key in step.after and value(step.before[key]) != value(step.after[key]):
                yield key
