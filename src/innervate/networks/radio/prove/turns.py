"""Practical CSMA/CD-R, turns: what two stations that heard the same frames do.

Both have the same record of the round and places of their own in it. A report gives each another
place, a data frame the turn to the place that it names; and the next turn reaches nobody before the
last has ended there, nor so late that it would be taken for dead. What stations do that missed a
frame, and how windows and openings end, is not proved.
"""

from collections.abc import Callable
from functools import partial
from typing import Any

from innervate.dialect.arith import MASK30
from innervate.dialect.outbox import SEND
from innervate.networks.radio.protocol import constants as const
from innervate.networks.radio.protocol import fields
from innervate.networks.radio.protocol.modes import TURN
from innervate.networks.radio.prove.reports import ROOM, STATION, Ending, Report, apart, same_round
from innervate.prove.answers import Answers
from innervate.prove.records import Outbox, Record, Store
from innervate.prove.steps import Goal, Stage, Step
from innervate.prove.terms import Term, Terms
from innervate.prove.theory import Source

LOOKED_UP = ("count_kept", "count_places", "goes_on")  # whatever they answer
PLANNED = ("dmin_us", "dmax_us", "ta_us", "minislot_us", "dead_us")
CLAIM = (
    "Of two stations that heard the same frames one takes a turn, alone on it. NOT proved: "
    "stations that missed a frame, who joins, and how openings and windows end."
)
ASSUMED = (
    "Both heard every frame since the round began, and have places of their own in it.",
    "A minislot of which a report says that one CR-R was in it was used by one station.",
    "Delays lie between dmin_us and dmax_us, or what is believed since.",
    "dead_us is 2 ta_us + 3 dmax_us + minislot_us or more, as plans make it.",
)

OPENINGS = "no turn is named: how openings end is not proved"
UNREACHABLE = {
    ("hear_data", "if sender >= POSITIONS or behind == NEXT_NONE:", True): "a turn is named",
    ("hear_data", "if WINDOWS <= behind < NEXT_NONE:", True): OPENINGS,
    ("hear_data", "if lone:", True): OPENINGS,
    ("is_skipped", "if behind >= LONE_WINDOWS:", True): OPENINGS,
    ("hear_data", "if frame.more:", False): OPENINGS,
    ("hear_data", "if frame.more:", True): OPENINGS,
    ("hear_data", "elif opens:", True): OPENINGS,
    ("enter_turn", "if cur == NONE:", True): "it is some place's turn",
    ("disprove", "if station.pending:", False): "it is asked where packets wait for their proof",
    ("rest_round", "if station.pos >= keeps(params):", True): "who quits has no place left",
    ("prove", "if count:", False): "it is asked where packets wait for their proof",
    ("schedule", "if after(station.at, now):", False): "what is waited for is always to come",
}


def steps(known: Source) -> tuple[Callable[[], Step], ...]:
    """What two stations do, and when."""
    return (
        partial(_reported, known),
        partial(_named, known),
        partial(_taken, known),
        *(
            partial(_alone, known, wide, late)
            for wide in range(const.WIDE_MOST + 1)
            for late in (False, True)
        ),
    )


def _stage(known: dict[str, Any], *names: str) -> tuple[Stage, list[Record], Record]:
    stage = Stage(known, fields.FRAME, ROOM)
    stations = [stage.record(name, STATION) for name in names]
    for other in stations[1:]:
        for k in range(const.POSITIONS):
            stage.store[other, "live", k] = stage.store[stations[0], "live", k]
    return stage, stations, stage.record("params", fields.PARAMS)


def _reported(known: Source) -> Step:
    """Both hear the report of a window, which gives out places."""
    stage, (a, b), _ = _stage(known, "a", "b")
    stage.record("frame", fields.FRAME)
    report, t = Report(known, stage, True), stage.terms
    cur = t.same(report.after[a, "cur", None], report.after[b, "cur", None])
    goals = [
        report.own("R1 they have places of their own"),
        Goal("R2 they have the same record of the round",
             t.implies(report.ends, same_round(t, report.after, a, b))),
        Goal("R3 they go on with the same place", t.implies(report.ends, cur)),
    ]  # fmt: skip
    return report.step("two stations hear a report", goals)


