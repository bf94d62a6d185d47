import asyncio
import random
from itertools import pairwise

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from innervate.dialect.arith import MASK16, later
from innervate.live.receipts import DELIVERED, EXPIRED
from innervate.networks.mesh.live.order import Message, Order, Orderly
from innervate.networks.mesh.protocol import queue as mesh_queue
from innervate.networks.mesh.protocol.constants import DATA
from tests.live import time_by_hand
from tests.live.net import Mesh, until

LINE = [(0, 1), (1, 2)]
PROFILE = {"ack_us": 5000, "e2e_us": 30_000}  # of live nodes
WAIT = 1000


def chain(count, start, steps):
    """(seq, before) of messages of one sender; numbers between them went to others."""
    numbers = [start]
    for k in range(count - 1):
        numbers.append((numbers[-1] + steps[k % len(steps)]) & MASK16)
    return list(zip(numbers, [start, *numbers], strict=False))


@settings(max_examples=100, deadline=None, database=None)
@given(
    st.integers(1, 40), st.integers(0, MASK16), st.lists(st.integers(1, 9), min_size=1),
    st.randoms(use_true_random=False),
)  # fmt: skip
def test_whatever_the_order_in_which_they_come_they_go_up_as_they_were_sent(
    count, start, steps, chance
):
    sent = [(seq, before, b"%d" % k) for k, (seq, before) in enumerate(chain(count, start, steps))]
    mixed = sent.copy()
    chance.shuffle(mixed)
    order, got = Order(None, WAIT), []
    for seq, before, payload in mixed:
        got += order.take(seq, before, payload, now=0)
    assert got == [payload for _, _, payload in sent]
    assert not order.held
    assert order.late == 0


@settings(max_examples=100, deadline=None, database=None)
@given(
    st.integers(2, 40), st.integers(0, MASK16), st.integers(1, 8),
    st.randoms(use_true_random=False),
)  # fmt: skip
def test_with_losses_nothing_is_out_of_order_and_all_that_came_is_accounted_for(
    count, start, buffer, chance
):
    order, got, now, came = Order(None, WAIT, buffer), [], 0, 0
    first, *rest = [(*pair, bytes([k])) for k, pair in enumerate(chain(count, start, [3]))]
    chance.shuffle(rest)
    for seq, before, payload in [first, *rest]:
        now += chance.randrange(WAIT)
        got += order.release(now)
        if chance.random() < 0.8 or before == seq:
            came += 1
            got += order.take(seq, before, payload, now)
        assert len(order.held) <= buffer
    got += order.release(now + WAIT)
    assert not order.held
    assert all(a < b for a, b in pairwise(got))
    assert len(got) + order.late == came


def test_one_that_is_missing_is_waited_for_and_no_longer():
    order = Order(10, WAIT)
    assert order.take(13, 12, b"c", now=0) == []
    assert order.release(WAIT - 1) == []
    assert order.due() == WAIT
    assert order.release(WAIT) == [b"c"]
    assert order.take(12, 10, b"b", now=WAIT) == []
    assert order.late == 1


def test_a_sender_that_starts_anew_is_not_waited_for():
    order = Order(10, WAIT)
    assert order.take(12, 11, b"old", now=0) == []
    assert order.take(20_000, 20_000, b"new", now=1) == [b"old", b"new"]
    assert order.take(20_001, 20_000, b"next", now=2) == [b"next"]


def handed_up(order, *messages):
    """What each of these (seq, before) sets free, by number."""
    return [[int(payload) for payload in order.take(seq, before, b"%d" % seq, now=0)]
            for seq, before in messages]  # fmt: skip


@pytest.mark.parametrize("start", [0, 65_500, 65_535])
def test_what_was_sent_after_the_new_beginning_is_kept_behind_it(start):
    def at(*numbers):
        return [(start + number) & MASK16 for number in numbers]

    last, old, anew, second, third = at(10, 12, 20_000, 20_001, 20_007)
    order = Order(last, WAIT)
    *_, ready = handed_up(order, (third, second), (old, *at(11)), (second, anew), (anew, anew))
    assert ready == [old, anew, second, third]
    assert (order.held, order.late, order.last) == ([], 0, third)


@pytest.mark.parametrize("start", [0, 65_500])
def test_a_beginning_after_messages_of_somebody_unheard_of_sorts_them_by_their_numbers(start):
    early, anew, later_, behind = ((start + number) & MASK16 for number in (5, 20, 22, 30))
    order = Order(None, WAIT)
    *_, ready = handed_up(order, (behind, later_), (early, early - 1), (anew, anew))
    assert ready == [early, anew]
    assert [one.seq for one in order.held] == [behind]
    assert handed_up(order, (later_, anew)) == [[later_, behind]]


def test_of_those_that_wait_the_oldest_goes_first_when_one_more_comes_than_there_is_room_for():
    order = Order(65_530, WAIT, buffer=2)
    assert handed_up(order, (3, 1), (65_534, 65_532), (7, 5)) == [[], [], [65_534]]
    assert handed_up(order, (9, 8)) == [[3]]  # and then the next oldest
    assert handed_up(order, (5, 3)) == [[5, 7]]


