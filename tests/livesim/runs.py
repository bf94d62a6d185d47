"""A run from one seed: a network is brought up, hurt, left alone, looked at, again and again."""

import gc
import zlib
from contextlib import suppress
from typing import NamedTuple

from tests.livesim import hurts, mesh, radio, skin
from tests.livesim.checks import Nonces
from tests.livesim.slowly import MET_S
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


def run(seed, kind=None, **given):
    """The run of a seed, of the kind that it stands for or of this one."""
    world = World(seed)
    prints, nets, told = [0], [], {}

    def note(source, _target, data):
        prints[0] = zlib.crc32(data, zlib.crc32(repr((world.now, source)).encode(), prints[0]))

    def watch(net):
        net.sniffers.append(note)
        nets.append(net)

    with suppress(Broken), Nonces(world):  # what is broken is told by `world.broken`
        KINDS[kind or kind_of(seed)](world, watch, told, given)
    world.end()
    gc.collect()
    what = told.pop("what")
    told["datagrams"] = nets[0].sent
    return Found(what, world.now / SECOND, world.broken, told, prints[0])


def kind_of(seed):
    """The kind of network that a seed stands for."""
    kinds = sorted(KINDS)
    return kinds[seed % len(kinds)]


def _weeks(world, watch, told, given):
    _mesh(world, watch, told, given, mesh.Weeks)


def _mesh(world, watch, told, given, plan_of=mesh.Plan):
    plan = plan_of(world, **given)
    stage = mesh.Mesh(world, plan)
    watch(stage.net)
    told["what"] = f"mesh of {plan.nodes}, {len(plan.links)} links" + _words(plan)
    try:
        stage.begin()
        world.run(15.0)
        for _ in range(plan.storms):
            _mesh_storm(world, stage)
        stage.end()
    finally:
        told |= {**stage.messages.states, "again in another life": stage.messages.again,
                 "sent": len(stage.messages.sent), **_lives(stage.hosts)}  # fmt: skip


def _mesh_storm(world, stage):
    """Hurt it, heal it, and look whether all is as it was."""
    plan, slowly = stage.plan, stage.slowly
    stage.is_sending = True
    hurts.storm(stage, plan.storm_s)
    world.run(plan.storm_s)
    hurts.over(stage)
    stage.is_sending = False
    if slowly:
        world.run(MET_S)
        slowly.met()
    world.run(stage.again_s() - (MET_S if slowly else 0))
    sent = stage.everybody_reaches_everybody()
    world.run(10.0)
    stage.check_reach(sent)
    if slowly:
        slowly.heard()
    rest_s = mesh.ENDS_S + plan.longer_s - 10.0 + plan.calm_s
    world.run(rest_s)
    if slowly:
        slowly.rested(rest_s)
    stage.messages.look()
    stage.check_memory()
    stage.check_rest()
    world.check()
    if plan.sealed:
        stage.rotate_in_peace()


def _skin(world, watch, told, given):
    plan = skin.Plan(world, **given)
    stage = skin.Skin(world, plan)
    watch(stage.net)
    told["what"] = f"skin of {plan.columns} x {plan.rows}" + _words(plan)
    try:
        stage.begin()
        world.run(skin.AGAIN_S)
        stage.check_reach()
        stage.sends()
        for _ in range(plan.storms):
            hurts.storm(stage, plan.storm_s)
            world.run(plan.storm_s)
            hurts.over(stage)
            world.run(skin.AGAIN_S + plan.calm_s)
            stage.check_reach()
            stage.check_memory()
            world.check()
        stage.end()
    finally:
        told |= {"touches": stage.touches, "commands": len(stage.had), **_lives(stage.hosts)}


def _radio(world, watch, told, given):
    plan = radio.Plan(world, **given)
    team = radio.Team(world, plan)
    watch(team.net)
    told["what"] = f"radio team of {plan.nodes}"
    try:
        team.begin()
        world.run(radio.AGAIN_S)
        for _ in range(plan.storms):
            team.storm(plan.storm_s)
            world.run(plan.storm_s)
            team.heal()
            world.run(radio.AGAIN_S)
            team.check_reach()
            world.run(radio.ENDS_S + plan.calm_s)
    finally:
        told |= {**team.told, **_lives(team.hosts)}


def _lives(hosts):
    return {"lives": sum(host.lives for host in hosts)}


def _words(plan):
    how = ("sealed", "in_order", "serial", "multicast")
    return "".join(f", {name.replace('_', ' ')}" for name in how if getattr(plan, name, False))


KINDS = {"mesh": _mesh, "radio": _radio, "skin": _skin, "weeks": _weeks}
