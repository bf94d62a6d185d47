"""Live nodes of a network over a field: UDP to everybody who hears them.

The air between processes is none: nothing collides, and what a medium access is for is done by
queues. What a link loses is in the scenario, and not played.
"""

from collections.abc import Coroutine
from typing import Any

from innervate.dialect.access import ALL
from innervate.dialect.outbox import URGENT
from innervate.live.build import links_of, sealer_of, state_of
from innervate.live.declared import DeclaredNode, DeclaredStack
from innervate.live.deployment import Deployment, Pairs, Stage, Table
from innervate.live.errors import LiveError
from innervate.live.moving import follow, tell
from innervate.live.nodefile import Loaded
from innervate.network import networks
from innervate.scenario.actions import ON_LINKS
from innervate.scenario.declared.moving import met, placed_of, walkers_of

RSSI = -50  # of every frame that comes over UDP, dBm


class FieldStack(DeclaredStack):
    """One node, as an engine runs it: what it sends goes to all who hear it."""

    def on_frame(self, now: int, port: int) -> None:
        """The frame in the inbox was received, on whatever path."""
        if hasattr(self.inbox, "rssi"):
            self.inbox.rssi = RSSI
        self.do.on_frame(self.node, self.params, now, 0, self.inbox, self.out)

    def objection(self, sender: int | None) -> str:
        """A frame that is for another node is not for us."""
        to = getattr(self.inbox, "to", ALL)
        return "" if to in (ALL, self.number) else "for another node"

    def ports_of(self, port: int, frame: Any, attempt: int) -> list[int] | None:
        """All paths: who is in reach hears it."""
        return None

    def on_sent(self, now: int) -> None:
        """Our own frame has ended, at once; the channel is free, as ever."""
        if hasattr(self.do, "on_sent"):
            self.do.on_sent(self.node, self.params, now, 1, self.out)
        elif hasattr(self.do, "on_carrier"):
            self.do.on_carrier(self.node, self.params, now, 0, 0, self.out)


class FieldNode(DeclaredNode):
    """A node that is told when its own frames have ended."""

    stack: FieldStack
    _unended = 0  # own frames that it was not told of yet

    def _transmit(self, port: int, frame: Any, attempt: int, flags: int) -> None:
        super()._transmit(port, frame, 0, flags)  # attempts are for a medium access
        self._unended += not flags & URGENT

    def _settled(self) -> None:
        super()._settled()
        while self._unended and self.engine is not None:
            self._unended -= 1
            self.engine.call(self.stack.on_sent, self.engine.now)


class FieldDeployment(Deployment):
    """Nodes, and a cable for every pair that hears each other.

    Attributes:
        no_serial: why serial cables are refused.
        no_link: what is wrong with a pair of nodes, `a` and `b`, that no cable joins.
    """

    no_serial = "--pty joins two ends; nodes of a field take --netns or UDP"
    no_link = "{a} and {b} do not hear each other"

    def layout(self) -> tuple[list[str], Pairs]:
        """Nodes by number; pairs that hear at least half of each other's frames, some time."""
        names = [f"n{i}" for i in range(self.plan.nodes)]
        return names, met(self.plan.nodes, self.plan.good, walkers_of(self.plan))

    def check(self, cables: str, sealed: bool) -> None:
        """Refuse serial cables, which join two ends each."""
        if cables == "pty":
            raise LiveError(self.no_serial)

    def file(self, number: int, cables: list[int]) -> tuple[Table, dict[str, Table]]:
        """A node's parameters; one that nobody hears has no file."""
        if not cables:
            raise LiveError(f"node {number} hears nobody; raise air.reach_m")
        return {}, {"protocol": dict(self.plan.params)}

    def others(self, stage: Stage) -> list[Coroutine[Any, Any, None]]:
        """Inputs; robots come and go, and are told where, if their network wants to know."""
        found = super().others(stage)
        if self.plan.walks:
            found.append(follow(self.plan, stage))
        if (placed := placed_of(networks()[self.plan.kind].fields)) is not None:
            found += [tell(self.plan, walk, placed, stage) for walk in self.plan.walks]
        return found

    def cable_of(self, fault: Any) -> int:
        """The number of the link that a fault is done to; -1 if it is done to none."""
        if self.word(fault) not in ON_LINKS:
            return -1
        pair = (min(fault.node, fault.other), max(fault.node, fault.other))
        if pair not in self.links:
            a, b = (self.names[node] for node in pair)
            raise LiveError(f"event.{fault.index}: {self.no_link.format(a=a, b=b)}")
        return self.links.index(pair)


def build(loaded: Loaded) -> FieldNode:
    """The node of a file, not yet started; a LiveError says what cannot be as written."""
    links, state = links_of(loaded), state_of(loaded)
    stack = FieldStack.of(loaded, [])
    return FieldNode(loaded.name, stack, links, sealer_of(loaded, state), state)
