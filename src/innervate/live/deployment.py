"""How a scenario's plan becomes running nodes: who there is, who is joined to whom, their files.

What stands here is for any network over cables; a network that has more to say overrides it.
"""

from __future__ import annotations

import asyncio
from collections.abc import Coroutine, Iterator
from contextlib import suppress
from pathlib import Path
from typing import Any, Protocol

from innervate.live import status
from innervate.live.errors import LiveError
from innervate.network import networks
from innervate.scenario.actions import ON_LINKS
from innervate.scenario.declared.shared import refuse_script

Table = dict[str, Any]
Pairs = list[tuple[int, int]]


class Stage(Protocol):
    """The running network that a scenario is played on."""

    deployment: Deployment

    def socket(self, name: str) -> Path:
        """Where a node's status socket lies."""

    async def change(self, cable: int, what: str, loss: float = 0.0) -> None:
        """Cut, restore or loosen a cable, at both its ends, or say who is in reach."""

    async def end_node(self, name: str, gently: bool) -> None:
        """End a node's process; `gently` lets it say goodbye, else it is killed."""

    async def begin_node(self, name: str) -> None:
        """Start a node's process, or start it again."""


class Deployment:
    """The nodes of a plan and their cables.

    Args:
        plan: of nodes over cables: with `graph` (topology.Graph) and `params` of the protocol.

    Attributes:
        names: every node's name, by number.
        links: cables: pairs of nodes.
        has_channel: the nodes share a channel, which is a process of its own.
    """

    has_channel = False

    def __init__(self, plan: Any) -> None:
        refuse_script(plan)
        self.plan = plan
        self._ends: list[tuple[int, int]] = []
        self.names, self.links = self.layout()

    def layout(self) -> tuple[list[str], Pairs]:
        """Names by number; cables as pairs of nodes.

        Raises:
            LiveError: there are no live nodes for such a plan.
        """
        return [f"n{i}" for i in range(self.plan.graph.cells)], self.cables()

    def cables(self) -> Pairs:
        """The cables of the plan's graph, as pairs of nodes; notes their ends."""
        graph = self.plan.graph
        self._ends = [(end, other) for end, other in enumerate(graph.peer) if end < other]
        return [(graph.node_of(end), graph.node_of(other)) for end, other in self._ends]

    def port_of(self, number: int, cable: int) -> int:
        """The port of a node that a cable is plugged into."""
        graph = self.plan.graph
        return next(int(graph.port_of(end)) for end in self._ends[cable]
                    if graph.node_of(end) == number)  # fmt: skip

    def check(self, cables: str, sealed: bool) -> None:
        """Refuse cables ("udp", "pty" or "netns") or seals that such nodes do not have.

        Raises:
            LiveError: they have no such cables, or no keys.
        """

    def channel(self) -> tuple[int, int]:
        """A slot of the channel that the nodes share and its turnaround, us, if they do.

        Raises:
            LookupError: they share none.
        """
        raise LookupError(self.plan.kind)

    def slower(self) -> int:
        """How many times as long everything takes as in the scenario."""
        return 1

    def is_board(self, number: int) -> bool:
        """True if what the network has for boards (live/board.py) can be this node."""
        return True

    def in_order(self, number: int, cables: list[int]) -> list[int]:
        """A node's cables in the order of its paths."""
        return cables

    def file(self, number: int, cables: list[int]) -> tuple[Table, dict[str, Table]]:
        """What is particular to a node's file: keys and tables, but for its links.

        Args:
            number: the node.
            cables: of its paths, in order.
        """
        ports = [self.port_of(number, k) for k in cables]
        return {"ports": ports}, {"protocol": dict(self.plan.params)}

    def word(self, fault: Any) -> str:
        """What an event of the plan does."""
        return str(networks()[self.plan.kind].actions[fault.action])

    def cable_of(self, fault: Any) -> int:
        """The cable that an event of the plan happens to; -1 = it happens to a node.

        Raises:
            LiveError: there is no such cable.
        """
        if self.word(fault) not in ON_LINKS:
            return -1
        return next(k for k, ends in enumerate(self._ends) if fault.end in ends)

    def others(self, stage: Stage) -> list[Coroutine[Any, Any, None]]:
        """What a scenario has done beside its events, to be run with them: here its inputs."""
        return [self._play_inputs(stage)]

    def inputs(self) -> Iterator[tuple[float, str, Table]]:
        """What nodes are asked by the scenario: when, s, which one, and the request."""
        for one in sorted(getattr(self.plan, "inputs", ()), key=lambda one: one.at_us):
            request = {"do": "input", "kind": one.kind, "item": one.item}
            yield one.at_us * self.slower() / 1e6, self.names[one.node], request

    async def _play_inputs(self, stage: Stage) -> None:
        began = asyncio.get_running_loop().time()
        for at_s, name, request in self.inputs():
            await sleep_until(began + at_s)
            await ask(stage.socket(name), request)


async def ask(where: Path, request: Table) -> None:
    """Ask a node for something; one that does not run has nothing to do."""
    with suppress(LiveError):
        await asyncio.to_thread(status.ask_one, where, request)


async def sleep_until(when: float) -> None:
    """Wait for a moment of the loop's clock."""
    await asyncio.sleep(max(0.0, when - asyncio.get_running_loop().time()))
