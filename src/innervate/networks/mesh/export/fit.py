"""A mesh out of a capture: who hears whom, how well, how soon, who sends what; as a scenario."""

from dataclasses import dataclass, field
from pathlib import Path
from statistics import median
from typing import Any, NamedTuple

from innervate.dialect import plain
from innervate.export import measure, pcapng
from innervate.export.errors import ExportError
from innervate.export.measure import Measured
from innervate.export.reading import Capture, Packet
from innervate.networks.mesh import frames
from innervate.networks.mesh.protocol import constants as const
from innervate.networks.mesh.protocol import fields
from innervate.networks.mesh.scenario.profiles import PROFILES
from innervate.networks.mesh.scenario.traffic import payload_max


class Flow(NamedTuple):
    """Messages from one node to another."""

    origin: int
    dest: int
    messages: int
    every_s: float
    first_s: float
    size: int


@dataclass
class Mesh(Measured):
    """What is measured of a mesh; its ways are between numbers of nodes."""

    kind: str = "mesh"
    gateway: int = -1  # -1 nobody seen to be it
    flows: list[Flow] = field(default_factory=list)  # who sends what to whom
    longest: int = 0  # of all frames, bytes


class Reader(measure.Reader):
    """Frames on the air, or over paths to one neighbour each."""

    found: Mesh

    def __init__(self, path: Path, capture: Capture) -> None:
        super().__init__(Mesh(), path, capture)
        self.frame = plain.make("Frame", fields.frame(const.MTU_MAX))()
        self.data, self.answer = b"", -1  # what was decoded last, into the frame
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
        if packet.data != self.data:  # one frame comes in at many
            self.data = packet.data
            self.answer = frames.decode(packet.data, self.frame, const.MTU_MAX)
        if self.answer != frames.OK:
            return
        sender = self.frame.link_src
        self.found.longest = max(self.found.longest, len(packet.data))
        if packet.flags & pcapng.OUTBOUND:
            if packet.comment:  # onto a cable that is cut
                return
            self.depart((place.number, place.there), packet)
            self._look(packet)
        elif packet.comment == measure.NOISE:
            self.found.way(sender, place.number).lost += 1
        elif not packet.comment:
            sent = self.arrive((sender, place.here), packet, keep=not place.here)
            self.note(self.found.way(sender, place.number), sent, packet)

    def _look(self, packet: Packet) -> None:
        """What traffic there is: messages as their origin sends them first."""
        frame = self.frame
        own = frame.kind != const.ACK and frame.link_src == frame.origin
        if own and frame.kind == const.REQUEST:
            if frame.body[0] != const.ALL:  # of nobody: who has just been switched on asks
                self.found.gateway = frame.body[0]
        elif own and frame.kind == const.DATA:
            seen = self.sent.setdefault((frame.origin, frame.dest), {})
            seen.setdefault(frame.seq, (packet.time_ns, frame.length))

    def give_up(self, key: Any, packet: Packet) -> None:
        """Nothing came in at the path's other end; on the air simulations say why."""
        number, there = key
        if there in self.there and not self.told:
            self.found.way(number, self.there[there]).lost += 1

    def end(self, last_ns: int) -> None:
        """Frames that came in nowhere; flows."""
        super().end(last_ns)
        self.found.ways = {key: way for key, way in self.found.ways.items() if way.got}
        for (origin, dest), seen in sorted(self.sent.items()):
            times = sorted(time for time, _ in seen.values())
            every = (times[-1] - times[0]) / 1e9 / max(1, len(times) - 1)
            size = round(median(size for _, size in seen.values()))
            first = (times[0] - self.first_ns) / 1e9
            self.found.flows.append(Flow(origin, dest, len(times), every, first, size))


def tables_of(found: Any) -> dict[str, Any]:
    """The tables of a scenario, without what all scenarios have."""
    nodes = sorted({node for key in found.ways for node in key})
    number = {node: i for i, node in enumerate(nodes)}
    pairs = sorted({(min(key), max(key)) for key in found.ways})
    links = [
        {"a": f"n{a}", "b": f"n{b}", "quality": [_quality(found, a, b), _quality(found, b, a)]}
        for a, b in pairs
    ]
    tables: dict[str, Any] = {"node": [{"name": f"n{node}"} for node in nodes], "link": links}
    tables["radio"] = {"profile": profile_of(found)}
    mtu = const.MTU
    if found.longest > mtu:
        mtu = const.MTU_MAX
        tables["radio"], tables["protocol"] = {"profile": "ip"}, {"mtu": mtu}
    if found.gateway in number:
        tables["gateway"] = f"n{found.gateway}"
    flows = []
    for flow in found.flows:
        dest: Any = "all" if flow.dest == 255 else "monitor" if flow.dest == 254 else None
        if dest is None and flow.dest not in number:
            continue
        one = {"from": f"n{flow.origin}", "to": dest or f"n{flow.dest}"}
        one |= {"bytes": min(flow.size, payload_max(mtu)), "count": flow.messages}
        flows.append(one | {"every_s": round(max(flow.every_s, 0.0001), 4),
                            "start_s": round(flow.first_s, 3)})  # fmt: skip
    tables["flow"] = flows
    return tables


def _quality(found: Measured, a: int, b: int) -> float:
    way = found.ways.get((a, b))
    return 0.0 if way is None else round(way.quality, 4)


def profile_of(found: Measured) -> str:
    """The radio whose airtime is nearest to the delays of frames, by their sizes."""
    some = [
        (size, delay)
        for way in found.ways.values()
        for size, delay in zip(way.sizes, way.delays_us, strict=True)
    ]
    if not some:
        return "ip"

    def off(name: str) -> float:
        radio = PROFILES[name]
        return sum(abs(delay - (radio.phy_bytes + size) * radio.byte_ns / 1000)
                   for size, delay in some)  # fmt: skip

    return min(("250k", "38k4", "ip"), key=off)


def named(node: int) -> str:
    """What the fitted scenario calls a node of the capture."""
    return f"n{node}"


def named_again(node: int, plan: Any) -> str:
    """What the fitted scenario calls a node of its own capture."""
    name: str = plan.names[node]
    return name
