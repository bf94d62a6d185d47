"""Records what one node of a plain simulation is told, and what came of each call."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import ExitStack
from dataclasses import dataclass, field
from importlib import import_module
from pathlib import Path
from typing import Any
from unittest import mock

from boards.parity import replay
from boards.roles import kind_of
from innervate import scenario
from innervate.dialect import plain
from innervate.dialect.arith import MASK30
from innervate.live.board import Declaration, Role
from innervate.sim import clocks
from innervate.sim.driver import Simulation

HERE = Path(__file__).resolve().parent
# Handlers in order of their number, and how many arguments stand between clock and outbox.
HANDLERS = {
    "on_start": 1, "on_frame": 2, "on_timer": 1, "on_input": 2, "on_carrier": 2, "on_sent": 1,
}  # fmt: skip


@dataclass
class Transcript:
    """What one node was told, and what came of it.

    Attributes:
        role: which protocol.
        params: its parameters, words in order of declaration.
        calls: a row of numbers per call, as `replay.play` reads them.
        marks: (hash of the state, hash of the outbox) after each call.
        room: actions in the fullest outbox.
        fingerprint: of the whole run.
    """

    role: Role
    params: list[int] = field(default_factory=list)
    calls: list[list[int]] = field(default_factory=list)
    marks: list[tuple[int, int]] = field(default_factory=list)
    room: int = 0
    fingerprint: str = ""


def names_of(declaration: Declaration) -> list[str]:
    """Names of declared fields."""
    return [name for name, *_ in declaration]


def layout_of(declaration: Declaration, counted: Mapping[str, str]) -> list[tuple[str, Any]]:
    """Fields as `replay.read_record` takes them: single ones first, as they count the others."""
    names = names_of(declaration)
    fields = [
        (name, counted[name] if counted.get(name) in names else many)
        for name, many, *_ in declaration
    ]
    return sorted(fields, key=lambda item: item[1] != 0)


def flat(layout: Iterable[tuple[str, Any]]) -> tuple[Any, ...]:
    """A layout as replay.py has it: a board keeps one tuple instead of many."""
    return tuple(part for pair in layout for part in pair)


def values_of(record: Any, layout: list[tuple[str, Any]]) -> list[int]:
    """A record's fields in such an order."""
    found: list[int] = []
    for name, many in layout:
        value = getattr(record, name)
        count = getattr(record, many) if isinstance(many, str) else many
        found += [value] if many == 0 else value[:count]
    return found


