"""Messages longer than a frame: whole, once, in order, or told; under simulated time."""

import asyncio
import random

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from innervate.live.receipts import DELIVERED, EXPIRED, REFUSED
from innervate.networks.mesh.live import pieces
from innervate.networks.mesh.live.pieces import SIZE_MAX, Pieces
from tests.live import time_by_hand as live_time
from tests.live.net import Mesh

LINE = [(0, 1), (1, 2)]


def lossy(mesh, share, seed=1):
    """Frames are lost on all cables, by a seed."""
    chance = random.Random(seed)
    for a, b in mesh.cables.values():
        for path in (a, b):
            path.take = lambda data, take=path.take: chance.random() < share or take(data)


def listening(node, in_order=True):
    got = []
    node.receive_messages(lambda sender, data: got.append((sender, data)), in_order=in_order)
    return got


def at_piece(node, count, do):
    """Do something to a node when so many pieces came."""
    take, came = node.inbox.pieces.take, []

    def watched(*given):
        came.append(given)
        if len(came) == count:
            do(node)
        return take(*given)

    node.inbox.pieces.take = watched


def run(story, *given):
    return live_time.run(story(*given))


@pytest.mark.parametrize(("size", "mtu"), [(91, 127), (65_536, 1200), (5000, 64), (164, 127)])
@pytest.mark.parametrize("in_order", [False, True])
def test_a_long_message_arrives_whole(size, mtu, in_order):
    payload = random.Random(size).randbytes(size)

    async def main():
        async with Mesh(3, LINE, mtu=mtu) as mesh:
            got = [listening(mesh.nodes[2], kind) for kind in (False, True)]
            told = await mesh.nodes[0].send_message(2, payload, in_order=in_order).wait()
            return told, got, mesh.nodes[2].status()["in_pieces"]

    told, got, left = run(main)
    assert told == DELIVERED
    assert got == [[(0, payload)]] * 2
    assert left == {"messages": 0, "bytes": 0}


def test_where_frames_are_lost_all_arrive_once_and_in_order():
    async def main():
        async with Mesh(3, LINE) as mesh:
            got = listening(mesh.nodes[2])
            lossy(mesh, 0.2)
            sizes = [10, 3000, 20, 88, 89, 1000, 30]
            sent = [bytes([k]) * size for k, size in enumerate(sizes)]
            receipts = [mesh.nodes[0].send_message(2, one, in_order=True) for one in sent]
            told = [await receipt.wait() for receipt in receipts]
            return told, sent, [data for _, data in got]

    told, sent, got = run(main)
    assert told == [DELIVERED] * len(sent)
    assert got == sent


def test_a_recipient_that_starts_anew_in_the_middle_has_no_half_of_it():
    payload = bytes(range(256)) * 20

    async def main():
        async with Mesh(3, LINE) as mesh:
            got = listening(mesh.nodes[2])
            at_piece(mesh.nodes[2], 20, lambda node: setattr(node.inbox, "pieces", Pieces()))
            told = [await mesh.nodes[0].send_message(2, payload, in_order=True).wait()]
            told.append(await mesh.nodes[0].send_message(2, payload, in_order=True).wait())
            await asyncio.sleep(31)
            return told, [data for _, data in got], mesh.nodes[2]

    told, got, node = run(main)
    assert told == [EXPIRED, DELIVERED]
    assert got == [payload]
    assert node.counters()["messages never whole"] == 1
    assert len(node.inbox.pieces) == 0


def test_the_sender_is_told_at_once_that_its_recipient_was_started_anew():
    """It was told when the last piece had been tried for as long as a packet is, up to 26 s."""

    async def main():
        async with Mesh(3, LINE) as mesh:
            loop, at = asyncio.get_running_loop(), []
            at_piece(mesh.nodes[2], 20, lambda node: setattr(node.inbox, "pieces", Pieces()))
            at_piece(mesh.nodes[2], 20, lambda _: at.append(loop.time()))
            node = mesh.nodes[0]
            receipt = node.send_message(2, bytes(2000))
            told = await receipt.wait(), receipt.reason
            took_s = loop.time() - at[0]
            await asyncio.sleep(1)
            kept = sum(node.stack.node.wait_kind[:])
            return told, took_s, node.status(), mesh.nodes[2].status(), kept

    told, took_s, *status, kept = run(main)
    assert told == (EXPIRED, "its recipient no longer has its beginning")
    assert took_s < 0.5
    assert [one["under_way"] for one in status] == [0, 0]
    assert kept == 0  # nor does the router try the last piece any more


@pytest.mark.parametrize(
    ("of", "by", "size", "told"),
    [(0, 0, 0, EXPIRED), (1, 0, 0, DELIVERED), (0, -1, 0, DELIVERED), (0, 0, 1, DELIVERED)],
)
def test_a_refusal_ends_the_message_that_it_names_and_no_other(of, by, size, told):
    async def main():
        async with Mesh(3, LINE) as mesh:
            sender, take = mesh.nodes[0], mesh.nodes[2].inbox.pieces.take

            def watched(origin, piece, now):
                if piece.is_last:
                    named = piece.message + of, piece.size + size
                    refusal = pieces.Piece(named[0], pieces.REFUSAL, 0, named[1], b"\0")
                    sender.outgoing.refused(2 + by, refusal)
                return take(origin, piece, now)

            mesh.nodes[2].inbox.pieces.take = watched
            return await sender.send_message(2, bytes(2000)).wait()

    assert run(main) == told


