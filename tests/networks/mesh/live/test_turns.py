"""A recipient that is gone holds up nobody else; under simulated time, waits cost nothing."""

import asyncio

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from innervate.cli import live_status
from innervate.live.receipts import DELIVERED, EXPIRED, REFUSED
from innervate.networks.mesh.live import turns
from innervate.networks.mesh.live.parameters import fence_parameters, mesh_parameters
from innervate.networks.mesh.live.stack import MeshStack
from innervate.networks.mesh.live.turns import FEW, MOST, Turns
from innervate.networks.mesh.protocol.constants import ALL, END_TO_END, MONITOR, PRIORITY
from tests.live import time_by_hand as live_time
from tests.live.net import Mesh

PROFILE = {"ack_us": 5000, "e2e_us": 30_000}  # the profile of live nodes
SQUARE = [[(0, 0), (2000, 0), (2000, 1000), (0, 1000)]]
HOP_S = 0.015  # three transmissions to a neighbour that does not answer
SOON_S = HOP_S + 0.005


def now():
    return asyncio.get_running_loop().time()


async def took(receipt):
    """When a message had its end, from now, s; and how it ended."""
    began = now()
    state = await receipt.wait()
    return round(now() - began, 4), state


class Star(Mesh):
    """Node 1 in the middle, the gateway 0 and others around it, of which the last are gone."""

    def __init__(self, others, gone):
        super().__init__(2 + others, [(0, 1), *((1, 2 + k) for k in range(others))], **PROFILE)
        self.dead = range(2 + others - gone, 2 + others)
        self.middle = self.nodes[1]

    async def __aenter__(self):
        await super().__aenter__()
        for i in set(range(len(self.nodes))) - {1}:
            assert await self.middle.send_message(i, b"all is well").wait() == DELIVERED
        for i in self.dead:
            await self.nodes[i].stop()
        return self


@pytest.mark.parametrize("many", [10, 100])
@pytest.mark.parametrize("later_s", [0.0, 1.0])
def test_messages_to_a_dead_node_hold_up_neither_a_living_one_nor_an_alarm(many, later_s):
    async def main():
        async with Star(1, 1) as mesh:
            for node in mesh.nodes:
                for name, value in fence_parameters(SQUARE).items():
                    setattr(node.stack.params, name, value)
            robot, raised = mesh.middle, []
            robot.stack.node.robot = 1
            for _ in range(many):
                robot.send_message(2, b"?")
            await asyncio.sleep(later_s)
            began = now()
            mesh.nodes[0].receive_alarms(lambda alarm: raised.append((now() - began, alarm.kind)))
            robot.locate((100, 100))
            robot.locate((-50, 100))
            urgent = robot.send_message(0, b"!", priority=True)
            common = robot.send_message(0, b".")
            return await asyncio.gather(took(urgent), took(common)), raised

    ((urgent_s, urgent), (common_s, common)), raised = live_time.run(main())
    assert (urgent, common) == (DELIVERED, DELIVERED)
    assert urgent_s <= SOON_S
    assert common_s <= SOON_S
    assert [kind for _, kind in raised] == ["cross"]
    assert raised[0][0] <= SOON_S


def test_every_message_to_a_dead_node_has_its_end():
    async def main():
        async with Star(1, 1) as mesh:
            receipts = [mesh.middle.send_message(2, b"?") for _ in range(10)]
            ends = await asyncio.gather(*map(took, receipts))
            return ends, mesh.middle.status()

    ends, told = live_time.run(main())
    assert {state for _, state in ends} == {EXPIRED}
    assert max(ends)[0] < 30
    assert (told["backlog"], told["under_way"], told["waiting"]) == (0, 0, {})


@pytest.mark.parametrize(("gone", "limit_s"), [(2, 0.05), (3, 0.06), (6, 0.25)])
def test_several_dead_nodes_hold_up_a_stream_to_living_ones_only_for_their_hops(gone, limit_s):
    async def main():
        async with Star(2 + gone, gone) as mesh:
            for k in range(20 * gone):
                mesh.middle.send_message(mesh.dead[k % gone], b"?")
            told = []
            for k in range(150):
                receipt = mesh.middle.send_message((0, 2, 3)[k % 3], b".")
                told.append(asyncio.ensure_future(took(receipt)))
                await asyncio.sleep(0.02)
            return await asyncio.gather(*told)

    ends = live_time.run(main())
    assert {state for _, state in ends} == {DELIVERED}
    assert max(ends)[0] < limit_s


