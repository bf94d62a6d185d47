"""What a capture says of a network: who hears whom, how well, how soon; and what goes over it.

A frame that left is matched with the same bytes coming in at the other end. Where the capture says
what became of frames that did not come in, as those of simulations do, a frame counts as lost if
noise took it; elsewhere if nothing came in within a second.
"""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass, field
from itertools import chain
from pathlib import Path
from statistics import median
from typing import Any

from innervate.export import links
from innervate.export.capture import DROPPED, WORDS
from innervate.export.errors import ExportError
from innervate.export.links import Place
from innervate.export.reading import Capture, Packet
from innervate.network import networks
from innervate.sim import taps

WAIT_NS = 1_000_000_000  # who has not come in by then was lost
NOISE = DROPPED + WORDS[taps.NOISE]
NEVER_LEFT = {DROPPED + WORDS[why] for why in (taps.QUEUE, taps.BROKEN, taps.OFF)}
DELAYS_MAX = 4096  # kept of a way


@dataclass
class Way:
    """One direction of a link."""

    got: int = 0  # frames that came in
    lost: int = 0  # frames that noise took
    # Of frames that came in, from their start.
    delays_us: deque[float] = field(default_factory=lambda: deque(maxlen=DELAYS_MAX))
    # Of the same, bytes.
    sizes: deque[int] = field(default_factory=lambda: deque(maxlen=DELAYS_MAX))

    @property
    def quality(self) -> float:
        """Share of frames that came in, 0 to 1."""
        return self.got / max(1, self.got + self.lost)


@dataclass
class Measured:
    """A network as a capture has it."""

    kind: str  # of network
    # By sender and receiver, nodes or ends of cables.
    ways: dict[tuple[Any, Any], Way] = field(default_factory=dict)
    seconds: float = 0.0  # from the first packet to the last
    packets: int = 0  # read
    cut: set[str] = field(default_factory=set)  # ends whose cable was cut for some time
    notes: list[str] = field(default_factory=list)  # what to know besides

    def way(self, a: Any, b: Any) -> Way:
        """The way from a to b; a new one if it was not seen before."""
        return self.ways.setdefault((a, b), Way())

    def delay_us(self) -> tuple[float, float, float]:
        """Least, median and greatest of the ways' median delays; 0 unknown."""
        found = [median(way.delays_us) for way in self.ways.values() if way.delays_us]
        return (min(found), median(found), max(found)) if found else (0.0, 0.0, 0.0)


def measure(path: Path) -> Measured:
    """Read a capture, or a log of its own that a network has.

    Raises:
        ExportError: it is none, is damaged, or says too little.
    """
    for network in networks().values():
        if network.has("log") and network.log.looks_like_one(path):
            logged: Measured = network.log.measure(path)
            return logged
    capture = Capture(path)
    packets = capture.packets()
    first = next(packets, None)
    if first is None:
        raise ExportError(f"{path} holds no packets; capture for longer")
    made = _reader(path, capture)
    last = first
    for packet in chain([first], packets):
        made.take(packet)
        made.found.packets += 1
        last = packet
    made.found.seconds = (last.time_ns - first.time_ns) / 1e9
    made.end(last.time_ns)
    if capture.cut_short:
        made.found.notes.append("the capture ends in the middle of a block")
    if not any(way.got for way in made.found.ways.values()):
        raise ExportError(f"{path}: no frame that left came in anywhere; capture more nodes")
    return made.found


def _reader(path: Path, capture: Capture) -> Reader:
    """For the frames of the one kind of network that is in a capture."""
    kinds = {links.kind_of(one.link_type) for one in capture.interfaces}
    kind = kinds.pop() if len(kinds) == 1 else None
    able = [name for name, network in networks().items() if network.has("fit")]
    if kind in able:
        made: Reader = networks()[kind].fit.Reader(path, capture)
        return made
    if kind is not None:
        raise ExportError(f"{path}: {networks()[kind].unfit}")
    raise ExportError(f"{path} is no capture of a {' or a '.join(able)} by innervate")


class Reader:
    """Matches frames of a capture that left with frames that came in; fills `found`."""

    def __init__(self, found: Measured, path: Path, capture: Capture) -> None:
        self.found = found
        self.path, self.capture = path, capture
        self.told = capture.comment.endswith("simulated")
        self.places: list[Place] = []
        self.left: dict[Any, deque[Packet]] = {}

    def place(self, packet: Packet) -> Place:
        """Whose interface a packet is of."""
        while len(self.places) <= packet.interface:
            one = self.capture.interfaces[len(self.places)]
            self.places.append(links.place_of(one.description))
        return self.places[packet.interface]

    def take(self, packet: Packet) -> None:
        """Take in the next packet of a capture; they come in order of time."""
        raise NotImplementedError

    def end(self, last_ns: int) -> None:
        """That was the last one: what left long enough before came in nowhere."""
        for key, waiting in self.left.items():
            for packet in waiting:
                if last_ns - packet.time_ns > WAIT_NS:
                    self.give_up(key, packet)

    def depart(self, key: Any, packet: Packet) -> None:
        """A frame left: it may come in elsewhere, by the same key."""
        self.left.setdefault(key, deque()).append(packet)

    def arrive(self, key: Any, packet: Packet, keep: bool) -> Packet | None:
        """The frame that came in as it left; `keep` it for others to whom it may come in too.

        On a path it is the oldest of these bytes; a path keeps the order of frames, so that those
        before it were lost, unless the capture names what was lost. On the air it is the newest.
        """
        waiting = self.left.get(key, deque())
        while waiting and packet.time_ns - waiting[0].time_ns > WAIT_NS:
            self.give_up(key, waiting.popleft())
        places = range(len(waiting) - 1, -1, -1) if keep else range(len(waiting))
        for i in places:
            sent = waiting[i]
            if sent.data == packet.data and sent.time_ns <= packet.time_ns:
                if not keep:
                    del waiting[i]
                    for _ in range(0 if self.told else i):
                        self.give_up(key, waiting.popleft())
                return sent
        return None

    def give_up(self, key: Any, packet: Packet) -> None:
        """A frame came in nowhere."""

    def note(self, way: Way, sent: Packet | None, packet: Packet) -> None:
        """A frame came in by a way; `sent` is how it left, None if that was not seen."""
        way.got += 1
        if sent is not None:
            way.delays_us.append((packet.time_ns - sent.time_ns) / 1000)
            way.sizes.append(len(packet.data))
