"""What RFC 8966, section 4, says of packets: octet by octet, by its tables."""

import asyncio
import random
from struct import pack

import pytest
from hypothesis import given
from hypothesis import strategies as st

from innervate.dialect import plain
from innervate.live.declared import DeclaredNode, DeclaredStack
from innervate.live.links import Link, Path
from innervate.network import networks
from innervate.networks.babel.packets import NOT_BABEL, NOTHING, Packets
from innervate.networks.babel.protocol import constants as c
from innervate.networks.babel.protocol import fields
from innervate.networks.babel.tlvs import NOBODY, address, router_id
from tests.networks.babel.bench import Bench

FRAME = plain.make("Frame", fields.FRAME)
PARAMS = plain.make("Params", fields.PARAMS)
PC, US, OTHER = 3, 7, 300
# By hand, from the RFC's tables; numbers are 3, the source, and 300, who sends.
SENDER = bytes.fromhex("07 0a 03 00 69 6e 6e 65 72 76 01 2c")
SOURCE = bytes.fromhex("06 0a 00 00 69 6e 6e 65 72 76 00 03")
PREFIX = bytes.fromhex("fd 69 6e 6e 65 72 76 61 69 6e 6e 65 72 76 00 03")
TOLD = bytes.fromhex("08 1a 02 00 80 00 00 02 00 05 00 60") + PREFIX


def coder(number=US):
    params = PARAMS()
    params.pc = PC
    return Packets(number, params)


def frame(kind, **values):
    made = FRAME()
    for name, value in {"kind": kind, "source": OTHER, **values}.items():
        setattr(made, name, value)
    return made


def packet(*tlvs):
    body = b"".join(tlvs)
    return b"\x2a\x02" + len(body).to_bytes(2, "big") + body


def values_of(one):
    return {name: value for name, *_ in fields.FRAME if (value := getattr(one, name))}


def said(data, number=US):
    """What a packet says to us: the fields that are not 0 of each frame; or why it says nothing."""
    one, found = FRAME(), []
    for why in coder(number).read(data, one):
        if why:
            return why
        found.append(values_of(one))
    return found


HELLO_ONLY = {"kind": c.HELLO, "source": OTHER, "hello_no": 258, "hello": 100}
ROUTE = {"seq": 5, "metric": 96, "update": 200}
KNOWN = [
    (HELLO_ONLY, "04 06 00 00 01 02 00 01"),
    (HELLO_ONLY | {"rxcost": 96}, "04 06 00 00 01 02 00 01 05 06 00 00 00 60 00 03"),
    (
        HELLO_ONLY | {"rxcost": c.INFINITY, "has_update": 1} | ROUTE,
        "04 06 00 00 01 02 00 01 05 06 00 00 ff ff 00 03" + (SOURCE + TOLD).hex(),
    ),
    ({"kind": c.UPDATE, "source": OTHER} | ROUTE, (SOURCE + TOLD).hex()),
    ({"kind": c.IHU, "source": OTHER, "rxcost": 256, "hello": 500}, "05 06 00 00 01 00 00 05"),
    ({"kind": c.ROUTE_REQUEST, "source": OTHER}, "09 12 02 80" + PREFIX.hex()),
    (
        {"kind": c.SEQNO_REQUEST, "source": OTHER, "seq": 6, "hops": 64},
        "0a 1e 02 80 00 06 40 00" + SOURCE[4:].hex() + PREFIX.hex(),
    ),
    (
        {"kind": c.ACK_REQUEST, "source": OTHER, "value": 48879, "hello": 1000},
        "02 06 00 00 be ef 00 0a",
    ),
    ({"kind": c.ACK, "source": OTHER, "value": 48879}, "03 02 be ef"),
]


@pytest.mark.parametrize(("values", "octets"), KNOWN)
def test_4_6_octets_by_the_tables(values, octets):
    data = packet(SENDER, bytes.fromhex(octets))
    assert coder(OTHER).encode(frame(**values)) == data
    assert said(data) == [values]


