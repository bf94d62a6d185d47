"""The channel below a mesh whose nodes all hear each other: a world of `sim/channel`."""

from typing import Any

from innervate.networks.mesh.scenario.plan import ONE
from innervate.networks.radio.scenario.plan import RadioPlan
from innervate.networks.radio.sim import build
from innervate.sim.channel.build import grow_heap
from innervate.sim.channel.world import Heap, World
from innervate.sim.tables import put


def world_of(plan: Any, plain: bool, checks: bool, above: Heap) -> World:
    """The channel of a mesh plan; `above` is the mesh's queue.

    All stations are off: the mesh switches on its nodes. Of a channel that all share the share of
    frames that are lost is one number; it is that of the worst pair.
    """
    n = plan.nodes
    pairs = [i * n + j for i in range(n) for j in range(n) if i != j]
    delay = plan.mac_params["dmax_us"]
    stations = RadioPlan(
        scenario=plan.scenario,
        kind="radio",
        seed=plan.seed,
        duration_us=plan.duration_us,
        protocol=plan.mac,
        stations=n,
        params=plan.mac_params,
        delays_us=[[delay if i != j else 0 for j in range(n)] for i in range(n)],
        loss_q15=ONE - min((plan.radio.prob_q15[pair] for pair in pairs), default=ONE),
        arrivals=[[] for _ in range(n)],
        sizes=[[1] for _ in range(n)],
        absent=[1] * n,
    )
    world = build.build(stations, plain, checks=checks, observe=False)
    put(world.run, 0, exclusive=0)  # nodes come and go
    return world._replace(above=above)


def grown(world: Any) -> Any:
    """The mesh's world with twice the room for events, in its own queue and the channel's."""
    world = grow_heap(world)
    if not world.below:
        return world
    return world._replace(below=grow_heap(world.below)._replace(above=world.heap))
