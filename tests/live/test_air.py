"""A medium takes nothing that no station sends, and tells of the carrier as it is."""

import asyncio

import pytest

from innervate.live.channel_radio import JOIN, PLUG, SEND
from innervate.live.engine import clock_us
from tests.live import time_by_hand
from tests.live.noted import HERE, THERE, Noted


@pytest.mark.parametrize(
    "data",
    [
        b"", b"J", JOIN.pack(b"J", 1) + b"x", JOIN.pack(b"X", 1), b"P", PLUG.pack(b"P", 0, 2),
        PLUG.pack(b"P", 1, 0), PLUG.pack(b"P", 0, 0) + b"x", PLUG.pack(b"X", 0, 0), b"T",
        SEND.pack(b"T", 0, 0, 1), SEND.pack(b"X", 0, 0, 1) + b"x", b"\xff" * 40,
    ],
)  # fmt: skip
def test_what_no_station_sends_is_counted_and_nothing_else(data):
    async def main():
        air = Noted()
        air.join(0)
        air.told.clear()
        air.medium.take(data, HERE)
        return air.medium.unsound, air.told, list(air.medium._ears), len(air.medium.log)

    assert time_by_hand.run(main()) == (1, [], [0], 0)


@pytest.mark.parametrize("late_us", [0, 1])
def test_the_next_frame_begins_where_the_last_has_ended(late_us):
    async def main():
        air = Noted()
        air.join(0)
        assert air.send(0, slots=3)
        (first,) = air.medium.log
        now = first[1] - air.medium.turnaround_us - late_us
        await asyncio.sleep((now - clock_us()) / 1e6)
        return air.send(0, late_us=clock_us() - now)

    assert time_by_hand.run(main()) is not bool(late_us)


def test_who_joins_is_told_what_is_on_the_air():
    async def main():
        air = Noted()
        air.join(0)
        air.send(0, slots=9)
        await asyncio.sleep(0.01)
        air.told.clear()
        air.join(1, THERE)
        return [one[:1] + one[2:] for one in air.told]

    assert time_by_hand.run(main()) == [("L", True, True, 10)]


def plugs(*given, while_sending=False):
    """What a station is told whose plug goes in and out at once, and once again later."""

    async def main():
        air = Noted()
        air.join(0)
        air.join(1, THERE)
        air.send(1, slots=50, where=THERE)
        if while_sending:
            air.send(0, slots=3)
        await asyncio.sleep(0.01)
        air.told.clear()
        air.began = clock_us()
        for plugged in given:
            air.medium.take(PLUG.pack(b"P", 0, plugged), HERE)
        await asyncio.sleep(0.05)
        return [one for one in air.told if one[4] == 9]

    return time_by_hand.run(main())


def test_a_plug_that_flickers_is_told_of_once_a_slot():
    out, again = ("C", 0, False, False, 9), ("C", 10_000, True, True, 9)
    assert plugs(0) == [out]
    assert plugs(0, 1) == plugs(0, 1, 0, 1) == [out, again]
    assert plugs(0, 1, 0) == [out, ("C", 10_000, False, False, 9)]
    assert plugs(0, 0) == [out]
    assert plugs(1) == []


def test_who_sends_is_not_told_of_its_plug_but_hears_when_it_listens_again():
    assert [one[:1] + one[2:] for one in plugs(0, while_sending=True)] == [("R", False, False, 9)]
    told = plugs(while_sending=True)
    assert [one[0] for one in told] == ["R"]
    assert told[0][2] is True
