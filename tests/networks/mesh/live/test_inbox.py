"""What comes in for a node's user: what is counted, handed up and acknowledged, and when."""

import asyncio
import struct
from collections import Counter
from types import SimpleNamespace

import pytest

from innervate.networks.mesh.live.inbox import HAD_US, Inbox
from innervate.networks.mesh.live.pieces import IDLE_US, REFUSAL, Piece
from innervate.networks.mesh.payloads import PIECE_AHEAD, PIECE_STRUCT
from innervate.networks.mesh.protocol.constants import ALL, ORDERED
from innervate.networks.mesh.protocol.duplicates import ANEW
from tests.live import time_by_hand


class Orderly:
    """Notes what it is given."""

    def __init__(self):
        self.taken, self.repeated, self.stopped, self.boots = [], [], 0, []

    def take(self, message):
        self.boots.append(message.boot)
        self.taken.append((message.sender, message.seq, message.before, message.payload))

    def again(self, message):
        self.boots.append(message.boot)
        self.repeated.append((message.sender, message.seq, message.before, message.payload))

    def counters(self):
        return Counter({"messages out of turn": 2})

    def stop(self):
        self.stopped += 1


def inbox():
    made = Inbox(Orderly(), lambda *one: made.told.append(one), Counter())
    made.told, made.got = [], []
    made.arrivals.receive(lambda *one: made.got.append(one))
    return made


def frame(body, seq=10, flags=ORDERED, dest=1, origin=5):
    return SimpleNamespace(body=bytearray(body + b"more"), length=len(body), flags=flags,
                           dest=dest, origin=origin, seq=seq)  # fmt: skip


def run(what, *given):
    async def main():
        return what(*given)

    return time_by_hand.run(main())


@pytest.mark.parametrize(
    ("flags", "dest", "body", "before", "payload"),
    [
        (ORDERED, 1, b"\x00\x09text", 9, b"text"), (ORDERED, 1, b"\x00\x0atext", 10, b"text"),
        (ORDERED, 1, b"\x00\x0btext", 10, b"text"),  # none can come after a later one
        (0, 1, b"\x00\x09text", None, b"\x00\x09text"),
        (ORDERED, ALL, b"\x00\x09", None, b"\x00\x09"),
        (ORDERED, 1, b"\x09", None, b"\x09"), (ORDERED, 1, b"\x00\x09", 9, b""),
    ],
)  # fmt: skip
def test_a_message_in_order_begins_with_the_one_before_it(flags, dest, body, before, payload):
    def come():
        one = inbox()
        one.note(frame(body, flags=flags, dest=dest), False)
        assert (one.got, one.outcomes) == ([], {"messages received": 1})
        one.hand_up()
        one.hand_up()
        assert one.got == [(5, payload)]
        assert one.orderly.taken == [(5, 10, before, payload)]

    run(come)


@pytest.mark.parametrize(("before", "boot"), [
    (b"\x80\x0a", 0), (b"\x80\x09", 1), (b"\x7f\x8b", 127), (b"\x7f\x8a", None),
    (b"\x80\x0b", None), (b"\x00\x0a", None),
])  # fmt: skip
@pytest.mark.parametrize("is_again", [False, True])
def test_a_message_of_an_origin_that_is_new_comes_after_none(before, boot, is_again):
    def come():
        one = inbox()
        one.note(frame(before + b"text"), is_again)
        one.hand_up()
        (found,) = one.orderly.repeated if is_again else one.orderly.taken
        assert found[2] == (32_779 if before == b"\x80\x0b" else 10)
        assert one.orderly.boots == [boot]

    run(come)


def test_a_copy_is_not_counted_nor_handed_up():
    def come():
        one = inbox()
        one.note(frame(b"\x00\x09text"), True)
        one.hand_up()
        assert (one.got, one.outcomes, one.orderly.taken) == ([], {}, [])
        assert one.orderly.repeated == [(5, 10, 9, b"text")]

    run(come)


