"""Robots of live nodes: who hears them follows from where they are, which they are told."""

import asyncio
from collections.abc import Iterator
from types import SimpleNamespace
from typing import Any

from innervate.live.deployment import Pairs, Stage, Table, ask, sleep_until
from innervate.live.links import APART, NEAR
from innervate.scenario.declared.moving import Placed
from innervate.scenario.robots import Walk, errs, position_cm
from innervate.topology import astray, placement
from innervate.topology.placement import RSSI50_CDB, Point

LOOKED_US = 100_000  # so often it is looked who hears whom


class Errors:
    """By how much a robot is wrong about its place: sample by sample what a simulation has."""

    def __init__(self, plan: Any, walk: Walk) -> None:
        self._walk = SimpleNamespace(**errs(walk, plan.seed, plan.sample_us)._asdict())
        self._samples = 0

    def at(self, sample: int) -> Point:
        """Of a sample, from 0 on, and not before the last one that was asked for; cm."""
        if not self._walk.noise:
            return 0, 0
        while self._samples <= sample:
            astray.err(self._walk, astray.normal_table())
            self._samples += 1
        x, y = (astray.centimetres(self._walk.noise, off)
                for off in (self._walk.off_x, self._walk.off_y))  # fmt: skip
        return x, y


def told(plan: Any, walk: Walk, placed: Placed) -> Iterator[tuple[int, Table]]:
    """When a robot is told where it is, us, and the request; what stands and is sure only once."""
    errors = Errors(plan, walk)
    for sample, at_us in enumerate(range(0, plan.duration_us, plan.sample_us)):
        (x, y), (dx, dy) = position_cm(walk, at_us), errors.at(sample)
        item = {
            "x": within((x + dx) / placed.unit_cm, placed.x),
            "y": within((y + dy) / placed.unit_cm, placed.y),
        }
        yield at_us, {"do": "input", "kind": placed.kind, "item": item}
        if at_us >= walk.points[-1][0] and not walk.noise_um:
            return


def within(number: float, limits: tuple[int, int]) -> int:
    """The nearest whole number within limits."""
    return min(max(round(number), limits[0]), limits[1])


def changes(plan: Any, links: Pairs) -> Iterator[tuple[int, int, str]]:
    """When whose ends come near or are apart, us, as robots come and go; all are near at first."""
    ways = {walk.node: walk for walk in plan.walks}
    carried = [True] * len(links)
    last_us = max((walk.points[-1][0] for walk in plan.walks), default=0)
    for at_us in range(0, min(last_us + plan.sample_us, plan.duration_us), LOOKED_US):
        places = dict(enumerate(plan.positions_cm))
        for node, walk in ways.items():
            x, y = position_cm(walk, at_us)
            places[node] = round(x), round(y)
        for cable, (a, b) in enumerate(links):
            if a in ways or b in ways:
                holds = _is_near(plan, places, a, b)
                if holds != carried[cable]:
                    carried[cable] = holds
                    yield at_us, cable, NEAR if holds else APART


def _is_near(plan: Any, places: dict[int, Point], a: int, b: int) -> bool:
    """True if two nodes receive half of each other's frames, where nothing disturbs them."""
    far_cm = placement.distance_cm(places[a], places[b])
    lost = placement.path_loss_cdb(far_cm, plan.heard.exponent_c)
    least = min(plan.heard.base_cdb[i * plan.nodes + j] for i, j in ((a, b), (b, a)))
    return bool(least - lost >= RSSI50_CDB)


async def follow(plan: Any, stage: Stage) -> None:
    """Let links carry as robots come and go; one that is cut stays cut."""
    began = asyncio.get_running_loop().time()
    for at_us, cable, what in changes(plan, stage.deployment.links):
        await sleep_until(began + at_us / 1e6)
        await stage.change(cable, what)


async def tell(plan: Any, walk: Walk, placed: Placed, stage: Stage) -> None:
    """Tell a robot's node where it is, again and again; what comes too late is left out."""
    loop = asyncio.get_running_loop()
    began, name = loop.time(), stage.deployment.names[walk.node]
    for at_us, request in told(plan, walk, placed):
        due = began + at_us / 1e6
        if loop.time() <= due + plan.sample_us / 1e6:
            await sleep_until(due)
            await ask(stage.socket(name), request)
