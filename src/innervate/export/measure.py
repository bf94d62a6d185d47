"""What a capture says of a network: who hears whom, how well, how soon; and what goes over it.

A frame that left is matched with the same bytes coming in at the other end. Where the capture says
what became of frames that did not come in, as those of simulations do, a frame counts as lost if
noise took it; elsewhere if nothing came in within a second.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Iterable, Iterator
from itertools import pairwise
from pathlib import Path
from statistics import median
from typing import Any

from innervate.dialect import plain
from innervate.export import links, pcapng
from innervate.export.capture import DROPPED, WORDS
from innervate.export.errors import ExportError
from innervate.export.links import Place
from innervate.export.measured import Flow, Measured, Way
from innervate.export.reading import Capture, Packet
from innervate.networks.mesh import frames as mesh
from innervate.networks.mesh.protocol import constants as mesh_words
from innervate.networks.mesh.protocol import fields as mesh_fields
from innervate.networks.skin import frames as skin
from innervate.networks.skin.protocol import constants as skin_words
from innervate.sim import taps
from innervate.wire.bits import get
from innervate.wire.layout import width

WAIT_NS = 1_000_000_000  # who has not come in by then was lost
NOISE = DROPPED + WORDS[taps.NOISE]
# Where a data frame says which cell measured it.
_BEFORE = [name for name, *_ in skin.TOUCH].index("cell")
CELL_AT = skin.KIND_BITS + width(skin.TOUCH[:_BEFORE])
CELL_BITS = skin.TOUCH[_BEFORE][2]
NEVER_LEFT = {DROPPED + WORDS[why] for why in (taps.QUEUE, taps.BROKEN, taps.OFF)}


def measure(path: Path) -> Measured:
    """Read a capture of a skin or a mesh.

    Raises:
        ExportError: it is none, is damaged, or says too little.
    """
    capture = Capture(path)
    packets = capture.packets()
    first = next(packets, None)
    kinds = {links.kind_of(one.link_type) for one in capture.interfaces}
    if first is None:
        raise ExportError(f"{path} holds no packets; capture for longer")
    if kinds == {"radio"}:
        raise ExportError(f"{path}: a radio team has one channel and no links to fit")
    if kinds not in ({"skin"}, {"mesh"}):
        raise ExportError(f"{path} is no capture of a skin or a mesh by innervate")
    made: _Reader = _Skin(path, capture) if kinds == {"skin"} else _Mesh(path, capture)
    last = first
    for packet in _all(first, packets):
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


def _all(first: Packet, rest: Iterator[Packet]) -> Iterable[Packet]:
    yield first
    yield from rest


class _Reader:
    """Matches frames that left with frames that came in."""

    def __init__(self, kind: str, path: Path, capture: Capture) -> None:
        self.found = Measured(kind)
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
        """The next packet."""
        raise NotImplementedError

    def end(self, last_ns: int) -> None:
        """That was the last one."""
        raise NotImplementedError

    def depart(self, key: Any, packet: Packet) -> None:
        """A frame left."""
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
        """A frame came in."""
        way.got += 1
        if sent is not None:
            way.delays_us.append((packet.time_ns - sent.time_ns) / 1000)
            way.sizes.append(len(packet.data))


class _Skin(_Reader):
    """Frames over cables: an end of a cable has one other end."""

    def __init__(self, path: Path, capture: Capture) -> None:
        super().__init__("skin", path, capture)
        self.ends: dict[str, str] = {}
        self.beacons: dict[str, list[int]] = {}
        self.samples = 0

    def end_of(self, place: Place) -> str:
        """An end as a scenario names it."""
        name = "pc" if place.what == "pc" else f"c{place.number}"
        if place.what not in ("pc", "cell") or place.port < 0 or not place.here:
            raise ExportError(
                f"{self.path} does not say which cables join its interfaces; "
                "captures of runs and of nodes on UDP do"
            )
        return f"{name}.{place.port}"

    def take(self, packet: Packet) -> None:
        """The next packet: the key of a way is (this end, that end), in the capture's words."""
        place = self.place(packet)
        self.ends.setdefault(place.here, self.end_of(place))
        if packet.flags & pcapng.OUTBOUND:
            self._look(place, packet)
            key = (place.here, place.there)
            if packet.comment == NOISE:
                self._way(key).lost += 1
            elif packet.comment.endswith("cable cut"):
                self.found.cut.add(self.ends[place.here])
            elif packet.comment not in NEVER_LEFT:
                self.depart(key, packet)
            return
        key = (place.there, place.here)
        sent = self.arrive(key, packet, keep=False)
        if not packet.comment:
            # One beacon is like another: where some are lost, nobody knows which came in.
            is_known = self.told or _kind(packet) == skin_words.DATA
            self.note(self._way(key), sent if is_known else None, packet)

    def _way(self, key: tuple[str, str]) -> Way:
        return self.found.way(*key)

    def _look(self, place: Place, packet: Packet) -> None:
        """What traffic there is."""
        kind = _kind(packet)
        if kind == skin_words.BEACON:
            self.beacons.setdefault(place.here, []).append(packet.time_ns)
        elif kind == skin_words.DATA and len(packet.data) == skin.SIZES[kind]:
            self.samples += get(packet.data, CELL_AT, CELL_BITS) == place.number

    def give_up(self, key: Any, packet: Packet) -> None:
        """Nothing came in; simulations say why."""
        if not self.told:
            self._way(key).lost += 1

    def end(self, last_ns: int) -> None:
        """Ends in the words of a scenario; rates."""
        for key, waiting in self.left.items():
            for packet in waiting:
                if last_ns - packet.time_ns > WAIT_NS:
                    self.give_up(key, packet)
        ways = self.found.ways
        known = [(key, way) for key, way in ways.items() if all(end in self.ends for end in key)]
        if len(known) < len(ways):
            self.found.notes.append("cables of which only one end was captured are left out")
        self.found.ways = {(self.ends[a], self.ends[b]): way for (a, b), way in known}
        gaps = [b - a for times in self.beacons.values() for a, b in pairwise(times)]
        self.found.beacon_us = median(gaps) / 1000 if gaps else 0.0
        cells = len({end.split(".")[0] for end in self.ends.values()} - {"pc"})
        self.found.rate_hz = self.samples / max(1, cells) / max(
            1e-9, self.found.seconds
        )  # fmt: skip


