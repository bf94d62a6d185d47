"""Which settings the slotted level of the radio uses; all others are refused there.

The slotted level counts slots: whole collisions, no delays, no events. A setting that it has no use
for would be read and never asked again, so a scenario that changes one is refused.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from innervate.networks.radio.scenario.model import (
    ChannelTable,
    MediumAccessTable,
    RadioScenario,
    TrafficTable,
)
from innervate.scenario.events import Finding

TURNAROUND = frozenset({"csma-cd-r", "csma-cd-d2", "csma-cd-d2p"})
BACKOFF = frozenset({"csma-cd-d1", "csma-cd-d2", "csma-cd-d2p"})
BY_CHANCE = frozenset({"slotted-aloha", "nonpersistent", "p-persistent"})

# What only some protocols use there.
USED_BY = {
    ("protocol", "p"): BY_CHANCE,
    ("protocol", "reading"): frozenset({"csma-cd-r"}),
    ("protocol", "backoff_slots"): BACKOFF,
    ("channel", "turnaround_us"): TURNAROUND,
}
EVENT_ONLY = ("token-ring", "polling")
# What none uses.
UNUSED = (
    *(("protocol", name) for name in ("mode", "tau_bounds_us", "turns", "per_turn", "wait_us",
                                      "cw_min", "cw_max")),
    *(("channel", name) for name in ("tau_us", "loss", "hidden")),
    *(("traffic", name) for name in ("spread_us", "start_s")),
)  # fmt: skip
_DEFAULTS: dict[str, Any] = {
    "protocol": MediumAccessTable(),
    "channel": ChannelTable(),
    "traffic": TrafficTable(),
}


def check(model: RadioScenario) -> Iterator[Finding]:
    """The settings that a slotted run would ignore, and why they are refused."""
    mac = model.protocol.mac
    if mac in EVENT_ONLY:
        yield ("protocol", "mac"), f'{mac} goes with level = "event"; the slotted level has none'
    for key in UNUSED:
        if _is_changed(model, key):
            name = ".".join(key)
            yield key, f'{name} goes with level = "event"; the slotted level has no use for it'
    for key, macs in USED_BY.items():
        if mac not in macs and _is_changed(model, key):
            message = (
                f"{'.'.join(key)} goes with {', '.join(sorted(macs))} on the slotted level; "
                f"{mac} has no use for it there"
            )
            yield key, message
    if isinstance(model.packet_slots, tuple) and len(set(model.packet_slots)) > 1:
        message = 'a range of packet_slots goes with level = "event"; the slotted level takes one'
        yield ("packet_slots",), message
    if model.event:
        yield ("event", 0), 'events go with level = "event"; leave them out'


def _is_changed(model: RadioScenario, key: tuple[str, str]) -> bool:
    table, name = key
    return bool(getattr(getattr(model, table), name) != getattr(_DEFAULTS[table], name))


def words(model: RadioScenario, slot_us: int) -> tuple[str, str]:
    """(channel, protocol) of a slotted run in words: only what it uses."""
    protocol, mac = model.protocol, model.protocol.mac
    channel = f"slotted level, {model.channel.bit_rate:,} bit/s, a slot of {slot_us} us"
    if mac in TURNAROUND:
        channel += f", turnaround {model.channel.turnaround_us / 1000:g} ms"
    used = [
        f"{name.replace('_', ' ')} {getattr(protocol, name)}"
        for (table, name), macs in USED_BY.items()
        if table == "protocol" and mac in macs
    ]
    return channel, ", ".join([mac, *used])