def _named(known: dict[str, Any]) -> Step:
    """Both hear a data frame that names whose turn is next."""
    stage, (a, b), params = _stage(known, "a", "b")
    t, frame = stage.terms, stage.record("frame", fields.FRAME)
    sender, behind = (stage.store[frame, name, None] for name in ("pos", "next"))
    names = t.all(t.less(behind, t.number(const.WINDOWS)), t.negated(t.same(behind, sender)),
                  t.less(sender, t.number(const.POSITIONS)))  # fmt: skip
    before, after, turns, machines = stage.store, stage.store, [], []
    for one in (a, b):
        machine = Ending(known, t, Outbox(fields.FRAME, ROOM))
        given = [one, params, t.unknown(f"{one.name}.now", 0, MASK30), frame, machine.out]
        after, _ = machine.run("hear_data", given, after)
        turns.append(_kept(t, before, after, one))
        machines.append(machine)
    goals = [
        Goal("R4 nobody gets another's place", t.all(*turns)),
        Goal("R5 they have the same record of the round", same_round(t, after, a, b)),
    ]
    return Step("two stations hear a data frame", machine, stage.records, before, after,
                [names, apart(t, before, a, b)], goals, others=machines[:-1])  # fmt: skip


def _kept(terms: Terms, before: Store, after: Store, one: Record) -> Term:
    """A station has the place that it had, or none."""
    may = before[one, "pos", None], terms.number(const.NONE)
    return terms.any(*(terms.same(after[one, "pos", None], place) for place in may))


def _taken(known: dict[str, Any]) -> Step:
    """The turn of a place comes, at a station that may have it."""
    stage, (a,), params = _stage(known, "a")
    t = stage.terms
    stage.machine = Answers(known, t, stage.out, LOOKED_UP)
    place = t.unknown("place", 0, const.POSITIONS - 1)
    step = stage.play("a place's turn comes", "enter_turn",
                      [a, params, stage.clock(), place, stage.out], [])  # fmt: skip
    mine = t.same(step.before[a, "pos", None], place)
    sends = t.any(*(one.guard for one in step.machine.out.actions if one.kind == SEND))
    waits = t.all(t.same(step.after[a, "mode", None], t.number(TURN)),
                  t.same(step.after[a, "act", None], t.number(1)))  # fmt: skip
    step.goals = [
        Goal("R6 only who has the place takes the turn", t.implies(t.any(sends, waits), mine)),
        Goal("R7 it keeps its place or gives it up", _kept(t, step.before, step.after, a)),
    ]
    return step


def _alone(known: dict[str, Any], wide: int, late: bool) -> Step:
    """One turn behind another, at any third station, of bounds that were doubled `wide` times."""
    stage, _, params = _stage(known)
    t, store = stage.terms, stage.store
    turn = store[params, "ta_us", None]
    dmin, dmax, _, slot, dead = (store[params, name, None] for name in PLANNED)
    planned = t.add(t.add(turn, turn), t.add(t.mul(t.number(3), dmax), slot))
    least, most, wait, end = (
        stage.machine.run(name, [params, wide], store)[1]
        for name in ("least_delay", "most_delay", "guard", "turn_timeout")
    )
    # From sender to next, and on to a third: two delays; from sender to the third: one.
    soonest = t.add(t.add(least, least), t.add(wait, turn))
    latest = t.add(t.add(most, most), t.add(wait, turn))
    goal = Goal("R8 the next turn begins nowhere before the last has ended there",
                t.at_most(most, soonest))  # fmt: skip
    if late:
        goal = Goal("R9 it begins before it would be given up",
                    t.at_most(t.sub(latest, least), end))  # fmt: skip
    facts = [t.at_most(dmin, dmax), t.at_most(planned, dead)]
    return stage.step(f"turn follows turn, dmax x {1 << wide}", store, facts, [goal])
