"""Packets of others, at the edges of what RFC 8966 [4] allows; numbers as in its other tests."""

import pytest

from innervate.networks.babel import tlvs
from innervate.networks.babel.packets import NOTHING, centiseconds
from innervate.networks.babel.protocol.constants import (
    DATA,
    HELLO,
    IHU,
    INFINITY,
    ROUTE_REQUEST,
    UPDATE,
)
from innervate.networks.babel.tlvs import NOBODY, Parser, address, router_id
from tests.networks.babel.test_rfc8966_packets import (
    OTHER,
    PREFIX,
    SENDER,
    SOURCE,
    TOLD,
    coder,
    frame,
    longer,
    packet,
    said,
)

ALONE = bytes.fromhex("04 06 00 00 01 02 00 01")  # a Hello
MINE = bytes.fromhex("05 06 00 00 00 60 00 03")  # an IHU for whoever hears it
TOLD_ALONE = {"kind": UPDATE, "source": OTHER, "seq": 5, "metric": 96, "update": 200}


def update(encoding, bits, omitted, octets, flags=0, metric=96):
    body = bytes([encoding, flags, bits, omitted, 0, 2, 0, 5]) + metric.to_bytes(2, "big") + octets
    return bytes([8, len(body)]) + body


@pytest.mark.parametrize(("octets", "number"), [
    (router_id(9), 9), (address(9), 9), (b"\xff" * 8 + router_id(9), 9),
    (b"innerw\0\x09", NOBODY), (b"jnnerv\0\x09", NOBODY), (router_id(9)[1:], NOBODY),
])  # fmt: skip
def test_whose_an_address_is(octets, number):
    assert tlvs.number_of(octets) == number


@pytest.mark.parametrize(("head", "source"), [
    ("07 0a 03 00", OTHER), ("07 12 02 00 fd 69 6e 6e 65 72 76 61", OTHER),
    ("07 12 02 00 fe 80 00 00 00 00 00 00", OTHER), ("07 0a 01 00", NOBODY),
    ("07 0a 04 00", NOBODY), ("07 09 03 00", NOBODY),
])  # fmt: skip
def test_who_sends_is_said_by_a_next_hop_of_either_form_and_whole(head, source):
    hop = bytes.fromhex(head) + router_id(OTHER)
    (one,) = said(packet(hop[: 2 + hop[1]], ALONE))
    assert one["source"] == source


def test_a_router_id_that_is_cut_short_is_none():
    short = bytes.fromhex("06 09 00 00 69 6e 6e 65 72 76 00")
    assert said(packet(SENDER, SOURCE, short, TOLD)) == [TOLD_ALONE]
    assert said(packet(SENDER, short, TOLD)) == NOTHING


def test_an_octet_that_is_begun_is_there():
    """Of 60 bits there are 8 octets, the last of which ends in zeros."""
    kept, rest = 0x80, update(2, 128, 7, PREFIX[7:])
    whole = update(2, 60, 0, PREFIX[:8], kept)
    assert said(packet(SENDER, SOURCE, whole, rest)) == [TOLD_ALONE]
    assert said(packet(SENDER, SOURCE, whole, update(2, 128, 8, PREFIX[8:]))) == NOTHING
    assert said(packet(SENDER, SOURCE, update(2, 60, 0, PREFIX[:7], kept), rest)) == NOTHING
    assert said(packet(SENDER, SOURCE, update(2, 64, 0, PREFIX[:8], kept),
                       update(2, 128, 8, PREFIX[8:]))) == [TOLD_ALONE]  # fmt: skip


def test_no_prefix_has_more_bits_than_its_address():
    assert said(packet(SENDER, SOURCE, update(2, 136, 0, PREFIX + b"\0", 0x80))) == NOTHING
    assert said(packet(SENDER, SOURCE, update(3, 72, 0, PREFIX[:9]))) == NOTHING


