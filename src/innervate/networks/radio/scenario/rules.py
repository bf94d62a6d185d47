"""What the keys of a radio scenario must fulfil together."""

from collections.abc import Iterator

from innervate.networks.radio.scenario import slotted as radio_slotted
from innervate.networks.radio.scenario.model import RadioEventTable, RadioScenario
from innervate.scenario.actions.channel import TABLE
from innervate.scenario.events import Finding, in_order, in_time, own_keys, refuse
from innervate.scenario.lines import Key
from innervate.scenario.source import Source, dotted

PACKET_SLOTS = (3, 250)
DELAY_US = (1, 1000)
POSITIONS = 120


def check(source: Source, model: RadioScenario) -> None:
    """Raise ScenarioError at the first thing that does not fit together."""
    refuse(source, _findings(model, source))


def _findings(model: RadioScenario, source: Source) -> Iterator[Finding]:
    yield from _number(("packet_slots",), model.packet_slots, PACKET_SLOTS, "slots")
    yield from _number(("channel", "tau_us"), model.channel.tau_us, DELAY_US, "microseconds")
    yield from _channel(model)
    yield from _protocol(model)
    yield from _traffic(model)
    for index, event in enumerate(model.event):
        yield from _event(model, index, event)
    if model.channel.level == "slotted":
        yield from radio_slotted.check(model, source.given)


def pair(value: int | tuple[int, int]) -> tuple[int, int]:
    """[least, most] of a number or a range."""
    return value if isinstance(value, tuple) else (value, value)


def outside(model: RadioScenario) -> bool:
    """True if delays can be others than stations believe they are."""
    real, believed = pair(model.channel.tau_us), model.protocol.tau_bounds_us
    return believed is not None and (real[0] < believed[0] or real[1] > believed[1])


def _number(
    key: Key, value: int | tuple[int, int], limits: tuple[int, int], unit: str
) -> Iterator[Finding]:
    least, most = pair(value)
    yield from in_order(key, (least, most))
    if least < limits[0] or most > limits[1]:
        wrong = least if least < limits[0] else most
        yield key, f"{dotted(key)} must be {limits[0]} to {limits[1]} {unit}, not {wrong}"


def _no_station(model: RadioScenario, number: int) -> str:
    return f"there is no station {number}; they are numbered 0 to {model.stations - 1}"


def _channel(model: RadioScenario) -> Iterator[Finding]:
    for index, (a, b) in enumerate(model.channel.hidden):
        key = ("channel", "hidden", index)
        if max(a, b) >= model.stations:
            yield key, _no_station(model, max(a, b))
        if a == b:
            yield key, f"station {a} cannot be hidden from itself; name two"


def _protocol(model: RadioScenario) -> Iterator[Finding]:
    protocol = model.protocol
    if protocol.cw_min > protocol.cw_max:
        message = f"protocol.cw_min = {protocol.cw_min} is above cw_max = {protocol.cw_max}"
        yield ("protocol", "cw_min"), message
    bounds = protocol.tau_bounds_us
    if bounds is not None and not 1 <= bounds[0] <= bounds[1]:
        message = f"protocol.tau_bounds_us must be [least, most] from 1, not {list(bounds)}"
        yield ("protocol", "tau_bounds_us"), message
    practical = protocol.mac == "csma-cd-r" and protocol.mode == "practical"
    if practical and model.channel.level == "event":
        least, most = bounds or pair(model.channel.tau_us)
        if most > 2 * least:
            yield (
                ("protocol", "tau_bounds_us") if bounds else ("channel", "tau_us"),
                f"practical mode needs delays within a factor of two, not {least} to {most} us: "
                "the next turn could overtake the last one",
            )
        slot_us = 8 * round(1_000_000 / model.channel.bit_rate)
        if 2 * (most - least) >= slot_us:
            yield (
                ("protocol", "tau_bounds_us") if bounds else ("channel", "tau_us"),
                f"practical mode needs delays that differ by less than half a slot "
                f"({slot_us // 2} us), not {least} to {most} us; CR-Rs would run together",
            )
        if model.stations > POSITIONS:
            yield (
                ("stations",),
                f"practical mode has {POSITIONS} places in a round, too few for {model.stations} "
                "stations",
            )
    if protocol.per_turn > 1 and not (practical or protocol.mac in radio_slotted.EVENT_ONLY):
        message = (
            'protocol.per_turn goes with csma-cd-r in mode = "practical", token-ring and polling'
        )
        yield ("protocol", "per_turn"), message
    yield from _told(model)


def _told(model: RadioScenario) -> Iterator[Finding]:
    """Only who is told for nothing what became of its packet can be told of everybody."""
    protocol = model.protocol
    if protocol.received_by != "anybody" and protocol.mac in ("csma-cd-r", "csma-cd-d1"):
        message = (
            f"protocol.received_by goes with baselines whose senders are told who received their "
            f"packets, not {protocol.mac}"
        )
        yield ("protocol", "received_by"), message
    if protocol.answers != "instant" and protocol.mac != "dcf":
        yield ("protocol", "answers"), f"protocol.answers goes with dcf, not {protocol.mac}"


def _traffic(model: RadioScenario) -> Iterator[Finding]:
    traffic = model.traffic
    if traffic.spread_us and traffic.kind != "disaster":
        message = f'traffic.spread_us goes with kind = "disaster", not "{traffic.kind}"'
        yield ("traffic", "spread_us"), message
    begins = traffic.kind != "saturated" and model.channel.level == "event"
    if begins and traffic.start_s >= model.duration_s:
        message = f"traffic.start_s = {traffic.start_s:g} is after the end ({model.duration_s:g} s)"
        yield ("traffic", "start_s"), message


def _event(model: RadioScenario, index: int, event: RadioEventTable) -> Iterator[Finding]:
    key, name, station = ("event", index), f"event.{index}", event.station
    yield from in_time(index, event.at_s, model.duration_s)
    if isinstance(station, str):
        if station != "random":
            message = f'{name}.station must be a station from 0, or "random", not "{station[:40]}"'
            yield (*key, "station"), message
    elif not 0 <= station < model.stations:
        yield (*key, "station"), _no_station(model, station)
    yield from own_keys(index, event, TABLE)
    if event.frames is not None and not 1 <= event.frames <= 1_000_000:
        yield (*key, "frames"), f"{name}.frames must be 1 to 1000000, not {event.frames}"
