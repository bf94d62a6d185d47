"""What `innervate prove radio` claims: of a station's queue, and of switching it on.

That no two turns overlap is proved of stations that heard the same frames (turns.py), and not of
others: `innervate verify radio` tries those.
"""

from functools import partial
from typing import Any

from innervate.dialect.source import Change
from innervate.networks.radio.protocol import fields
from innervate.networks.radio.prove import missed, turns
from innervate.prove.mutants import planted
from innervate.prove.steps import Goal, Stage, Step, own_goals
from innervate.prove.terms import Term
from innervate.prove.theory import Theory, whole_source

ENTRY = "innervate.networks.radio.protocol.practical"
STATION = (*fields.STATION, *fields.PRACTICAL)
ROOM = 16
TIMERS = 2
PLACES = 16
UNREACHABLE = {
    ("join_after", "if wide:", True): "bounds are not doubled yet when a station is switched on",
    ("probe", "if wide:", True): "nor are they here",
    ("schedule", "if after(station.at, now):", False): "what is waited for is always to come",
}
MUTANTS = planted(
    ("a packet is put where the oldest is", "station.head + station.queued", "station.head"),
    ("a full queue takes another", "station.queued >= QUEUE", "station.queued > QUEUE"),
    ("a place that another gets is kept",
     "                if place == station.pos:\n                    station.pos = NONE\n", ""),
    ("who is not named takes the turn",
     "    if cur == station.pos:\n", "    if cur <= station.pos:\n"),
    ("a turn does not wait for the one before it", "2 * least_delay(params, wide) - params.ta_us)",
     "3 * least_delay(params, wide) - params.ta_us)"),
    ("a turn is given up too soon",
     "+ 4 * most_delay(params, wide) + minislot(params, wide)", "+ minislot(params, wide)"),
    ("who is passed over takes the sender's place",
     "        station.pos = NONE\n    if lone:", "        station.pos = sender\n    if lone:"),
)  # fmt: skip


def theories(_network: Any, change: Change | None = None) -> list[Theory]:
    """What can be shown of one station by itself."""
    known = whole_source(ENTRY, change)
    claim = "A packet that is taken waits in the queue, and none that waits is lost or changed."
    return [
        Theory("radio, the queue of a station", claim, (),
               (partial(_start, known), partial(_packet, known)), UNREACHABLE),
        Theory("radio, turns", turns.CLAIM, turns.ASSUMED, turns.steps(known), turns.UNREACHABLE),
        *missed.theories(known),
    ]  # fmt: skip


def _stage(known: dict[str, Any]) -> tuple[Stage, list[Any]]:
    stage = Stage(known, fields.FRAME, ROOM)
    station = stage.record("station", STATION)
    return stage, [station, stage.record("params", fields.PARAMS), stage.clock()]


def _start(known: dict[str, Any]) -> Step:
    stage, given = _stage(known)
    cause = stage.terms.unknown("cause", 0, 1)
    step = stage.play("a station is switched on", "on_start", [*given, cause, stage.out], [])
    step.goals = own_goals(step, ("station",), TIMERS, 0)
    return step


def _packet(known: dict[str, Any]) -> Step:
    stage, given = _stage(known)
    t, kind = stage.terms, stage.terms.unknown("kind", 0, 3)
    item = stage.record("item", fields.PACKET)
    step = stage.play(
        "its user hands something in", "on_input", [*given, kind, item, stage.out], []
    )
    kept: list[Term] = []
    for k in range(PLACES):
        place = t.add(step.was("station", "head"), t.number(k))
        waits = t.less(t.number(k), step.was("station", "queued"))
        for p in range(PLACES):
            here = t.same(t.bits_and(place, t.number(PLACES - 1)), t.number(p))
            same = [t.same(step.was("station", name, p), step.now("station", name, p))
                    for name in ("size", "handle")]  # fmt: skip
            kept.append(t.implies(t.all(waits, here), t.all(*same)))
    grown = t.sub(step.now("station", "queued"), step.was("station", "queued"))
    step.goals = [
        *own_goals(step, ("station",), TIMERS, 0),
        Goal("Q1 what waits in the queue stays as it is", t.all(*kept)),
        Goal("Q2 the queue grows by one at most", t.within(grown, 0, 1)),
    ]
    return step
