"""Robots of a scenario tell the nodes that they bear where they are."""

import asyncio
import json
from itertools import pairwise
from pathlib import Path
from typing import Any

from innervate.live.deployment import sleep_until
from innervate.live.errors import LiveError
from innervate.live.moving import Errors
from innervate.networks.mesh.scenario.plan import Point
from innervate.scenario.robots import Walk, position_cm

ANSWER_S = 5.0
STANDING_S = 0.5


def place_at(way: Walk, time_us: int) -> tuple[Point, Point]:
    """Place (cm) and speed (cm/s) of a walk at a time."""
    speed = (0.0, 0.0)
    for (t0, x0, y0), (t1, x1, y1) in pairwise(way.points):
        if t0 <= time_us < t1:
            took_s = (t1 - t0) / 1e6
            speed = ((x1 - x0) / took_s, (y1 - y0) / took_s)
    return position_cm(way, time_us), speed


async def walk(plan: Any, way: Walk, where: Path) -> None:
    """Tell a robot's node where it is, so often as the scenario says; seldom where it stands.

    One that errs is told as often where it stands, as its error goes on changing. `where` is the
    node's status socket. Raises LiveError: the node is no robot.
    """
    loop = asyncio.get_running_loop()
    began, period_s = loop.time(), plan.sample_us / 1e6
    due = began
    robot, errors = Robot(where), Errors(plan, way)
    x0, y0 = plan.origin_cm
    try:
        while True:
            at, speed = place_at(way, round((due - began) * 1e6))
            dx, dy = errors.at(int((due - began) / period_s + 0.5))
            await robot.locate((at[0] - x0 + dx, at[1] - y0 + dy), speed)
            ended = due - began > way.points[-1][0] / 1e6 and not way.noise_um
            # Late once, no burst after it; at rest only for a robot that starts anew.
            due = max(due + (STANDING_S if ended else period_s), loop.time() - period_s)
            await sleep_until(due)
    finally:
        robot.close()


class Robot:
    """The connection to a robot's node; one that is away for a while is told when it is back."""

    def __init__(self, where: Path) -> None:
        self.where = where
        self._streams: tuple[asyncio.StreamReader, asyncio.StreamWriter] | None = None

    async def locate(self, at_cm: Point, speed_cm_s: Point) -> None:
        """Say where it is; LiveError if the node is no robot."""
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
        """Hang up on the node that is told where its robot is."""
        if self._streams is not None:
            self._streams[1].close()
            self._streams = None
