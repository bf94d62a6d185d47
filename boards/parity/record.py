"""Records what one node of a plain simulation is told, and what came of each call."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from contextlib import ExitStack
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any
from unittest import mock

from boards.parity import replay
from boards.roles import COUNTED, ROLES, Declaration, Role
from innervate import scenario
from innervate.dialect import plain
from innervate.networks.mesh.protocol import csma
from innervate.networks.mesh.protocol import node as mesh
from innervate.networks.mesh.sim import simulate as mesh_simulate
from innervate.networks.radio.protocol import practical as radio_practical
from innervate.networks.radio.sim import simulate as radio_simulate
from innervate.networks.skin.protocol import cell as skin
from innervate.networks.skin.sim import simulate as skin_simulate
from innervate.networks.skin.sim import stack as skin_stack

HERE = Path(__file__).resolve().parent
# Handlers in order of their number, and how many arguments stand between clock and outbox.
HANDLERS = {"on_start": 1, "on_frame": 2, "on_timer": 1, "on_input": 2, "on_carrier": 2}


@dataclass(frozen=True)
class Watched:
    """Whom to watch: a scenario, how it is simulated, and where the node's state is.

    Attributes:
        scenario: a file of this folder.
        simulator: the module that runs it.
        module: the protocol's module.
        table: of the world, that holds the states.
        node: which of them.
    """

    scenario: str
    simulator: Any
    module: Any
    table: str
    node: int


WATCHED = {
    "skin": Watched("skin", skin_simulate, skin, "cells", 4),
    "csma": Watched("mesh", mesh_simulate, csma, "macs", 3),
    "radio": Watched("radio", radio_simulate, radio_practical, "stations", 2),
    "mesh": Watched("mesh", mesh_simulate, mesh, "nodes", 3),
}


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


def layout_of(declaration: Declaration) -> list[tuple[str, Any]]:
    """Fields as `replay.read_record` takes them: single ones first, as they count the others."""
    fields = [(name, COUNTED.get(name, many)) for name, many, *_ in declaration]
    if "path_len" not in names_of(declaration):
        fields = [(name, "length" if name == "body" else many) for name, many in fields]
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
    """Stands between a simulation and the handlers of one node."""

    def __init__(self, watched: Watched, role: Role) -> None:
        self.watched = watched
        self.transcript = Transcript(role)
        self.names = names_of(role.state)
        self.heard, self.given = layout_of(role.frame), layout_of(role.item)
        self.kinds = {kind: flat(fields) for kind, fields in role.kinds.items()}
        self.last = self._copy(plain.make("Fresh", role.state)())
        self.world: Any = None

    def is_watched(self, state: Any) -> bool:
        """True for the state of the node that is recorded."""
        return state is getattr(self.world, self.watched.table)[self.watched.node]

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

    def hear(self, world: Any, node: int, time: int, port: int, frame: Any) -> None:
        """What stands for the skin's on_frame in the simulator, recorded."""
        if node != self.watched.node:
            HEAR(world, node, time, port, frame)
            return
        cell, params = world.cells[node], world.params[0]
        now = skin_stack.local(world, node, time)
        self.before(replay.FRAME, cell, params, now, (port, frame))
        HEAR(world, node, time, port, frame)
        self.after(cell, world.out)

    def build(self, *args: Any, **keep: Any) -> Any:
        """Builds the world, and keeps it."""
        self.world = self._build(*args, **keep)
        return self.world

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

    def run(self) -> Transcript:
        """Simulate, and record."""
        watched, simulator = self.watched, self.watched.simulator
        self._build = simulator.builder.build
        with ExitStack() as stack:
            patch = mock.patch.object
            stack.enter_context(patch(simulator.builder, "build", self.build))
            for name in HANDLERS:
                if hasattr(watched.module, name) and (watched.module, name) != (skin, "on_frame"):
                    made = self.around(name, getattr(watched.module, name))
                    stack.enter_context(patch(watched.module, name, made))
            if watched.module is skin:
                stack.enter_context(patch(skin_stack, "on_frame", self.hear))
            result = simulator.simulate(plan_of(watched), plain=True)
        self.transcript.fingerprint = result.fingerprint
        return self.transcript

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


HEAR = skin_stack.on_frame


def plan_of(watched: Watched) -> Any:
    """The plan of what is watched."""
    return scenario.plan(scenario.load(HERE / f"{watched.scenario}.toml"))


def record(name: str) -> Transcript:
    """What a role's node was told, and what came of it."""
    return Recorder(WATCHED[name], ROLES[name]).run()


def compiled_mark(name: str) -> tuple[int, str]:
    """The state's hash at the end of the compiled run, and the run's fingerprint."""
    watched, role = WATCHED[name], ROLES[name]
    result = watched.simulator.simulate(plan_of(watched))
    state = getattr(result.world, watched.table)[watched.node]
    mark = 1
    for field_name, many, *_ in role.state:
        value = state[field_name]
        mark = replay.fold_field(mark, [int(word) for word in value] if many else int(value))
    return mark, result.fingerprint
