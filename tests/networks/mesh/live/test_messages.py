import asyncio
from collections import Counter

import pytest

from innervate.live.receipts import DELIVERED, EXPIRED, HOP_ACKED, REFUSED
from innervate.networks.mesh.live.turns import MOST
from tests.live.net import Mesh, until

LINE = [(0, 1), (1, 2), (2, 3)]
RING = [(0, 1), (1, 2), (2, 3), (3, 4), (0, 4)]


def test_receipt_moves_from_accepted_over_hop_to_delivered():
    async def main():
        async with Mesh(4, LINE) as mesh:
            receipt = mesh.nodes[0].send_message(3, b"far")
            states = [receipt.state]
            while receipt.state != DELIVERED:
                states.append(await receipt.change())
            return states

    assert asyncio.run(main()) == ["accepted", HOP_ACKED, DELIVERED]


def test_a_mistake_of_its_user_does_not_keep_a_node_from_sending():
    """A callback that raises, on a message to the node itself; and what is no message at all."""

    def raises(*_):
        raise RuntimeError("a mistake")

    told = []

    async def main():
        asyncio.get_running_loop().set_exception_handler(lambda _, what: told.append(what))
        async with Mesh(2, [(0, 1)]) as mesh:
            one, other = mesh.nodes
            one.receive_messages(raises)
            assert await one.send_message(0, b"to myself").wait() == DELIVERED
            (what,) = told
            assert str(what["exception"]) == "a mistake"
            assert "raises" in what["message"]
            for wrong in ({"payload": "text"}, {"recipient": 1.0}, {"payload": None}):
                with pytest.raises(TypeError, match=r"a payload is bytes|a node's number"):
                    one.send_message(**{"recipient": 1, "payload": b"x"} | wrong)
            del one.arrivals.callbacks[:]
            return await one.send_message(1, b"x").wait(), await other.send_message(0, b"y").wait()

    assert asyncio.run(main()) == (DELIVERED, DELIVERED)


def test_a_callback_that_raises_keeps_no_message_from_others():
    """Neither from those behind it, nor from who wants order, nor from who sent it."""
    heard, told = [], []

    def raises(*_):
        raise RuntimeError("a mistake")

    async def main():
        asyncio.get_running_loop().set_exception_handler(lambda _, what: told.append(what))
        async with Mesh(2, [(0, 1)]) as mesh:
            one, other = mesh.nodes
            for in_order in (False, True):
                one.receive_messages(raises, in_order=in_order)
                one.receive_messages(lambda *parts: heard.append(parts), in_order=in_order)
            receipts = [other.send_message(0, bytes([k]), in_order=True) for k in range(20)]
            receipts.append(other.send_message(0, bytes(300)))
            return [await receipt.wait() for receipt in receipts]

    assert asyncio.run(main()) == 21 * [DELIVERED]
    assert sorted(heard) == sorted(2 * [(1, bytes([k])) for k in range(20)] + 2 * [(1, bytes(300))])
    assert [str(what["exception"]) for what in told] == 42 * ["a mistake"]


def test_messages_come_to_callbacks_and_iterators_once_each():
    async def main():
        async with Mesh(4, LINE) as mesh:
            heard = []
            mesh.nodes[3].receive_messages(lambda sender, payload: heard.append((sender, payload)))
            messages = mesh.nodes[3].receive_messages()
            receipts = [mesh.nodes[0].send_message(3, bytes([k])) for k in range(40)]
            assert {await receipt.wait() for receipt in receipts} == {DELIVERED}
            read = [await anext(messages) for _ in range(40)]
            await messages.aclose()
            return heard, read

    heard, read = asyncio.run(main())
    assert sorted(heard) == sorted(read) == [(0, bytes([k])) for k in range(40)]


