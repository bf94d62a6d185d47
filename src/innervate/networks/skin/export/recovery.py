"""How a skin healed, from the frames of a capture: of running nodes, or of a simulation.

A cell's beacons say which port leads to its parent, so that a capture of all nodes holds every
route at every moment. What was hurt is said by the capture itself: frames onto a cut cable, nodes
that went away and came back.
"""

from collections import deque
from dataclasses import dataclass, field
from statistics import median

from innervate.export import links, pcapng
from innervate.export.errors import ExportError
from innervate.export.reading import Capture, Packet
from innervate.networks.skin import frames as skin
from innervate.networks.skin.export import routes
from innervate.networks.skin.export.routes import PC, End, Network
from innervate.networks.skin.protocol import constants as skin_const
from innervate.wire.bits import get

NOTHING = "nothing happened to this skin while it was captured"
CUT = "cable cut"
SAME_NS = 1_000_000_000  # within that time both ends of a cable say that it was cut
RECENT_NS = 500_000_000  # a sample's number comes again after 256 periods
ROUND_NS = 3_000_000  # beacons of one moment are told within that time


SEQS = 1 << routes.SEQ_BITS
LATE_MAX = 16  # samples that one that comes late may be behind
NAMED = 8  # cells that are cut off and are told one by one
END_NS = 2_000_000_000  # nodes that went away so shortly before the end were ended


@dataclass
class Healing:
    """What became of a skin after something happened to it.

    Times are from then, ms; None = not while it was watched.
    """

    at_s: float  # when, from the capture's first frame
    what: str  # "cut c1.2 - pc.0", "c6 gone", "pc back", "restore ...", "loose ..."
    # Cells whose way to the PC it cut, and that still have cables to it; or that it brought back.
    # Those that had none yet from what happened just before are among them.
    cells: int = 0
    # Cells that it cut off: they run, and no cables lead from them to the PC any more, so that they
    # have a way again when somebody puts one back, and not before.
    apart: list[str] = field(default_factory=list)
    watched_ms: float = 0.0  # until something else happened, or the capture ended
    # The first of them said in a beacon that it has another parent, or none.
    first_ms: float | None = None
    wrong_ms: float | None = None  # the last one's last beacon whose parent did not lead to the PC
    routed_ms: float | None = None  # all had said in beacons that their parents lead to the PC
    # The PC had a sample of all of them by a way without what was hurt.
    heard_ms: float | None = None
    heard_median_ms: float | None = None  # of half of them
    lost: int = 0  # samples of theirs that never came to the PC
    sampled: bool = True  # samples were sent or came in, at any time in the capture


@dataclass
class _Open:
    """An event whose consequences are watched."""

    found: Healing
    at_ns: int
    key: frozenset[End] | str
    cells: set[str]
    heard: dict[str, int] = field(default_factory=dict)
    missing: set[tuple[str, int]] = field(default_factory=set)  # samples that were passed over