def _kind(packet: Packet) -> int:
    """The type of a skin's frame; 0 of no bytes."""
    return packet.data[0] >> (8 - skin.KIND_BITS) if packet.data else 0


class _Mesh(_Reader):
    """Frames on the air, or over paths to one neighbour each."""

    def __init__(self, path: Path, capture: Capture) -> None:
        super().__init__("mesh", path, capture)
        self.frame = plain.make("Frame", mesh_fields.FRAME)()
        self.there: dict[str, int] = {}  # address: node
        self.sent: dict[tuple[int, int], dict[int, tuple[int, int]]] = {}
        self.first_ns = -1

    def take(self, packet: Packet) -> None:
        """The next packet: the key is its sender, and the path's address if it has one."""
        place = self.place(packet)
        if place.what != "node" or place.number < 0:
            raise ExportError(f"{self.path}: an interface does not say which node it is of")
        if self.first_ns < 0:
            self.first_ns = packet.time_ns
        if place.here:
            self.there[place.here] = place.number
        if mesh.decode(packet.data, self.frame) != mesh.OK:
            return
        sender = self.frame.link_src
        if packet.flags & pcapng.OUTBOUND:
            if packet.comment:  # onto a cable that is cut
                return
            self.depart((place.number, place.there), packet)
            self._look(packet)
        elif packet.comment == NOISE:
            self.found.way(sender, place.number).lost += 1
        elif not packet.comment:
            sent = self.arrive((sender, place.here), packet, keep=not place.here)
            self.note(self.found.way(sender, place.number), sent, packet)

    def _look(self, packet: Packet) -> None:
        """What traffic there is: messages as their origin sends them first."""
        frame = self.frame
        own = frame.kind != mesh_words.ACK and frame.link_src == frame.origin
        if own and frame.kind == mesh_words.REQUEST:
            self.found.gateway = frame.origin
        elif own and frame.kind == mesh_words.DATA:
            seen = self.sent.setdefault((frame.origin, frame.dest), {})
            seen.setdefault(frame.seq, (packet.time_ns, frame.length))

    def give_up(self, key: Any, packet: Packet) -> None:
        """Nothing came in at the path's other end; on the air simulations say why."""
        number, there = key
        if there in self.there and not self.told:
            self.found.way(number, self.there[there]).lost += 1

    def end(self, last_ns: int) -> None:
        """Frames that came in nowhere; flows."""
        for key, waiting in self.left.items():
            for packet in waiting:
                if last_ns - packet.time_ns > WAIT_NS:
                    self.give_up(key, packet)
        self.found.ways = {key: way for key, way in self.found.ways.items() if way.got}
        for (origin, dest), seen in sorted(self.sent.items()):
            times = sorted(time for time, _ in seen.values())
            every = (times[-1] - times[0]) / 1e9 / max(1, len(times) - 1)
            size = round(median(size for _, size in seen.values()))
            first = (times[0] - self.first_ns) / 1e9
            self.found.flows.append(Flow(origin, dest, len(times), every, first, size))
