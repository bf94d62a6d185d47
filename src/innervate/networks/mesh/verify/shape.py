"""A mesh node's record as a value that can be kept, compared, and come back to.

Times are kept from the node's own present on, what is past as 0, or, where its age counts, as
that; what no handler looks at any more (the places of a queue that are free, scratch) is put to
one value, so that states which differ in nothing else are one. A test plays the same walks with
and without (`tidy`).
"""

from collections.abc import Callable
from operator import attrgetter
from typing import Any

from innervate.dialect.arith import MASK30
from innervate.networks.mesh.protocol import constants as const
from innervate.networks.mesh.protocol import fields as fields
from innervate.networks.mesh.protocol.neighbours import SUSPECT

NOW = 1 << 28  # what a node's clock shows at every event
FEW = 8  # draws out of so many or fewer are enumerated, others have one value a node
TIMES = ("tick_at", "wait_due", "q_due")
GATE_TIMES = ("job_due",)
AGES = ("q_born", "wait_at", "wait_sent")
OLDEST_US = 5_000_000  # whatever is older is alike
# Nothing but statistics of these: round trips count only where timeouts adapt to them.
PLAIN = {"rng": 1, "choice": 0, "asked": 0, "round_trip": 0, "tick_at": 0}
SCRATCH = ("far", "line")
QUEUED = ("q_rank", "q_order", "q_due", "q_tries", "q_fails", "q_copies", "q_from", "q_owner",
          "q_kind", "q_flags", "q_link_dst", "q_origin", "q_dest", "q_seq", "q_ver", "q_ttl",
          "q_path_len", "q_length")  # fmt: skip
RETRANSMISSION = ("wait_seq", "wait_dest", "wait_flags", "wait_tries", "wait_due", "wait_handle",
                  "wait_hop", "wait_length")  # fmt: skip
FORWARDED = ("done_origin", "done_seq", "done_kind", "done_from", "done_hops")
NEIGHBOUR = ("heard", "rssi", "suspect", "until", "round_rssi", "round_depth")


class OutOfRange(ArithmeticError):
    """A field has left its declared range."""


def drawing(base: type, who: Callable[[int, int], int]) -> type:
    """A node whose draws are answered by its `script`, or by `who`, and noted in `drawn`."""

    def ask(self: Any, count: int) -> None:
        if count == 0:
            return  # a record is put back
        if count > FEW:
            self.answer = who(self.number, count)
            return
        place = len(self.drawn)
        self.drawn.append(count)
        self.answer = min(self.script[place], count - 1) if place < len(self.script) else 0

    def ignore(self: Any, value: int) -> None:
        pass

    members = {
        "answer": 0,
        "script": (),
        "choice": property(lambda self: self.answer, ignore),
        "asked": property(lambda self: 0, ask),
    }
    return type("Node", (base,), members)


class Shape:
    """The fields of one kind of record, and how they are kept."""

    def __init__(self, declared: Any, times: tuple[str, ...], grain: int) -> None:
        self.grain = grain
        names = [field[0] for field in declared]
        self.names = names
        self.place = {name: i for i, name in enumerate(names)}
        self.pool: dict[Any, Any] = {}
        self.put = _putter(declared, times)
        self._values = attrgetter(*names)
        self.timed = [
            (self.place[name], age if name in AGES else ahead, length)
            for name, length, *_ in declared if name in times
        ]  # fmt: skip
        self._numbers = [(self.place[name], low, high)
                         for name, length, low, high, *_ in declared if not length]  # fmt: skip
        self._arrays: list[tuple[int, type, int, int, dict[Any, Any]]] = [
            (self.place[name], bytes if low >= 0 and high <= 255 else tuple, low, high, {})
            for name, length, low, high, *_ in declared if length
        ]  # fmt: skip

    def take(self, record: Any, now: int) -> tuple[Any, ...]:
        """The record's value; arrays that many states share are kept once."""
        found = list(self._values(record))
        for place, since, length in self.timed:
            value, grain = found[place], self.grain
            found[place] = (
                [since(t, now, grain) for t in value] if length else since(value, now, grain)
            )
        for place, low, high in self._numbers:
            if not low <= found[place] <= high:
                raise OutOfRange(f"{self.names[place]} = {found[place]}")
        for place, kind, low, high, known in self._arrays:
            value = found[place]
            try:
                kept = kind(value)
            except ValueError:
                raise OutOfRange(f"{self.names[place]} = {list(value)}") from None
            seen = known.get(kept)  # one that was seen is known to lie in its range
            if seen is None:
                if min(value) < low or max(value) > high:
                    raise OutOfRange(f"{self.names[place]} = {list(value)}")
                seen = known[kept] = self.pool.setdefault(kept, kept)
            found[place] = seen
        return tuple(found)


