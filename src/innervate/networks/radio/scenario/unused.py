"""Settings that an event-level run does not use, by protocol and traffic.

They are told, not refused as the slotted level's are: a sweep over protocols gives some of them
what others have no use for.
"""

from collections.abc import Iterator

from innervate.networks.radio.scenario.model import (
    ChannelTable,
    MediumAccessTable,
    RadioScenario,
    TrafficTable,
)
from innervate.networks.radio.scenario.slotted import BACKOFF, BY_CHANCE

DEFAULTS = {
    "channel": ChannelTable(),
    "protocol": MediumAccessTable(),
    "traffic": TrafficTable(),
}


def unused(model: RadioScenario) -> list[str]:
    """Keys that are set to something else than their default, and for nothing."""
    return [
        f"{table}.{name}"
        for table, name, is_used in _uses(model)
        if not is_used and getattr(getattr(model, table), name) != getattr(DEFAULTS[table], name)
    ]


def _uses(model: RadioScenario) -> Iterator[tuple[str, str, bool]]:
    """(table, key, whether this protocol and this traffic use it)."""
    mac, mode, kind = model.protocol.mac, model.protocol.mode, model.traffic.kind
    ours = mac == "csma-cd-r"
    yield "channel", "turnaround_us", mac != "csma-cd-d1"  # a cable's transceiver has none
    yield "protocol", "mode", ours
    yield "protocol", "turns", ours and mode == "practical"
    yield "protocol", "wait_us", ours and mode == "paper"
    yield "protocol", "p", mac in BY_CHANCE
    yield "protocol", "cw_min", mac == "dcf"
    yield "protocol", "cw_max", mac == "dcf"
    yield "protocol", "backoff_slots", mac == "dcf" or mac in BACKOFF
    yield "protocol", "reading", False  # the slotted level's alone
    lasts = any(event.action in ("kill", "leave") for event in model.event)
    yield "traffic", "packets", kind == "saturated" and not lasts
    yield "traffic", "load", kind == "poisson"
    yield "traffic", "start_s", kind != "saturated"
