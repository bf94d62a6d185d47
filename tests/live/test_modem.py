"""What a radio modem says to its board and to its channel: ages in place of times."""

import asyncio

import pytest

from innervate.live.engine import clock_us
from innervate.live.links import Path
from innervate.live.modem import AGE_MAX, CARRIER, FRAME, SEND, Modem
from innervate.live.modem import run as run_modem
from tests.live import time_by_hand


class Line:
    """A serial line that keeps what is put on it."""

    def __init__(self):
        self.path, self.said = Path("line", 0), []
        self.path.send = self.said.append


class Radio:
    def __init__(self):
        self.sent = []

    def send(self, at, data, slots):
        self.sent.append((at, data, slots))


def modem():
    return Modem(Line(), Radio())


def run(what):
    """Call it once the clock is so far on that all ages can be."""

    async def main():
        return what()

    loop_began_us = 1_000_000_000
    assert loop_began_us > 2 * AGE_MAX
    return time_by_hand.run(main())


AGES = [(0, 0), (1, 1), (AGE_MAX, AGE_MAX), (AGE_MAX + 1, AGE_MAX), (-50, 0)]


@pytest.mark.parametrize(("ago_us", "age_us"), AGES)
@pytest.mark.parametrize(("cd", "voc"), [(False, False), (True, False), (True, True)])
def test_a_carrier_and_a_frame_are_told_with_how_long_ago_they_came(ago_us, age_us, cd, voc):
    def tell():
        one = modem()
        one.on_carrier(clock_us() - ago_us, cd, voc)
        one.on_frame(clock_us() - ago_us, b"frame")
        return one.link.said

    assert run(tell) == [CARRIER.pack(b"C", cd, voc, age_us), FRAME.pack(b"F", age_us) + b"frame"]


def test_to_a_board_what_was_lost_has_collided_and_that_is_over():
    def tell():
        one = modem()
        one.on_lost(clock_us() - 3, True, True)
        return one.link.said

    told = [CARRIER.pack(b"C", True, False, 3), CARRIER.pack(b"C", True, True, 3)]
    assert run(tell) == told


@pytest.mark.parametrize("age_us", [0, 1, AGE_MAX, AGE_MAX + 1, 2**32 - 1])
def test_what_a_board_sends_was_decided_so_long_ago(age_us):
    def tell():
        one = modem()
        one._said(one.link.path, SEND.pack(b"T", age_us, 7) + b"x")
        assert one.unsound == 0
        return [(clock_us() - at, data, slots) for at, data, slots in one.radio.sent]

    assert run(tell) == [(min(age_us, AGE_MAX), b"x", 7)]


@pytest.mark.parametrize("data", [b"", b"T", SEND.pack(b"T", 0, 1), SEND.pack(b"C", 0, 1) + b"x"])
def test_what_no_board_says_is_counted_and_not_sent(data):
    one = modem()
    one._said(one.link.path, data)
    assert (one.unsound, one.radio.sent) == (1, [])


def test_a_device_that_is_not_there_is_said(tmp_path, capsys):
    said = []

    async def main():
        running = asyncio.create_task(run_modem(str(tmp_path / "tty"), 115_200, 1, "127.0.0.1:9"))
        async with asyncio.timeout(3):
            while len(said) < 2:
                await asyncio.sleep(0)
                said.extend(capsys.readouterr().out.splitlines())
        running.cancel()

    asyncio.run(main())
    assert said[1] == f"modem: {tmp_path}/tty: No such file or directory; trying again"
