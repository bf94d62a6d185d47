"""Packets of RFC 8966, section 4: what live nodes of Babel say to each other, and to others.

Of time a packet holds whole centiseconds: what is said is rounded up; what is heard is cut at
6.5535 s. A Next Hop says who sends, an IHU is for whoever is at the other end of the cable (AE 0),
data, which Babel leaves to IP, is a TLV for experiments. Not looked at: other prefixes and the
trailer; Unicast Hellos, which a node may do without.
"""

from collections.abc import Iterator
from struct import pack
from typing import Any

from innervate.networks.babel import tlvs as tlv
from innervate.networks.babel.protocol import constants as const
from innervate.networks.babel.protocol import fields

MAGIC, VERSION, HEAD_BYTES = 42, 2, 4
NOT_BABEL, NOTHING = 1, 2
REASONS = ("ok", "no Babel packet", "nothing for this node")
IHU_HELLOS = 3  # Hellos in the interval of an IHU that comes with one [appendix B]
FIELDS = tuple(field[0] for field in fields.FRAME)


def centiseconds(tenths_ms: int) -> int:
    """An interval as packets have it: never 0, which would promise nothing."""
    return max(1, -(-tenths_ms // tlv.TENTHS_MS))


class Packets:
    """The coder of one node.

    Args:
        number: the node's.
        params: of its protocol.
    """

    reasons = REASONS
    wireshark = ("udp.port", 6696)  # who reads captures of live nodes

    def __init__(self, number: int, params: Any) -> None:
        self.number, self.pc = number, params.pc
        self.source, self.prefix = tlv.router_id(self.pc), tlv.address(self.pc)
        self.sender = pack(">BBBx8s", tlv.NEXT_HOP_TLV, 10, tlv.LOCAL, tlv.router_id(number))

    def encode(self, frame: Any) -> bytes:
        """The packet of a frame."""
        body = self._data(frame) if frame.kind == const.DATA else self.sender + self._tlvs(frame)
        return pack(">BBH", MAGIC, VERSION, len(body)) + body

    def read(self, data: bytes, frame: Any) -> Iterator[int]:
        """Fill a frame, one after the other, with what a packet says; any bytes will do.

        Yields 0 for each, or once why there is none.
        """
        end = HEAD_BYTES + int.from_bytes(data[2:HEAD_BYTES], "big")
        if not HEAD_BYTES <= end <= len(data) or data[:2] != bytes((MAGIC, VERSION)):
            yield NOT_BABEL
            return
        parser = tlv.Parser(self.number, self.pc)
        for kind, value in tlv.tlvs(data[HEAD_BYTES:end]):
            parser.take(kind, value)
        if not parser.messages:
            yield NOTHING
        for message in joined(parser.messages):
            for name in FIELDS:
                setattr(frame, name, message.get(name, 0))
            yield 0

    def _tlvs(self, frame: Any) -> bytes:
        kind = frame.kind
        if kind == const.HELLO:
            return self._hello(frame)
        if kind == const.UPDATE:
            return self._update(frame)
        if kind == const.IHU:
            return self._ihu(frame.rxcost, centiseconds(frame.hello))
        if kind == const.ROUTE_REQUEST:
            return pack(">BBBB16s", tlv.ROUTE_REQUEST_TLV, 18, tlv.IPV6, 128, self.prefix)
        if kind == const.SEQNO_REQUEST:
            asked = (tlv.IPV6, 128, frame.seq, frame.hops, self.source, self.prefix)
            return pack(">BBBBHBx8s16s", tlv.SEQNO_REQUEST_TLV, 30, *asked)
        if kind == const.ACK_REQUEST:
            return pack(">BBxxHH", tlv.ACK_REQUEST_TLV, 6, frame.value, centiseconds(frame.hello))
        assert kind == const.ACK, "a frame of no kind"
        return pack(">BBH", tlv.ACK_TLV, 2, frame.value)

    def _hello(self, frame: Any) -> bytes:
        """A Hello, and what comes with it."""
        until = centiseconds(frame.hello) if frame.hello else 0
        found = pack(">BBHHH", tlv.HELLO_TLV, 6, 0, frame.hello_no, until)
        if frame.rxcost:
            found += self._ihu(frame.rxcost, IHU_HELLOS * until)
        return found + self._update(frame) if frame.has_update else found

    def _ihu(self, rxcost: int, until: int) -> bytes:
        return pack(">BBBxHH", tlv.IHU_TLV, 6, tlv.WILDCARD, rxcost, until)

    def _update(self, frame: Any) -> bytes:
        """The way to the source, and whose it is."""
        found = pack(">BBxx8s", tlv.ROUTER_ID_TLV, 10, self.source)
        told = (centiseconds(frame.update), frame.seq, frame.metric, self.prefix)
        return found + pack(">BBBBBBHHH16s", tlv.UPDATE_TLV, 26, tlv.IPV6, 0, 128, 0, *told)

    def _data(self, frame: Any) -> bytes:
        return pack(">BBHHB", tlv.DATA_TLV, 5, frame.source, frame.value, frame.hops)


def joined(messages: list[tlv.Message]) -> list[tlv.Message]:
    """Messages, with an IHU and an update put into the Hello right before them."""
    found: list[tlv.Message] = []
    for one in messages:
        last = found[-1] if found and found[-1]["kind"] == const.HELLO else {}
        if not last or "metric" in last or last["source"] != one["source"]:
            found.append(one)
        elif one["kind"] == const.IHU and "rxcost" not in last and is_of(one, last):
            last["rxcost"] = one["rxcost"]
        elif one["kind"] == const.UPDATE:
            last |= {"has_update": 1} | {name: one[name] for name in ("seq", "metric", "update")}
        else:
            found.append(one)
    return found


def is_of(ihu: tlv.Message, hello: tlv.Message) -> bool:
    """True if an IHU lasts as long as that of a frame with a Hello does."""
    return ihu["hello"] == min(IHU_HELLOS * hello["hello"], tlv.INTERVAL_MAX)
