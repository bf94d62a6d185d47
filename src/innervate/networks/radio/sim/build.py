"""From a radio plan to a world: which records its stations have, and what may be checked of it."""

from typing import Any

from innervate.networks.radio.protocol import fields
from innervate.networks.radio.sim.stacks import PROTOCOLS
from innervate.sim.channel import build as channel
from innervate.sim.channel.world import World
from innervate.sim.recorded import Recorded
from innervate.sim.tables import put


def build(plan: Any, plain: bool, room: int | None = None, **kept: bool) -> World:
    """The world of a plan, before its first event; `kept` as in `sim.recorded`."""
    station, asked = fields.STATION + PROTOCOLS[plan.protocol].fields, Recorded(**kept)
    records = channel.Records(station, fields.PARAMS, fields.FRAME, fields.PACKET)
    world = channel.build(plan, records, plain, asked, room)
    put(world.run, 0, exclusive=int(asked.checks and _is_orderly(plan)))
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
