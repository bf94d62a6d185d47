"""The PC: what it announces, and that its number only rises while it is not restarted.

Proved for up to four ports; every port is treated alike, and none is read for another.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any

from innervate.dialect.arith import MASK16
from innervate.dialect.source import Change
from innervate.networks.skin.protocol import fields
from innervate.networks.skin.protocol.constants import BEACON, COMMAND, DATA, GIVE, TICK, TIMERS
from innervate.prove.records import Record
from innervate.prove.steps import Goal, Stage, Step, own_goals, sent
from innervate.prove.terms import Term
from innervate.prove.theory import source

ENTRY = "innervate.networks.skin.protocol.sink"
PORTS = 4
ROOM = PORTS + 2


def steps(change: Change | None = None) -> tuple[Callable[[], Step], ...]:
    """All that can happen to the PC."""
    known = source(ENTRY, change)
    found = [partial(_play, known, "the PC is switched on", "on_start", ["cause"])]
    for kind, what in ((BEACON, "hears a beacon"), (DATA, "is given data"), (0, "hears a setup")):
        found.append(partial(_play, known, f"the PC {what}", "on_frame", ["port", "frame"], kind))
    found.append(partial(_play, known, "the PC's period ends", "on_timer", [TICK]))
    found.append(partial(_play, known, "the PC is given a command", "on_input", [GIVE, "frame"]))
    found.append(partial(_play, known, "the PC is given something else", "on_input", [0, "frame"]))
    return tuple(found)


def _play(known: dict[str, Any], name: str, handler: str, told: list[Any], kind: int = 0) -> Step:
    stage = Stage(known, fields.FRAME, ROOM)
    t = stage.terms
    own = stage.record("own", fields.SINK)
    pc = stage.record("pc", fields.SINK_PORT, ports=PORTS)
    pc.parts["own"] = (own,)
    params, frame = stage.record("params", fields.PARAMS), stage.record("frame", fields.FRAME)
    stage.store[own, "ports", None] = ports = t.unknown("own.ports", 0, PORTS)
    if kind:
        stage.fix(frame, "kind", kind)
    elif handler == "on_frame":
        stage.store[frame, "kind", None] = t.unknown("frame.kind", COMMAND, 15)
    port = t.unknown("port", 0, PORTS - 1)
    given = {"cause": t.unknown("cause", 0, 1), "port": port, "frame": frame}
    args = [given.get(one, one) for one in told]
    step = stage.play(name, handler, [pc, params, stage.clock(), *args, stage.out],
                      [t.less(port, ports)])  # fmt: skip
    step.goals = [*own_goals(step, ("own", "pc"), TIMERS, PORTS), *_goals(step, own, handler)]
    return step


def _goals(step: Step, own: Record, handler: str) -> list[Goal]:
    t = step.terms
    said = []
    for guard, _port, frame in sent(step, BEACON):
        is_zero = t.same(step.after[frame, "dist", None], t.number(0))
        is_own = t.same(step.after[frame, "sq", None], step.after[own, "sq", None])
        said.append(t.implies(guard, t.all(is_zero, is_own)))
    goals = [Goal("P1 the PC announces distance 0 and its number", t.all(*said))]
    if handler != "on_start":
        known = t.same(step.before[own, "sq_known", None], t.number(1))
        rises = t.implies(known, _rises(step, own))
        goals.append(Goal("P2 the PC's number never goes back", rises))
    return goals


def _rises(step: Step, own: Record) -> Term:
    t = step.terms
    ahead = t.sub(step.after[own, "sq", None], step.before[own, "sq", None])
    return t.less(t.bits_and(ahead, t.number(MASK16)), t.number(1 << 15))