def test_data_is_a_tlv_of_those_for_experiments():
    values = {"kind": c.DATA, "source": 9, "value": 513, "hops": 2}
    data = packet(bytes.fromhex("e0 05 00 09 02 01 02"))
    assert coder().encode(frame(**values)) == data
    assert said(data) == [values]


# "packets with a first octet different from 42 MUST be silently ignored" and "Packets with a second
# octet different from 2 MUST be silently ignored." [4.2]
def test_4_2_what_is_no_packet():
    good = packet(SENDER, TOLD)
    for data in (b"", good[:3], b"\x2b" + good[1:], good[:1] + b"\x03" + good[2:], good[:-1]):
        assert said(data) == NOT_BABEL


# "an implementation MAY silently ignore the packet trailer" [4.2]
def test_4_2_the_trailer_is_not_looked_at():
    good = packet(SENDER, SOURCE, TOLD)
    assert said(good + TOLD + b"\1\2") == said(good)


# "TLVs with an unknown type value MUST be silently ignored." [4.3]
def test_4_3_unknown_types_and_padding():
    pads = (b"\0", b"\1\3\0\0\0", b"\x14\2\1\1")
    assert said(packet(*pads, SENDER, *pads, SOURCE, b"\0", TOLD, *pads)) == said(
        packet(SENDER, SOURCE, TOLD)
    )
    assert said(packet(*pads)) == NOTHING
    assert said(packet()) == NOTHING


def longer(tlv, more):
    """A TLV with sub-TLVs behind it."""
    return tlv[:1] + bytes([tlv[1] + len(more)]) + tlv[2:] + more


# "If the mandatory bit is not set, then an unknown sub-TLV MUST be silently ignored [...] If the
# mandatory bit is set, then the whole enclosing TLV MUST be silently ignored (except for updating
# the parser state by a Router-Id, Next-Hop or Update TLV" [4.4]
@pytest.mark.parametrize(("values", "octets"), KNOWN[:1] + KNOWN[4:])
def test_4_4_sub_tlvs(values, octets):
    tlv = bytes.fromhex(octets)
    assert said(packet(SENDER, longer(tlv, b"\0\1\1\0\x05\2\1\1"))) == [values]
    assert said(packet(SENDER, longer(tlv, b"\0\x80\1\1"))) == NOTHING
    assert said(packet(SENDER, longer(tlv, b"\5\2\1\1")[:-1])) == NOTHING, "cut short"


def test_4_4_the_state_of_the_parser_is_kept_though():
    told = said(packet(SENDER, SOURCE, TOLD))
    refused = b"\x80\0"
    assert said(packet(longer(SENDER, refused), longer(SOURCE, refused), TOLD)) == told
    assert said(packet(SENDER, SOURCE, longer(TOLD, refused))) == NOTHING
    flags = TOLD[:3] + b"\xc0" + TOLD[4:]  # a new default prefix, and the router-id at its end
    short = bytes.fromhex("08 0c 02 00 80 0e 00 02 00 05 00 60 00 03")
    assert said(packet(SENDER, longer(flags, refused), short)) == told


# "multiple Hello TLVs", "a Unicast Hello": "if the Unicast flag is set" [4.6.5]
def test_4_6_5_unicast_hellos_are_passed_over():
    assert said(packet(SENDER, bytes.fromhex("04 06 80 00 01 02 00 01"))) == NOTHING
    other_flags = bytes.fromhex("04 06 7f ff 01 02 00 01")
    assert said(packet(SENDER, other_flags)) == [HELLO_ONLY]


