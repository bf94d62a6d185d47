"""The PC: what it announces, and that its number only rises while it is not restarted.

Proved for up to four ports; every port is treated alike, and none is read for another.
"""

from collections.abc import Callable
from functools import partial
from typing import Any

from innervate.dialect.arith import MASK16, MASK30
from innervate.dialect.source import Change
from innervate.networks.skin.protocol import fields
from innervate.networks.skin.protocol.constants import BEACON, COMMAND, DATA, GIVE, TICK, TIMERS
from innervate.prove.records import Record, Store, name_of
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


def unread(change: Change | None = None) -> tuple[Callable[[], Step], ...]:
    """What the explorer leaves out of a PC, and of beacons on their way to it."""
    known = source(ENTRY, change)
    return partial(_known_before, known), partial(_heard_alike, known)


def _known_before(known: dict[str, Any]) -> Step:
    """A number that it knows, or of a cell that never had one."""
    step = _play(known, "the PC hears what it knows", "on_frame", ["port", "frame"], BEACON)
    t, said, mine = step.terms, step.was("frame", "sq"), step.was("own", "sq")
    _, newer = step.machine.run("later", [said, mine], step.before)
    old = t.all(t.same(step.was("own", "sq_known"), t.number(1)), t.negated(t.as_truth(newer)))
    step.facts.append(t.any(old, t.same(step.was("frame", "load"), t.number(0))))
    step.goals = [Goal("it notes no more than a port's load", _same(step, step.before))]
    return step


def _heard_alike(known: dict[str, Any]) -> Step:
    """Of a beacon it reads the number, and whether the load is 0, at whatever port."""
    step = _play(known, "the PC hears a number", "on_frame", ["port", "frame"], BEACON)
    t, frame = step.terms, step.records["frame"]
    other = dict(step.before)
    for key, low, high in frame.places():
        if key[1] not in ("kind", "sq"):
            other[key] = t.unknown(f"{name_of(key)}'", low, high)
    none = [t.same(store[frame, "load", None], t.number(0)) for store in (step.before, other)]
    port = t.unknown("port'", 0, PORTS - 1)
    step.facts += [t.same(*none), t.less(port, step.was("own", "ports"))]
    given = [step.records["pc"], step.records["params"], t.unknown("now'", 0, MASK30), port, frame]
    after, _ = step.machine.run("on_frame", [*given, step.machine.out], other)
    step.goals = [Goal("the same comes of it, and nothing is sent", _same(step, after))]
    return step


def _same(step: Step, store: Store) -> Term:
    """It knows the same as it would in other values, and sends nothing."""
    t, own = step.terms, step.records["own"]
    alike = [t.same(step.after[key], store[key]) for key, _, _ in own.places()]
    return t.all(*alike, *(t.negated(action.guard) for action in step.machine.out.actions))


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