class Recorder:
    """Stands between a plain simulation and the handlers of one node."""

    def __init__(self, role: Role) -> None:
        self.role, self.watched = role, role.watched
        self.transcript = Transcript(role)
        self.names = names_of(role.state)
        self.heard = layout_of(role.frame, role.counted)
        self.given = layout_of(role.item, role.counted)
        self.kinds = {kind: flat(fields) for kind, fields in role.kinds.items()}
        self.last = self._copy(plain.make("Fresh", role.state)())
        self.world: Any = None

    def is_watched(self, state: Any) -> bool:
        """True for the state of the node that is recorded."""
        return state is self._state()

    def around(self, name: str, call: Callable[..., None]) -> Callable[..., None]:
        """A handler that is recorded; a gateway's record may stand behind the state."""
        arguments = HANDLERS[name]
        number = list(HANDLERS).index(name)

        def recorded(state: Any, *rest: Any) -> None:
            if not self.is_watched(state):
                call(state, *rest)
                return
            *front, now = rest[: -arguments - 1]
            self.before(number, state, front[-1], now, rest[-arguments - 1 : -1])
            call(state, *rest)
            self.after(state, rest[-1])

        return recorded

    def in_place(self, hear: Callable[..., None]) -> Callable[..., None]:
        """What a run calls for the protocol's on_frame, recorded; it reads the clock itself."""

        def recorded(world: Any, node: int, time: int, port: int, frame: Any) -> None:
            if node != self.watched.node:
                hear(world, node, time, port, frame)
                return
            state, now = self._state(), clocks.reading(world.clocks[node], time) & MASK30
            self.before(replay.FRAME, state, world.params[0], now, (port, frame))
            hear(world, node, time, port, frame)
            self.after(state, world.out)

        return recorded

    def before(self, handler: int, state: Any, params: Any, now: int, given: Any) -> None:
        """A call is about to be made."""
        row = [handler, now]
        if handler == replay.START:
            layout = [(name, many) for name, many, *_ in self.transcript.role.params]
            self.transcript.params = values_of(params, layout)
            changes = list(self._changes(state))
            row += [len(changes), *(word for change in changes for word in change), *given]
        elif handler == replay.FRAME:
            row += [given[0], *values_of(given[1], self.heard)]
        elif handler == replay.INPUT:
            row += [given[0], *values_of(given[1], self.given)]
        else:
            row += given
        self.transcript.calls.append([int(word) for word in row])

    def after(self, state: Any, out: Any) -> None:
        """It was made."""
        marks = (replay.fold_state(state, self.names), replay.fold_out(out, self.kinds))
        self.transcript.marks.append(marks)
        self.transcript.room = max(self.transcript.room, out.count[0])
        self.last = self._copy(state)

    def run(self, plan: Any) -> Transcript:
        """Simulate, and record."""
        with ExitStack() as stack:
            self._record(stack)
            running = simulation(self.role, plan, plain=True)
            self.world = running.world
            running.finish()
        self.transcript.fingerprint = running.fingerprint
        return self.transcript

    def _record(self, stack: ExitStack) -> None:
        """Put the recorder in place of the handlers."""
        protocol, hears = import_module(self.role.entry), self.watched.on_frame
        for name in HANDLERS:
            if hasattr(protocol, name) and not (hears and name == "on_frame"):
                made = self.around(name, getattr(protocol, name))
                stack.enter_context(mock.patch.object(protocol, name, made))
        if hears:
            stack.enter_context(mock.patch(hears.replace(":", "."), self.in_place(part(hears))))

    def _state(self) -> Any:
        return getattr(self.world, self.watched.table)[self.watched.node]

    def _copy(self, state: Any) -> list[list[int]]:
        values = (getattr(state, name) for name in self.names)
        return [list(value) if isinstance(value, list) else [value] for value in values]

    def _changes(self, state: Any) -> Iterator[tuple[int, int, int]]:
        """What the driver has changed since the last call: (field, place or -1, value)."""
        for index, (old, new) in enumerate(zip(self.last, self._copy(state), strict=True)):
            is_array = self.transcript.role.state[index][1] != 0
            for i, (one, other) in enumerate(zip(old, new, strict=True)):
                if one != other:
                    yield index, i if is_array else -1, other


def part(place: str) -> Any:
    """What is meant by "module:name"."""
    module, _, name = place.partition(":")
    return getattr(import_module(module), name)


def simulation(role: Role, plan: Any, plain: bool) -> Simulation:
    """The run that a role is watched in, before its first event."""
    made: Simulation = part(role.watched.simulation)(plan, plain=plain)
    return made


def own_file(role: Role) -> Path | None:
    """The scenario of a role that lies here; None = it is watched as it is by itself."""
    own = HERE / f"{role.watched.scenario or role.name}.toml"
    return own if own.exists() else None


def scenario_of(role: Role, file: Path | None = None, **changes: Any) -> scenario.Scenario:
    """What is watched: a file's scenario, that of the role here, or the network's plainest."""
    file = file or own_file(role)
    if file is None:
        return scenario.from_dict({"kind": kind_of(role)}, **changes)
    return scenario.load(file, **changes)


def plan_of(role: Role, file: Path | None = None) -> Any:
    """The plan of what is watched."""
    return scenario.plan(scenario_of(role, file))


def record(role: Role, file: Path | None = None) -> Transcript:
    """What a role's node was told, and what came of it."""
    return Recorder(role).run(plan_of(role, file))


def compiled_mark(role: Role, file: Path | None = None) -> tuple[int, str]:
    """The state's hash at the end of the compiled run, and the run's fingerprint."""
    running = simulation(role, plan_of(role, file), plain=False)
    running.finish()
    state = getattr(running.world, role.watched.table)[role.watched.node]
    mark = 1
    for field_name, many, *_ in role.state:
        value = state[field_name]
        mark = replay.fold_field(mark, [int(word) for word in value] if many else int(value))
    return mark, running.fingerprint
