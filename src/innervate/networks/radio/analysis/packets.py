"""Which packets of a radio run count as delivered, as settled, as timed; and what was offered."""

from typing import Any

import numpy as np

from innervate.networks.radio.analysis.air import off_times

WARM_UP = 10  # in saturation one in so many successes is left out


def successes(result: Any) -> Any:
    """Packets that were delivered, in the order in which their frames ended."""
    packets = result.packets[result.packets["receivers"] > 0]
    return packets[np.argsort(packets["end"], kind="stable")]


def settled(result: Any) -> Any:
    """The successes that means are made of: in saturation without the first tenth."""
    found = successes(result)
    return found[len(found) // WARM_UP :] if result.plan.saturated else found


def timed(result: Any) -> Any:
    """The settled successes whose robots were on from the offer to the end of the frame.

    What a switched-off robot keeps waits for its return, not for the channel: it has no delay.
    """
    steady = settled(result)
    stayed = np.ones(len(steady), np.bool_)
    for node, spans in enumerate(off_times(result)):
        for begun, ended in spans.tolist():
            met = (steady["offered"] < ended) & (steady["end"] > begun)
            stayed &= ~(met & (steady["node"] == node))
    return steady[stayed]


def traffic_of(plan: Any) -> str:
    """What stations had to send: "saturated", "disaster" (one packet each) or "poisson".

    Poisson traffic may be so thin that nobody has more than a packet: then the scenario says it.
    """
    if plan.saturated:
        return "saturated"
    if plan.scenario is not None and plan.scenario.model.traffic.kind == "poisson":
        return "poisson"
    return "disaster" if max(map(len, plan.arrivals), default=0) <= 1 else "poisson"


def first_offer_us(result: Any) -> int:
    """When the first packet was offered."""
    offers = [times[0] for times in result.plan.arrivals if len(times)]
    return min(offers, default=0)
