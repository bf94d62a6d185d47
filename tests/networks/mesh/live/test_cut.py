"""A long message at its sender, piece by piece: how it is cut, when each may go, what becomes."""

from types import SimpleNamespace

import pytest

from innervate.live.receipts import ACCEPTED, DELIVERED, EXPIRED, HOP_ACKED
from innervate.networks.mesh.live.chains import Chains
from innervate.networks.mesh.live.long import Long
from innervate.networks.mesh.live.pieces import HEAD_BYTES, NO_TURN, Pieces, read_piece

DEST, ROOM = 7, HEAD_BYTES + 10  # ten bytes of the message in a packet


def cut(long, count=None):
    """The next pieces, or all: their receipts and items."""
    made = []
    while not long.is_cut and len(made) != count:
        item = SimpleNamespace(body=[0] * 64)
        receipt = []
        long.cut(lambda one, item=item, receipt=receipt: (receipt.append(one), item))
        made.append((receipt[0], item))
    return made


@pytest.mark.parametrize(("size", "sizes"), [
    (1, [1]), (9, [9]), (10, [10]), (11, [10, 1]), (20, [10, 10]), (35, [10, 10, 10, 5]),
])  # fmt: skip
def test_pieces_are_as_long_as_there_is_room_and_the_last_is_the_rest(size, sizes):
    payload = bytes(range(100, 100 + size))
    long = Long(DEST, 5, payload, ROOM, None)
    pieces = cut(long)
    assert [item.length - HEAD_BYTES for _, item in pieces] == sizes
    assert [receipt.at for receipt, _ in pieces] == [10 * k for k in range(len(sizes))]
    assert [receipt.is_last for receipt, _ in pieces] == [False] * (len(sizes) - 1) + [True]
    assert {(item.dest, item.flags) for _, item in pieces} == {(DEST, 5)}
    bodies = [bytes(item.body[HEAD_BYTES : item.length]) for _, item in pieces]
    assert b"".join(bodies) == payload
    # Their heads are read as they were meant, whatever number each packet has.
    received = Pieces()
    for (receipt, _), body, seq in zip(pieces, bodies, range(65_534, 65_600), strict=False):
        head = long.head(receipt.at, seq & 65_535)
        piece = read_piece(seq & 65_535, head + body)
        assert (piece.at, piece.is_last, piece.turn) == (receipt.at, receipt.is_last, NO_TURN)
        whole = received.take(1, piece, 0)
    assert whole == (True, payload)


@pytest.mark.parametrize("chained", [False, True])
def test_the_last_piece_goes_when_all_others_have_their_end_and_those_before_it(chained):
    chains = Chains()
    long = Long(DEST, 0, bytes(25), ROOM, chains if chained else None)
    chains.sent(1, DEST, 40, True)
    assert long.in_order == chained
    (first, _), (second, _) = cut(long, 2)
    assert long.is_ending
    assert not long.is_cut
    assert not long.may_go()  # two are under way
    for receipt in (second, first):
        receipt.move(DELIVERED)
    assert long.may_go() == (not chained)
    chains.ended(1, True)
    assert long.may_go()
    chains.sent(2, DEST + 1, 41, True)  # to somebody else
    assert long.may_go()


def test_pieces_before_the_last_may_always_go():
    long = Long(DEST, 0, bytes(25), ROOM, None)
    assert long.may_go()
    cut(long, 1)
    assert long.may_go()


def ends_of(long):
    ends = []
    long.on_end = lambda state, reason: (ends.append((state, reason)), long.receipt.move(state))
    return ends


def test_what_becomes_of_the_last_piece_becomes_of_the_message():
    long = Long(DEST, 0, bytes(15), ROOM, None)
    ends = ends_of(long)
    assert long.receipt.state == ACCEPTED
    (first, _), (last, _) = cut(long)
    first.seq, last.seq = 50, 51
    first.move(HOP_ACKED)
    assert (long.receipt.state, long.receipt.seq, ends) == (HOP_ACKED, 50, [])
    first.move(DELIVERED)
    assert ends == []
    last.move(DELIVERED)
    assert (ends, long.receipt.state, long.receipt.seq) == ([(DELIVERED, "")], DELIVERED, 51)


def test_a_piece_that_expires_ends_the_message_once():
    long = Long(DEST, 0, bytes(25), ROOM, None)
    ends = ends_of(long)
    (first, _), (second, _), (last, _) = cut(long)
    first.move(EXPIRED, "nobody there")
    second.move(EXPIRED, "later")
    last.move(DELIVERED)
    assert ends == [(EXPIRED, "nobody there")]
    assert long.receipt.state == EXPIRED
