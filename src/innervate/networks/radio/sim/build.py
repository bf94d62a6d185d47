"""From a radio plan to a world: which records its stations have, and what may be checked of it."""

from __future__ import annotations

from typing import Any

from innervate.networks.radio.protocol import fields
from innervate.networks.radio.sim.stacks import PROTOCOLS
from innervate.sim.channel import build as channel
from innervate.sim.channel.world import World
from innervate.sim.tables import put


def build(
    plan: Any,
    plain: bool,
    checks: bool,
    keep: bool,
    trail: bool,
    tap: bool = False,
    room: int | None = None,
) -> World:
    """The world of a plan, before its first event; arguments as of `channel.build`."""
    station = fields.STATION + PROTOCOLS[plan.protocol].fields
    records = channel.Records(station, fields.PARAMS, fields.FRAME, fields.PACKET)
    world = channel.build(plan, records, plain, checks, keep, trail, tap, room)
    put(world.run, 0, exclusive=int(checks and _is_orderly(plan)))
    return world


def _is_orderly(plan: Any) -> bool:
    """Practical CSMA/CD-R on a channel as it assumes it: then no two turns ever overlap."""
    return (
        plan.protocol == "csma-cd-r/practical"
        and plan.loss_q15 == 0
        and not plan.faults
        and not plan.pairs.hidden
        and plan.pairs.within(plan.params["dmin_us"], plan.params["dmax_us"])
    )
