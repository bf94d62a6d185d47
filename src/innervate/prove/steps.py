"""A step: one handler, run on any state that may come, and what has to hold behind it."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

from innervate.dialect.arith import MASK30
from innervate.dialect.outbox import SEND, SET_TIMER
from innervate.dialect.source import Function
from innervate.prove.execute import Machine
from innervate.prove.records import Declaration, Outbox, Record, Store, name_of, unknowns
from innervate.prove.terms import Term, Terms

RANGES = "every field stays in its declared range"
SENT = "what is sent and set is in its declared range"
ROOM = "the outbox has room"


@dataclass(frozen=True, slots=True)
class Goal:
    """Something that has to hold."""

    name: str
    holds: Term


@dataclass(slots=True)
class Step:
    """A handler that was run."""

    name: str  # for people: "hear a beacon"
    machine: Machine  # that ran it
    records: dict[str, Record]  # by their names in `before` and `after`
    # before, after: all values
    before: Store
    after: Store
    facts: list[Term]  # what is known of the values before
    # what has to hold; those of any protocol come by themselves
    goals: list[Goal] = field(default_factory=list)
    result: Any = None  # what the function returned
    others: Sequence[Machine] = ()  # machines that have a part in it, too
    # goals are asked one by one: where each takes long, all at once take longer
    singly: bool = False
    # timers, ports: how many a node has, as `own_goals` was told
    timers: int = 0
    ports: int = 0

    def all_ways(self) -> dict[tuple[str, int, bool], list[Term]]:
        """Where every way of a branch is taken, whichever of its machines comes there."""
        found: dict[tuple[str, int, bool], list[Term]] = {}
        for machine in (self.machine, *self.others):
            for way, guards in machine.ways.items():
                found.setdefault(way, []).extend(guards)
        return found

    @property
    def terms(self) -> Terms:
        """That the step is made of."""
        return self.machine.terms

    def was(self, record: str, name: str, index: int | None = None) -> Term:
        """A value before the step."""
        return self.before[self.records[record], name, index]

    def now(self, record: str, name: str, index: int | None = None) -> Term:
        """A value after the step."""
        return self.after[self.records[record], name, index]


class Stage:
    """Records and terms on which a step is to be played."""

    def __init__(self, functions: dict[str, Function], frame: Declaration, room: int) -> None:
        self.functions = functions
        self.terms = Terms()
        self.out = Outbox(frame, room)
        self.machine = Machine(functions, self.terms, self.out)
        self.records: dict[str, Record] = {}
        self.store: Store = {}

    def record(self, name: str, *declarations: Declaration, ports: int = 0) -> Record:
        """A record of any values in their ranges."""
        made = Record(name, [field for one in declarations for field in one], ports)
        self.records[name] = made
        self.store.update(unknowns(self.terms, made))
        return made

    def fix(self, record: Record, name: str, value: int, index: int | None = None) -> None:
        """Let a field have a value that is known."""
        self.store[record, name, index] = self.terms.number(value)

    def number(self, value: int) -> Term:
        """A number that is known."""
        return self.terms.number(value)

    def clock(self) -> Term:
        """Any reading of a clock."""
        return self.terms.unknown("now", 0, MASK30)

    def play(self, name: str, handler: str, args: list[Any], facts: list[Term]) -> Step:
        """Run a handler; numbers among its arguments are known ones."""
        before = dict(self.store)
        after, result = self.machine.run(handler, args, before)
        known = [*facts, *self.machine.facts]
        return Step(name, self.machine, self.records, before, after, known, result=result)

    def step(self, name: str, after: Store, facts: list[Term], goals: list[Goal]) -> Step:
        """What led from the values on the stage to others, as a step with goals."""
        return Step(name, self.machine, self.records, self.store, after, facts, goals)


def own_goals(step: Step, changed: tuple[str, ...], timers: int, ports: int) -> list[Goal]:
    """What has to hold of any protocol: ranges, indices, numbers, room, what is asked for.

    Args:
        step: that was played.
        changed: records whose fields must stay in range.
        timers: how many there are.
        ports: how many there are; 0 for frames that go out without one.
    """
    terms = step.terms
    step.timers, step.ports = timers, ports
    by_name: dict[str, list[Term]] = {}
    for name in changed:
        for key, low, high in step.records[name].places():
            holds = terms.within(step.after[key], low, high)
            if holds is not terms.true:
                by_name.setdefault(f"{RANGES}: {name_of(key)}", []).append(holds)
    for demand in step.machine.demands:
        what = f"{demand.what}: {demand.where}"
        by_name.setdefault(what, []).append(terms.implies(demand.guard, demand.holds))
    by_name[SENT] = list(_sent(step, timers, ports))
    by_name[ROOM] = [room(step)]
    return [Goal(name, terms.all(*holds)) for name, holds in by_name.items()]


def room(step: Step) -> Term:
    """The actions fit into the outbox."""
    terms, out = step.terms, step.machine.out
    count = terms.number(0)
    for action in out.actions:
        more = terms.add(count, terms.number(1))
        count = terms.pick(action.guard, more, count)
    return terms.at_most(count, terms.number(out.limit))


def _sent(step: Step, timers: int, ports: int) -> Any:
    terms = step.terms
    for action in step.machine.out.actions:
        holds = [
            terms.within(step.after[key], low, high)
            for key, low, high in action.frame.places()
            if key in step.after
        ]
        if action.kind == SEND and ports:
            holds.append(terms.within(action.a, 0, ports - 1))
        if action.kind == SET_TIMER:
            holds += [terms.within(action.a, 0, timers - 1), terms.within(action.b, 0, MASK30)]
        yield terms.implies(action.guard, terms.all(*holds))


def sent(step: Step, kind: int | None = None) -> Any:
    """(guard, port, frame record) of all frames that a step sends; of one type alone if wanted."""
    terms = step.terms
    for action in step.machine.out.actions:
        if action.kind == SEND:
            is_kind = terms.true
            if kind is not None:
                is_kind = terms.same(step.after[action.frame, "kind", None], terms.number(kind))
            guard = terms.all(action.guard, is_kind)
            if guard is not terms.false:
                yield guard, action.a, action.frame
