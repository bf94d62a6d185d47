"""TLVs of RFC 8966, section 4: their types, addresses, and a parser for which any bytes will do.

A node's number n stands at the end of all that it is called by: its router-id is 696e:6e65:7276:n,
its address fd69:6e6e:6572:7661:696e:6e65:7276:n, its address on a link fe80::696e:6e65:7276:n. The
one prefix that is spoken of is the address of the node `pc`, of 128 bits; others are passed over.
"""

from collections.abc import Callable, Iterator
from struct import pack, unpack_from

from innervate.networks.babel.protocol import constants as const

Message = dict[str, int]  # fields of a frame
PAD1 = 0
(ACK_REQUEST_TLV, ACK_TLV, HELLO_TLV, IHU_TLV, ROUTER_ID_TLV, NEXT_HOP_TLV, UPDATE_TLV,
 ROUTE_REQUEST_TLV, SEQNO_REQUEST_TLV) = range(2, 11)  # fmt: skip
DATA_TLV = 224  # the first of those for experiments
UNICAST_FLAG, PREFIX_FLAG, ROUTER_ID_FLAG = 0x8000, 0x80, 0x40
MANDATORY = 128  # sub-TLVs from here on may not be passed over alone
WILDCARD, IPV4, IPV6, LOCAL = range(4)
OCTETS = {WILDCARD: 0, IPV4: 4, IPV6: 16, LOCAL: 8}  # of an address
HOST, NET = b"innerv", b"\xfdinnerva"  # what router-ids begin with, and addresses
LINK = b"\xfe\x80" + bytes(6)
NOBODY = 65535  # who sends a packet and does not say so
NO_ROUTER = (bytes(8), b"\xff" * 8)
TENTHS_MS = 100  # in a centisecond
INTERVAL_MAX = 65535


def router_id(number: int) -> bytes:
    """The router-id of a node, 8 octets; all its addresses end so."""
    return HOST + pack(">H", number)


def address(number: int) -> bytes:
    """The address of a node, 16 octets."""
    return NET + router_id(number)


def number_of(octets: bytes) -> int:
    """Whose the last 8 octets of an address are."""
    return int.from_bytes(octets[-2:], "big") if octets[-8:-2] == HOST else NOBODY


def interval(centiseconds: int) -> int:
    """An interval as frames have it, 0.1 ms."""
    return min(centiseconds * TENTHS_MS, INTERVAL_MAX)


def tlvs(data: bytes) -> Iterator[tuple[int, bytes]]:
    """(type, value) of each TLV or sub-TLV up to one that is cut short; Pad1 is passed over."""
    at = 0
    while at < len(data):
        if data[at] == PAD1:
            at += 1
            continue
        end = at + 2 + (data[at + 1] if at + 1 < len(data) else len(data))
        if end > len(data):
            return
        yield data[at], data[at + 2 : end]
        at = end


def is_whole(value: bytes, size: int) -> bool:
    """True if a TLV is as long as it has to be, and no sub-TLV behind that forbids it."""
    return len(value) >= size and all(kind < MANDATORY for kind, _ in tlvs(value[size:]))


