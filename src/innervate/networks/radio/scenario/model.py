"""The keys of a radio scenario, each with its range and meaning (see keys.py).

What one key alone cannot show is checked in rules.py.
"""

from typing import TYPE_CHECKING, Annotated, Literal

from msgspec import Meta

from innervate.networks.radio.scenario.baselines import NUMBERS, Answers, ReceivedBy
from innervate.scenario import keys
from innervate.scenario.actions.channel import WORDS

MACS = ("csma-cd-r", *NUMBERS)
Station = Annotated[int, Meta(ge=0, le=1022, description="a station, counted from 0")]
# Words that tables give a type, which a type checker cannot see.
if TYPE_CHECKING:
    Mac = str
    Action = str
else:
    Mac, Action = Literal[MACS], Literal[tuple(WORDS)]


class TrafficTable(keys.Table, frozen=True, kw_only=True):
    """[traffic]: when stations have packets."""

    kind: Literal["saturated", "disaster", "poisson"] = "disaster"
    load: Annotated[
        float,
        Meta(gt=0, le=100, description="packets per packet time of all stations, > 0, at most 100"),
    ] = 0.3
    spread_us: Annotated[int, keys.whole("microseconds", 0, limit=60_000_000)] = 0
    packets: Annotated[
        int, Meta(ge=1, le=10_000_000, description="packets per station, a whole number from 1")
    ] = 100
    start_s: Annotated[float, keys.number("seconds", 0, limit=100_000)] = 0.1


class ChannelTable(keys.Table, frozen=True, kw_only=True):
    """[channel]: the radio channel that all share [radio 2, 3]."""

    level: Literal["slotted", "event"] = "event"
    bit_rate: Annotated[int, keys.whole("bit/s", 1000, 1_000_000)] = 38_400
    # Ranges are checked in rules.py: msgspec 0.22 crashes on limits in a union with a tuple.
    tau_us: Annotated[
        int | tuple[int, int],
        Meta(description="a whole number of microseconds from 1, or a range [least, most]"),
    ] = (52, 104)
    turnaround_us: Annotated[int, keys.whole("microseconds", 0, 100_000)] = 0
    loss: Annotated[
        float, Meta(ge=0, le=1, description="share of frames that a receiver cannot read, 0 to 1")
    ] = 0.0
    hidden: Annotated[
        list[tuple[Station, Station]],
        Meta(description="a list of pairs of stations that do not hear each other, [[0, 3]]"),
    ] = []


class MediumAccessTable(keys.Table, frozen=True, kw_only=True):
    """[protocol] of a radio: which protocol, and its settings [radio 4, 9]."""

    mac: Mac = "csma-cd-r"
    mode: Literal["paper", "practical"] = "practical"
    tau_bounds_us: Annotated[
        tuple[keys.Micros, keys.Micros] | None,
        Meta(description="two numbers of microseconds, [least, most]"),
    ] = None
    turns: Annotated[int, keys.whole("turns", 1, 65_535)] = 20
    per_turn: Annotated[int, keys.whole("packets", 1, 8)] = 1
    wait_us: keys.Micros = 0
    p: Annotated[float, Meta(gt=0, le=1, description="a probability > 0, at most 1")] = 0.1
    cw_min: Annotated[int, keys.whole("slots", 1, 1024)] = 32
    cw_max: Annotated[int, keys.whole("slots", 1, 32_768)] = 1024
    backoff_slots: Annotated[int, keys.whole("slots", 1, 1000)] = 1
    received_by: ReceivedBy = "anybody"
    answers: Answers = "instant"
    reading: Literal["A", "B"] = "A"


class RadioEventTable(keys.Table, frozen=True, kw_only=True):
    """[[event]]: what happens to a station, and when."""

    at_s: keys.When
    action: Action
    station: Annotated[int | str, Meta(description='a station from 0, or "random"')]
    frames: Annotated[int | None, Meta(description="a whole number of CR-Rs, 1 to 1000000")] = None


class RadioScenario(keys.Scenario, frozen=True, kw_only=True):
    """A scenario of kind "radio"; its tables are built as Radio.Traffic, Radio.Event and so on."""

    Traffic = TrafficTable
    Channel = ChannelTable
    Protocol = MediumAccessTable
    Event = RadioEventTable

    kind: Literal["radio"] = "radio"
    duration_s: Annotated[float, keys.above_0("seconds", limit=100_000)] = 60.0
    stations: Annotated[int, keys.whole("stations", 1, 1023)] = 10
    packet_slots: Annotated[
        int | tuple[int, int],
        Meta(description="a whole number of slots, 3 to 250, or a range [least, most]"),
    ] = 25
    traffic: TrafficTable = TrafficTable()
    channel: ChannelTable = ChannelTable()
    protocol: MediumAccessTable = MediumAccessTable()
    event: list[RadioEventTable] = []
