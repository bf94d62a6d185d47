"""Twelve cells of firmware around a live PC heal as the simulation of the same patch does."""

import asyncio

import pytest

from innervate import scenario as scenarios
from innervate.firmware import patch
from innervate.live.up import Processes
from innervate.networks.skin.sim.simulate import simulation
from tests.firmware.test_patch import FIRST_S, asked, samples, tools
from tests.live.net import until

HZ = 5
CUT_S = 6.0
SEEDS = range(6)
TWELVE = {
    "kind": "skin", "name": "twelve", "duration_s": 16, "patch": [{"columns": 4, "rows": 3}],
    "interface": [{"patch": 0, "row": 0, "column": 0}, {"patch": 0, "row": 2, "column": 3}],
    "protocol": {"beacon_hz": HZ}, "data": {"rate_hz": 1},
    "event": [{"at_s": CUT_S, "action": "cut", "interface": 0}],
}  # fmt: skip
__all__ = ["tools"]


def hops(cells):
    """Every cell's distance to the PC; None without a way."""
    return [None if c.parent < 0 else c.dist[c.parent] + 1 for c in cells]


def simulated(seed):
    """(hops before the cut, hops in the end, periods from the cut until they are so)."""
    plan = scenarios.plan(scenarios.from_dict({**TWELVE, "seed": seed}))
    running = simulation(plan, plain=True)
    step_us, at_us = 1_000_000 // HZ // 4, int(CUT_S * 1e6)
    running.advance(at_us, 1 << 30)
    before, seen = hops(running.world.cells), []
    for later in range(at_us, plan.duration_us, step_us):
        running.advance(later, 1 << 30)
        seen.append(hops(running.world.cells))
    healed = next(k for k in range(len(seen)) if all(one == seen[-1] for one in seen[k:]))
    return before, seen[-1], healed / 4


async def measured(tmp_path, plan, images, before, after):
    """Periods from the cut until all cells are as far as they are to be, on emulated boards."""
    network = Processes(plan, tmp_path / "run", "udp", None, images)
    await network.up()
    try:
        cells = [name for name in network.names if name != "pc"]

        def far():
            return [asked(network, name)["dist"] for name in cells]

        await until(lambda: far() == before, FIRST_S)
        cable = network.links.index((0, 12))
        took_s = await _cut(network, cable, lambda: far() == after)
        got = samples(network)
        await until(lambda: samples(network) > got + 24, FIRST_S)
        await network.end_node("pc", gently=False)  # and the PC starts anew
        await network.begin_node("pc")
        await until(lambda: far() == after and samples(network) > 24, FIRST_S)
        await network.change(cable, "restore")
        await until(lambda: far() == before, FIRST_S)
        return took_s * HZ
    finally:
        await network.down()


async def _cut(network, cable, healed):
    await network.change(cable, "cut")
    return await until(healed, FIRST_S)


@pytest.mark.slow
def test_twelve_cells_heal_as_their_simulation_does(tmp_path):
    told = [simulated(seed) for seed in SEEDS]
    before, after, _ = told[0]
    assert all(one[:2] == (before, after) for one in told)
    periods = [one[2] for one in told]
    plan = scenarios.plan(scenarios.from_dict({**TWELVE, "event": []}))
    images = patch.images(plan, tmp_path, [])
    assert len(images) == 12
    took = asyncio.run(measured(tmp_path, plan, images, before, after))
    print(f"simulated {min(periods)} to {max(periods)} periods, emulated {took:.1f}")
    assert min(periods) - 2 <= took <= max(periods) + 3