def test_those_after_one_that_expired_wait_for_nothing():
    async def main():
        async with Mesh(3, LINE) as mesh:
            got, node = listening(mesh.nodes[2]), mesh.nodes[0]
            mesh.nodes[2].inbox.pieces.take = lambda *given: (not given[1].is_last, None)
            sent = [node.send_message(2, bytes(90), in_order=True) for _ in range(2)]
            sent += [node.send_message(2, b"%d" % k, in_order=True) for k in range(3)]
            told = [await receipt.wait() for receipt in sent[:2]]
            loop = asyncio.get_running_loop()
            at = loop.time()
            told += [await receipt.wait() for receipt in sent[2:]]
            return told, got, loop.time() - at

    told, got, later_s = run(main)
    assert told == [EXPIRED, EXPIRED, DELIVERED, DELIVERED, DELIVERED]
    assert [data for _, data in got] == [b"0", b"1", b"2"]
    assert later_s < 5  # else the 10 s for which one may be missing


def test_pieces_of_a_sender_that_is_gone_are_forgotten():
    async def main():
        async with Mesh(3, LINE) as mesh:
            at_piece(mesh.nodes[2], 20, lambda _: mesh.cut(0, 1))
            mesh.nodes[0].send_message(2, bytes(50_000))
            await asyncio.sleep(29)
            held = [mesh.nodes[2].status()["in_pieces"]]
            await asyncio.sleep(3)
            return [*held, mesh.nodes[2].status()["in_pieces"]]

    before, after = run(main)
    assert before == {"messages": 1, "bytes": 50_000}
    assert after == {"messages": 0, "bytes": 0}


def test_a_recipient_without_room_takes_what_fits_and_the_sender_hears_of_the_rest(monkeypatch):
    monkeypatch.setattr(pieces, "HELD_MAX", 3000)

    async def main():
        async with Mesh(3, [(0, 2), (1, 2)]) as mesh:
            got = listening(mesh.nodes[2], False)
            sent = [mesh.nodes[k].send_message(2, bytes([k]) * size)
                    for k, size in ((0, 2000), (1, 2000), (0, 3001), (0, 90))]  # fmt: skip
            told = [await receipt.wait() for receipt in sent]
            return told, sorted((who, len(data)) for who, data in got)

    told, got = run(main)
    assert told == [DELIVERED, DELIVERED, EXPIRED, DELIVERED]  # the second one waits for room
    assert got == [(0, 90), (0, 2000), (1, 2000)]


def test_an_urgent_message_does_not_wait_for_a_long_one_nor_do_other_recipients():
    async def main():
        async with Mesh(3, LINE) as mesh:
            long = mesh.nodes[0].send_message(2, bytes(60_000))
            urgent = mesh.nodes[0].send_message(2, b"!", priority=True)
            other = mesh.nodes[0].send_message(1, b"?")
            told = [await urgent.wait(), await other.wait(), mesh.nodes[2].inbox.held()["messages"]]
            return [*told, await long.wait()]

    assert run(main) == [DELIVERED, DELIVERED, 1, DELIVERED]


def test_what_cannot_go_in_pieces_is_refused():
    async def main():
        async with Mesh(2, [(0, 1)]) as mesh:
            node, got = mesh.nodes[0], listening(mesh.nodes[0], False)
            for to, size, how, why in (
                (255, 91, {}, "payload of 91 bytes; a message to all holds at most 90"),
                (1, 91, {"reliable": False}, "a message that is not reliable holds at most 90"),
                (1, SIZE_MAX + 1, {}, "a message holds at most 65536"),
            ):
                with pytest.raises(ValueError, match=why):
                    node.send_message(to, bytes(size), **how)
            own = node.send_message(0, bytes(SIZE_MAX))
            full = [node.send_message(1, bytes(SIZE_MAX)).state for _ in range(65)]
            return own.state, full, [len(data) for _, data in got]

    own, full, got = run(main)
    assert own == DELIVERED
    assert full[-1] == REFUSED
    assert REFUSED not in full[:-1]
    assert got == [SIZE_MAX]


SIZES = st.lists(st.integers(1, 300), min_size=1, max_size=12)


@settings(max_examples=100, deadline=None, database=None)
@given(SIZES, st.randoms(use_true_random=False))
def test_pieces_in_any_order_and_twice_make_the_message_when_the_last_one_came(sizes, chance):
    whole, at, found = chance.randbytes(sum(sizes)), 0, []
    for size in sizes:
        found.append(pieces.Piece(5, False, at, len(whole), whole[at : at + size]))
        at += size
    store, others = Pieces(), [*found[:-1], *found[:-1]]
    chance.shuffle(others)
    assert all(store.take(1, one, 0) == (True, None) for one in others)
    assert store.take(2, found[-1], 0) == (len(sizes) == 1, whole if len(sizes) == 1 else None)
    assert store.take(1, found[-1], 0) == (True, whole)
    assert store.take(1, chance.choice(found), 0) == (True, None)
    store.forget(pieces.IDLE_US)
    assert (len(store), store.held) == (0, 0)


def test_a_sender_has_at_most_two_open_and_the_older_one_goes():
    store = Pieces()
    for message in range(5):
        assert store.take(1, pieces.Piece(message, False, 0, 1000, b"x"), 0)[0]
    assert (len(store), store.held, store.forgotten) == (2, 2000, 3)
    assert store.take(1, pieces.Piece(4, False, 999, 1000, b"xy"), 0) == (False, None)  # too long


@given(st.integers(0, 65_535), st.binary(max_size=40))
def test_no_message_is_taken_for_a_piece(seq, text):
    before = seq.to_bytes(2, "big")
    assert pieces.read_piece(seq, before + text) is None
