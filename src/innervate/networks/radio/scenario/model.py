"""The keys of a radio scenario, each with its range and meaning (see model.py).

What one key alone cannot show is checked in radio_rules.py.
"""

from __future__ import annotations

from typing import Annotated, Literal

from msgspec import Meta, Struct

from innervate.scenario.keys import SCHEMA, Micros

MACS = (
    "csma-cd-r", "csma-cd-d1", "csma-cd-d2", "csma-cd-d2p", "slotted-aloha", "nonpersistent",
    "p-persistent", "dcf", "tree", "tdma", "token-ring", "polling",
)  # fmt: skip
Mac = Literal[
    "csma-cd-r", "csma-cd-d1", "csma-cd-d2", "csma-cd-d2p", "slotted-aloha", "nonpersistent",
    "p-persistent", "dcf", "tree", "tdma", "token-ring", "polling",
]  # fmt: skip
Station = Annotated[int, Meta(ge=0, le=1022, description="a station, counted from 0")]


class TrafficTable(Struct, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """[traffic]: when stations have packets."""

    kind: Annotated[
        Literal["saturated", "disaster", "poisson"],
        Meta(description='"saturated", "disaster" or "poisson"'),
    ] = "disaster"
    load: Annotated[
        float,
        Meta(gt=0, le=100, description="packets per packet time of all stations, > 0, at most 100"),
    ] = 0.3
    spread_us: Annotated[
        int, Meta(ge=0, le=60_000_000, description="a whole number of microseconds from 0")
    ] = 0
    packets: Annotated[
        int,
        Meta(ge=1, le=10_000_000, description="packets per station, a whole number from 1"),
    ] = 100
    start_s: Annotated[float, Meta(ge=0, le=100_000, description="a number of seconds from 0")] = (
        0.1
    )


class ChannelTable(Struct, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """[channel]: the radio channel that all share [radio 2, 3]."""

    level: Annotated[Literal["slotted", "event"], Meta(description='"slotted" or "event"')] = (
        "event"
    )
    bit_rate: Annotated[
        int,
        Meta(ge=1000, le=1_000_000, description="a whole number of bit/s, 1000 to 1000000"),
    ] = 38_400
    # Ranges are checked in radio_rules.py: msgspec 0.22 crashes on limits in a union with a tuple.
    tau_us: Annotated[
        int | tuple[int, int],
        Meta(description="a whole number of microseconds from 1, or a range [least, most]"),
    ] = (52, 104)
    turnaround_us: Annotated[
        int, Meta(ge=0, le=100_000, description="a whole number of microseconds, 0 to 100000")
    ] = 0
    loss: Annotated[
        float, Meta(ge=0, le=1, description="share of frames that a receiver cannot read, 0 to 1")
    ] = 0.0
    hidden: Annotated[
        list[tuple[Station, Station]],
        Meta(description="a list of pairs of stations that do not hear each other, [[0, 3]]"),
    ] = []


class MediumAccessTable(Struct, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """[protocol] of a radio: which protocol, and its settings [radio 4, 9]."""

    mac: Annotated[
        Mac, Meta(description=", ".join(f'"{mac}"' for mac in MACS[:-1]) + f' or "{MACS[-1]}"')
    ] = "csma-cd-r"
    mode: Annotated[Literal["paper", "practical"], Meta(description='"paper" or "practical"')] = (
        "practical"
    )
    tau_bounds_us: Annotated[
        tuple[Micros, Micros] | None,
        Meta(description="two numbers of microseconds, [least, most]"),
    ] = None
    turns: Annotated[
        int, Meta(ge=1, le=65_535, description="a whole number of turns, 1 to 65535")
    ] = 20
    per_turn: Annotated[int, Meta(ge=1, le=7, description="a whole number of packets, 1 to 7")] = 1
    wait_us: Micros = 0
    p: Annotated[float, Meta(gt=0, le=1, description="a probability > 0, at most 1")] = 0.1
    cw_min: Annotated[
        int, Meta(ge=1, le=1024, description="a whole number of slots, 1 to 1024")
    ] = 32
    cw_max: Annotated[
        int, Meta(ge=1, le=32_768, description="a whole number of slots, 1 to 32768")
    ] = 1024
    backoff_slots: Annotated[
        int, Meta(ge=1, le=1000, description="a whole number of slots, 1 to 1000")
    ] = 1
    reading: Annotated[Literal["A", "B"], Meta(description='"A" or "B"')] = "A"


RadioAction = Literal["join", "leave", "kill", "revive", "garble", "fade"]


class RadioEventTable(Struct, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """[[event]]: what happens to a station, and when."""

    at_s: Annotated[
        float | tuple[float, float],
        Meta(description="a number of seconds from 0, or a range [from, to]"),
    ]
    action: Annotated[
        RadioAction,
        Meta(description='"join", "leave", "kill", "revive", "garble" or "fade"'),
    ]
    station: Annotated[int | str, Meta(description='a station from 0, or "random"')]
    frames: Annotated[int | None, Meta(description="a whole number of CR-Rs, 1 to 1000000")] = None


class RadioScenario(Struct, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """A scenario of kind "radio"."""

    kind: Annotated[Literal["radio"], Meta(description='"radio"')]
    schema: Annotated[int, Meta(ge=1, description="a whole number from 1")] = SCHEMA
    name: Annotated[str, Meta(max_length=200, description="a string of at most 200 characters")] = (
        ""
    )
    duration_s: Annotated[float, Meta(gt=0, le=100_000, description="a number of seconds > 0")] = (
        60.0
    )
    seed: Annotated[int, Meta(ge=0, description="a whole number from 0")] = 1
    stations: Annotated[
        int, Meta(ge=1, le=1023, description="a whole number of stations, 1 to 1023")
    ] = 10
    packet_slots: Annotated[
        int | tuple[int, int],
        Meta(description="a whole number of slots, 3 to 250, or a range [least, most]"),
    ] = 25
    traffic: Annotated[TrafficTable, Meta(description="a table [traffic]")] = TrafficTable()
    channel: Annotated[ChannelTable, Meta(description="a table [channel]")] = ChannelTable()
    protocol: Annotated[MediumAccessTable, Meta(description="a table [protocol]")] = (
        MediumAccessTable()
    )
    event: Annotated[list[RadioEventTable], Meta(description="tables [[event]]")] = []
