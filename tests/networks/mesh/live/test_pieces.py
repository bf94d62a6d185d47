"""Messages in pieces at their recipient, at each bound; and which message one is to come after."""

import pytest

from innervate.networks.mesh.live import pieces
from innervate.networks.mesh.live.chains import Chains
from innervate.networks.mesh.live.pieces import (
    EACH,
    HAD,
    HELD_MAX,
    IDLE_US,
    PRESSED_US,
    SIZE_MAX,
    Piece,
    Pieces,
)

KEPT, NOT_KEPT = (True, None), (False, None)


def piece(message=1, at=0, data=b"ab", size=4):
    return Piece(message, True, at, size, data)


def test_a_message_is_there_with_its_last_piece_if_nothing_is_missing_and_once():
    store = Pieces()
    assert store.take(7, piece(at=2), 0) == NOT_KEPT  # the last of all, but one is missing
    assert store.take(7, piece(), 1) == KEPT
    assert store.take(7, piece(data=b"xx"), 2) == KEPT  # it is here already
    assert (len(store), store.held) == (1, 4)
    assert store.take(7, piece(at=2, data=b"cd"), 3) == (True, b"abab")
    assert (len(store), store.held, store.forgotten) == (0, 0, 0)
    assert store.take(7, piece(at=2), 3 + IDLE_US - 1) == KEPT, "a copy that comes late"
    assert (len(store), store.held) == (0, 0)
    assert store.take(7, piece(), 3 + IDLE_US) == KEPT, "its number is used again"
    assert len(store) == 1


def test_pieces_of_other_senders_messages_and_sizes_are_others():
    store = Pieces()
    for sender, one in ((7, piece()), (8, piece()), (7, piece(message=2)), (9, piece(size=6))):
        assert store.take(sender, one, 0) == KEPT
    assert (len(store), store.held) == (4, 18)
    assert store.take(9, piece(at=2, data=b"cdef", size=6), 0) == (True, b"abcdef")
    assert store.take(8, piece(at=2, data=b"yz"), 0) == (True, b"abyz")


@pytest.mark.parametrize(
    ("at", "data", "kept"),
    [(0, b"abc", True), (1, b"abc", True), (2, b"abc", False), (4, b"a", False)],
)
def test_a_piece_lies_within_its_message(at, data, kept):
    store = Pieces()
    store.take(7, piece(at=0, data=b"a"), 0)
    assert store.take(7, piece(at=at, data=data), 0)[0] == kept
    assert store.held == (0 if at == 1 else 4), "with the one from 1 to 3 it was whole"


def test_of_a_sender_so_many_are_open_and_the_oldest_goes():
    store = Pieces()
    for message in range(EACH):
        store.take(7, piece(message), message)
    store.take(8, piece(0), 0)
    assert store.forgotten == 0
    store.take(7, piece(EACH), EACH)
    assert store.forgotten == 1
    assert [name[:2] for name in store._open] == [(7, 1), (8, 0), (7, 2)]


def test_so_many_bytes_are_held_and_where_there_is_no_room_the_idle_ones_go_first():
    store = Pieces()
    many = HELD_MAX // SIZE_MAX
    for sender in range(many):
        assert store.take(sender, piece(size=SIZE_MAX), sender) == KEPT
    assert store.held == HELD_MAX
    late = PRESSED_US
    assert store.take(99, piece(size=4), late - 1) == NOT_KEPT
    assert (len(store), store.forgotten) == (many, 0)
    assert store.take(99, piece(size=4), late) == KEPT  # the first has been idle for so long
    assert (len(store), store.forgotten, store.held) == (many, 1, HELD_MAX - SIZE_MAX + 4)


def test_what_is_idle_is_forgotten_at_its_time_and_what_is_heard_of_stays():
    store = Pieces()
    store.take(7, piece(), 100)
    store.take(8, piece(), 200)
    assert store.due() == 100 + IDLE_US
    store.take(7, piece(), 300)
    assert store.due() == 200 + IDLE_US
    store.forget(200 + IDLE_US - 1)
    assert len(store) == 2
    store.forget(200 + IDLE_US)
    assert ([name[0] for name in store._open], store.forgotten, store.held) == ([7], 1, 4)


def test_so_many_that_were_handed_up_are_remembered_of_each_sender():
    store = Pieces()
    whole = [piece(message, data=b"abcd") for message in range(HAD + 1)]
    for one in whole:
        assert store.take(7, one, 0) == (True, b"abcd")
    assert store.take(7, whole[1], 0) == KEPT
    assert store.take(8, whole[1], 0) == (True, b"abcd")
    assert store.take(7, whole[0], 0) == (True, b"abcd"), "that is too long ago to know"
    assert HAD == 8


def test_the_last_piece_of_a_message():
    some = ((0, b"ab"), (2, b"ab"), (2, b"a"), (0, b"abcd"))
    last = [piece(at=at, data=data).is_last for at, data in some]
    assert last == [False, True, False, True]


def test_heads_of_pieces_are_read_as_they_are_written():
    body = pieces.struct.pack(pieces.PIECE_STRUCT, (5 + 16_384) & 65_535, 3, 1, 9, 99) + b"data"
    assert pieces.read_piece(5, body) == Piece(3, True, 9, 100, b"data")
    assert pieces.read_piece(6, body) is None
    assert pieces.read_piece(5, body[: pieces.HEAD_BYTES]) is None


def test_a_message_comes_after_the_newest_that_has_no_end():
    chains = Chains()
    assert chains.before(4, 10) == 10  # none to wait for
    assert not chains.is_open(4)
    for handle, (dest, seq) in enumerate(((4, 10), (4, 11), (4, 12), (5, 13))):
        chains.sent(handle, dest, seq, is_reliable=True)
    assert (chains.before(4, 14), chains.before(5, 14), chains.before(6, 14)) == (12, 13, 14)
    chains.ended(2, is_delivered=False)  # 12 will not come
    assert chains.before(4, 14) == 11
    chains.ended(1, is_delivered=True)  # 11 did, after all before it
    assert chains.before(4, 14) == 14
    assert chains.is_open(4), "of 10 nothing was told yet"
    chains.ended(0, is_delivered=True)
    assert (chains.is_open(4), chains.is_open(5)) == (False, True)
    chains.ended(77, is_delivered=True)


def test_one_that_is_not_reliable_stands_for_all_before_it():
    chains = Chains()
    chains.sent(1, 4, 10, is_reliable=True)
    chains.sent(2, 4, 11, is_reliable=False)
    assert chains.before(4, 12) == 11
    chains.ended(1, is_delivered=True)
    assert chains.before(4, 12) == 11
    chains.sent(3, 4, 12, is_reliable=True)
    chains.ended(3, is_delivered=True)
    assert chains.before(4, 13) == 13


def test_numbers_go_round():
    chains = Chains()
    for handle, seq in enumerate((65_535, 0)):
        chains.sent(handle, 4, seq, is_reliable=True)
    chains.ended(0, is_delivered=True)
    assert chains.before(4, 1) == 0
    chains.ended(1, is_delivered=True)
    assert chains.before(4, 1) == 1


def test_a_recipient_that_has_none_of_ours_may_have_numbers_of_an_earlier_life():
    chains = Chains(boot=0)
    chains.sent(1, 4, 10, is_reliable=True)
    chains.sent(2, 5, 11, is_reliable=True)
    chains.ended(1, is_delivered=True)
    chains.ended(2, is_delivered=False)
    assert [chains.boot(dest) for dest in (4, 5, 6)] == [None, 0, 0]
    chains = Chains()
    assert chains.boot(4) is None
