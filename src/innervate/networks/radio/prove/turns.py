"""Practical CSMA/CD-R, turns: what two stations that heard the same frames do.

Both have the same record of the round and places of their own in it. A report gives each another
place, a data frame the turn to the place that it names; and the next turn reaches nobody before the
last has ended there, nor so late that it would be taken for dead. What stations do that missed a
frame, and how windows and openings end, is not proved.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from copy import copy
from functools import partial
from typing import Any

from innervate.dialect.outbox import SEND
from innervate.dialect.source import Function
from innervate.networks.radio.protocol import fields
from innervate.networks.radio.protocol.constants import (
    NONE,
    POSITIONS,
    WIDE_MOST,
    WINDOWS,
)
from innervate.networks.radio.protocol.modes import TURN
from innervate.prove.execute import Machine
from innervate.prove.records import Outbox, Record, Store
from innervate.prove.steps import Goal, Stage, Step
from innervate.prove.terms import Term, Terms
from innervate.prove.theory import Source

STATION = (*fields.STATION, *fields.PRACTICAL)
ROOM = 16
PLANNED = ("dmin_us", "dmax_us", "ta_us", "minislot_us", "dead_us")
MINISLOTS = 8  # of a report's 32: those behind them are counted alike
CLAIM = (
    "Of two stations that heard the same frames one takes a turn, alone on it. NOT proved: "
    "stations that missed a frame, who joins, and how openings and windows end."
)
ASSUMED = (
    "Both heard every frame since the round began, and have places of their own in it.",
    f"Of a report's minislots the first {MINISLOTS} are tried; those behind are counted alike.",
    "A minislot of which a report says that one CR-R was in it was used by one station.",
    "Delays lie between dmin_us and dmax_us, or what is believed since.",
    "dead_us is 2 ta_us + 3 dmax_us + minislot_us or more, as plans make it.",
)

OPENINGS = "no turn is named: how openings end is not proved"
UNREACHABLE = {
    ("hear_data", "if sender >= POSITIONS or behind == NEXT_NONE:", True): "a turn is named",
    ("hear_data", "if WINDOWS <= behind < NEXT_NONE:", True): OPENINGS,
    ("hear_data", "if lone:", True): OPENINGS,
    ("hear_data", "if frame.more:", False): OPENINGS,
    ("hear_data", "if frame.more:", True): OPENINGS,
    ("hear_data", "elif opens:", True): OPENINGS,
    ("enter_turn", "if cur == NONE:", True): "it is some place's turn",
    ("disprove", "if station.pending:", False): "it is asked where packets wait for their proof",
    ("prove", "if count:", False): "it is asked where packets wait for their proof",
    ("schedule", "if after(station.at, now):", False): "what is waited for is always to come",
}


class Ending(Machine):
    """Leaves out what follows the report: what comes of that is a step of its own."""

    def call(
        self, function: Function, args: list[Any], store: Store, under: Term
    ) -> tuple[Store, Any]:
        """Follow a call, but of the handler's last."""
        if function.name in ("enter_window", "enter_turn"):
            return store, self.terms.number(0)
        return super().call(function, args, store, under)


def steps(known: Source) -> tuple[Callable[[], Step], ...]:
    """What two stations do, and when."""
    return (
        partial(_reported, known),
        partial(_named, known),
        partial(_taken, known),
        *(
            partial(_alone, known, wide, late)
            for wide in range(WIDE_MOST + 1)
            for late in (False, True)
        ),
    )


def _stage(known: dict[str, Any], *names: str) -> tuple[Stage, list[Record], Record]:
    stage = Stage(known, fields.FRAME, ROOM)
    stations = [stage.record(name, STATION) for name in names]
    for other in stations[1:]:
        for k in range(POSITIONS):
            stage.store[other, "live", k] = stage.store[stations[0], "live", k]
    return stage, stations, stage.record("params", fields.PARAMS)


def short(function: Function) -> Function:
    """A function as it is where reports have few minislots."""
    made = copy(function)
    if "MINISLOTS" in made.constants:
        made.constants = made.constants | {"MINISLOTS": MINISLOTS}
    return made


def apart(terms: Terms, store: Store, a: Record, b: Record) -> Term:
    """Two stations have no place in common."""
    mine, other = store[a, "pos", None], store[b, "pos", None]
    return terms.any(terms.same(mine, terms.number(NONE)), terms.negated(terms.same(mine, other)))


