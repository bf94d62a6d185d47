"""A radio modem at a serial line: a board at its other end is a station on a channel of processes.

Frames between zeros (COBS), as on any serial line; numbers have their lowest byte first. To the
board: `C`, cd, voc, age: the carrier came or went so many microseconds ago; `F`, age, frame. From
it: `T`, age, slots, frame: it decided so long ago to send this. Ages, so that the two clocks need
not know each other.
"""

import asyncio
import struct

from innervate.live.channel_radio import MediumRadio
from innervate.live.engine import clock_us
from innervate.live.links import Path
from innervate.live.nodefile import address
from innervate.live.serial import SerialLink

CARRIER = struct.Struct("<cBBI")
FRAME = struct.Struct("<cI")
SEND = struct.Struct("<cIH")
AGE_MAX = 1 << 28  # us; the board's clock has 30 bits


class Modem:
    """Carries what the board behind a link and the channel of a radio say to each other.

    Attributes:
        unsound: frames of the board that were none.
    """

    def __init__(self, link: SerialLink, radio: MediumRadio) -> None:
        self.link, self.radio = link, radio
        self.unsound = 0

    async def start(self) -> None:
        """Open the line, then join the channel."""
        await self.link.open(self._said)
        await self.radio.start(self)

    def stop(self) -> None:
        """Leave the channel, close the line."""
        self.radio.stop()
        self.link.close()

    def on_carrier(self, at: int, cd: bool, voc: bool) -> None:
        """The carrier came or went, or the radio listens again."""
        self.link.path.send(CARRIER.pack(b"C", cd, voc, _age(at)))

    def on_lost(self, at: int, cd: bool, voc: bool) -> None:
        """What the board sent did not go out: to it it has collided, and that is over."""
        self.on_carrier(at, True, False)
        self.on_carrier(at, cd, voc)

    def on_frame(self, at: int, data: bytes) -> None:
        """The radio received a frame."""
        self.link.path.send(FRAME.pack(b"F", _age(at)) + data)

    def _said(self, path: Path, data: bytes) -> None:
        if len(data) <= SEND.size or data[:1] != b"T":
            self.unsound += 1
            return
        _, age, slots = SEND.unpack_from(data)
        self.radio.send(clock_us() - min(age, AGE_MAX), data[SEND.size :], slots)


def _age(at: int) -> int:
    return min(max(0, clock_us() - at), AGE_MAX)


async def run(device: str, baud: int, number: int, medium: str) -> None:
    """A modem until it is cancelled.

    Raises:
        LiveError: the line has no such speed, or the channel's address is none.
    """
    modem = Modem(SerialLink(device, baud), MediumRadio(number, address(medium, "modem")))
    await modem.start()
    print(f"modem: {device} is station {number} of {medium}", flush=True)
    if modem.link.path.trouble:
        print(f"modem: {modem.link.path.trouble}", flush=True)
    try:
        await asyncio.Event().wait()
    finally:
        modem.stop()
