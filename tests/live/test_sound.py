"""Nothing from outside changes what a node keeps before it is sound and from whom it says."""

import asyncio
import copy
import marshal
import random
import socket

import pytest

from innervate.dialect import plain
from innervate.live.channel import Medium
from innervate.live.channel_radio import JOIN, PLUG, SEND, read_heard
from innervate.live.engine import clock_us
from innervate.live.keys import Sealer, ring_of
from innervate.live.multicast import MulticastLink
from innervate.live.receipts import DELIVERED
from innervate.live.state import State
from innervate.live.udp import UdpLink
from innervate.networks.mesh import frames as wire
from innervate.networks.mesh.live.node import MeshNode
from innervate.networks.mesh.live.parameters import mesh_parameters
from innervate.networks.mesh.live.stack import MeshStack
from innervate.networks.mesh.protocol import fields
from innervate.networks.mesh.protocol.constants import ACK, ALL, SOURCE_ROUTE
from innervate.wire import seal
from tests.live.net import Mesh, Skin, until
from tests.live.test_fuzz import crc

HOP_ACK_OF_255 = bytes.fromhex("50ff0100000000e5b7")
KEY = bytes(range(32))
Frame = plain.make("Frame", fields.FRAME)
LINE = [(0, 1), (1, 2)]
COUNT = 3
ME = 1
SAMPLES = 100


def test_a_hop_ack_of_a_node_that_cannot_be_does_not_bind_broadcasts_to_one_path():
    async def main():
        async with Mesh(3, LINE) as mesh:
            middle, heard = mesh.nodes[1], set()
            for i in (0, 2):
                mesh.nodes[i].receive_messages(lambda *_, i=i: heard.add(i))
            for path in middle.paths:
                middle._receive(path, HOP_ACK_OF_255)
            middle.send_message(ALL, b"all")
            await until(lambda: heard == {0, 2})
            return middle.counters()["dropped: from no node of ours"], middle.stack.places

    dropped, places = asyncio.run(main())
    assert dropped == 2
    assert set(places) == {0, 2}


def kept(node):
    """All that a node keeps of what it hears."""
    records = [record for record in (node.stack.node, node.stack.gate) if record is not None]
    contacts = {} if node.sealer is None else node.sealer._contacts
    stack = node.stack
    counted = [dict(one) for one in (stack.asked, stack.acked, node.outcomes)]
    taken = [(port, index, one.window.highest, one.window.bits)
             for port, at in contacts.items() for index, one in at._by_index.items()]  # fmt: skip
    heard = [path.heard_at for path in node.paths]
    fields = [[getattr(record, name) for name in record.__slots__] for record in records]
    return marshal.dumps([fields, stack.places, counted, node.arrived_by, heard, taken], 2)


def can_be(data, asked):
    """True if a frame can be what it says, for node ME of COUNT, as the packet formats have it."""
    frame = Frame()
    if wire.decode(data, frame) != wire.OK or frame.link_src not in {0, 2}:
        return False
    if frame.kind == ACK:
        return frame.link_dst != ME or (frame.link_src, frame.origin, frame.seq) in asked
    route = []
    if frame.flags & SOURCE_ROUTE:
        if not frame.length or frame.body[0] >= frame.length:
            return False
        route = frame.body[1 : 1 + frame.body[0]]
    ids = [frame.origin, *frame.path[: frame.path_len], *route]
    to_all = frame.dest == ALL and frame.link_dst == ALL
    return frame.path_len > 0 and max(ids) < COUNT and (frame.dest < COUNT or to_all)


def mutated(chance, samples):
    """Frames of a running network with some bytes changed, or noise; most with a good CRC."""
    data = bytearray(chance.choice(samples))
    shape = chance.randrange(4)
    if shape == 0:
        return crc(bytes([0x50]) + chance.randbytes(6))
    if shape == 1:
        return crc(chance.randbytes(chance.randrange(1, 100)))
    for _ in range(chance.randrange(1, 4)):
        data[chance.randrange(len(data) - 2)] = chance.choice((0, 1, 2, 3, 254, 255, 16, 32))
    return crc(bytes(data[:-2])) if shape == 2 else bytes(data)


