"""Order over a sender's restarts: what is of an earlier life, and what of one that begins anew."""

import pytest

from innervate.dialect.arith import HALF16, MASK16
from innervate.live.machine import Machine, machine, on
from innervate.live.receipts import DELIVERED
from innervate.networks.mesh.live import node as mesh_node
from innervate.networks.mesh.live.chains import drawn_number
from innervate.networks.mesh.live.order import QUIET_US, Order
from innervate.networks.mesh.protocol.constants import TABLES, WHOLE_GRAPH
from innervate.networks.mesh.protocol.duplicates import ANEW
from tests.live import time_by_hand
from tests.live.net import Mesh
from tests.networks.mesh.live.test_order import PROFILE, WAIT, handed_up, until_simulated

BEHIND = (25, 77)  # boots whose numbers are far behind those of the one before


@pytest.mark.parametrize("start", [0, 65_500])
def test_one_of_an_earlier_life_that_comes_behind_those_of_the_next_is_late(start):
    old, last = ((start + number) & MASK16 for number in (1000, 7000))
    order = Order(last, WAIT)
    assert handed_up(order, (old, old)) == [[]]
    assert (order.late, order.is_up(old)) == (1, False)


@pytest.mark.parametrize(("behind", "is_late"), [(0, True), (ANEW - 1, True), (ANEW, False)])
def test_a_sender_that_drew_its_numbers_may_be_far_behind_itself(behind, is_late):
    seq = (200 - behind) & MASK16
    order = Order(200, WAIT)
    assert order.take(seq, seq, b"new", 0, boot=3) == [b"new"] * (not is_late)
    assert order.late == is_late


def test_an_old_one_of_numbers_drawn_in_the_same_boot_is_late():
    order = Order(None, WAIT)
    assert order.take(7000, 7000, b"second life", now=0, boot=5) == [b"second life"]
    assert order.take(7001, 7000, b"knows us", now=1) == [b"knows us"]
    assert order.take(4000, 4000, b"first life", now=2, boot=5) == []
    assert order.take(4001, 4001, b"numbers kept", now=3) == []
    assert order.take(4002, 4002, b"switched on again", now=4, boot=6) == [b"switched on again"]
    assert order.late == 2


@pytest.mark.parametrize("seq", [1000, 6990, 7000])  # over many starts they may have come round
@pytest.mark.parametrize(("quiet_us", "is_late"), [(QUIET_US - 1, True), (QUIET_US, False)])
def test_so_long_after_the_last_one_none_can_be_of_an_earlier_life(quiet_us, is_late, seq):
    order = Order(None, WAIT)
    assert order.take(7000, 7000, b"last", now=50) == [b"last"]
    assert order.take(6999, 6998, b"late", now=60) == []
    assert order.take(seq, seq, b"new", now=50 + quiet_us) == [b"new"] * (not is_late)
    order = Order(7000, WAIT, now=90)  # it came when nobody wanted order
    assert order.take(seq, seq, b"new", now=90 + quiet_us) == [b"new"] * (not is_late)


def test_one_that_waited_too_long_is_the_last_from_then_on():
    order = Order(100, WAIT, now=0)
    assert order.take(300, 200, b"waits", now=QUIET_US - WAIT) == []
    assert order.release(QUIET_US) == [b"waits"]
    assert order.take(60_005, 60_005, b"old", now=2 * QUIET_US - 1) == []
    assert order.take(60_006, 60_006, b"new", now=2 * QUIET_US) == [b"new"]


@pytest.mark.parametrize("at_ms", [0, 70_000_123])
def test_numbers_that_are_drawn_go_up_by_one_a_millisecond_in_a_boot_of_the_machine(at_ms):
    class Drawing(Machine):
        started, passed_ms = "boot 1", at_ms

        def boot(self):
            return self.started

        def monotonic_ns(self):
            return 1_000_000 * self.passed_ms

    with on(Drawing()):
        boot, first = drawn_number()
        machine().passed_ms += 300
        assert drawn_number() == (boot, (first + 300) & MASK16)
        machine().started = "boot 2"
        assert drawn_number()[0] != boot


def test_a_sender_that_lost_its_numbers_is_heard_all_the_same():
    async def main():
        async with Mesh(2, [(0, 1)], **PROFILE) as mesh:
            heard, states, boots = [], [], iter(BEHIND)
            mesh.nodes[0].receive_messages(lambda _, data: heard.append(data[:1]), in_order=True)
            sender = mesh.nodes[1]
            for first in (b"a", b"f"):  # another message is long, and goes in pieces
                for text in (first, bytes([first[0] + 1]) * 300, bytes([first[0] + 2])):
                    receipt = sender.send_message(0, text, in_order=True)
                    states.append(await receipt.wait())
                    newest = receipt.seq
                await sender.stop()
                sender.state.numbers = -1
                machine().boots = next(boots)
                await sender.start()
                assert ANEW < (newest - sender.stack.first) & MASK16 < HALF16
                await until_simulated(lambda: sender.stack.node.version != 0)
            late = sender.send_message(0, bytes(300), in_order=True)
            return heard, [*states, await late.wait()]

    heard, states = time_by_hand.run(main())
    assert states == [DELIVERED] * 7
    assert heard == [b"a", b"b", b"c", b"f", b"g", b"h", b"\0"]


@pytest.mark.parametrize("mode", [TABLES, WHOLE_GRAPH])
@pytest.mark.parametrize("in_order", [False, True])
@pytest.mark.parametrize("behind", [30, 100, 300])
def test_what_a_sender_says_that_drew_its_numbers_near_its_old_ones_is_delivered_only_if_handed_up(
    behind, in_order, mode, monkeypatch
):
    """One in 200 lives that lost their numbers: what was not heard must not count as if it was."""

    async def main():
        async with Mesh(2, [(0, 1)], **PROFILE, mode=mode) as mesh:
            heard, delivered = [], []
            mesh.nodes[0].receive_messages(lambda _, data: heard.append(data), in_order=in_order)
            sender = mesh.nodes[1]
            for k in range(60):
                receipt = sender.send_message(0, b"old %d" % k, in_order=in_order)
                assert await receipt.wait() == DELIVERED
            first = (receipt.seq - behind) & MASK16
            await sender.stop()
            sender.state.numbers = -1
            monkeypatch.setattr(mesh_node, "drawn_number", lambda: (7, first))
            await sender.start()
            await until_simulated(lambda: sender.stack.node.known)
            for k in range(60):
                text = b"new %d" % k
                if await sender.send_message(0, text, in_order=in_order).wait() == DELIVERED:
                    delivered.append(text)
            return heard[60:], delivered

    heard, delivered = time_by_hand.run(main())
    assert heard == delivered
    assert delivered[-20:] == [b"new %d" % k for k in range(40, 60)]