def used_by_one(
    terms: Terms, store: Store, frame: Record, stations: Sequence[Record]
) -> list[Term]:
    """A minislot that a report calls good was used by one of the stations at most."""
    found = []
    for i in range(MINISLOTS):
        bits = terms.shr(store[frame, "good", i >> 4], terms.number(i & 15))
        good = terms.as_truth(terms.bits_and(bits, terms.number(1)))
        here = [terms.same(store[one, "slot", None], terms.number(i)) for one in stations]
        found.append(terms.negated(terms.all(good, *here)))
    return found


def _reported(known: Source) -> Step:
    """Both hear the report of a window, which gives out places."""
    stage, (a, b), params = _stage(known, "a", "b")
    t, frame = stage.terms, stage.record("frame", fields.FRAME)
    before = dict(stage.store)
    after, facts = dict(before), []
    known = Source({name: short(one) for name, one in known.items()}, known.changed)
    machines = []
    for one in (a, b):
        machine = Ending(known, t, Outbox(fields.FRAME, ROOM))
        given = [one, params, t.unknown(f"{one.name}.now", 0, (1 << 30) - 1), frame, machine.out]
        after, _ = machine.run("hear_report", given, after, t.true)
        facts += machine.facts
        machines.append(machine)
    facts += used_by_one(t, before, frame, (a, b))
    live = t.all(*(t.same(after[a, "live", k], after[b, "live", k]) for k in range(POSITIONS)))
    goals = [
        Goal("R1 they have places of their own", apart(t, after, a, b)),
        Goal("R2 they have the same record of the round", live),
        Goal("R3 they go on with the same place",
             t.same(after[a, "cur", None], after[b, "cur", None])),
    ]  # fmt: skip
    return Step("two stations hear a report", machine, stage.records, before, after,
                [apart(t, before, a, b), *facts], goals, others=machines[:-1])  # fmt: skip


def _named(known: dict[str, Any]) -> Step:
    """Both hear a data frame that names whose turn is next."""
    stage, (a, b), params = _stage(known, "a", "b")
    t, frame = stage.terms, stage.record("frame", fields.FRAME)
    sender, behind = (stage.store[frame, name, None] for name in ("pos", "next"))
    names = t.all(t.less(behind, t.number(WINDOWS)), t.negated(t.same(behind, sender)),
                  t.less(sender, t.number(POSITIONS)))  # fmt: skip
    before, turns, machines = dict(stage.store), [], []
    after = dict(before)
    for one in (a, b):
        machine = Ending(known, t, Outbox(fields.FRAME, ROOM))
        given = [one, params, t.unknown(f"{one.name}.now", 0, (1 << 30) - 1), frame, machine.out]
        after, _ = machine.run("hear_data", given, after, t.true)
        kept = t.any(*(t.same(after[one, "pos", None], value)
                       for value in (before[one, "pos", None], t.number(NONE))))  # fmt: skip
        turns.append(kept)
        machines.append(machine)
    live = t.all(*(t.same(after[a, "live", k], after[b, "live", k]) for k in range(POSITIONS)))
    goals = [
        Goal("R4 nobody gets another's place", t.all(*turns)),
        Goal("R5 they have the same record of the round", live),
    ]
    return Step("two stations hear a data frame", machine, stage.records, before, after,
                [names, apart(t, before, a, b)], goals, others=machines[:-1])  # fmt: skip


def _taken(known: dict[str, Any]) -> Step:
    """The turn of a place comes, at a station that may have it."""
    stage, (a,), params = _stage(known, "a")
    t = stage.terms
    place = t.unknown("place", 0, POSITIONS - 1)
    step = stage.play("a place's turn comes", "enter_turn",
                      [a, params, stage.clock(), place, stage.out], [])  # fmt: skip
    mine = t.same(step.before[a, "pos", None], place)
    sends = t.any(*(one.guard for one in step.machine.out.actions if one.kind == SEND))
    waits = t.all(t.same(step.after[a, "mode", None], t.number(TURN)),
                  t.same(step.after[a, "act", None], t.number(1)))  # fmt: skip
    own = t.any(*(t.same(step.after[a, "pos", None], value)
                  for value in (step.before[a, "pos", None], t.number(NONE))))  # fmt: skip
    step.goals = [
        Goal("R6 only who has the place takes the turn", t.implies(t.any(sends, waits), mine)),
        Goal("R7 it keeps its place or gives it up", own),
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
        stage.machine.run(name, [params, t.number(wide)], dict(store), t.true)[1]
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
    return Step(f"turn follows turn, dmax x {1 << wide}", stage.machine, stage.records, store,
                store, [t.at_most(dmin, dmax), t.at_most(planned, dead)], [goal])  # fmt: skip