@pytest.mark.parametrize(("seq", "late"), [(99, 1), (100, 1), (101, 0), (100 + 32_767, 0),
                                           (100 + 32_768, 1), (100 + 32_769, 1)])  # fmt: skip
def test_a_number_that_is_not_later_than_the_newest_is_too_late(seq, late):
    order = Order(100, WAIT)
    assert handed_up(order, (seq, (seq - 1) & MASK16)) == [[seq] if seq == 101 else []]
    assert (order.late, len(order.held)) == (late, int(not late and seq != 101))
    assert order.is_up(seq) == (seq == 101)


def test_what_comes_after_one_that_its_sender_gave_up_is_not_held_up():
    order = Order(10, WAIT)
    assert handed_up(order, (13, 12), (15, 13)) == [[], []]
    assert [int(one) for one in order.again(13, 10, now=0)] == [13, 15]
    assert order.ended == [13, 15]
    assert handed_up(order, (17, 9)) == [[17]]  # the one before it was passed long ago
    assert order.again(17, 17, now=0) == []


def test_of_several_that_follow_one_the_first_sent_goes_first_whichever_came_first():
    assert handed_up(Order(10, WAIT), (15, 13), (14, 13), (13, 10)) == [[], [], [13, 14, 15]]
    order = Order(65_530, WAIT)
    assert handed_up(order, (2, 65_533), (65_534, 65_533), (65_533, 65_530)) == [
        [], [], [65_533, 65_534, 2]]  # fmt: skip


def test_each_waits_from_its_own_arrival():
    order = Order(10, WAIT)
    order.take(20, 19, b"a", now=0)
    order.take(30, 29, b"b", now=400)
    assert order.due() == WAIT
    assert (order.release(WAIT - 1), order.release(WAIT)) == ([], [b"a"])
    assert (order.release(WAIT + 399), order.release(WAIT + 400)) == ([], [b"b"])


def test_who_sent_is_told_what_was_handed_up_and_of_copies_only_if_it_was():
    async def main():
        orderly, up = Orderly(WAIT), []
        orderly.on_up = lambda sender, seq: up.append((sender, seq))
        told = {}

        def came(what, seq, before, again=False):
            up.clear()
            (orderly.again if again else orderly.take)(Message(3, seq, before, b"x"))
            told[what] = [number for _, number in up]

        came("nobody listens", 16, 15)
        came("nobody listens, again", 16, 15, again=True)
        listening(orderly)
        came("waits", 19, 18)
        came("waits, again", 19, 18, again=True)
        came("sets free", 18, 16)
        came("sets free, again", 18, 16, again=True)
        came("freed, again", 19, 18, again=True)
        came("too late", 17, 16)
        came("too late, again", 17, 16, again=True)
        orderly.stop()
        return told

    assert asyncio.run(main()) == {
        "nobody listens": [16], "nobody listens, again": [16],
        "waits": [], "waits, again": [], "sets free": [18, 19],
        "sets free, again": [18], "freed, again": [19], "too late": [], "too late, again": [],
    }  # fmt: skip


def listening(orderly):
    got = []
    orderly.arrivals.callbacks.append(lambda sender, payload: got.append((sender, payload)))
    return got


def test_who_begins_to_want_order_gets_it_from_the_newest_message_on():
    async def main():
        orderly = Orderly(WAIT)
        orderly.take(Message(3, 16, 15, b"not heard"))
        orderly.take(Message(3, 17, 16, b"not heard"))
        got = listening(orderly)
        orderly.take(Message(3, 19, 18, b"waits"))
        orderly.take(Message(3, 18, 17, b"next"))
        assert got == [(3, b"next"), (3, b"waits")]
        orderly.take(Message(3, 17, 16, b"late"))
        orderly.take(Message(4, 9, 8, b"of somebody else"))
        assert (len(got), orderly.held()) == (2, 1)
        assert orderly.counters() == {"dropped: after its turn": 1}
        orderly.arrivals.callbacks.clear()
        orderly.take(Message(4, 30, 29, b"not heard"))
        again = listening(orderly)
        assert orderly.held() == 0  # what waited for somebody who listens no more
        orderly.take(Message(4, 31, 30, b"new"))
        assert again == [(4, b"new")]
        orderly.stop()

    asyncio.run(main())
    assert Orderly(WAIT).counters() == {}


def test_each_sender_is_waited_for_as_long_as_it_may_and_at_the_end_for_none():
    async def main():
        orderly = Orderly(1_000_000)
        got = listening(orderly)
        for sender in (3, 4):
            orderly.take(Message(sender, 10, 10, b"first"))
        got.clear()
        orderly.take(Message(3, 13, 12, b"gap"))
        await asyncio.sleep(0.6)
        orderly.take(Message(4, 13, 12, b"gap"))
        await asyncio.sleep(0.399)
        assert got == []
        await asyncio.sleep(0.002)
        assert got == [(3, b"gap")]
        await asyncio.sleep(0.6)
        assert got == [(3, b"gap"), (4, b"gap")]
        orderly.take(Message(3, 17, 16, b"end"))
        orderly.stop()
        assert got[2:] == [(3, b"end")]
        others = asyncio.all_tasks() - {asyncio.current_task()}
        await asyncio.sleep(5)  # nothing is left that would go off
        return others, orderly.held(), got

    others, held, got = time_by_hand.run(main())
    assert (others, held, len(got)) == (set(), 0, 3)