class Parser:
    """Reads the TLVs of one packet; `messages` is what they say to a node.

    Args:
        own: the node's number.
        pc: the number of the only source that is looked at.
    """

    def __init__(self, own: int, pc: int) -> None:
        self.own = router_id(own)
        self.source, self.prefix = router_id(pc), address(pc)
        self.messages: list[Message] = []
        # The state of a parser [4.5].
        self._router_id = b""
        self._prefixes: dict[int, bytes] = {}
        self._sender = NOBODY

    def take(self, kind: int, value: bytes) -> None:
        """The next TLV; one of an unknown type is passed over."""
        if kind in _READERS:
            _READERS[kind](self, value)

    def _say(self, kind: int, **values: int) -> None:
        self.messages.append({"kind": kind, "source": self._sender, **values})

    def _ack_request(self, value: bytes) -> None:
        if is_whole(value, 6):
            opaque, until = unpack_from(">HH", value, 2)
            if until:
                self._say(const.ACK_REQUEST, value=opaque, hello=interval(until))

    def _ack(self, value: bytes) -> None:
        if is_whole(value, 2):
            self._say(const.ACK, value=unpack_from(">H", value)[0])

    def _hello(self, value: bytes) -> None:
        if is_whole(value, 6):
            flags, seqno, until = unpack_from(">HHH", value)
            if not flags & UNICAST_FLAG:
                self._say(const.HELLO, hello_no=seqno, hello=interval(until))

    def _ihu(self, value: bytes) -> None:
        size = 6 + OCTETS.get(value[0], 0) if value else 6
        if is_whole(value, size) and value[0] in OCTETS:
            rxcost, until = unpack_from(">HH", value, 2)
            is_ours = value[6:size] in (b"", self.own, LINK + self.own)
            if is_ours and rxcost and until:
                self._say(const.IHU, rxcost=rxcost, hello=interval(until))

    def _router(self, value: bytes) -> None:
        if len(value) >= 10:
            self._router_id = value[2:10]

    def _next_hop(self, value: bytes) -> None:
        if len(value) >= 10 and value[0] in (IPV6, LOCAL):
            self._sender = number_of(value[2 : 2 + OCTETS[value[0]]])

    def _prefix(self, encoding: int, bits: int, omitted: int, octets: bytes) -> bytes | None:
        """A prefix that is written so, as an address; None = it cannot be."""
        size = OCTETS.get(encoding, 0)
        count = (bits + 7) // 8 - omitted
        known = self._prefixes.get(encoding, b"")[:omitted]
        if bits > 8 * size or not 0 <= count <= len(octets) or len(known) < omitted:
            return None
        found = int.from_bytes((known + octets[:count]).ljust(size, b"\0"), "big")
        cleared = 8 * size - bits
        return (found >> cleared << cleared).to_bytes(size, "big")

    def _is_ours(self, encoding: int, bits: int, octets: bytes) -> bool:
        is_host = encoding == IPV6 and bits == 128
        return is_host and self._prefix(encoding, bits, 0, octets) == self.prefix

    def _update(self, value: bytes) -> None:
        if len(value) < 10:
            return
        encoding, flags, bits, omitted, until, seqno, metric = unpack_from(">BBBBHHH", value)
        prefix = self._prefix(encoding, bits, omitted, value[10:])
        if prefix is None or encoding not in OCTETS:
            return
        if flags & PREFIX_FLAG:
            self._prefixes[encoding] = prefix
        if flags & ROUTER_ID_FLAG and prefix:
            self._router_id = prefix[-8:].rjust(8, b"\0")
        is_all = encoding == WILDCARD and metric == const.INFINITY
        is_ours = bits == 128 and prefix == self.prefix
        size = 10 + (bits + 7) // 8 - omitted
        if not until or not (is_all or is_ours) or not is_whole(value, size):
            return
        if metric < const.INFINITY:
            if self._router_id in (b"", *NO_ROUTER):
                return
            if self._router_id != self.source:  # the neighbour goes to another source now
                metric = const.INFINITY
        self._say(const.UPDATE, seq=seqno, metric=metric, update=interval(until))

    def _route_request(self, value: bytes) -> None:
        if len(value) >= 2 and is_whole(value, 2 + (value[1] + 7) // 8):
            is_all = value[0] == WILDCARD and not value[1]
            if is_all or self._is_ours(value[0], value[1], value[2:]):
                self._say(const.ROUTE_REQUEST)

    def _seqno_request(self, value: bytes) -> None:
        if len(value) < 14 or not is_whole(value, 14 + (value[1] + 7) // 8):
            return
        encoding, bits, seqno, hops, router = unpack_from(">BBHBx8s", value)
        if hops and router not in NO_ROUTER and self._is_ours(encoding, bits, value[14:]):
            if router == self.source:
                self._say(const.SEQNO_REQUEST, seq=seqno, hops=hops)
            else:  # any update from our source satisfies it
                self._say(const.ROUTE_REQUEST)

    def _data(self, value: bytes) -> None:
        if is_whole(value, 5):
            source, number, hops = unpack_from(">HHB", value)
            self._say(const.DATA, value=number, hops=hops)
            self.messages[-1]["source"] = source


_READERS: dict[int, Callable[[Parser, bytes], None]] = {
    ACK_REQUEST_TLV: Parser._ack_request,
    ACK_TLV: Parser._ack,
    HELLO_TLV: Parser._hello,
    IHU_TLV: Parser._ihu,
    ROUTER_ID_TLV: Parser._router,
    NEXT_HOP_TLV: Parser._next_hop,
    UPDATE_TLV: Parser._update,
    ROUTE_REQUEST_TLV: Parser._route_request,
    SEQNO_REQUEST_TLV: Parser._seqno_request,
    DATA_TLV: Parser._data,
}
