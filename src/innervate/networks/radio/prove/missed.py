"""Practical CSMA/CD-R, turns: what becomes of places when a station has missed a frame.

Places are named by the report, so a data frame that was missed before does not matter to them. A
report that was missed does: whoever was in a place that it gives out stays there.
"""

from functools import partial

from innervate.networks.radio.protocol import fields
from innervate.networks.radio.protocol.constants import NONE
from innervate.networks.radio.prove import turns
from innervate.networks.radio.prove.reports import ROOM, STATION, Ending, Report, apart, hear
from innervate.prove.solve import Question
from innervate.prove.steps import Goal, Stage, Step
from innervate.prove.theory import Source, Theory

MISSED = "a station misses a report"
ASKED = {("note_joined", "if asked:", False): "a report says that somebody asked"}
OWN = "they have places of their own"


def theories(known: Source) -> list[Theory]:
    """What a missed data frame does not do, and what a missed report does."""
    return [
        Theory("radio, a data frame missed", "Behind a report two stations have places of their "
               "own, whatever either had heard of the round before.", (),
               (partial(_both, known),), turns.UNREACHABLE | ASKED),
        Theory("radio, a report missed", "The same if one of them missed the report.", (),
               (partial(_one, known),), refuted_by=MISSED, is_example=True, tell=tell),
    ]  # fmt: skip


def _stage(known: Source) -> Stage:
    stage = Stage(known, fields.FRAME, ROOM)
    for name in "ab":
        stage.record(name, STATION)
    stage.record("params", fields.PARAMS)
    stage.record("frame", fields.FRAME)
    return stage


def _both(known: Source) -> Step:
    """Both stations hear a report, of whatever rounds."""
    report = Report(known, _stage(known), False)
    goals = [report.own(f"R10 {OWN}")]
    return report.step("two stations hear a report, of whatever rounds", goals)


def _one(known: Source) -> Step:
    """A station hears a report that the other misses."""
    stage = _stage(known)
    t, a, b = stage.terms, stage.records["a"], stage.records["b"]
    stage.machine = machine = Ending(known, t, stage.out)
    after, _ = hear(stage, machine, a, stage.store)
    asked = t.same(stage.store[b, "slot", None], t.number(NONE))
    facts = [apart(t, stage.store, a, b), asked, *machine.facts]
    return stage.step(MISSED, after, facts, [Goal(OWN, apart(t, after, a, b))])


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