async def network_and_frames(sealed=False):
    """A line of three, what came in at the one in the middle, and what it asked acks for."""
    mesh = Mesh(COUNT, LINE)
    if sealed:
        for i, node in enumerate(mesh.nodes):
            node.sealer = Sealer(ring_of("mesh", {1: KEY}, 1), i, State(None))
    samples, asked = [], set()

    def tap(_at, _port, out, data, why):
        frame = Frame()
        if out and wire.decode(data, frame) == wire.OK and frame.kind != ACK:
            asked.add((frame.link_dst, frame.origin, frame.seq))
        elif not out and not why and len(samples) < SAMPLES:
            samples.append(data)

    mesh.nodes[ME].taps.append(tap)
    await mesh.__aenter__()
    receipts = [mesh.nodes[0].send_message(2, b"%d" % k) for k in range(20)]
    assert {await receipt.wait() for receipt in receipts} == {DELIVERED}
    return mesh, samples, asked


@pytest.mark.parametrize("count", [2000, pytest.param(100_000, marks=pytest.mark.slow)])
def test_what_is_kept_changes_only_by_frames_that_can_be_what_they_say(count):
    async def main():
        mesh, samples, asked = await network_and_frames()
        node, chance, good = mesh.nodes[ME], random.Random(5), 0
        for path in node.paths:
            path.send = lambda data: None  # answers to what was made up stay here
        for _ in range(count):
            data = mutated(chance, samples)
            before = kept(node)
            node._receive(chance.choice(node.paths), data)
            if can_be(data, asked):
                good += 1
            else:
                assert kept(node) == before, data.hex()
        await mesh.__aexit__()
        return good

    assert asyncio.run(main()) > count // 50  # both sides of the rule were seen


def test_what_is_sealed_by_one_and_from_another_changes_nothing():
    async def main():
        mesh, samples, _ = await network_and_frames(sealed=True)
        node = mesh.nodes[ME]
        path, theirs = mesh.cables[ME, 2]
        insider = mesh.nodes[2].sealer
        others = [data for data in samples if data[2 if data[0] != 0x50 else 1] == 0]
        before = kept(node)
        for data in others:
            node._receive(path, insider.close(theirs, data))
        assert others
        assert kept(node) == before
        own = next(data for data in samples if data not in others)
        node._receive(path, insider.close(theirs, own))
        assert kept(node) != before
        dropped = node.counters()["dropped: sealed by another than it is from"]
        await mesh.__aexit__()
        return len(others), dropped

    sent, dropped = asyncio.run(main())
    assert sent == dropped


@pytest.mark.parametrize("count", [1000, pytest.param(100_000, marks=pytest.mark.slow)])
def test_no_window_moves_by_what_is_not_genuine_or_was_seen(count):
    async def main():
        mesh, samples, _ = await network_and_frames(sealed=True)
        node, chance, taken = mesh.nodes[ME], random.Random(7), []
        there = mesh.cables[0, 1][0]  # the path of node 0 to us
        send, there.send = there.send, taken.append
        receipts = [mesh.nodes[0].send_message(ME, b"%d" % k) for k in range(20)]
        await until(lambda: len(taken) > 5)
        there.send = send
        assert {await receipt.wait() for receipt in receipts} == {DELIVERED}
        for path in node.paths:
            path.send = lambda data: None
        taken = [data for data in taken if data[0] == seal.FRAME]
        for data in taken:  # sealed and never seen: these are genuine
            before = kept(node)
            node._receive(node.paths[0], data)
            assert kept(node) != before
        for _ in range(count):
            data = bytearray(chance.choice(taken))
            shape = chance.randrange(4)
            if shape == 0:
                data = chance.randbytes(chance.randrange(26, 160))
                data = bytes([chance.randrange(0xC0, 0x100), 0, chance.randrange(4)]) + data
            elif shape == 1:
                data = mutated(chance, samples)  # in the clear
            elif shape == 2:
                data[chance.randrange(len(data))] ^= 1 << chance.randrange(8)
            before = kept(node)
            node._receive(chance.choice(node.paths), bytes(data))
            assert kept(node) == before, bytes(data).hex()
        await mesh.__aexit__()
        return len(taken)

    assert asyncio.run(main()) > 5


def test_an_ack_counts_once_and_only_for_what_was_asked():
    async def main():
        async with Mesh(2, [(0, 1)]) as mesh:
            node = mesh.nodes[0]
            acks = []
            node.taps.append(
                lambda _at, _port, out, data, _why: acks.append(data) if not out else None
            )
            assert await mesh.nodes[0].send_message(1, b"x").wait() == DELIVERED
            ack = next(data for data in acks if data[0] == 0x50)
            before = node.stack.acked[1]
            for _ in range(5):
                node._receive(node.paths[0], ack)
            assert node.stack.acked[1] == before
            node._receive(node.paths[0], crc(ack[:4] + b"\x77\x77" + ack[6:7]))
            return node.counters()["dropped: ack of nothing"]

    assert asyncio.run(main()) == 1