def test_a_message_to_all_reaches_everybody_else():
    async def main():
        async with Mesh(5, RING) as mesh:
            heard = Counter()
            for i, node in enumerate(mesh.nodes):
                node.receive_messages(lambda sender, payload, i=i: heard.update([(i, payload)]))
            mesh.nodes[2].send_message(255, b"all")
            await until(lambda: len(heard) == 4)
            return heard

    assert asyncio.run(main()) == {(i, b"all"): 1 for i in (0, 1, 3, 4)}


def test_no_message_is_lost_or_doubled_when_a_cable_comes_out():
    async def main():
        async with Mesh(5, RING) as mesh:
            heard = Counter()
            mesh.nodes[2].receive_messages(lambda _, payload: heard.update([payload[0]]))
            receipts = []
            for k in range(120):
                if k == 40:
                    mesh.cut(1, 2)
                if k == 80:
                    mesh.cut(1, 2, cut=False)
                receipts.append(mesh.nodes[0].send_message(2, bytes([k])))
                await asyncio.sleep(0.005)
            states = Counter([await receipt.wait() for receipt in receipts])
            suspects = sum(node.reports[7] for node in mesh.nodes)
            return heard, states, suspects

    heard, states, suspects = asyncio.run(main())
    assert heard == {k: 1 for k in range(120)}
    assert states == {DELIVERED: 120}
    assert suspects > 0  # the cut was noticed, not missed


def test_a_message_expires_if_its_recipient_is_gone():
    async def main():
        async with Mesh(3, LINE[:2], e2e_us=50_000, ack_us=5000) as mesh:
            await mesh.nodes[2].stop()
            receipt = mesh.nodes[0].send_message(2, b"?")
            return await receipt.wait(), receipt.reason

    assert asyncio.run(main()) == (EXPIRED, "no acknowledgement")


def test_a_standby_takes_over_and_messages_still_arrive():
    async def main():
        async with Mesh(4, [*LINE, (0, 3)], standbys=[2], dead=10, period=4) as mesh:
            await mesh.nodes[0].stop()
            await until(lambda: mesh.nodes[2].status()["role"] == "gateway")
            await until(lambda: mesh.nodes[3].status()["gateway"] == 2)
            return await mesh.nodes[1].send_message(3, b"still").wait()

    assert asyncio.run(main()) == DELIVERED


def test_more_messages_than_can_wait_are_refused_at_once():
    async def main():
        async with Mesh(2, [(0, 1)]) as mesh:
            receipts = [mesh.nodes[0].send_message(1, b"") for _ in range(MOST + 100)]
            return Counter(receipt.state for receipt in receipts[-50:]), receipts[-1].reason

    assert asyncio.run(main()) == ({REFUSED: 50}, "queue full")


def test_what_cannot_be_sent_is_said():
    async def main():
        async with Mesh(2, [(0, 1)]) as mesh:
            with pytest.raises(ValueError, match="at most 65536"):
                mesh.nodes[0].send_message(1, bytes(65_537))
            with pytest.raises(ValueError, match="0 to 1, 254 or 255"):
                mesh.nodes[0].send_message(2, b"")

    asyncio.run(main())


def test_status_names_the_broken_cable():
    async def main():
        async with Mesh(5, RING, period=1, period_max=1) as mesh:
            node = mesh.nodes[1]
            assert node.status()["broken"] == []
            mesh.cut(1, 2)
            await until(lambda: node.status()["broken"] == ["local 1-2"])
            mesh.cut(1, 2, cut=False)
            await until(lambda: node.status()["broken"] == [])
            await until(lambda: node.status()["routes"]["3"][0] == 2)
            return node.status()

    assert {row["node"] for row in asyncio.run(main())["neighbours"]} == {0, 2}


def test_counters_add_up():
    async def main():
        async with Mesh(4, LINE) as mesh:
            receipts = [mesh.nodes[0].send_message(3, bytes([k])) for k in range(30)]
            for receipt in receipts:
                await receipt.wait()
            return mesh.nodes[0].counters(), mesh.nodes[3].counters()

    sender, receiver = asyncio.run(main())
    assert sender["messages accepted"] == sender["messages delivered"] == 30
    assert receiver["messages received"] == 30
