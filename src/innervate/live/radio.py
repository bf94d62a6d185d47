"""A radio as a live node has one: it sends and hears frames on a shared channel.

It has a carrier-detect line, and listens or not. The one in channel.py is on a channel made of a
process; a serial modem with such a line is another.
"""

from typing import Protocol

from innervate.live.links import Path


class Listener(Protocol):
    """Who a radio tells what it hears; times are microseconds of the driver's clock."""

    def on_carrier(self, at: int, cd: bool, voc: bool) -> None:
        """The carrier came or went, or the radio listens again: cd = somebody, voc = just one."""

    def on_lost(self, at: int, cd: bool, voc: bool) -> None:
        """The radio listens again, and what it sent last was not on the air for all to hear."""

    def on_frame(self, at: int, data: bytes) -> None:
        """A frame was received whole; the carrier's end is told after it."""


class Radio(Protocol):
    """A half-duplex radio.

    One that knows who else is on its channel says so by `others()`, and whether it has one by
    `is_there()`.

    Attributes:
        mode: "off", "listening" or "sending"; while it sends and turns round it is deaf.
    """

    mode: str

    async def start(self, listener: Listener) -> None:
        """Switch it on; it tells the listener at once whether there is a carrier."""

    def send(self, at: int, data: bytes, slots: int) -> None:
        """Decide at `at` to send: a frame that lasts so many slots, after a turnaround."""

    def plug(self, plugged: bool) -> None:
        """Pull the aerial's plug, or push it in: without it nothing is heard, nor does it reach."""

    def stop(self) -> None:
        """Switch the radio off: nothing is heard or sent any more."""


class Aerial(Path):
    """The one path of a station, up while its channel is there; cut, it neither hears nor sends."""

    def __init__(self, radio: Radio, name: str) -> None:
        self._radio = radio
        self._is_cut = False
        super().__init__(name, 0)

    @property
    def up(self) -> bool:
        """False while the radio knows that there is no channel."""
        return bool(getattr(self._radio, "is_there", lambda: True)())

    @up.setter
    def up(self, up: bool) -> None:
        """Only the radio knows whether there is a channel."""

    @property
    def trouble(self) -> str:
        """That there is no channel, as far as the radio knows."""
        return "" if self.up else f"{self.name}: no answer; trying again"

    @trouble.setter
    def trouble(self, trouble: str) -> None:
        """What the radio knows is said, and nothing else."""

    @property
    def cut(self) -> bool:
        """True = its plug is out."""
        return self._is_cut

    @cut.setter
    def cut(self, cut: bool) -> None:
        if cut != self._is_cut:
            self._is_cut = cut
            self._radio.plug(not cut)