def test_messages_that_say_nothing_of_order_go_up_at_once():
    orderly, got = Orderly(WAIT), []
    orderly.arrivals.callbacks.append(lambda sender, payload: got.append((sender, payload)))
    orderly.take(Message(3, 17, None, b"x"))
    assert got == [(3, b"x")]


def lose_some(node, share):
    """It takes packets over, acknowledges them, and forgets some: as if it had been restarted."""
    chance, stack = random.Random(5), node.stack
    frame = stack.on_frame

    def forgetful(now, port):
        kind, seq, own = stack.inbox.kind, stack.inbox.seq, stack.node
        frame(now, port)
        for i, found in enumerate(own.q_seq):
            waits = own.q_state[i] == mesh_queue.WAITS and own.busy != i
            if kind == DATA and found == seq and waits and chance.random() < share:
                mesh_queue.drop(own, stack.params, i)

    stack.on_frame = forgetful


@pytest.mark.parametrize("count", [150])
def test_a_mesh_that_mixes_them_up_hands_them_up_in_order(count):
    async def main():
        async with Mesh(3, LINE, e2e_us=60_000) as mesh:
            lose_some(mesh.nodes[1], 0.2)
            mixed, ordered = [], []
            mesh.nodes[2].receive_messages(lambda _, payload: mixed.append(payload))
            mesh.nodes[2].receive_messages(
                lambda _, payload: ordered.append(payload), in_order=True
            )
            receipts = [
                mesh.nodes[0].send_message(2, k.to_bytes(2, "big"), in_order=True)
                for k in range(count)
            ]
            others = [mesh.nodes[0].send_message(1, b"else") for _ in range(20)]
            states = {await receipt.wait() for receipt in receipts + others}
            await until(lambda: len(ordered) == count)
            return states, mixed, ordered, mesh.nodes[2].status()

    states, mixed, ordered, told = time_by_hand.run(main())
    assert states == {DELIVERED}
    assert mixed != sorted(mixed), "nothing was out of order: the test shows nothing"
    assert ordered == sorted(mixed)
    assert told["out_of_turn"] == 0
    assert "dropped: after its turn" not in told["counters"]


def test_a_node_that_does_not_care_for_the_order_gets_the_payload_alone():
    async def main():
        async with Mesh(2, [(0, 1)]) as mesh:
            heard = []
            mesh.nodes[1].receive_messages(lambda _, payload: heard.append(payload))
            for size in (88, 89):  # as many as one frame has, and one more
                await mesh.nodes[0].send_message(1, bytes(range(size)), in_order=True).wait()
            return heard

    assert asyncio.run(main()) == [bytes(range(88)), bytes(range(89))]


def test_a_message_that_waits_for_its_turn_is_not_delivered_until_it_was_handed_up():
    async def main():
        async with Mesh(2, [(0, 1)], **PROFILE) as mesh:
            a, b = mesh.nodes
            told = []
            b.receive_messages(lambda _, payload: told.append(payload), in_order=True)
            assert await a.send_message(1, b"here", in_order=True).wait() == DELIVERED
            read = b.engine.read
            b.engine.read = lambda data, *who: "lost" if b"lost" in data else read(data, *who)
            first = a.send_message(1, b"lost", in_order=True)
            second = a.send_message(1, b"behind", in_order=True)
            while not b.inbox.orderly.held():
                await asyncio.sleep(0.005)
            between = second.state, list(told)
            return between, await first.wait(), await second.wait(), told

    between, first, second, told = time_by_hand.run(main())
    assert between[0] != DELIVERED
    assert between[1] == [b"here"]
    assert (first, second) == (EXPIRED, DELIVERED)
    assert told == [b"here", b"behind"]


def test_a_sender_that_starts_again_goes_on_with_its_numbers():
    async def main():
        async with Mesh(2, [(0, 1)], **PROFILE) as mesh:
            heard, numbers = [], []
            mesh.nodes[0].receive_messages(lambda _, payload: heard.append(payload))
            sender = mesh.nodes[1]
            for k in range(12):
                receipt = sender.send_message(0, b"%d" % k)
                assert await receipt.wait() == DELIVERED
                numbers.append(receipt.seq)
                await sender.stop()
                await sender.start()
                await until_simulated(lambda: sender.stack.node.version != 0)
            return heard, numbers

    heard, numbers = time_by_hand.run(main())
    assert heard == [b"%d" % k for k in range(12)]
    assert all(later(b, a) for a, b in pairwise(numbers))


async def until_simulated(what):
    while not what():
        await asyncio.sleep(0.01)