class Watcher:
    """Reads a capture packet by packet, and keeps what became of every event."""

    def __init__(self, capture: Capture) -> None:
        self.capture = capture
        self.net = Network()
        self.found: list[Healing] = []
        self._places: list[End] = []
        self._names: dict[int, str] = {}
        self._first_ns = self._last_ns = -1
        self._now: _Open | None = None
        self._doubt: dict[str, int] = {}  # who said no of its parent's port, and when
        # Samples on their way, by cell and number: the ends that they left by.
        self._samples: dict[tuple[str, int], set[End]] = {}
        self._order: deque[tuple[int, tuple[str, int]]] = deque()
        self._newest: dict[str, int | None] = {}  # number of the newest sample that came in
        self.sampled = False

    def take(self, packet: Packet) -> None:
        """The next packet of a capture, in order of time: an event or a beacon."""
        if self._first_ns < 0:
            self._first_ns = packet.time_ns
        self._last_ns = packet.time_ns
        end = self._end(packet.interface)
        if not packet.data:
            self._event(packet.time_ns, end, packet.comment.removeprefix("event: "))
            return
        out = bool(packet.flags & pcapng.OUTBOUND)
        is_cut = packet.comment.endswith(CUT)
        if out and is_cut != (end in self.net.cut):
            self._event(packet.time_ns, end, "cut" if is_cut else "restore")
        kind = packet.data[0] >> (8 - skin.KIND_BITS)
        if len(packet.data) != skin.SIZES.get(kind):
            return
        if kind == skin_const.BEACON and out and end.node != PC:
            self._beacon(packet, end)
        elif kind == skin_const.DATA and (out or (end.node == PC and not packet.comment)):
            self._sample(packet, end, out)

    def end(self) -> list[Healing]:
        """That was the last packet: what was found."""
        self._close(self._last_ns)
        while (
            self.found
            and self.found[-1].what.endswith("gone")
            and (self._last_ns - self._first_ns - 1e9 * self.found[-1].at_s < END_NS)
        ):
            self.found.pop()
        for one in self.found:
            one.sampled = self.sampled
        return self.found

    def _end(self, interface: int) -> End:
        for one in self.capture.interfaces[len(self._places) :]:
            place = links.place_of(one.description)
            end = routes.end_of(place)
            if end is None:
                raise ExportError(
                    f"{self.capture.path} does not say which cables join its interfaces; capture "
                    "a skin of `innervate live up`, or nodes with a UDP address for each path"
                )
            self._places.append(end)
            self.net.cable(end, place.here, place.there)
        return self._places[interface]

    def _event(self, at_ns: int, end: End, what: str) -> None:
        other = self.net.peer.get(end, end)
        is_node = what.startswith("node ")
        key: frozenset[End] | str = end.node if is_node else frozenset((end, other))
        word = what.removeprefix("node ")
        ways = {cell: self.net.way(cell) for cell in self.net.parent}
        joined = self.net.joined()
        if is_node:
            (self.net.away.add if word == "gone" else self.net.away.discard)(end.node)
            if word == "gone" and end.node != PC:
                self.net.parent[end.node] = None
            # A PC that comes back does not know what it missed; a cell counts from 0 again.
            self._newest = {} if end.node == PC else {**self._newest, end.node: None}
        elif word == "cut":
            self.net.cut.add(end)
        else:
            self.net.cut.discard(end)
        now = self._now
        if (
            now
            and now.key == key
            and now.found.what.startswith(word)
            and (at_ns - now.at_ns < SAME_NS)
        ):
            now.cells |= self.net.joined() - joined  # a cable is whole when both ends say so
            now.found.cells = len(now.cells)
            return  # the other end says so, too
        self._close(at_ns)
        names = [f"{e.node}.{e.port}" for e in sorted({end, other})]
        text = f"{end.node} {word}" if is_node else f"{word} {' - '.join(names)}"
        still = {cell for cell in now.cells if ways[cell] is None} if now else set()
        here = self.net.joined()
        cells = here - joined  # those that it brings back, or that lose their way
        if word not in ("back", "restore"):
            cells = {c for c in here if ways[c] and not self.net.way(c)}
        cells |= {c for c in here & still if not self.net.way(c)}
        apart = sorted(joined - here - self.net.away, key=lambda cell: int(cell[1:]))
        found = Healing(round((at_ns - self._first_ns) / 1e9, 4), text, len(cells), apart)
        self._now = _Open(found, at_ns, key, cells)

    def _beacon(self, packet: Packet, end: End) -> None:
        """A cell says on each of its ports whether it leads to its parent."""
        for cell, at_ns in list(self._doubt.items()):
            if packet.time_ns - at_ns > ROUND_NS:
                del self._doubt[cell]
                self._moved(cell, None, at_ns)
        before = self.net.parent[end.node]
        if not get(packet.data, routes.PARENT_AT, 1):
            if before == end.port:  # it says so of its new parent's port next, if it has one
                self._doubt.setdefault(end.node, packet.time_ns)
            return
        self._doubt.pop(end.node, None)
        if before != end.port:
            self._moved(end.node, end.port, packet.time_ns)
        now = self._now
        if now and end.node in now.cells and self.net.way(end.node) is None:
            now.found.wrong_ms = (packet.time_ns - now.at_ns) / 1e6

    def _moved(self, cell: str, port: int | None, at_ns: int) -> None:
        """A cell has another parent."""
        self.net.parent[cell] = port
        now = self._now
        if now is None or not now.cells:
            return
        after_ms = max(0, at_ns - now.at_ns) / 1e6
        if cell in now.cells and now.found.first_ms is None:
            now.found.first_ms = after_ms
        routed = all(self.net.way(cell) for cell in now.cells)
        if not routed:
            now.found.routed_ms = None
        elif now.found.routed_ms is None:
            now.found.routed_ms = after_ms

    def _sample(self, packet: Packet, end: End, out: bool) -> None:
        self.sampled = True
        cell, seq = (
            f"c{get(packet.data, routes.CELL_AT, routes.CELL_BITS)}",
            get(packet.data, routes.SEQ_AT, routes.SEQ_BITS),
        )
        while self._order and packet.time_ns - self._order[0][0] > RECENT_NS:
            self._samples.pop(self._order.popleft()[1], None)
        if out:
            if (cell, seq) not in self._samples:
                self._samples[cell, seq] = set()
                self._order.append((packet.time_ns, (cell, seq)))
            self._samples[cell, seq].add(end)
            return
        ends = self._samples.pop((cell, seq), set())
        newest = self._newest.get(cell)
        missing = 0 if newest is None else (seq - newest - 1) % SEQS
        is_late = missing >= SEQS - LATE_MAX
        if not is_late:
            self._newest[cell] = seq
        now = self._now
        if now is None or cell not in now.cells:
            return
        if is_late:
            now.missing.discard((cell, seq))
        now.missing |= {(cell, (seq - i) % SEQS) for i in range(1, 0 if is_late else missing + 1)}
        if cell not in now.heard and not _touched(now, ends):
            now.heard[cell] = packet.time_ns

    def _close(self, at_ns: int) -> None:
        """What is known of the last event, which is watched no longer."""
        now, self._now = self._now, None
        if now is None:
            return
        now.found.watched_ms = round((at_ns - now.at_ns) / 1e6, 3)
        now.found.lost = len(now.missing)
        times = sorted((at - now.at_ns) / 1e6 for at in now.heard.values())
        if times and len(times) == len(now.cells):
            now.found.heard_ms, now.found.heard_median_ms = times[-1], median(times)
        self.found.append(now.found)


