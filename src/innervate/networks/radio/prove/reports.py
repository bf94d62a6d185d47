"""Practical CSMA/CD-R: two stations hear the same report, minislot by minislot.

A report gives out places for minislots in their order. That two stations have places of their own
is shown before the first minislot and, of any minislot, behind it wherever it was so before it; so
it is so behind the last.
"""

from typing import Any

from innervate.dialect.arith import MASK30
from innervate.dialect.source import Function
from innervate.networks.radio.protocol import fields
from innervate.networks.radio.protocol.constants import MINISLOTS, NONE, POSITIONS
from innervate.networks.radio.protocol.modes import QUIET_MOST
from innervate.prove.induction import Induction
from innervate.prove.records import Array, Outbox, Record, State, Store
from innervate.prove.steps import Goal, Stage, Step
from innervate.prove.terms import Term, Terms
from innervate.prove.theory import Source

STATION = (*fields.STATION, *fields.PRACTICAL)
ROOM = 16
SLOT_MOST = 4 * MINISLOTS + 3  # a minislot's number behind any report
COUNTS = ("places", "groups")
EACH = "places stay their own, minislot by minislot"


class Ending(Induction):
    """Leaves out what follows a frame: what comes of that is a step of its own."""

    looped = ""

    def call(
        self, function: Function, args: list[Any], store: Store, under: Term
    ) -> tuple[Store, Any]:
        """Follow a call, but of the handler's last."""
        if function.name in ("enter_first", "enter_window", "enter_turn"):
            return store, self.terms.number(0)
        return super().call(function, args, store, under)


class Hearing(Ending):
    """A station hears a report by any of its minislots.

    `shared` is how the round's record is called, so that stations may have the same.
    """

    looped = "hear_report"

    def __init__(self, known: Source, terms: Terms, one: Record, shared: str) -> None:
        super().__init__(known, terms, Outbox(fields.FRAME, ROOM))
        self.one = one
        self.shared = shared

    def vary(self, state: State) -> None:
        """What minislots change: how many gave places or collided, and whose places are."""
        t, one = self.terms, self.one
        for name in COUNTS:
            state.names[name] = t.unknown(f"{name} then", 0, MINISLOTS)
        state.store[one, "pos", None] = t.unknown(f"{one.name}.pos then", NONE, POSITIONS - 1)
        state.store[one, "slot", None] = t.unknown(f"{one.name}.slot then", NONE, SLOT_MOST)
        for k in range(POSITIONS):
            state.store[one, "live", k] = t.unknown(f"{self.shared}.live[{k}] then", 0, QUIET_MOST)


class Report:
    """Stations a and b of a stage hear its frame as a report.

    `alike`: both have the same record of the round.
    """

    def __init__(self, known: Source, stage: Stage, alike: bool) -> None:
        self.stage, self.t, self.alike = stage, stage.terms, alike
        self.before = stage.store
        self.a, self.b, self.frame = (stage.records[name] for name in ("a", "b", "frame"))
        self.after = self.before  # the values behind it
        self.machines = []  # that heard it
        for one in (self.a, self.b):
            machine = Hearing(known, self.t, one, "round" if alike else one.name)
            self.after, _ = hear(stage, machine, one, self.after)
            self.machines.append(machine)
        self.ends = self.t.negated(self.machines[0].passes.is_pass)

    def facts(self) -> list[Term]:
        """What is known before the report, and before any of its minislots."""
        t, machine = self.t, self.machines[0]
        at = machine.passes.at
        _, good = machine.run("bit", [Array(self.frame, "good", 2), at], self.before)
        both = [t.same(self.before[one, "slot", None], at) for one in (self.a, self.b)]
        used_by_one = t.negated(t.all(t.as_truth(good), *both))
        drawn = [fact for one in self.machines for fact in one.facts]
        return [apart(t, self.before, self.a, self.b), used_by_one, self.holds("head", at), *drawn]

    def holds(self, when: str, done: Term) -> Term:
        """What is so when so many minislots are done."""
        t = self.t
        mine, other = (getattr(one.passes, when) for one in self.machines)
        store = mine.store | {key: value for key, value in other.store.items() if key[0] is self.b}
        parts = [apart(t, store, self.a, self.b)]
        for name in COUNTS:
            parts.append(t.same(mine.names[name], other.names[name]))
            parts.append(t.at_most(t.as_number(mine.names[name]), done))
        return t.all(*parts, *([same_round(t, store, self.a, self.b)] if self.alike else []))

    def each(self) -> Goal:
        """It is so before the first minislot, and behind each."""
        t, passes = self.t, [one.passes for one in self.machines]
        more = t.add(passes[0].at, t.number(1))
        behind = t.implies(passes[0].is_pass, self.holds("passed", more))
        fits = t.all(*(one.fits(t) for one in passes))
        return Goal(EACH, t.all(self.holds("entered", t.number(0)), behind, fits))

    def step(self, name: str, goals: list[Goal]) -> Step:
        """That it is heard, as a step; it is so minislot by minislot, and goals hold besides."""
        first, *others = self.machines
        return Step(name, first, self.stage.records, self.before, self.after, self.facts(),
                    [self.each(), *goals], others=others)  # fmt: skip

    def own(self, name: str) -> Goal:
        """They have places of their own behind the last."""
        return Goal(name, self.t.implies(self.ends, apart(self.t, self.after, self.a, self.b)))


def hear(stage: Stage, machine: Ending, one: Record, store: Store) -> tuple[Store, Any]:
    """A station hears the stage's frame as a report."""
    now = stage.terms.unknown(f"{one.name}.now", 0, MASK30)
    given = [one, stage.records["params"], now, stage.records["frame"], machine.out]
    return machine.run("hear_report", given, store)


def same_round(terms: Terms, store: Store, a: Record, b: Record) -> Term:
    """Two stations have the same record of the round."""
    return terms.all(*(terms.same(store[a, "live", k], store[b, "live", k])
                       for k in range(POSITIONS)))  # fmt: skip


def apart(terms: Terms, store: Store, a: Record, b: Record) -> Term:
    """Two stations have no place in common."""
    mine, other = store[a, "pos", None], store[b, "pos", None]
    return terms.any(terms.same(mine, terms.number(NONE)), terms.negated(terms.same(mine, other)))
