"""What a scenario tells happens to the processes of a network: events at their times, and more."""

import asyncio
from collections.abc import Callable
from typing import NamedTuple

from innervate.live.deployment import Deployment, Stage, sleep_until
from innervate.live.errors import LiveError
from innervate.scenario.declared.shared import own_events

LOSS_ONE = 32_768
# Noise, single frames lost come by themselves; all else is done to processes and their cables.
UNPLAYED = ("begin", "lose", "jam", "quiet", "garble", "fade")


class Event(NamedTuple):
    """What happens.

    Attributes:
        at_s: when, from the moment at which all nodes are up, s.
        what: a word of the network's actions.
        cable: the cable it happens to, -1 = none.
        node: the node it happens to, by name; "" = none.
        loss: share of the frames that a loose cable loses.
        text: for people: "cut n1 - n2".
    """

    at_s: float
    what: str
    cable: int
    node: str
    loss: float
    text: str


def events(deployment: Deployment) -> list[Event]:
    """The events of a plan, in order of time.

    Raises:
        LiveError: one is about a cable that is not there.
    """
    names, found = deployment.names, []
    for fault in deployment.plan.faults:
        what, cable = deployment.word(fault), deployment.cable_of(fault)
        name = names[fault.node] if cable < 0 else ""
        where = name or " - ".join(names[node] for node in deployment.links[cable])
        loss = getattr(fault, "loss_q15", 0) / LOSS_ONE
        at_s = fault.at_us * deployment.slower() / 1e6
        found.append(Event(at_s, what, cable, name, loss, f"{what} {where}"))
    for at_us, words in own_events(deployment.plan):  # played as what users hand in
        at_s = at_us * deployment.slower() / 1e6
        found.append(Event(at_s, words.partition(" ")[0], -1, "", 0.0, words))
    return sorted(found, key=lambda event: event.at_s)


def is_played(event: Event) -> bool:
    """False for what real cables and channels do by themselves: noise, single frames lost."""
    return event.what not in UNPLAYED


class Player:
    """Plays events on a running network, from now on; `tell` is given each as it happens."""

    def __init__(self, stage: Stage, events: list[Event], tell: Callable[[Event], None]) -> None:
        self.stage = stage
        self.events = events
        self.tell = tell

    async def play(self) -> None:
        """Play all; some scenarios have no end; LiveError if a node did not come up again."""
        failed: list[BaseException] = []
        try:
            async with asyncio.TaskGroup() as group:
                group.create_task(self._play_events())
                for other in self.stage.deployment.others(self.stage):
                    group.create_task(other)
        except* LiveError as errors:
            failed.extend(errors.exceptions)
        if failed:  # raised in an `except*`, Python 3.11.2 would wrap it in another group
            raise failed[0] from None

    async def _play_events(self) -> None:
        began = asyncio.get_running_loop().time()
        for event in filter(is_played, self.events):
            await sleep_until(began + event.at_s)
            self.tell(event)
            if event.cable >= 0:
                await self.stage.change(event.cable, event.what, event.loss)
            if event.what in ("kill", "restart", "leave"):
                await self.stage.end_node(event.node, event.what == "leave")
            if event.what in ("revive", "restart", "join"):
                await self.stage.begin_node(event.node)
