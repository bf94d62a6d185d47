"""What the keys of a radio scenario must fulfil together."""

from __future__ import annotations

from innervate.scenario import radio_slotted
from innervate.scenario.radio_model import RadioEventTable, RadioScenario
from innervate.scenario.source import Source
from innervate.scenario.times import check_end

PACKET_SLOTS = (3, 250)
DELAY_US = (1, 1000)
POSITIONS = 120


def check(source: Source, model: RadioScenario) -> None:
    """Raise ScenarioError at the first thing that does not fit together."""
    _number(source, ("packet_slots",), model.packet_slots, PACKET_SLOTS, "slots")
    _number(source, ("channel", "tau_us"), model.channel.tau_us, DELAY_US, "microseconds")
    _channel(source, model)
    _protocol(source, model)
    _traffic(source, model)
    for index, event in enumerate(model.event):
        _event(source, model, index, event)
    if model.channel.level == "slotted":
        radio_slotted.check(source, model)


def pair(value: int | tuple[int, int]) -> tuple[int, int]:
    """[least, most] of a number or a range."""
    return value if isinstance(value, tuple) else (value, value)


def _number(
    source: Source,
    key: tuple[str, ...],
    value: int | tuple[int, int],
    limits: tuple[int, int],
    unit: str,
) -> None:
    least, most = pair(value)
    name = ".".join(key)
    if least > most:
        raise source.error(key, f"{name} must be [least, most], not [{least}, {most}]")
    if least < limits[0] or most > limits[1]:
        wrong = least if least < limits[0] else most
        message = f"{name} must be {limits[0]} to {limits[1]} {unit}, not {wrong}"
        raise source.error(key, message)


def _no_station(model: RadioScenario, number: int) -> str:
    return f"there is no station {number}; they are numbered 0 to {model.stations - 1}"


def _channel(source: Source, model: RadioScenario) -> None:
    for index, (a, b) in enumerate(model.channel.hidden):
        key = ("channel", "hidden", index)
        if max(a, b) >= model.stations:
            raise source.error(key, _no_station(model, max(a, b)))
        if a == b:
            raise source.error(key, f"station {a} cannot be hidden from itself; name two")


def _protocol(source: Source, model: RadioScenario) -> None:
    protocol = model.protocol
    if protocol.cw_min > protocol.cw_max:
        message = f"protocol.cw_min = {protocol.cw_min} is above cw_max = {protocol.cw_max}"
        raise source.error(("protocol", "cw_min"), message)
    bounds = protocol.tau_bounds_us
    if bounds is not None and not 1 <= bounds[0] <= bounds[1]:
        message = f"protocol.tau_bounds_us must be [least, most] from 1, not {list(bounds)}"
        raise source.error(("protocol", "tau_bounds_us"), message)
    practical = protocol.mac == "csma-cd-r" and protocol.mode == "practical"
    if practical and model.channel.level == "event":
        least, most = bounds or pair(model.channel.tau_us)
        if most > 2 * least:
            raise source.error(
                ("protocol", "tau_bounds_us") if bounds else ("channel", "tau_us"),
                f"practical mode needs delays within a factor of two, not {least} to {most} us: "
                "the next turn could overtake the last one",
            )
        slot_us = 8 * round(1_000_000 / model.channel.bit_rate)
        if 2 * (most - least) >= slot_us:
            raise source.error(
                ("protocol", "tau_bounds_us") if bounds else ("channel", "tau_us"),
                f"practical mode needs delays that differ by less than half a slot "
                f"({slot_us // 2} us), not {least} to {most} us; CR-Rs would run together",
            )
        if model.stations > POSITIONS:
            raise source.error(
                ("stations",),
                f"practical mode has {POSITIONS} places in a round, too few for {model.stations} "
                "stations",
            )
    if protocol.per_turn > 1 and not (practical or protocol.mac in radio_slotted.EVENT_ONLY):
        message = (
            'protocol.per_turn goes with csma-cd-r in mode = "practical", token-ring and polling'
        )
        raise source.error(("protocol", "per_turn"), message)


def _traffic(source: Source, model: RadioScenario) -> None:
    traffic = model.traffic
    if traffic.spread_us and traffic.kind != "disaster":
        message = f'traffic.spread_us goes with kind = "disaster", not "{traffic.kind}"'
        raise source.error(("traffic", "spread_us"), message)
    begins = traffic.kind != "saturated" and model.channel.level == "event"
    if begins and traffic.start_s >= model.duration_s:
        message = f"traffic.start_s = {traffic.start_s:g} is after the end ({model.duration_s:g} s)"
        raise source.error(("traffic", "start_s"), message)


def _event(source: Source, model: RadioScenario, index: int, event: RadioEventTable) -> None:
    key = ("event", index)
    name = f"event.{index}"
    times = event.at_s if isinstance(event.at_s, tuple) else (event.at_s, event.at_s)
    if times[0] > times[1]:
        message = f"{name}.at_s must be [from, to], not [{times[0]:g}, {times[1]:g}]"
        raise source.error((*key, "at_s"), message)
    if not times[0] >= 0:
        message = f"{name}.at_s must be a number of seconds from 0, not {times[0]:g}"
        raise source.error((*key, "at_s"), message)
    check_end(source, index, times[1], model.duration_s)
    station = event.station
    if isinstance(station, str):
        if station != "random":
            message = f'{name}.station must be a station from 0, or "random", not "{station[:40]}"'
            raise source.error((*key, "station"), message)
    elif not 0 <= station < model.stations:
        raise source.error((*key, "station"), _no_station(model, station))
    if event.frames is not None:
        if event.action not in ("garble", "fade"):
            message = f'{name}.frames goes with "garble" and "fade", not "{event.action}"'
            raise source.error((*key, "frames"), message)
        if not 1 <= event.frames <= 1_000_000:
            message = f"{name}.frames must be 1 to 1000000, not {event.frames}"
            raise source.error((*key, "frames"), message)