# "If this is 0, then this Hello represents an unscheduled Hello, and doesn't carry any new
# information about times at which Hellos are sent." [4.6.5]
def test_4_6_5_an_unscheduled_hello_promises_nothing():
    node = Bench()
    node.hello(0, hello=0)
    assert node.node.neighbour[0] == -1
    node.hello(0)
    before = node.node.hello_at[0], node.node.hello_us[0]
    node.now += 1000
    node.hello(0, hello=0)
    assert (node.node.hello_at[0], node.node.hello_us[0]) == before
    assert node.node.history[0] == 3


# "IHU TLVs contain an explicit destination address", "it MAY be 0 if [...] the association is over
# a point-to-point link" and "IHU TLVs with an unknown value in the AE field MUST be silently
# ignored." [4.6.6]
@pytest.mark.parametrize(
    ("encoding", "to", "taken"),
    [
        (0, b"", True),
        (3, router_id(US), True),
        (3, router_id(OTHER), False),
        (2, b"\xfe\x80" + bytes(6) + router_id(US), True),
        (2, address(US), False),
        (1, b"\xc0\0\2\1", False),
        (4, b"", False),
    ],
)
def test_4_6_6_whom_an_ihu_is_for(encoding, to, taken):
    tlv = bytes([5, 6 + len(to), encoding, 0, 0, 96, 0, 3]) + to
    assert (said(packet(SENDER, tlv)) != NOTHING) == taken


def test_4_6_6_an_ihu_alone_is_heard():
    node = Bench()
    node.hello(0, rxcost=0)
    assert node.node.txcost[0] == c.INFINITY
    node.comes(0, c.IHU, rxcost=96, hello=120)
    assert node.node.txcost[0] == 96
    assert node.node.ihu_at[0] == node.now + 42_000  # 3.5 times its interval [appendix B]
    node.comes(1, c.IHU, rxcost=96, hello=120)
    assert node.node.txcost[1] == c.INFINITY, "nobody is known there"


# "the first Omitted octets of the prefix are taken from the previous Update TLV with the Prefix
# flag set and the same address encoding", "if Omitted is not zero and there is no such TLV, then
# this Update MUST be ignored" [4.6.9]
def test_4_6_9_compressed_prefixes():
    other = bytes.fromhex("08 12 02 80 40 00 00 02 00 05 00 60") + PREFIX[:8]  # of 64 bits
    short = bytes.fromhex("08 12 02 40 80 08 00 02 00 05 00 60") + PREFIX[8:]
    told = said(packet(SENDER, SOURCE, TOLD))
    assert said(packet(SENDER, other, short)) == told
    assert said(packet(SENDER, short)) == NOTHING
    assert said(packet(SENDER, other[:3] + b"\0" + other[4:], short)) == NOTHING
    assert said(packet(SENDER, SOURCE, short, TOLD)) == told, "what is ignored sets no router-id"


# "if there is no suitable TLV, then this update is ignored" [4.6.9]
def test_4_6_9_whose_route_it_is():
    elsewhere = b"\x06\x0a\0\0" + router_id(OTHER)
    lost = {"kind": c.UPDATE, "source": OTHER} | ROUTE | {"metric": c.INFINITY}
    assert said(packet(SENDER, TOLD)) == NOTHING
    assert said(packet(SENDER, elsewhere, TOLD)) == [lost], "its way to our source is gone"
    assert said(packet(SENDER, b"\x06\x0a\0\0" + bytes(8), TOLD)) == NOTHING


# "If the metric is finite, AE MUST NOT be 0", "If the metric is infinite and AE is 0, Plen and
# Omitted MUST both be 0" and "in which case this Update retracts all of the routes" [4.6.9]
def test_4_6_9_retractions():
    lost = {"kind": c.UPDATE, "source": OTHER, "metric": c.INFINITY, "update": 200}
    one = TOLD[:10] + b"\xff\xff" + TOLD[12:]
    assert said(packet(SENDER, one)) == [lost | {"seq": 5}], "the router-id is not used"
    everything = bytes.fromhex("08 0a 00 00 00 00 00 02 00 00 ff ff")
    assert said(packet(SENDER, everything)) == [lost]
    for wrong in ("00 00 00 00 00 02 00 00 00 60", "00 00 08 00 00 02 00 00 ff ff",
                  "00 00 00 01 00 02 00 00 ff ff", "04 00 00 00 00 02 00 00 ff ff"):  # fmt: skip
        assert said(packet(SENDER, SOURCE, b"\x08\x0a" + bytes.fromhex(wrong))) == NOTHING