@pytest.mark.parametrize(("bits", "octets", "ours"), [(128, 16, True), (120, 15, False)])
def test_a_shorter_prefix_is_another_though_it_ends_in_zeros(bits, octets, ours):
    parser = Parser(7, 256)
    for kind, body in (
        (tlvs.ROUTER_ID_TLV, b"\0\0" + router_id(256)),
        (tlvs.UPDATE_TLV, update(2, bits, 0, address(256)[:octets])[2:]),
        (tlvs.ROUTE_REQUEST_TLV, bytes([2, bits]) + address(256)[:octets]),
        (tlvs.SEQNO_REQUEST_TLV, bytes([2, bits, 0, 6, 9, 0]) + router_id(256) +
         address(256)[:octets]),
    ):  # fmt: skip
        parser.take(kind, body)
    assert len(parser.messages) == (3 if ours else 0)


def test_a_retraction_of_everything_names_no_router():
    everything = update(0, 0, 0, b"", 0x40, INFINITY)
    assert [one["metric"] for one in said(packet(SENDER, SOURCE, everything, TOLD))] == [
        INFINITY, 96]  # fmt: skip


def test_data_may_have_more_behind_it():
    data = bytes.fromhex("e0 05 00 09 02 01 02")
    heard = [{"kind": DATA, "source": 9, "value": 513, "hops": 2}]
    assert said(packet(longer(data, b"\x05\1\1"))) == heard
    assert said(packet(longer(data, b"\x85\1\1"))) == NOTHING
    assert said(packet(bytes.fromhex("e0 04 00 09 02 01"))) == NOTHING


@pytest.mark.parametrize(("tenths_ms", "told"), [(0, 1), (1, 1), (100, 1), (101, 2), (200, 2)])
def test_an_interval_is_never_nothing(tenths_ms, told):
    assert centiseconds(tenths_ms) == told
    octets = coder(OTHER).encode(frame(IHU, rxcost=96, hello=tenths_ms))
    assert octets.endswith(bytes.fromhex("05 06 00 00 00 60 00") + bytes([told]))


def test_a_hello_that_promises_nothing_says_so():
    assert coder(OTHER).encode(frame(HELLO, hello_no=258, hello=0)) == packet(
        SENDER, ALONE[:-1] + b"\0"
    )


def kinds(*parts):
    return [(one["kind"], one.get("source"), one.get("rxcost", 0), one.get("metric", 0))
            for one in said(packet(*parts))]  # fmt: skip


def test_what_comes_behind_a_hello_is_put_into_it_once():
    other = b"\x07\x0a\3\0" + router_id(301)
    late = TOLD[:10] + b"\0\x61" + TOLD[12:]
    assert kinds(SENDER, ALONE, MINE) == [(HELLO, OTHER, 96, 0)]
    assert kinds(SENDER, ALONE, other, MINE) == [(HELLO, OTHER, 0, 0), (IHU, 301, 96, 0)]
    assert kinds(SENDER, ALONE, MINE, MINE) == [(HELLO, OTHER, 96, 0), (IHU, OTHER, 96, 0)]
    assert kinds(SENDER, ALONE, MINE[:-1] + b"\4") == [(HELLO, OTHER, 0, 0), (IHU, OTHER, 96, 0)]
    assert kinds(SENDER, ALONE, SOURCE, TOLD, late) == [
        (HELLO, OTHER, 0, 96), (UPDATE, OTHER, 0, 97)]  # fmt: skip
    assert kinds(SENDER, ALONE, SOURCE, TOLD, MINE) == [
        (HELLO, OTHER, 0, 96), (IHU, OTHER, 96, 0)]  # fmt: skip
    assert kinds(SENDER, ALONE, b"\x09\2\0\0", MINE) == [
        (HELLO, OTHER, 0, 0), (ROUTE_REQUEST, OTHER, 0, 0), (IHU, OTHER, 96, 0)]  # fmt: skip


def test_the_longest_interval_of_an_ihu_goes_with_that_of_its_hello():
    """What is longer than a frame can say is cut, on either side alike."""
    slow = ALONE[:-2] + (300).to_bytes(2, "big")
    ihu = MINE[:-2] + (900).to_bytes(2, "big")
    assert kinds(SENDER, slow, ihu) == [(HELLO, OTHER, 96, 0)]
    assert len(kinds(SENDER, slow, MINE)) == 2
