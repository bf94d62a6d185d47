"""Practical CSMA/CD-R, turns: what becomes of places when a station has missed a frame.

Places are named by the report, so a data frame that was missed before does not matter to them. A
report that was missed does: whoever was in a place that it gives out stays there.
"""

from __future__ import annotations

from functools import partial

from innervate.networks.radio.protocol import fields
from innervate.networks.radio.prove.turns import (
    MINISLOTS,
    ROOM,
    STATION,
    Ending,
    apart,
    short,
    used_by_one,
)
from innervate.prove.records import Outbox
from innervate.prove.solve import Question
from innervate.prove.steps import Goal, Stage, Step
from innervate.prove.theory import Source, Theory

MISSED = "a station misses a report"
TRIED = (f"Of a report's minislots the first {MINISLOTS} are tried.",)
OWN = "they have places of their own"


def theories(known: Source) -> list[Theory]:
    """What a missed data frame does not do, and what a missed report does."""
    return [
        Theory("radio, a data frame missed", "Behind a report two stations have places of their "
               "own, whatever either had heard of the round before.", TRIED,
               (partial(_places, known, True),), is_example=True),
        Theory("radio, a report missed", "The same if one of them missed the report.", TRIED,
               (partial(_places, known, False),), refuted_by=MISSED, is_example=True, tell=tell),
    ]  # fmt: skip


def _places(known: Source, both: bool) -> Step:
    """A station hears a report, and the other does, too, or does not."""
    stage = Stage(known, fields.FRAME, ROOM)
    t = stage.terms
    a, b = (stage.record(name, STATION) for name in "ab")
    params, frame = stage.record("params", fields.PARAMS), stage.record("frame", fields.FRAME)
    brief = Source({name: short(one) for name, one in known.items()}, known.changed)
    before = dict(stage.store)
    after, facts = dict(before), [apart(t, before, a, b), *used_by_one(t, before, frame, (a, b))]
    for one in (a, b) if both else (a,):
        machine = Ending(brief, t, Outbox(fields.FRAME, ROOM))
        now = t.unknown(f"{one.name}.now", 0, (1 << 30) - 1)
        given = [one, params, now, frame, machine.out]
        after, _ = machine.run("hear_report", given, after, t.true)
        facts += machine.facts
    name = "two stations hear a report, of whatever rounds" if both else MISSED
    goal = Goal(f"R10 {OWN}" if both else OWN, apart(t, after, a, b))
    return Step(name, machine, stage.records, before, after, facts, [goal])


def tell(step: Step, question: Question, _goal: str) -> list[str]:
    """Two stations in one place."""
    place = question.value(step.now("a", "pos"))
    slot = question.value(step.was("a", "slot"))
    return [
        f"B has place {place} in the round. The reporter does not know it: it missed B's frame.",
        f"A asks in minislot {slot}. The report gives out places from "
        f"{question.value(step.was('frame', 'base'))} on: {place} is A's.",
        f"B misses the report, and keeps place {place}.",
        f"A data frame names place {place} as next: A and B take the turn, both at once.",
    ]


__all__ = ["theories"]
