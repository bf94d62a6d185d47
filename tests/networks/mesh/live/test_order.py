import asyncio
import random
from itertools import pairwise

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from innervate.dialect.arith import MASK16
from innervate.live.receipts import DELIVERED
from innervate.networks.mesh.live.order import Message, Order, Orderly
from innervate.networks.mesh.protocol import queue as mesh_queue
from innervate.networks.mesh.protocol.constants import DATA
from tests.live.net import Mesh, until

LINE = [(0, 1), (1, 2)]
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
    assert order.take(40_000, 40_000, b"new", now=1) == [b"old", b"new"]
    assert order.take(40_001, 40_000, b"next", now=2) == [b"next"]


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
                mesh_queue.drop(own, i)

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

    states, mixed, ordered, told = asyncio.run(main())
    assert states == {DELIVERED}
    assert mixed != sorted(mixed), "nothing was out of order: the test shows nothing"
    assert ordered == sorted(mixed)
    assert told["out_of_turn"] == 0
    assert "dropped: after its turn" not in told["counters"]


def test_two_bytes_less_fit_and_a_node_that_does_not_care_gets_the_payload_alone():
    async def main():
        async with Mesh(2, [(0, 1)]) as mesh:
            heard = []
            mesh.nodes[1].receive_messages(lambda _, payload: heard.append(payload))
            with pytest.raises(ValueError, match="at most 88"):
                mesh.nodes[0].send_message(1, bytes(89), in_order=True)
            await mesh.nodes[0].send_message(1, bytes(range(88)), in_order=True).wait()
            return heard

    assert asyncio.run(main()) == [bytes(range(88))]
