"""What of a scenario of RPL cannot work, told before it runs."""

from typing import Any

from innervate.networks.rpl import frames
from innervate.networks.rpl.protocol.kinds import ACK
from innervate.scenario.declared.field import sizes_of
from innervate.topology.placement import distances, neighbours

BITS = 8


def foreseen(plan: Any) -> list[str]:
    """A sentence for each thing; none if all is well."""
    air, params = plan.air, plan.params
    length = air.preamble_bytes + sizes_of(frames)[ACK]
    needed_us = air.turnaround_us + round(1e6 * BITS * length / air.bits_per_s)
    found = []
    if params["ack_us"] < needed_us:
        found.append(
            f"a hop's acknowledgement is there after {needed_us:,} us at the earliest, and "
            f"protocol.ack_us is {params['ack_us']:,}: every frame counts as lost; make it longer"
        )
    first_us = 1000 << params["dio_min"]
    if first_us // 2 > plan.duration_us:
        found.append(
            f"the root speaks after {first_us / 2e6:g} s at the earliest, and duration_s is "
            f"{plan.duration_us / 1e6:g}: nobody gets a way; make protocol.dio_min smaller"
        )
    if params["root"] < plan.nodes:
        hops = distances(neighbours(plan.nodes, plan.good), params["root"])
        if max(hops) > params["hops"]:
            far = sum(one > params["hops"] for one in hops)
            found.append(
                f"protocol.hops is {params['hops']}, and {far} of {plan.nodes} nodes "
                f"{'is' if far == 1 else 'are'} farther "
                f"from the root, up to {max(hops)} hops: no packet comes from there"
            )
    return found