def _putter(declared: Any, times: tuple[str, ...]) -> Callable[[Any, tuple[Any, ...]], None]:
    """Makes a record what it was, its present being NOW: an assignment a field, written out."""
    taken, lines = [], []
    for i, (name, length, *_) in enumerate(declared):
        part = f"part{i}" if length or name in times else f"it.{name}"
        taken.append(part)
        if name in AGES:
            lines.append(f"  it.{name} = [{NOW} - t for t in {part}]")
        elif name in times:
            lines.append(f"  it.{name} = " + (f"[{NOW} + t for t in {part}]" if length
                                              else f"{NOW} + {part}"))  # fmt: skip
        elif length:
            lines.append(f"  it.{name} = list({part})")
    made: dict[str, Any] = {}
    exec("\n".join(["def put(it, value):", f"  ({', '.join(taken)}) = value", *lines]), made)
    put: Callable[[Any, tuple[Any, ...]], None] = made["put"]
    return put


def ahead(time: int, now: int, grain: int = 1) -> int:
    """How far a time lies ahead, in whole grains; 0 = it is past, or less than a grain."""
    wait = (time - now) & MASK30
    return 0 if wait > MASK30 >> 1 else wait - wait % grain


def age(time: int, now: int, grain: int = 1) -> int:
    """How long a time is past, in whole grains."""
    past = min((now - time) & MASK30, OLDEST_US)
    return past - past % grain


def tidy(node: Any, capacity: int, adapts: int, now: int) -> None:
    """Put to one value what no handler of this node looks at any more."""
    for name, value in PLAIN.items():
        if name != "round_trip" or not adapts:
            setattr(node, name, value)
    for name in SCRATCH:
        values = getattr(node, name)
        for k in range(len(values)):
            values[k] = 0
    _tidy_queue(node, now)
    for w in range(fields.WAITING):
        used = 0
        if node.wait_kind[w]:
            used = node.wait_length[w]
        else:
            for name in RETRANSMISSION:
                getattr(node, name)[w] = 0
            node.wait_sent[w] = now
        if not (used and adapts):  # tries end long before a message is too old
            node.wait_at[w] = now
        first = w * const.DATA_MAX
        node.wait_body[first + used : first + const.DATA_MAX] = [0] * (const.DATA_MAX - used)
    for k in range(fields.SKIPS):
        if node.skip_origin[k] == const.ALL:
            node.skip_seq[k] = node.skip_neighbour[k] = 0
        if node.bad_neighbour[k] == const.ALL:
            node.bad_dest[k] = 0
    for k in range(len(node.neighbour)):
        if node.neighbour[k] == const.ALL:
            for name in NEIGHBOUR:
                getattr(node, name)[k] = 0
        if not node.suspect[k] & SUSPECT:
            node.until[k] = 0
    _sort_forwarded(node)


def _tidy_queue(node: Any, now: int) -> None:
    """Free places are empty; the order of those in use is 0, 1, ..."""
    used = [i for i in range(fields.QUEUE) if node.q_state[i]]
    order = sorted(used, key=lambda i: (node.q_order[i] - node.q_next) & MASK30)
    for place, i in enumerate(order):
        node.q_order[i] = place
    node.q_next = len(used)
    for i in range(fields.QUEUE):
        length, hops = (node.q_length[i], node.q_path_len[i]) if node.q_state[i] else (0, 0)
        if not node.q_state[i]:
            for name in QUEUED:
                getattr(node, name)[i] = 0
            node.q_due[i] = node.q_born[i] = now
        first = i * const.BODY
        node.q_body[first + length : first + const.BODY] = [0] * (const.BODY - length)
        first = i * const.PATH_MAX
        node.q_path[first + hops : first + const.PATH_MAX] = [0] * (const.PATH_MAX - hops)


def _sort_forwarded(node: Any) -> None:
    """As long as none was overwritten, the order of what was forwarded says nothing."""
    columns = [getattr(node, name) for name in FORWARDED]
    rows = sorted(row for row in zip(*columns, strict=True) if row[0] != const.ALL)
    if len(rows) >= fields.FORWARDED:
        return
    node.done_at = len(rows)
    rows += [(const.ALL, 0, 0, 0, 0)] * (fields.FORWARDED - len(rows))
    for column, values in zip(columns, zip(*rows, strict=True), strict=True):
        column[:] = values
