"""Live nodes that are told where their robots are, as the scenario has it."""

import asyncio
from collections.abc import Iterator
from types import SimpleNamespace
from typing import Any

from innervate.live.deployment import Stage, Table, ask, sleep_until
from innervate.scenario.declared.moving import Placed
from innervate.scenario.robots import Walk, errs, position_cm
from innervate.topology import astray


def told(plan: Any, walk: Walk, placed: Placed) -> Iterator[tuple[int, Table]]:
    """When a robot is told where it is, us, and the request; what stands and is sure only once."""
    err = SimpleNamespace(**errs(walk, plan.seed, plan.sample_us)._asdict())
    for at_us in range(0, plan.duration_us, plan.sample_us):
        x, y = position_cm(walk, at_us)
        if err.noise:
            astray.err(err, astray.normal_table())
            x += astray.centimetres(err.noise, err.off_x)
            y += astray.centimetres(err.noise, err.off_y)
        item = {
            "x": within(x / placed.unit_cm, placed.x),
            "y": within(y / placed.unit_cm, placed.y),
        }
        yield at_us, {"do": "input", "kind": placed.kind, "item": item}
        if at_us >= walk.points[-1][0] and not err.noise:
            return


def within(number: float, limits: tuple[int, int]) -> int:
    """The nearest whole number within limits."""
    return min(max(round(number), limits[0]), limits[1])


async def tell(plan: Any, walk: Walk, placed: Placed, stage: Stage) -> None:
    """Tell a robot's node where it is, again and again; what comes too late is left out."""
    loop = asyncio.get_running_loop()
    began, name = loop.time(), stage.deployment.names[walk.node]
    for at_us, request in told(plan, walk, placed):
        due = began + at_us / 1e6
        if loop.time() <= due + plan.sample_us / 1e6:
            await sleep_until(due)
            await ask(stage.socket(name), request)
