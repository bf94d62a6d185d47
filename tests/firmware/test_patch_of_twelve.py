"""Twelve cells of firmware around a live PC heal as the simulation of the same patch does.

Healing is counted in periods of the beacons, from the event until every cell is as far from the PC
as it will be. Boards are looked at again and again: they healed after the last look that saw them
ill began, and before the first that saw them well ended, however long a look takes on a busy
machine. Beacons are slow, so that what boards themselves are late by is little of a period.
"""

import asyncio
import time
from typing import NamedTuple

import pytest

from innervate import scenario as scenarios
from innervate.firmware import patch
from innervate.live.up import Processes
from innervate.networks.skin.sim.simulate import simulation
from innervate.sim.cables.world import ALIVE
from tests.firmware.test_patch import FIRST_S, asked, samples, tools
from tests.live.net import until

HZ = 1
STEPS = 4  # looks at a simulation in a period
SEEDS = range(40)
SETTLED_S = 20
# Periods on either side: boards say their state ten times a second, and no number of seeds meets
# every moment between two beacons at which a cable can be cut.
EDGE = 0.25
DEAD = 7  # the cell that is killed
TWELVE = {
    "kind": "skin", "name": "twelve", "patch": [{"columns": 4, "rows": 3}],
    "interface": [{"patch": 0, "row": 0, "column": 0}, {"patch": 0, "row": 2, "column": 3}],
    "protocol": {"beacon_hz": HZ}, "data": {"rate_hz": 1},
}  # fmt: skip
CUT = ({"action": "cut", "interface": 0},)
KILL = ({"action": "kill", "cell": {"patch": 0, "row": 1, "column": 3}},)
REVIVE = ({"action": "revive", "cell": {"patch": 0, "row": 1, "column": 3}},)
AWAY_S = 10  # until nobody has a way any more, and then some
PC_AWAY = ({"action": "cut", "interface": 1},)
PC_BACK = ({"action": "restart", "pc": True}, {"action": "restore", "interface": 1})
RESTORE = ({"action": "restore", "interface": 0},)
__all__ = ["tools"]


class Healed(NamedTuple):
    """What came of an event: how far every cell then is, and by when, in periods."""

    hops: list
    periods: float


def hops(running):
    """Every cell's distance to the PC; None without a way, or without life."""
    world = running.world
    return [None if c.parent < 0 or alive != ALIVE else c.dist[c.parent] + 1
            for c, alive in zip(world.cells, world.alive, strict=False)]  # fmt: skip


def simulated(seed, *stages):
    """What comes of events one after the other, in a simulation; the first are before any."""
    at, events = SETTLED_S, []
    for stage in stages:
        events += [{**event, "at_s": at + event.get("at_s", 0)} for event in stage]
        at += SETTLED_S
    given = {**TWELVE, "seed": seed, "event": events, "duration_s": at}
    running, found = simulation(scenarios.plan(scenarios.from_dict(given)), plain=True), []
    for k in range(len(stages) + 1):
        begin, seen = k * SETTLED_S * 1_000_000, []
        for step in range(SETTLED_S * HZ * STEPS):
            running.advance(begin + step * 1_000_000 // HZ // STEPS, 1 << 30)
            seen.append(hops(running))
        found.append(Healed(seen[-1], seen.index(seen[-1]) / STEPS))
    return found


def told(*stages):
    """Of each stage how far cells are in the end, and the least and most periods of all seeds."""
    runs = [simulated(seed, *stages) for seed in SEEDS]
    found = []
    for one in zip(*runs, strict=True):
        assert all(healed.hops == one[0].hops for healed in one)
        periods = [healed.periods for healed in one]
        found.append((one[0].hops, min(periods) - 1 / STEPS, max(periods)))
    return found


class Emulated:
    """The patch on emulated boards, and what happens to it."""

    def __init__(self, network):
        self.network = network
        self.since = time.monotonic()  # a node that begins does so when it answers
        self.cells = [name for name in network.names if name != "pc"]
        self.cables = [network.links.index((cell, 12)) for cell in (0, 11)]

    def hops(self):
        """As of a simulation; a machine that was killed answers nobody."""
        alive = [self.network.processes[name].poll() is None for name in self.cells]
        return [asked(self.network, name)["dist"] if is_alive else None
                for name, is_alive in zip(self.cells, alive, strict=True)]  # fmt: skip

    async def heals(self, wanted):
        """Periods between which cells came to be as far as they should be."""
        looks = [self.since]

        def well():
            looks.append(time.monotonic())
            return self.hops() == wanted

        await until(well, FIRST_S)
        return HZ * (looks[-2] - self.since), HZ * (time.monotonic() - self.since)

    async def cut(self):
        self.since = time.monotonic()
        await self.network.change(self.cables[0], "cut")

    async def restore(self):
        self.since = time.monotonic()
        await self.network.change(self.cables[0], "restore")

    async def kill(self):
        self.since = time.monotonic()
        await self.network.end_node(self.cells[DEAD], gently=False)

    async def revive(self):
        await self.network.begin_node(self.cells[DEAD])
        await until(self.board_runs, FIRST_S)
        self.since = time.monotonic()

    def board_runs(self):
        """The process beside a board answers before that is there: by some 0.1 s."""
        return asked(self.network, self.cells[DEAD])["counters"].get("board started", 0)

    async def kill_pc(self):
        self.since = time.monotonic()
        await self.network.end_node("pc", gently=False)

    async def begin_pc(self):
        await self.network.begin_node("pc")
        self.since = time.monotonic()


# What happens to the patch, simulated and to processes.
STAGES = ((CUT, Emulated.cut), (KILL, Emulated.kill), (REVIVE, Emulated.revive),
          (PC_AWAY, Emulated.kill_pc), (PC_BACK, Emulated.begin_pc),
          (RESTORE, Emulated.restore))  # fmt: skip


async def measured(tmp_path, plan, images, wanted):
    """Periods of each stage on emulated boards; the first is until all were there."""
    network = Processes(plan, tmp_path / "run", "udp", None, images)
    await network.up()
    try:
        boards = Emulated(network)
        took = [await boards.heals(wanted[0])]
        for (_, happens), hops_then in zip(STAGES, wanted[1:], strict=True):
            await happens(boards)
            took.append(await boards.heals(hops_then))
        got = samples(network)
        await until(lambda: samples(network) > got + 24, FIRST_S)
        return took
    finally:
        await network.down()


@pytest.mark.slow
def test_twelve_cells_heal_as_their_simulation_does(tmp_path):
    expected = told(*(events for events, _ in STAGES))
    plan = scenarios.plan(scenarios.from_dict(TWELVE))
    images = patch.images(plan, tmp_path, [])
    assert len(images) == 12
    took = asyncio.run(measured(tmp_path, plan, images, [one[0] for one in expected]))
    both = zip(STAGES, expected[1:], took[1:], strict=True)
    for (events, _), (_, least, most), (after, by) in both:
        what = " and ".join(event["action"] for event in events)
        print(f"{what}: simulated {least} to {most} periods, emulated in {after:.2f} to {by:.2f}")
    for (_, least, most), (after, by) in list(zip(expected, took, strict=True))[1:]:
        assert by >= least - EDGE
        assert after <= most + EDGE
