"""Which settings the slotted level of the radio uses; all others are refused there.

The slotted level counts slots: whole collisions, no delays, no events. A setting that it has no use
for would be read and never asked again, so a scenario that gives one is refused, whatever it says.
"""

from collections.abc import Collection, Iterator
from typing import Any

from innervate.networks.radio.scenario.model import RadioScenario
from innervate.scenario.events import Finding
from innervate.scenario.lines import Key
from innervate.scenario.source import Source

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
                                      "cw_min", "cw_max", "received_by", "answers")),
    *(("channel", name) for name in ("tau_us", "loss", "hidden")),
    *(("traffic", name) for name in ("spread_us", "start_s")),
)  # fmt: skip


def check(model: RadioScenario, given: Collection[Key]) -> Iterator[Finding]:
    """The settings that a slotted run would ignore, and why they are refused."""
    mac, unused = model.protocol.mac, unused_by(model.protocol.mac)
    if mac in EVENT_ONLY:
        yield ("protocol", "mac"), f'{mac} goes with level = "event"; the slotted level has none'
    for key in UNUSED:
        if key in given:
            name = ".".join(key)
            yield key, f'{name} goes with level = "event"; the slotted level has no use for it'
    for key, macs in USED_BY.items():
        if key in unused and key in given:
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


def unused_by(mac: str) -> list[tuple[str, str]]:
    """(table, key) of what a protocol has no use for on the slotted level."""
    return [*UNUSED, *(key for key, macs in USED_BY.items() if mac not in macs)]


def anchor(tables: dict[str, Any], source: Source) -> None:
    """Leave out of a scenario's tables what a slotted run would refuse to be given."""
    if tables["channel"]["level"] == "slotted":
        for table, name in unused_by(tables["protocol"]["mac"]):
            tables[table].pop(name, None)


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
