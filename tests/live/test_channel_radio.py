"""A station's radio on a medium made of a process: what it says there, and what it passes on."""

import asyncio
import socket

import pytest

from innervate.live.channel_radio import (
    HEARD,
    HEARD_US,
    JOIN,
    LEASE_US,
    PLUG,
    SEND,
    MediumRadio,
    read_heard,
)
from innervate.live.engine import clock_us
from innervate.live.radio import Aerial
from tests.live import time_by_hand

STATION = 7


class Listener:
    def __init__(self):
        self.told = []

    def on_frame(self, at, frame):
        self.told.append(("frame", at, frame))

    def on_carrier(self, at, cd, voc):
        self.told.append(("carrier", at, cd, voc))

    def on_lost(self, at, cd, voc):
        self.told.append(("lost", at, cd, voc))


class Medium:
    """The socket of a medium, and a radio that is on it."""

    def __init__(self):
        self.socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self.socket.bind(("127.0.0.1", 0))
        self.socket.setblocking(False)
        self.listener = Listener()
        self.radio = MediumRadio(STATION, self.socket.getsockname())

    def said(self):
        """What the radio said since it was last asked."""
        found = []
        while True:
            try:
                data, self.where = self.socket.recvfrom(2048)
            except BlockingIOError:
                return found
            found.append(data)

    async def tell(self, what, at=0, cd=0, voc=0, frame=b""):
        """What the radio passes on of a message, times from now."""
        now = clock_us()
        self.socket.sendto(HEARD.pack(what, now + at, cd, voc) + frame, self.where)
        await asyncio.sleep(0.001)
        told, self.listener.told = self.listener.told, []
        return [(kind, when - now, *more) for kind, when, *more in told]

    async def tell_all(self, data):
        """What the radio passes on of a message as it is."""
        self.socket.sendto(data, self.where)
        await asyncio.sleep(0.001)
        return self.listener.told


def on_air(test):
    def run():
        async def main():
            medium = Medium()
            await medium.radio.start(medium.listener)
            try:
                await test(medium)
            finally:
                medium.radio.stop()
                medium.socket.close()

        time_by_hand.run(main())

    run.__name__ = test.__name__
    return run


def joined(plugged):
    return [JOIN.pack(b"J", STATION), PLUG.pack(b"P", STATION, plugged)]


@on_air
async def test_it_joins_again_every_second_and_says_whether_its_aerial_is_in(medium):
    assert medium.said() == joined(True)
    await asyncio.sleep(0.999)
    assert medium.said() == []
    await asyncio.sleep(0.002)
    assert medium.said() == joined(True)
    medium.radio.plug(False)
    assert medium.said() == [PLUG.pack(b"P", STATION, 0)]
    await asyncio.sleep(1)
    assert medium.said() == joined(False)
    medium.radio.plug(True)
    assert medium.said() == [PLUG.pack(b"P", STATION, 1)]
    medium.radio.stop()
    await asyncio.sleep(3)
    assert medium.said() == []
    assert medium.radio.mode == "off"
    medium.radio.plug(False)  # it is off: remembered, and not said
    assert (medium.said(), medium.radio.plugged) == ([], False)


@on_air
async def test_what_is_heard_is_passed_on_with_its_time(medium):
    medium.said()
    assert await medium.tell(b"C", -5, 1, 1) == [("carrier", -5, True, True)]
    assert await medium.tell(b"C", 0, 1, 0) == [("carrier", 0, True, False)]
    assert await medium.tell(b"C", 9, 0, 0) == [("carrier", 9, False, False)]
    assert await medium.tell(b"F", 0, 1, 1, b"frame") == [("frame", 0, b"frame")]


@on_air
async def test_while_it_sends_it_is_deaf_until_the_medium_says_that_it_listens(medium):
    medium.said()
    medium.radio.send(1234, b"frame", 3)
    assert medium.said() == [SEND.pack(b"T", STATION, 1234, 3) + b"frame"]
    assert medium.radio.mode == "sending"
    assert await medium.tell(b"C", 0, 1, 1) == []
    assert await medium.tell(b"F", 0, 1, 1, b"other") == []
    assert await medium.tell(b"R", 0, 1, 0) == [("carrier", 0, True, False)]
    assert medium.radio.mode == "listening"
    assert await medium.tell(b"F", 0, 1, 1, b"other") == [("frame", 0, b"other")]


@on_air
async def test_a_medium_that_knows_nothing_of_a_frame_has_lost_it(medium):
    medium.said()
    assert await medium.tell(b"L", 0, 1, 0) == [("carrier", 0, True, False)]  # it sent nothing
    medium.radio.send(1234, b"frame", 3)
    assert await medium.tell(b"L", 0, 1, 0) == [("lost", 0, True, False)]
    assert medium.radio.mode == "listening"
    assert await medium.tell(b"L", 0, 0, 0) == [("carrier", 0, False, False)]


@on_air
async def test_what_happened_too_long_ago_for_a_clock_of_30_bits_is_left_out(medium):
    medium.said()
    await asyncio.sleep(1000)
    medium.said()
    assert len(await medium.tell(b"C", HEARD_US - 10)) == 1
    assert await medium.tell(b"C", HEARD_US + 10_000) == []
    assert len(await medium.tell(b"C", -HEARD_US + 10_000)) == 1
    assert await medium.tell(b"C", -HEARD_US - 10) == []
    assert HEARD_US == 2**28


@pytest.mark.parametrize("data", [
    b"", HEARD.pack(b"C", 0, 0, 0)[:-1], HEARD.pack(b"X", 0, 0, 0), HEARD.pack(b"C", 0, 2, 0),
    HEARD.pack(b"C", 0, 0, 1), HEARD.pack(b"C", 0, 2, 2),
], ids=repr)  # fmt: skip
def test_what_no_medium_says_is_nothing(data):
    assert read_heard(data) is None


@pytest.mark.parametrize("what", [b"C", b"R", b"L", b"F"])
@pytest.mark.parametrize(("cd", "voc"), [(0, 0), (1, 0), (1, 1)])
def test_what_a_medium_says_is_read(what, cd, voc):
    data = HEARD.pack(what, 2**40, cd, voc) + b"frame"
    assert read_heard(data) == (what, 2**40, bool(cd), bool(voc), b"frame")


@on_air
async def test_who_else_is_on_the_channel_is_known_while_it_says_so(medium):
    medium.said()
    assert medium.radio.others() == []
    assert await medium.tell_all(b"W\0\1\0\7\3\xff") == []
    assert medium.radio.others() == [1, 1023]
    await asyncio.sleep(LEASE_US / 1e6)
    assert medium.radio.others() == []


@on_air
async def test_a_path_is_up_while_the_channel_answers(medium):
    medium.said()
    path = Aerial(medium.radio, "medium here")
    assert (path.up, path.trouble) == (True, "")  # it has just been asked
    await asyncio.sleep(LEASE_US / 1e6)
    assert (path.up, path.trouble) == (False, "medium here: no answer; trying again")
    medium.said()
    await medium.tell(b"C")
    assert (path.up, path.trouble) == (True, "")
    assert Aerial(object(), "a modem that cannot know").up
