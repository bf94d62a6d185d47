"""A scenario's [script] played: the explorer's own states, one after the other, with no clock.

What broke as it was explored breaks here; so does nothing once the protocol is mended. A step takes
a millisecond, so that rows have a time.
"""

import hashlib
from collections import Counter
from dataclasses import dataclass, field
from types import SimpleNamespace
from typing import Any

import numpy as np

from innervate import folders
from innervate.dialect import plain
from innervate.dialect.outbox import DELIVER, REPORT
from innervate.kernel.clock import wall_s
from innervate.network import Network, networks
from innervate.scenario.declared.shared import cabled, script_of
from innervate.sim.counts import Counts
from innervate.sim.driver import InvariantBroken
from innervate.sim.tables import DELIVERY, ROW, row_dtype
from innervate.verify.declared import net_of
from innervate.verify.net import Net
from innervate.verify.scripts import Unplayable, begins, played
from innervate.verify.states import After, Budget, State, Step
from innervate.verify.telling import sentence
from innervate.verify.values import put

STEP_US = 1_000


class Noting(Net):
    """A network that notes what happens in a step, what its nodes report, deliver and are asked."""

    def __init__(self, *given: Any) -> None:
        super().__init__(*given)
        self.forget_step()

    def forget_step(self) -> None:
        """A step begins: nothing has happened in it so far."""
        self.done: list[tuple[int, ...]] = []
        self.handed: list[tuple[int, ...]] = []
        self.handled = 0
        self.counted = Counter[str]()

    def begin(self, budget: Budget) -> Step:
        """All nodes are switched on; what they did so before is no step."""
        self.forget_step()
        return super().begin(budget)

    def arrive(self, state: State, end: int) -> After:
        """A frame comes, and is counted."""
        self.counted["arrived"] += 1
        return super().arrive(state, end)

    def missed(self, state: State, end: int) -> After:
        """A frame is lost, and counted."""
        self.counted["noise"] += 1
        return super().missed(state, end)

    def leave(self, state: State, number: int, ok: int) -> After:
        """A frame goes out, or is counted as given up."""
        self.counted["busy"] += not ok
        return super().leave(state, number, ok)

    def give(self, state: State, number: int, kind: int, item: dict[str, Any]) -> After:
        """A user hands something down, which is counted."""
        self.counted["given"] += 1
        return super().give(state, number, kind, item)

    def call(self, state: State, number: int, now: int, handler: Any, *what: Any) -> After:
        """A handler of a node, and what it asked for is noted."""
        found = super().call(state, number, now, handler, *what)
        self.handled += 1
        port = what[0] if handler is getattr(self.do, "on_frame", None) else 0
        for act, frame in zip(self.out.action[: self.out.count[0]], self.out.frame, strict=False):
            if act.kind == REPORT:
                self.done.append((number, act.a, act.b, act.c))
            elif act.kind == DELIVER:
                self.handed.append((number, port, getattr(frame, "kind", -1), -1))
        return found


@dataclass(slots=True)
class Kept:
    """What is kept of the steps."""

    rows: list[tuple[int, ...]] = field(default_factory=list)
    deliveries: list[tuple[int, ...]] = field(default_factory=list)
    counted: Counter[str] = field(default_factory=Counter)
    words: list[str] = field(default_factory=list)
    handled: int = 0

    def note(self, net: Noting, before: State, step: Step) -> None:
        """A step, and what its calls asked for."""
        time = STEP_US * len(self.words)
        self.words.append(step.words)
        self.rows += [(time, *row) for row in net.done]
        self.deliveries += [(time, *row) for row in net.handed]
        self.handled += net.handled
        self.counted += net.counted
        ended = sum(net.counted[how] for how in ("arrived", "noise", "busy"))
        self.counted["sent"] += ended + _under_way(step.state) - _under_way(before)

    def counts(self, nodes: int) -> Counts:
        """What a medium would have counted."""
        of = self.counted
        lost_by = {name: of[name] for name in ("noise", "busy")}
        return Counts(nodes, (), of["sent"], of["arrived"], lost_by, of["given"],
                      len(self.deliveries))  # fmt: skip


def play(plan: Any) -> dict[str, Any]:
    """What playing a plan's script leaves, as a run's result has it.

    Raises:
        ScenarioError: a step that cannot be.
        InvariantBroken: what it is meant to show, or anything else that must not happen.
        NetworkError: so in the protocol of a folder.
    """
    network, script, started = networks()[plan.kind], script_of(plan), wall_s()
    assert script is not None
    net = _net(network, plan, script.graph)
    kept, state = Kept(), None
    try:
        for before, step in played(net, script.steps):
            kept.note(net, before, step)
            net.forget_step()
            state = step.state
            if step.broken:
                number = len(kept.words) - (not begins(script.steps))
                place = f"step {number} of {len(script.steps)} of its script"
                told = sentence(net, step.words, before, step.state)
                error = InvariantBroken if network.folder is None else folders.NetworkError
                raise error(f"invariant broken in {place}: {step.broken}. {told}")
    except Unplayable as error:
        key = ("script", "steps", error.place)
        raise plan.scenario.source.error(key, f"script.steps.{error.place}: {error}") from None
    assert state is not None
    rows = {"rows": _table(ROW, kept.rows), "deliveries": _table(DELIVERY, kept.deliveries)}
    mark = hashlib.sha256(repr((kept.words, state)).encode()).hexdigest()[:16]
    return {
        "plan": plan, "world": _world(network, net, state), "rows": rows,
        "counts": kept.counts(net.graph.cells), "ended_us": STEP_US * len(kept.words),
        "wall_s": wall_s() - started, "fingerprint": mark, "handled": kept.handled,
        "interrupted": False,
    }  # fmt: skip


def _under_way(state: State) -> int:
    return sum(map(len, state.ways))


def _net(network: Network, plan: Any, graph: str) -> Noting:
    cables = plan.graph if hasattr(plan, "graph") else cabled(graph)
    params = {name: plan.params[name] for name, *_ in network.fields.PARAMS}
    net = net_of(network, cables, params, Noting)
    assert isinstance(net, Noting)
    return net


def _table(names: Any, rows: list[tuple[int, ...]]) -> Any:
    return np.array(rows, row_dtype(names))


def _world(network: Network, net: Net, state: State) -> Any:
    """The nodes at the end, called as their medium's are."""
    make, nodes = plain.make("Node", network.fields.STATE), []
    for one in state.nodes:
        nodes.append(make())
        put(nodes[-1], network.fields.STATE, one.values)
    return SimpleNamespace(**{"cells" if network.medium == "cables" else "stations": nodes})
