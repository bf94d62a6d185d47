"""A live node on a shared channel: a protocol over any `Radio` (see radio.py)."""

from typing import Any

from innervate.live.declared import DeclaredNode, DeclaredStack
from innervate.live.engine import NEVER
from innervate.live.errors import LiveError
from innervate.live.machine import machine
from innervate.live.node import LiveNode
from innervate.live.nodefile import Loaded, MediumTable, address
from innervate.live.radio import Aerial, Radio


class AirNode(LiveNode):
    """A node whose frames go out by a radio, and come in from it.

    Attributes:
        radio: what it sends and hears with.
        heard: the bytes of the frame that was received last.
    """

    radio: Radio
    heard: bytes = b""

    def take_radio(self, radio: Radio, channel: str) -> None:
        """The node's radio, its one path, and what that is called."""
        self.radio = radio
        self.paths = [Aerial(radio, channel)]

    async def _switch_on(self) -> None:
        await super()._switch_on()
        self.running().late_us = NEVER  # a radio does not forget what it was told to send
        await self.radio.start(self)

    async def stop(self) -> None:
        """Switch the radio off, then the node."""
        self.radio.stop()
        await super().stop()

    def status(self) -> dict[str, Any]:
        """What is known here, and who else is on the channel if the radio knows it."""
        others = getattr(self.radio, "others", None)
        return super().status() | ({} if others is None else {"others": others()})

    def on_carrier(self, at: int, cd: bool, voc: bool) -> None:
        """The radio's carrier came or went."""
        assert self.engine is not None
        self.paths[0].heard_at = at
        stack: Any = self.stack
        self.engine.call(lambda now: stack.on_carrier(now, cd, voc), at)

    def on_lost(self, at: int, cd: bool, voc: bool) -> None:
        """What the radio sent did not go out: to a protocol it has collided, and that is over."""
        self.on_carrier(at, True, False)
        self.on_carrier(at, cd, voc)

    def on_frame(self, at: int, data: bytes) -> None:
        """The radio received a frame."""
        path = self.paths[0]
        if path.loss and machine().chance.random() < path.loss:
            return
        path.counters["received"] += 1
        path.counters["received bytes"] += len(data)
        assert self.engine is not None
        at_ns = machine().time_ns() if self.taps else 0
        why = self.engine.read(data)
        if not why:
            self.heard = data
            self.engine.receive(0, at)
        self._tell(at_ns, 0, False, data, why)

    def packed(self, frame: Any) -> bytes:
        """The bytes of a frame that goes on the air."""
        return self.stack.encode(frame)

    def _transmit(self, port: int, frame: Any, attempt: int, flags: int) -> None:
        assert self.engine is not None
        data = self.packed(frame)
        at_ns = machine().time_ns() if self.taps else 0
        self.radio.send(self.engine.now, data, frame.slots)
        self.paths[0].sent(data)
        self._tell(at_ns, 0, True, data, "")
        self.outcomes["frames sent"] += 1


class DeclaredAirStack(DeclaredStack):
    """One node of a network on a channel that only declares its protocol."""

    def on_carrier(self, now: int, cd: bool, voc: bool) -> None:
        """The carrier came or went, or our own frame has ended."""
        self.do.on_carrier(self.node, self.params, now, int(cd), int(voc), self.out)


class DeclaredAirNode(AirNode, DeclaredNode):
    """A node of such a network: what it sends goes out by its radio."""


def medium_of(loaded: Loaded) -> tuple[str, tuple[str, int]]:
    """The channel that a node file names: as it is written, and its address.

    Raises:
        LiveError: it names none, or keys besides.
    """
    table, where = loaded.table, f"{loaded.path}"
    if len(table.link) != 1 or not isinstance(table.link[0], MediumTable):
        raise LiveError(f'{where}: a node on a channel has one [[link]], of kind = "medium"')
    if table.keys is not None:
        raise LiveError(f"{where}: frames on a shared channel are not sealed; remove [keys]")
    text = table.link[0].address
    return text, address(text, f"{where}: link.0.address")


def build(loaded: Loaded) -> DeclaredAirNode:
    """The node of a file, not yet started; a LiveError says what cannot be as written."""
    from innervate.live.channel_radio import MediumRadio

    text, where = medium_of(loaded)
    node = DeclaredAirNode(loaded.name, DeclaredAirStack.of(loaded, [0]), [])
    node.take_radio(MediumRadio(loaded.table.number, where), f"medium {text}")
    return node
