"""What a scenario tells happens to the processes of a network: events at their times, robots."""

from __future__ import annotations

import asyncio
import json
from collections.abc import Callable
from contextlib import suppress
from itertools import pairwise
from pathlib import Path
from typing import Any, NamedTuple, Protocol

from innervate.live import status
from innervate.live.errors import LiveError

LOSS_ONE = 32_768
ANSWER_S = 5.0
STANDING_S = 0.5

# What an event does; skins, meshes and radio teams number the same words differently.
WORDS = {
    "skin": ("cut", "restore", "kill", "revive", "loose", "restart", "lose"),
    "mesh": ("kill", "revive", "cut", "restore", "jam", "quiet", "restart"),
    "radio": ("begin", "join", "kill", "leave", "garble", "fade"),
}
LINKS = ("cut", "restore", "loose")
NODES = ("kill", "revive", "restart", "join", "leave")


class Stage(Protocol):
    """The network that events happen to."""

    def socket(self, name: str) -> Path:
        """A node's status socket."""

    async def change(self, cable: int, what: str, loss: float = 0.0) -> None:
        """Cut, restore or loosen a cable, at both its ends."""

    async def end_node(self, name: str, gently: bool) -> None:
        """End a node's process."""

    async def begin_node(self, name: str) -> None:
        """Start a node's process, or start it again."""


class Event(NamedTuple):
    """What happens.

    Attributes:
        at_s: when, from the moment at which all nodes are up, s.
        what: a word of WORDS.
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


def events(
    plan: Any,
    names: list[str],
    links: list[tuple[int, int]],
    cable_of: Callable[[Any], int],
) -> list[Event]:
    """The events of a plan, in order of time; `cable_of` finds the cable that a fault is about."""
    found: list[Event] = []
    for fault in plan.faults:
        what = WORDS[plan.kind][fault.action]
        cable = cable_of(fault) if what in LINKS or what == "lose" else -1
        name = names[fault.node] if cable < 0 else ""
        where = name or " - ".join(names[node] for node in links[cable])
        loss = getattr(fault, "loss_q15", 0) / LOSS_ONE
        found.append(Event(fault.at_us / 1e6, what, cable, name, loss, f"{what} {where}"))
    return found


def is_played(event: Event) -> bool:
    """False for what real cables and channels do by themselves: noise, single frames lost."""
    return event.what in LINKS + NODES


class Player:
    """Plays events and robots' walks on a network, from now on.

    Args:
        stage: the network.
        plan: its scenario's plan.
        events: what happens.
        tell: is given a line for every event.
    """

    def __init__(
        self, stage: Stage, plan: Any, events: list[Event], tell: Callable[[Event], None]
    ) -> None:
        self.stage = stage
        self.plan = plan
        self.events = events
        self.tell = tell

    async def play(self) -> None:
        """Play all; with robots it has no end.

        Raises:
            LiveError: a node did not come up again.
        """
        walks = getattr(self.plan, "walks", ())
        try:
            async with asyncio.TaskGroup() as group:
                group.create_task(self._play_events())
                group.create_task(self._play_orders())
                for walk in walks:
                    group.create_task(self._walk(walk, f"n{walk.node}"))
        except* LiveError as errors:
            raise errors.exceptions[0] from None

    async def _play_events(self) -> None:
        began = asyncio.get_running_loop().time()
        for event in filter(is_played, self.events):
            await _sleep_until(began + event.at_s)
            self.tell(event)
            if event.what in LINKS:
                await self.stage.change(event.cable, event.what, event.loss)
            if event.what in ("kill", "restart", "leave"):
                await self.stage.end_node(event.node, event.what == "leave")
            if event.what in ("revive", "restart", "join"):
                await self.stage.begin_node(event.node)

    async def _play_orders(self) -> None:
        """Have the PC of a skin send the scenario's commands."""
        began = asyncio.get_running_loop().time()
        for order in getattr(self.plan, "orders", ()):
            await _sleep_until(began + order.at_us / 1e6)
            cell = None if order.cell < 0 else order.cell
            request = {"do": "command", "code": order.code, "value": order.value, "cell": cell}
            await ask(self.stage.socket("pc"), request)

    async def _walk(self, walk: Any, name: str) -> None:
        """Tell a robot where it is, so often as the scenario says; seldom where it stands."""
        loop = asyncio.get_running_loop()
        began, period_s = loop.time(), self.plan.sample_us / 1e6
        due = began
        robot = Robot(self.stage.socket(name))
        x0, y0 = self.plan.origin_cm
        try:
            while True:
                at, speed = place_at(walk.points, round((due - began) * 1e6))
                await robot.locate((at[0] - x0, at[1] - y0), speed)
                ended = due - began > walk.points[-1][0] / 1e6
                # Late once, no burst after it; at rest only for a robot that starts anew.
                due = max(due + (STANDING_S if ended else period_s), loop.time() - period_s)
                await _sleep_until(due)
        finally:
            robot.close()


Pair = tuple[float, float]


def place_at(points: Any, time_us: int) -> tuple[Pair, Pair]:
    """Place (cm) and speed (cm/s) of a walk at a time; it stands before its first point."""
    for (t0, x0, y0), (t1, x1, y1) in pairwise(points):
        if t0 <= time_us < t1:
            share, took_s = (time_us - t0) / (t1 - t0), (t1 - t0) / 1e6
            at = (x0 + share * (x1 - x0), y0 + share * (y1 - y0))
            return at, ((x1 - x0) / took_s, (y1 - y0) / took_s)
    _, x, y = points[0] if time_us < points[0][0] else points[-1]
    return (x, y), (0.0, 0.0)


class Robot:
    """The connection to a robot's node; one that is away for a while is told when it is back."""

    def __init__(self, where: Path) -> None:
        self.where = where
        self._streams: tuple[asyncio.StreamReader, asyncio.StreamWriter] | None = None

    async def locate(self, at_cm: Pair, speed_cm_s: Pair) -> None:
        """Say where it is.

        Raises:
            LiveError: the node is no robot.
        """
        request = {"do": "locate", "at_cm": at_cm, "speed_cm_s": speed_cm_s}
        try:
            async with asyncio.timeout(ANSWER_S):
                if self._streams is None:
                    self._streams = await asyncio.open_unix_connection(str(self.where))
                reader, writer = self._streams
                writer.write(json.dumps(request).encode() + b"\n")
                answer = json.loads(await reader.readline() or "{}")
        except (OSError, TimeoutError):
            self.close()
            return
        if "error" in answer:
            raise LiveError(f"{self.where.stem}: {answer['error']}")
        if not answer:
            self.close()

    def close(self) -> None:
        """Hang up."""
        if self._streams is not None:
            self._streams[1].close()
            self._streams = None


async def ask(where: Path, request: dict[str, Any]) -> None:
    """Ask a node for something; one that does not run has nothing to do."""
    with suppress(LiveError):
        await asyncio.to_thread(status.ask_one, where, request)


async def _sleep_until(when: float) -> None:
    await asyncio.sleep(max(0.0, when - asyncio.get_running_loop().time()))