def test_a_node_does_not_take_its_own_frames_in_a_group_for_a_neighbours():
    async def main():
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as sock:
            sock.bind(("127.0.0.1", 0))
            group = ("239.77.12.9", sock.getsockname()[1])
        stack = MeshStack(0, 0, mesh_parameters(3, {}), 7)
        async with MeshNode("n0", stack, [MulticastLink(group, "127.0.0.1")]) as node:
            await until(lambda: node.counters()["dropped: our own"])
            return stack.places, node.paths[0].heard_at

    assert asyncio.run(main()) == ({}, 0)


def test_damaged_frames_change_nothing_in_a_skin():
    async def main():
        chance = random.Random(3)
        async with Skin(2, 1, [(0, 0)]) as skin:
            frames = []
            cell = skin.cells[0]
            cell.taps.append(lambda _at, port, out, data, _why: frames.append((port, data, out)))
            await until(skin.fresh())
            came = [(port, data) for port, data, out in frames if not out]
            record = cell.stack.node
            for port, data in came:
                bad = bytearray(data)
                bad[chance.randrange(len(bad))] ^= 1 << chance.randrange(8)
                before = {name: copy.copy(getattr(record, name)) for name in record.__slots__}
                heard_at = cell.paths[port].heard_at
                cell._receive(cell.paths[port], bytes(bad))
                assert {name: getattr(record, name) for name in record.__slots__} == before
                assert cell.paths[port].heard_at == heard_at
            return len(came)

    assert asyncio.run(main()) > 0


def test_a_channel_keeps_a_stations_place_until_it_is_gone():
    async def main():
        medium, own, other = Medium(), ("127.0.0.1", 9), ("127.0.0.1", 10)
        medium.open(("127.0.0.1", 0))
        medium.take(JOIN.pack(b"J", 3), own)
        medium.take(JOIN.pack(b"J", 3), other)
        assert medium._ears[3].where == own
        medium.take(JOIN.pack(b"J", 1024), other)
        assert set(medium._ears) == {3}
        medium.take(PLUG.pack(b"P", 3, 0), other)
        medium.take(PLUG.pack(b"P", 3, 7), own)
        assert medium._ears[3].plugged
        assert medium.unsound == 4
        medium._ears[3].joined_at -= 3_000_000  # it said nothing for so long
        medium.take(JOIN.pack(b"J", 3), other)
        assert medium._ears[3].where == other
        medium.close()

    asyncio.run(main())


NEVER = [(5_000_000, 3), (-60_000_000, 3), (1 << 62, 3), (0, 0), (0, 65_535)]


@pytest.mark.parametrize(("after_us", "slots"), NEVER)
def test_a_channel_does_not_carry_what_no_station_can_send(after_us, slots):
    async def main():
        medium, own = Medium(), ("127.0.0.1", 9)
        medium.open(("127.0.0.1", 0))
        medium.take(JOIN.pack(b"J", 3), own)
        before = copy.deepcopy(medium._ears)
        medium.take(SEND.pack(b"T", 3, max(0, clock_us() + after_us), slots) + b"x", own)
        assert (medium._ears, list(medium.log)) == (before, [])
        for _ in range(50):  # one frame at a time
            medium.take(SEND.pack(b"T", 3, clock_us(), 20) + b"x", own)
        assert len(medium.log) == 1
        medium.close()

    asyncio.run(main())


def test_a_carrier_of_one_without_a_carrier_is_not_heard():
    assert read_heard(b"C" + bytes(8) + b"\x00\x01") is None
    assert read_heard(b"C" + bytes(8) + b"\x02\x00") is None
    assert read_heard(b"C" + bytes(8) + b"\x01\x01") is not None


@pytest.mark.parametrize("loss", [float("nan"), -0.1, 1.5, float("inf")])
def test_a_share_that_is_none_is_refused_and_the_path_stays_as_it_was(loss):
    node = MeshNode("n", MeshStack(0, 0, mesh_parameters(2, {}), 5),
                    [UdpLink(("127.0.0.1", 0), [("127.0.0.1", 9)])])  # fmt: skip
    node.change(0, "loose", 0.25)
    with pytest.raises(ValueError, match="0 to 1"):
        node.change(0, "loose", loss)
    assert (node.paths[0].loss, node.paths[0].cut) == (0.25, False)