# "A Request TLV with AE set to 0 and Plen not set to 0 MUST be ignored." [4.6.10]
def test_4_6_10_route_requests():
    asked = [{"kind": c.ROUTE_REQUEST, "source": OTHER}]
    assert said(packet(SENDER, b"\x09\2\0\0")) == asked, "a full dump"
    assert said(packet(SENDER, b"\x09\3\0\x08\0")) == NOTHING
    assert said(packet(SENDER, b"\x09\x12\2\x80" + address(OTHER))) == NOTHING


# "with either a router-id different from what is specified by the Router-Id field, or a Seqno no
# less", Hop Count "MUST NOT be 0", AE "MUST NOT be 0" [4.6.11]
def test_4_6_11_seqno_requests():
    def asked(hops=64, router=SENDER[4:], encoding=2):
        head = b"\x0a\x1e" + bytes([encoding, 128, 0, 6, hops, 0])
        return said(packet(SENDER, head + router + PREFIX))

    assert asked() == [{"kind": c.ROUTE_REQUEST, "source": OTHER}]
    assert asked(hops=0) == asked(router=b"\xff" * 8) == asked(encoding=0) == NOTHING


# "This MUST NOT be 0." [4.6.3, 4.6.6, 4.6.9]
@pytest.mark.parametrize(
    "octets",
    ["02 06 00 00 be ef 00 00", "05 06 00 00 00 60 00 00", "05 06 00 00 00 00 00 03",
     (TOLD[:6] + bytes(2) + TOLD[8:]).hex()],
)  # fmt: skip
def test_4_6_intervals_of_nothing(octets):
    assert said(packet(SENDER, SOURCE, bytes.fromhex(octets))) == NOTHING


# "every Babel speaker MUST be able to reply to such a request" [3.3]
def test_3_3_a_request_for_an_acknowledgment_is_answered():
    ((port, answer),) = Bench().comes(2, c.ACK_REQUEST, value=48879, hello=1000)
    assert (port, answer.kind, answer.value) == (2, c.ACK, 48879)
    assert Bench().comes(2, c.ACK, value=48879) == []


def test_who_does_not_say_so_is_nobody():
    (one,) = said(packet(bytes.fromhex("04 06 00 00 01 02 00 01")))
    assert one["source"] == NOBODY
    foreign = b"\x07\x0a\3\0" + bytes(range(8))
    (one,) = said(packet(foreign, bytes.fromhex("04 06 00 00 01 02 00 01")))
    assert one["source"] == NOBODY


def test_times_are_rounded_up_and_cut():
    for told, heard in ((40, 100), (101, 200), (65535, 65535)):
        data = coder(OTHER).encode(frame(c.HELLO, hello_no=1, hello=told, rxcost=1))
        assert [one["hello"] for one in said(data)] == [heard]
    slow = bytes.fromhex("04 06 00 00 01 02 ff ff 05 06 00 00 00 60 ff ff")
    assert [one["hello"] for one in said(packet(slow))] == [65535]


def of_many_parts():
    """As babeld has it: a Hello, an IHU of its own interval, updates for others, a request."""
    foreign = bytes.fromhex("08 12 02 80 40 00 06 40 00 05 01 00") + b"\xfd" + bytes(7)
    alone = b"\x05\x0e\3\0\1\0\0\x0a" + router_id(US)
    hello = bytes.fromhex("04 06 00 00 00 09 01 90")
    return packet(hello, alone, SOURCE, foreign, TOLD, b"\x09\2\0\0")


