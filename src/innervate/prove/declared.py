"""What is proved of any network that declares its protocol, without knowing what it is for.

From any state, parameters and frame whose fields are in their declared ranges: they stay there, no
index leaves its array, every number fits 32 bits, the outbox has room, draws are out of 1 or more,
loops end, what is used has a value; and every branch is taken by some state. That kinds of frames
have layouts, and draws a generator that is theirs alone, rests on no range: see laid.py.
"""

from collections.abc import Iterator
from functools import partial
from typing import Any

from innervate.dialect.source import Change
from innervate.network import Network, kinds_of
from innervate.prove.errors import ProveError
from innervate.prove.laid import beside_ranges
from innervate.prove.steps import Stage, Step, own_goals
from innervate.prove.theory import Theory, source

OUTBOX = 16
PORTS = 4
KIND_MAX = 1 << 20  # of what a scenario hands to nodes
RECORDS = ("state", "params", "frame")


def theories(network: Network, change: Change | None = None) -> list[Theory]:
    """That everything stays in its declared range."""
    if not (network.has("protocol") and network.has("fields")):
        raise ProveError(f"{network.name} declares no protocol")
    known = source(network.protocol.__name__, change)
    return [
        Theory(
            f"{network.name}: declared ranges",
            "Every field stays in its declared range, whatever comes in.",
            (),
            tuple(partial(_step, network, known, what) for what in _events(network)),
        )
    ]


def _events(network: Network) -> Iterator[tuple[str, str, list[Any]]]:
    """(name, handler, what it is told) of all that can happen to a node."""
    yield "it is switched on", "on_start", ["cause"]
    yield "a frame arrives", "on_frame", ["port", "frame"]
    for timer in range(network.protocol.TIMERS):
        yield f"timer {timer} fires", "on_timer", [timer]
    for name, handler, told in (
        ("its user hands something in", "on_input", ["kind", "frame"]),
        ("the carrier comes or goes", "on_carrier", ["cd", "voc"]),
        ("a frame has left or is given up", "on_sent", ["ok"]),
    ):
        if hasattr(network.protocol, handler):
            yield name, handler, told


def _step(network: Network, known: dict[str, Any], what: tuple[str, str, list[Any]]) -> Step:
    name, handler, told = what
    protocol, fields = network.protocol, network.fields
    stage = Stage(known, fields.FRAME, getattr(protocol, "OUTBOX", OUTBOX))
    state = stage.record("state", fields.STATE)
    params = stage.record("params", fields.PARAMS)
    given: dict[str, Any] = {
        **{name: stage.terms.unknown(name, 0, 1) for name in ("cause", "cd", "voc", "ok")},
        "port": stage.terms.unknown("port", 0, PORTS - 1),
        "kind": stage.terms.unknown("kind", 0, KIND_MAX),
        "frame": stage.record("frame", fields.FRAME),
    }
    args = [given.get(one, one) for one in told]
    alone = stage.terms.at_most(given["voc"], given["cd"])  # one that sends is somebody
    step = stage.play(name, handler, [state, params, stage.clock(), *args, stage.out], [alone])
    step.goals = own_goals(step, RECORDS, protocol.TIMERS, PORTS)
    step.goals += beside_ranges(step, known, kinds_of(network))
    return step
