"""A skin out of a capture: who is cabled to whom, how soon, how well; and as a scenario."""

from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path
from statistics import median
from typing import Any

from innervate.analysis.intervals import quantile
from innervate.export import measure, pcapng
from innervate.export.errors import ExportError
from innervate.export.links import Place
from innervate.export.measure import Measured, Way
from innervate.export.reading import Capture, Packet
from innervate.networks.skin.export.routes import CELL_AT, CELL_BITS, end_of
from innervate.networks.skin.frames import KIND_BITS, SIZES
from innervate.networks.skin.protocol.constants import BEACON, DATA
from innervate.wire.bits import get

LATENCY_US_MAX = 100_000  # as scenarios have it
LOOSE_SIGMAS = 4.0  # a cable is loose if it loses more than the others by so many deviations
SPREAD_US = 2.0  # delays of a cable that differ by more are drawn for every frame


@dataclass
class Skin(Measured):
    """What is measured of a skin; its ways are between ends of cables like "c3.1" and "pc.0"."""

    kind: str = "skin"
    beacon_us: float = 0.0  # between beacons of a port; 0 unknown
    rate_hz: float = 0.0  # samples per cell and second


class Reader(measure.Reader):
    """Frames over cables: an end of a cable has one other end."""

    found: Skin

    def __init__(self, path: Path, capture: Capture) -> None:
        super().__init__(Skin(), path, capture)
        self.ends: dict[str, str] = {}
        self.beacons: dict[str, list[int]] = {}
        self.samples = 0

    def end_of(self, place: Place) -> str:
        """An end as a scenario names it."""
        end = end_of(place)
        if end is None:
            raise ExportError(
                f"{self.path} does not say which cables join its interfaces; "
                "captures of runs and of nodes on UDP do"
            )
        return f"{end.node}.{end.port}"

    def take(self, packet: Packet) -> None:
        """The next packet: the key of a way is (this end, that end), in the capture's words."""
        place = self.place(packet)
        self.ends.setdefault(place.here, self.end_of(place))
        if packet.flags & pcapng.OUTBOUND:
            self._look(place, packet)
            key = (place.here, place.there)
            if packet.comment == measure.NOISE:
                self._way(key).lost += 1
            elif packet.comment.endswith("cable cut"):
                self.found.cut.add(self.ends[place.here])
            elif packet.comment not in measure.NEVER_LEFT:
                self.depart(key, packet)
            return
        key = (place.there, place.here)
        sent = self.arrive(key, packet, keep=False)
        if not packet.comment:
            # One beacon is like another: where some are lost, nobody knows which came in.
            is_known = self.told or _kind(packet) == DATA
            self.note(self._way(key), sent if is_known else None, packet)

    def _way(self, key: tuple[str, str]) -> Way:
        return self.found.way(*key)

    def _look(self, place: Place, packet: Packet) -> None:
        """Note what traffic a capture has, to choose a scenario by."""
        kind = _kind(packet)
        if kind == BEACON:
            self.beacons.setdefault(place.here, []).append(packet.time_ns)
        elif kind == DATA and len(packet.data) == SIZES[kind]:
            self.samples += get(packet.data, CELL_AT, CELL_BITS) == place.number

    def give_up(self, key: Any, packet: Packet) -> None:
        """Nothing came in; simulations say why."""
        if not self.told:
            self._way(key).lost += 1

    def end(self, last_ns: int) -> None:
        """Ends in the words of a scenario; rates."""
        super().end(last_ns)
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
    return packet.data[0] >> (8 - KIND_BITS) if packet.data else 0


def tables_of(found: Any) -> dict[str, Any]:
    """The tables of a scenario, without what all scenarios have."""
    ways = {key: way for key, way in found.ways.items() if way.got or way.lost}
    cables = sorted({(min(key, key=_order), max(key, key=_order)) for key in ways}, key=_both)
    if not any(end.startswith("pc.") for pair in cables for end in pair):
        raise ExportError("the PC was not captured: a skin needs its interface ports")
    loose = _loose(ways)
    rest = [way for key, way in ways.items() if frozenset(key) not in loose]
    timing: dict[str, Any] = {"loss": round(_loss(rest), 5)}
    known = [sorted(way.delays_us) for way in ways.values() if way.delays_us]
    if known:
        low, high, per_frame = _latency(known)
        timing["hop_latency_us"] = [low, high]
        if per_frame:
            timing["latency"] = "per_frame"
    tables: dict[str, Any] = {"link": [{"a": a, "b": b} for a, b in cables], "timing": timing}
    if found.beacon_us:
        tables["protocol"] = {"beacon_hz": round(1e6 / found.beacon_us)}
    tables["data"] = {"rate_hz": round(found.rate_hz)}
    tables["event"] = [
        {"at_s": 0.0, "action": "loose", "loss": round(loss, 4), **_cable(sorted(pair, key=_order))}
        for pair, loss in loose.items()
    ]
    return tables


def _latency(known: list[list[float]]) -> tuple[int, int, bool]:
    """Least and greatest hop latency, us, and whether every frame has its own.

    Scenarios draw evenly from a range: it has the captured least and median. A busy computer keeps
    some frames waiting for very long.
    """
    per_frame = any(quantile(delays, 0.99) - quantile(delays, 0.01) > SPREAD_US
                    for delays in known)  # fmt: skip
    some = [quantile(delays, 0.5) for delays in known]
    low, high = min(some), max(some)
    if per_frame:
        every = sorted(delay for delays in known for delay in delays)
        low = quantile(every, 0.01)
        high = 2 * quantile(every, 0.5) - low
    low_us, high_us = (min(max(1, round(value)), LATENCY_US_MAX) for value in (low, high))
    return low_us, high_us, per_frame


def _order(end: str) -> tuple[bool, int, int]:
    """Ends in order: the PC's first, then by cell and port."""
    name, _, port = end.partition(".")
    return (name != "pc", 0 if name == "pc" else int(name[1:]), int(port))


def _both(pair: tuple[str, str]) -> tuple[Any, ...]:
    return (*_order(pair[0]), *_order(pair[1]))


def _cable(pair: list[str]) -> dict[str, Any]:
    """A cable as an event names it."""
    a, b = pair
    if a.startswith("pc."):
        return {"interface": int(a[3:])}
    return {"link": [a.split(".")[0], b.split(".")[0]]}


def _loss(ways: list[Way]) -> float:
    lost = sum(way.lost for way in ways)
    return lost / max(1, lost + sum(way.got for way in ways))


def _loose(ways: dict[tuple[Any, Any], Way]) -> dict[frozenset[str], float]:
    """Cables that lose clearly more than all together, and their loss in the worse direction."""
    cables: dict[frozenset[str], list[Way]] = {}
    for key, way in ways.items():
        cables.setdefault(frozenset(key), []).append(way)
    typical = sorted(_loss(both) for both in cables.values())[len(cables) // 2]
    found = {}
    for pair, both in cables.items():
        count, loss = sum(way.got + way.lost for way in both), _loss(both)
        spread = (max(typical, 1e-4) * (1 - typical) / max(1, count)) ** 0.5
        if loss > typical + LOOSE_SIGMAS * spread and loss > 0.01:
            found[pair] = loss
    return found


def named(end: str) -> str:
    """What the fitted scenario calls an end of the capture."""
    return end


def named_again(end: str, plan: Any) -> str:
    """What the fitted scenario calls an end of its own capture."""
    name, _, port = end.partition(".")
    return end if name == "pc" else f"{plan.graph.names[int(name[1:])]}.{port}"