def test_an_urgent_message_finds_a_place_whoever_is_dead():
    async def main():
        async with Star(8, 7) as mesh:
            for k in range(70):
                mesh.middle.send_message(mesh.dead[k % 7], b"?", priority=k % 2 == 0)
            ends = []
            for _ in range(20):
                ends.append(await took(mesh.middle.send_message(2, b"!", priority=True)))
                await asyncio.sleep(0.1)
            return ends

    ends = live_time.run(main())
    assert {state for _, state in ends} == {DELIVERED}
    assert max(ends)[0] < 0.25


def test_recipients_have_their_messages_in_turn():
    async def main():
        heard = []
        async with Star(2, 0) as mesh:
            for i in (2, 3):
                mesh.nodes[i].receive_messages(lambda *_, i=i: heard.append(i))
            receipts = [mesh.middle.send_message(2, b"") for _ in range(200)]
            receipts += [mesh.middle.send_message(3, b"") for _ in range(50)]
            for receipt in receipts:
                assert await receipt.wait() == DELIVERED
        return heard

    heard = live_time.run(main())
    assert (heard.count(2), heard.count(3)) == (200, 50)
    assert all(heard[:k].count(3) >= k // 2 - 8 for k in range(100))


def test_what_a_recipient_is_sent_keeps_its_order_and_urgent_messages_go_first():
    async def main():
        heard = []
        async with Star(2, 0) as mesh:
            mesh.nodes[2].receive_messages(lambda _, payload: heard.append(payload), in_order=True)
            middle = mesh.middle
            receipts = [middle.send_message(2, b"%03d" % k, in_order=True) for k in range(60)]
            receipts += [middle.send_message(2, b"!%d" % k, in_order=True, priority=True)
                         for k in range(3)]  # fmt: skip
            for receipt in receipts:
                assert await receipt.wait() == DELIVERED
        return heard

    heard = live_time.run(main())
    urgent = [payload for payload in heard if payload.startswith(b"!")]
    others = [payload for payload in heard if not payload.startswith(b"!")]
    assert (urgent, others) == ([b"!0", b"!1", b"!2"], [b"%03d" % k for k in range(60)])
    assert heard.index(b"!2") < 20


def test_a_message_to_all_is_not_put_off_for_ever_by_one_that_is_gone():
    async def main():
        heard = []
        async with Star(2, 1) as mesh:
            mesh.nodes[0].receive_messages(lambda *got: heard.append((now(), got)))
            for _ in range(100):
                mesh.middle.send_message(3, b"?")
            for k in range(1500):  # numbers go on, and kept messages grow old
                mesh.middle.send_message(2, b".")
                await asyncio.sleep(0.02)
                if k == 100:
                    began = now()
                    mesh.middle.send_message(ALL, b"all")
                if heard:
                    break
            return [at - began for at, _ in heard], mesh.middle.status()["waiting"]

    (after_s,), waiting = live_time.run(main())
    assert after_s < 15
    assert waiting["3"] > 85  # it did not wait for them


def test_one_that_is_gone_does_not_use_up_the_room_of_others():
    async def main():
        async with Star(2, 1) as mesh:
            middle = mesh.middle
            many = [middle.send_message(3, b"?") for _ in range(MOST + 50)]
            few = [middle.send_message(2, b".") for _ in range(FEW)]
            assert middle.status()["waiting"]["3"] == MOST
            return [receipt.state for receipt in many], [await one.wait() for one in few]

    many, few = live_time.run(main())
    assert many.count(REFUSED) in range(40, 51)  # but for those that the router has taken
    assert few == [DELIVERED] * FEW


def test_nobody_is_looked_for_again_while_nothing_has_changed(monkeypatch):
    looked = []

    class Counted(turns.Places):
        def __init__(self, stack, *args):
            looked.append(stack)
            super().__init__(stack, *args)

    monkeypatch.setattr(turns, "Places", Counted)

    async def main():
        async with Star(1, 1) as mesh:
            for _ in range(50):
                mesh.middle.send_message(2, b"?")
            looked.clear()
            frames = mesh.middle.counters()["frames"]
            for _ in range(200):
                await mesh.nodes[0].send_message(1, b"").wait()
            frames = mesh.middle.counters()["frames"] - frames
            return frames, looked.count(mesh.middle.stack)

    frames, count = live_time.run(main())
    assert frames >= 390  # some acks go together
    assert count < 50  # of 400 times that a place could have become free


PUTS = st.lists(st.tuples(st.sampled_from([0, 1, 2, ALL, MONITOR]), st.booleans()), max_size=40)


@settings(max_examples=100, deadline=None, database=None)
@given(PUTS, st.integers(0, 40))
def test_no_message_is_lost_doubled_or_overtaken_by_a_later_one_of_its_kind(puts, before):
    stack = MeshStack(1, -1, mesh_parameters(3, {}), 5)
    waiting, taken = Turns(stack, None), []
    for handle, (dest, urgent) in enumerate(puts):
        if handle == before:
            taken += iter(waiting.take, None)
        item = stack.item()
        item.dest, item.flags = dest, END_TO_END | (PRIORITY if urgent else 0)
        waiting.put(handle, item)
    assert len(waiting) == len(puts) - len(taken) == sum(waiting.waiting().values())
    taken += iter(waiting.take, None)
    assert len(waiting) == 0
    assert not waiting.waiting()
    assert sorted(handle for handle, _ in taken) == list(range(len(puts)))
    for kind in set(puts):
        own = [handle for handle, _ in taken if puts[handle] == kind]
        assert own == sorted(own)


def test_status_says_how_many_messages_wait_for_whom():
    async def main():
        async with Star(1, 1) as mesh:
            for _ in range(30):
                mesh.middle.send_message(2, b"?")
            return mesh.middle.status()

    told = live_time.run(main())
    assert told["waiting"] == {"2": 25}
    assert "  messages that wait: 25 for 2" in live_status.lines(told)


def test_so_many_nodes_at_once_that_the_router_cannot_know_them_hold_others_up_only_once():
    async def main():
        async with Star(16, 15) as mesh:
            for k in range(300):
                mesh.middle.send_message(mesh.dead[k % 15], b"?")
            first = await took(mesh.middle.send_message(2, b"."))
            ends = []
            for _ in range(40):
                await asyncio.sleep(0.3)
                ends.append(await took(mesh.middle.send_message(2, b".")))
            return first, ends[20:]

    (first_s, first), ends = live_time.run(main())
    assert (first, {state for _, state in ends}) == (DELIVERED, {DELIVERED})
    assert first_s < 10
    assert max(ends)[0] < 0.1


def test_a_node_that_comes_back_is_sent_to_as_before():
    async def main():
        async with Star(2, 1) as mesh:
            assert await mesh.middle.send_message(3, b"?").wait() == EXPIRED
            for _ in range(20):
                mesh.middle.send_message(3, b"?")
            await mesh.nodes[3].start()
            began = now()
            while mesh.middle.status()["waiting"]:
                await asyncio.sleep(0.1)
            receipts = [mesh.middle.send_message(3, b".") for _ in range(20)]
            ends = await asyncio.gather(*map(took, receipts))
            return now() - began, ends

    back_s, ends = live_time.run(main())
    assert {state for _, state in ends} == {DELIVERED}
    assert back_s < 6  # discovery every 2 s, hope at most every 4 s
    assert max(ends)[0] < 0.5


@pytest.mark.parametrize("own", [1, 254])
def test_a_message_to_oneself_has_its_end(own):
    async def main():
        async with Star(1, 0) as mesh:
            node, heard = mesh.nodes[1 if own == 1 else 0], []  # 254: the gateway sends to itself
            node.receive_messages(lambda sender, payload: heard.append((sender, payload)))
            async with asyncio.timeout(5):
                state = await node.send_message(own, b"note").wait()
            return state, heard, node.stack.node.number, node.status()["under_way"]

    state, heard, number, under_way = live_time.run(main())
    assert (state, heard, under_way) == (DELIVERED, [(number, b"note")], 0)
