"""When each station is offered packets, and how long they are; from named streams."""

from innervate.networks.radio.scenario.model import RadioScenario
from innervate.networks.radio.scenario.rules import pair
from innervate.trace.streams import Stream, stream

ONE = 1 << 30
SIZES = 1024  # lengths repeat after so many packets of a station
OFFERS_MAX = 2_000_000


def exponential(draw: Stream, mean_us: int) -> int:
    """An exponentially distributed time in us, by comparing whole numbers only (von Neumann).

    No logarithm, so it is the same on any machine.
    """
    whole = 0
    while True:
        first = draw.draw(ONE)
        last, accepted = first, True
        while True:
            following = draw.draw(ONE)
            if following >= last:
                break
            last, accepted = following, not accepted
        if accepted:
            return ((whole << 30) + first) * mean_us >> 30
        whole += 1


def sizes(model: RadioScenario) -> list[list[int]]:
    """Per station, the lengths of its packets in turn, slots."""
    least, most = pair(model.packet_slots)
    if least == most:
        return [[least] for _ in range(model.stations)]
    draws = [stream(model.seed, f"sizes/{i}") for i in range(model.stations)]
    return [[draw.uniform(least, most) for _ in range(SIZES)] for draw in draws]


def mean_interval_us(model: RadioScenario, slot_us: int) -> int:
    """Mean time between two packets of one station with Poisson traffic, us."""
    least, most = pair(model.packet_slots)
    packet_us = slot_us * (least + most) / 2
    return max(1, round(packet_us * model.stations / model.traffic.load))


def arrivals(model: RadioScenario, slot_us: int, duration_us: int) -> list[list[int]]:
    """Per station, ascending moments at which a packet is offered, us."""
    traffic = model.traffic
    start = round(traffic.start_s * 1e6)
    if traffic.kind == "saturated":
        return [[] for _ in range(model.stations)]
    draws = [stream(model.seed, f"arrivals/{i}") for i in range(model.stations)]
    if traffic.kind == "disaster":
        return [[start + draw.uniform(0, traffic.spread_us)] for draw in draws]
    mean = mean_interval_us(model, slot_us)
    return [_poisson(draw, start, mean, duration_us) for draw in draws]


def _poisson(draw: Stream, start_us: int, mean_us: int, duration_us: int) -> list[int]:
    times = []
    at = start_us + exponential(draw, mean_us)
    while at < duration_us:
        times.append(at)
        at += max(1, exponential(draw, mean_us))
    return times