def recoveries(capture: Capture) -> list[Healing]:
    """Read a capture of a skin: an entry for everything that happened to it, in order.

    Raises:
        ExportError: it is none, is damaged, or says too little.
    """
    watcher = Watcher(capture)
    packets = sorted(capture.packets(), key=lambda packet: packet.time_ns)
    if {links.kind_of(one.link_type) for one in capture.interfaces} != {"skin"}:
        raise ExportError(f"{capture.path} is no capture of a skin; only skins have parents")
    for packet in packets:
        watcher.take(packet)
    return watcher.end()


def _touched(now: _Open, ends: set[End]) -> bool:
    """True if a sample took the cable, or passed the node, that was hurt."""
    if isinstance(now.key, str):
        return now.found.what.endswith("gone") and now.key in {end.node for end in ends}
    return now.found.what.startswith("cut") and not now.key.isdisjoint(ends)


def line(one: Healing) -> str:
    """What happened and how it healed, for people."""
    return f"{one.at_s:.3f} s: {one.what}{_text(one)}"


def _text(one: Healing) -> str:
    apart = _apart(one.apart)
    if not one.cells:
        others = "no other cell" if one.apart else "no cell"
        return f"{apart}; {others} had to find another way"
    words = ("first moved", "last wrong parent", "all routed", "all heard", "half of them heard")
    times = (one.first_ms, one.wrong_ms, one.routed_ms, one.heard_ms, one.heard_median_ms)
    not_yet = f"not within {one.watched_ms:.0f} ms"
    nothing = {"last wrong parent": "never"}  # nobody named a parent that led nowhere
    seen = len(words) if one.sampled else 3  # without samples nobody can be heard
    parts = [f"{word} {nothing.get(word, not_yet) if at is None else f'{at:.0f} ms'}"
             for word, at in zip(words[:seen], times[:seen], strict=True)]  # fmt: skip
    cells = "1 cell" if one.cells == 1 else f"{one.cells} cells"
    lost = "1 sample" if one.lost == 1 else f"{one.lost} samples"
    data = f"{lost} lost" if one.sampled else "no samples in the capture"
    return f"{apart}; {cells}: {', '.join(parts)}; {data}"


def _apart(cells: list[str]) -> str:
    """Who is cut off, the first few by name."""
    if not cells:
        return ""
    named = ", ".join(cells[:NAMED]) + (", ..." if len(cells) > NAMED else "")
    who = "1 cell" if len(cells) == 1 else f"{len(cells)} cells"
    return f"; {who} cut off, with no cables to the PC left ({named})"
