"""A mesh node between its user and its router: what each is told of the other, and what is kept."""

import asyncio
from types import SimpleNamespace

import pytest

from innervate.live.receipts import DELIVERED, REFUSED, Receipt
from innervate.live.state import State
from innervate.networks.mesh.live.node import MeshNode
from innervate.networks.mesh.live.parameters import mesh_parameters
from innervate.networks.mesh.live.pieces import Piece
from innervate.networks.mesh.live.stack import MeshStack
from innervate.networks.mesh.protocol.constants import (
    ACK,
    AGAIN,
    ALL,
    DATA,
    E2E_ACK,
    END_TO_END,
    MONITOR,
    ORDERED,
    PRIORITY,
    REPORT_ACCEPTED,
    REPORT_ALARM,
    REPORT_FULL,
    REPORT_GATEWAY,
)
from tests.live.net import Mesh, until


class Kept(State):
    """A state that counts how often it was written."""

    def __init__(self, epoch=0):
        super().__init__(None)
        self.epoch, self.written = epoch, []

    def write(self):
        self.written.append((self.epoch, self.numbers))
        return True


def made(state=None, mtu=127):
    return MeshNode("n0", MeshStack(0, 0, mesh_parameters(4, {"mtu": mtu}), 5), [], state=state)


def test_a_newer_epoch_is_kept_once_and_an_alarm_is_counted():
    state = Kept(epoch=3)
    node = made(state)
    assert node.stack.epoch == 3
    for epoch in (3, 4, 4, 5):
        node._reported(REPORT_GATEWAY, 0, epoch)
    assert [epoch for epoch, _ in state.written] == [4, 5]
    node._reported(REPORT_ALARM, 1, 2)
    assert node.outcomes == {"alarms raised": 1}


def test_only_what_is_said_of_messages_goes_to_them():
    node, told = made(), []
    node.outgoing.told = lambda *one: told.append(one)
    for code in range(REPORT_FULL + 2):
        node._reported(code, 7, 8)
    assert told == [(code, 7, 8) for code in range(REPORT_ACCEPTED, REPORT_FULL + 1)]


@pytest.mark.parametrize(("kind", "noted"), [(DATA, [False]), (AGAIN, [True]), (99, [])])
def test_a_message_that_comes_shows_its_way_and_that_its_sender_is_there(kind, noted):
    node, heard, come = made(), [], []
    node.outgoing.turns.heard = heard.append
    node.inbox.note = lambda frame, is_again: come.append(is_again)
    node._deliver(kind, SimpleNamespace(origin=3, path=[3, 2, 9, 9], path_len=2, dest=0))
    assert come == noted
    assert heard == [3] * len(noted)
    assert node.arrived_by == ({3: [3, 2, 0]} if noted else {})


@pytest.mark.parametrize(
    ("given", "in_order", "flags"),
    [
        ({}, False, END_TO_END), ({"reliable": False}, False, 0),
        ({"priority": True}, False, END_TO_END | PRIORITY), ({}, True, END_TO_END | ORDERED),
        ({"in_order": False}, True, END_TO_END), ({"in_order": True}, False, END_TO_END | ORDERED),
        ({"to": ALL, "in_order": True}, False, END_TO_END),
        ({"to": 0, "in_order": True}, False, END_TO_END),
        ({"to": MONITOR, "in_order": True}, False, END_TO_END | ORDERED),
    ],
)  # fmt: skip
def test_how_a_message_is_sent(given, in_order, flags):
    node, sent = made(), []
    node.in_order, node.engine = in_order, SimpleNamespace(look=int)
    node.outgoing.send = lambda *one: sent.append(one) or Receipt()
    to = given.get("to", 2)
    node.send_request({"payload": "c3a4", **given, "to": to})
    ((recipient, found, payload, most),) = sent
    assert (recipient, found, payload) == (to, flags, b"\xc3\xa4")
    assert most == node.outgoing.check(to, flags, 1)
    assert node.outcomes == {"messages accepted": 1}


@pytest.mark.parametrize("to", [-1, 4, 253, 256])
def test_recipients_that_no_node_can_be(to):
    with pytest.raises(ValueError, match="recipient must be 0 to 3, 254 or 255"):
        made().send_message(to, b"")


def test_before_it_is_started_nothing_is_sent():
    receipt = made().send_message(2, b"early")
    assert (receipt.state, receipt.reason) == (REFUSED, "node not started")


def test_a_robots_place_is_told_in_centimetres_and_may_stand_still():
    node, told = made(), []
    node.locate = lambda *one: told.append(one)
    assert node.requests["locate"]({"at_cm": [1, 2.5], "speed_cm_s": [3, -4]}) == {"ok": True}
    node.requests["locate"]({"at_cm": [1, 2]})
    assert told == [((1.0, 2.5), (3.0, -4.0)), ((1.0, 2.0), (0.0, 0.0))]


@pytest.mark.parametrize(("ends_s", "is_drained"), [(0.01, True), (9.0, False)])
def test_at_the_end_messages_under_way_are_waited_for_but_not_for_ever(ends_s, is_drained):
    async def main():
        node, receipt = made(), Receipt()
        assert await node.drain(0.0)
        node.outgoing.receipts[1] = receipt
        asyncio.get_running_loop().call_later(ends_s, receipt.move, DELIVERED)
        return await node.drain(0.05)

    assert asyncio.run(main()) == is_drained


def test_what_is_passed_on_leaves_before_it_is_acknowledged():
    """Its sender has time; whoever waits for it has not."""

    async def main():
        async with Mesh(3, [(0, 1), (1, 2)]) as mesh:
            await until(lambda: mesh.nodes[0].stack.gate.open == 0)  # tables would go first
            left, reader = [], made().stack

            def tap(at_ns, port, out, data, why):
                if out and reader.decode(data) == 0:
                    left.append((reader.inbox.kind, reader.inbox.origin, reader.inbox.seq))

            mesh.nodes[1].taps.append(tap)
            assert await mesh.nodes[0].send_message(2, b"x").wait() == DELIVERED
        return left

    left = asyncio.run(main())
    data = next(k for k, (kind, *_) in enumerate(left) if kind == DATA)
    assert data < left.index((ACK, *left[data][1:]))  # others are of tables


def test_a_hop_is_told_that_we_have_the_word_by_which_another_ack_of_ours_may_go():
    """Nothing is handed down while what a handler put out is still to leave."""

    async def main():
        async with Mesh(2, [(0, 1)], gather=0) as mesh:
            node, left, reader = mesh.nodes[1], [], made().stack

            def tap(at_ns, port, out, data, why):
                if out and reader.decode(data) == 0 and reader.inbox.kind in (ACK, E2E_ACK):
                    left.append(reader.inbox.kind)

            node.taps.append(tap)
            node._refuse(0, 7, Piece(10, 0, 2, 4, b"cd"))
            await until(lambda: E2E_ACK in left)
            await asyncio.sleep(0.01)
        return left

    assert asyncio.run(main())[:2] == [ACK, E2E_ACK]
