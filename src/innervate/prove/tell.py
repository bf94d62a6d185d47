"""A refuted goal in sentences: what was, what happened, what is."""

from __future__ import annotations

from collections.abc import Iterable

from innervate.prove.records import Key, name_of
from innervate.prove.solve import Question
from innervate.prove.steps import Step

FIELDS_MAX = 12  # that a sentence lists


def changes(step: Step, question: Question, goal: str) -> list[str]:
    """What a step does to the fields that it changes, with the values that refute a goal."""
    told = [
        f"Before: {_listed(step, question, before=True)}.",
        f"Then: {step.name}.",
        f"Afterwards: {_listed(step, question, before=False)}.",
        f"This breaks: {goal}.",
    ]
    return told


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