def test_a_packet_of_many_parts_is_heard_in_its_order():
    found = said(of_many_parts())
    assert [one["kind"] for one in found] == [c.HELLO, c.IHU, c.UPDATE, c.ROUTE_REQUEST]
    assert found[-1] == {"kind": c.ROUTE_REQUEST, "source": NOBODY}, (
        "nothing is left of those before"
    )


def test_a_live_node_is_told_each_of_its_parts():
    async def main():
        network = networks()["babel"]
        stack = DeclaredStack(network, US, {**fields.DEFAULTS, "pc": PC}, 1, [0])
        path = Path("cable", 0)
        path.send = sent.append
        link = Link()
        link.paths = [path]
        link.open = opened
        link.close = lambda: None
        async with DeclaredNode("n7", stack, [link]) as node:
            sent.clear()
            node._receive(path, of_many_parts())
            node._receive(path, b"nothing of Babel's")
            return node.counters(), stack.node

    async def opened(_receive):
        """There is nothing to open."""

    sent = []
    counters, node = asyncio.run(main())
    assert counters["frames"] == 4
    assert counters["dropped: no Babel packet"] == 1
    assert (node.neighbour[0], node.txcost[0], node.seq[0], node.metric[0]) == (NOBODY, 256, 5, 96)
    asked, told = (said(data, OTHER) for data in sent)
    assert [one["kind"] for one in (*asked, *told)] == [c.ROUTE_REQUEST, c.UPDATE]


CARRIED = {
    c.HELLO: ("hello_no", "hello", "rxcost", "has_update"),
    c.UPDATE: ("seq", "metric", "update"),
    c.SEQNO_REQUEST: ("seq", "hops"),
    c.IHU: ("rxcost", "hello"),
    c.ACK_REQUEST: ("value", "hello"),
    c.ACK: ("value",),
    c.DATA: ("value", "hops"),
    c.ROUTE_REQUEST: (),
}


@pytest.mark.parametrize("kind", CARRIED)
def test_whatever_is_said_is_heard(kind):
    draw = random.Random(kind)
    ranges = {name: (low, high) for name, _length, low, high, *_ in fields.FRAME}
    for _ in range(300):
        names = ["source", *CARRIED[kind]]
        values = {"kind": kind} | {name: draw.randint(*ranges[name]) for name in names}
        if values.get("has_update"):
            values |= {name: draw.randint(*ranges[name]) for name in CARRIED[c.UPDATE]}
        for name in ("hello", "update"):  # whole centiseconds
            if name in values:
                values[name] = 100 * draw.randint(1, 218)
        for name in ("rxcost", "hops"):
            if name in values and kind != c.DATA:
                values[name] = max(1, values[name])
        sender = values["source"] if kind != c.DATA else OTHER
        data = coder(sender).encode(frame(**values))
        assert len(data) <= 80
        assert said(data) == [{name: value for name, value in values.items() if value}]


def in_range(found):
    ranges = {name: (low, high) for name, _length, low, high, *_ in fields.FRAME}
    assert all(ranges[name][0] <= value <= ranges[name][1] for one in found
               for name, value in one.items())  # fmt: skip


@given(st.binary(max_size=120))
def test_any_bytes_will_do(data):
    for found in (said(data), said(packet(data))):
        if isinstance(found, list):
            in_range(found)


TLV = st.tuples(st.integers(0, 12), st.binary(max_size=40))


@given(st.lists(TLV, max_size=6), st.sampled_from([b"", SENDER, SOURCE, TOLD]))
def test_any_tlvs_will_do(tlvs, first):
    found = said(packet(first, *(pack("BB", kind, len(body)) + body for kind, body in tlvs)))
    if isinstance(found, list):
        in_range(found)


def test_4_packets_are_looked_for_at_the_port_that_babel_has():
    assert Packets.wireshark == ("udp.port", 6696)