def test_what_came_before_is_a_copy_whatever_the_router_says():
    async def main():
        one = inbox()

        def come(text, seq=10, origin=5, before=9):
            one.note(frame(bytes([0, before]) + text, seq, origin=origin), False)

        come(b"text")
        come(b"text", before=8)  # what was between has expired
        come(b"text", seq=11)
        come(b"text", origin=6)
        come(b"of another life")
        await asyncio.sleep(HAD_US / 1e6 - 0.001)
        come(b"text", seq=11)
        await asyncio.sleep(0.002)
        come(b"text", seq=11)
        for seq in range(100, 100 + ANEW - 1):
            come(b"", seq)
        come(b"text", seq=11)  # it is the oldest of those that are known
        come(b"", seq=9000)
        come(b"text", seq=11)
        one.hand_up()
        return one

    one = time_by_hand.run(main())
    text = [one for one in one.orderly.taken if one[3] != b""]
    assert [(sender, seq) for sender, seq, *_ in text] == [
        (5, 10), (5, 11), (6, 10), (5, 10), (5, 11), (5, 11)]  # fmt: skip
    assert [seq for _, seq, *_ in one.orderly.repeated] == [10, 11, 11]


def piece(seq, at, data, size=4, in_order=0, message=10):
    mark = (seq + PIECE_AHEAD) & 65_535
    return frame(struct.pack(PIECE_STRUCT, mark, message, in_order, at, size - 1) + data, seq)


@pytest.mark.parametrize(("in_order", "boot"), [(0, None), (1, None), (2, 0), (129, 127)])
def test_pieces_are_acknowledged_as_they_come_and_the_last_with_the_whole(in_order, boot):
    def come():
        one = inbox()
        for seq, at, data in ((10, 0, b"ab"), (11, 2, b"cd")):
            one.note(piece(seq, at, data, in_order=in_order), False)
            one.hand_up()
        assert one.outcomes == {"pieces received": 2, "messages received": 1}
        assert one.got == [(5, b"abcd")]
        assert one.orderly.boots == [boot]
        assert one.told == ([(5, 10)] if in_order else [(5, 10), (5, 11)])
        assert one.orderly.taken == [(5, 11, 11 if in_order else None, b"abcd")]
        one.note(piece(11, 2, b"cd", in_order=in_order), True)  # it was not heard that it came
        one.hand_up()
        assert one.orderly.repeated == ([(5, 11, 11, b"")] if in_order else [])
        assert one.told[1 if in_order else 2 :] == ([] if in_order else [(5, 11)])
        assert one.orderly.boots == [boot] * (2 if in_order else 1)
        assert one.outcomes == {"pieces received": 2, "messages received": 1}
        assert one.held() == {"messages": 0, "bytes": 0}

    run(come)


def test_a_last_piece_that_leaves_a_hole_is_refused():
    def come():
        one, refused = inbox(), []
        one.refuse = lambda *given: refused.append(given)
        one.note(piece(11, 2, b"cd"), False)
        one.hand_up()
        assert (one.told, one.got) == ([], [])
        assert one.held() == {"messages": 1, "bytes": 4}
        assert refused == [(5, 11, Piece(10, 0, 2, 4, b"cd"))]
        one.stop()

    run(come)


def test_a_refusal_is_no_piece_of_a_message_and_is_acknowledged():
    def come():
        one, refused = inbox(), []
        one.refused = lambda *given: refused.append(given)
        one.note(piece(30, 0, b"\0", in_order=REFUSAL), False)
        one.hand_up()
        assert (one.told, one.got, len(one.pieces)) == ([(5, 30)], [], 0)
        assert refused == [(5, Piece(10, REFUSAL, 0, 4, b"\0"))]

    run(come)


def test_what_is_never_whole_is_forgotten_at_its_time_also_after_a_new_start():
    async def main():
        one, found = inbox(), []
        for _ in range(2):
            one.note(piece(10, 0, b"ab"), False)
            one.hand_up()
            one.stop()
            assert one._sweep is None
            one.note(piece(10, 0, b"ab", message=12), False)
            one.hand_up()  # it has begun anew
            await asyncio.sleep(IDLE_US / 1e6 - 0.001)
            found.append(len(one.pieces))
            await asyncio.sleep(0.002)
            found.append(len(one.pieces))
        return one, found

    one, found = time_by_hand.run(main())
    assert found == [2, 0] * 2
    assert one.counters() == {"messages never whole": 4, "messages out of turn": 2}
    assert one.orderly.stopped == 2
    assert inbox().counters() == {"messages out of turn": 2}


def test_a_long_message_to_oneself_is_handed_up_at_once():
    def come():
        one = inbox()
        one.put_own(1, b"long")
        assert one.got == [(1, b"long")]
        assert one.outcomes == {"messages received": 1}
        assert one.told == []

    run(come)


def test_the_last_piece_is_one_that_ends_where_the_message_does():
    assert Piece(1, False, 2, 4, b"cd").is_last
