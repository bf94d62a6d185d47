"""A run from one seed: a network is brought up, hurt, left alone, looked at, again and again."""

import gc
import zlib
from typing import NamedTuple

from tests.livesim import hurts, mesh
from tests.livesim.world import SECOND, Broken, World


class Found(NamedTuple):
    """What a run showed.

    Attributes:
        what: the network, in words.
        seconds: of simulated time.
        broken: what must not be, one line each.
        told: what happened how often.
        fingerprint: of all datagrams, in order.
    """

    what: str
    seconds: float
    broken: list
    told: dict
    fingerprint: int


def _storm(world, stage):
    """Hurt it, heal it, and look whether all is as it was."""
    plan = stage.plan
    stage.is_sending = True
    hurts.storm(stage, plan.storm_s)
    world.run(plan.storm_s)
    hurts.over(stage)
    stage.is_sending = False
    world.run(mesh.AGAIN_S)
    sent = stage.everybody_reaches_everybody()
    world.run(10.0)
    stage.check_reach(sent)
    world.run(mesh.ENDS_S - 10.0 + plan.calm_s)
    stage.messages.look()
    stage.check_memory()
    world.check()


def run_mesh(seed, **given):
    """A mesh, as a seed has it."""
    world = World(seed)
    plan = mesh.Plan(world, **given)
    stage = mesh.Stage(world, plan)
    prints = [0]

    def note(source, _target, data):
        prints[0] = zlib.crc32(data, zlib.crc32(repr((world.now, source)).encode(), prints[0]))

    stage.net.sniffers.append(note)
    try:
        stage.begin()
        world.run(15.0)
        for _ in range(plan.storms):
            _storm(world, stage)
        stage.end()
    except Broken:
        pass  # it is told by `world.broken`
    gc.collect()
    what = f"mesh of {plan.nodes}, {len(plan.links)} links"
    what += ", sealed" if plan.sealed else ""
    what += ", in order" if plan.in_order else ""
    told = {**stage.messages.states, "again in another life": stage.messages.again,
            "sent": len(stage.messages.sent), "datagrams": stage.net.sent,
            "lives": sum(host.lives for host in stage.hosts)}  # fmt: skip
    return Found(what, world.now / SECOND, world.broken, told, prints[0])


KINDS = {"mesh": run_mesh}


def run(seed, kind=None, **given):
    """The run of a seed."""
    kinds = sorted(KINDS)
    return KINDS[kind or kinds[seed % len(kinds)]](seed, **given)
