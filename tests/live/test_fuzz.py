"""Whatever comes in from outside is taken or dropped and counted, and never raises."""

import asyncio
import binascii
import json
import random
from contextlib import suppress

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from innervate.dialect import plain
from innervate.live import status
from innervate.live.channel import Medium
from innervate.live.channel_radio import TOLD, read_heard
from innervate.live.contact import Contact
from innervate.live.group import GroupContact
from innervate.networks.mesh import frames as mesh
from innervate.networks.mesh.live.alarms import KINDS, read_alarm
from innervate.networks.mesh.live.order import Order
from innervate.networks.mesh.protocol import fields as mesh_fields
from innervate.networks.radio import frames as radio
from innervate.networks.radio.live.stack import Frame as RadioFrame
from innervate.networks.skin import frames as skin
from innervate.networks.skin.live.items import Frame as SkinFrame
from innervate.wire import cobs, seal
from tests.live.pair import Wire, network_sealer

FEW, MANY = 200, 100_000
MeshFrame = plain.make("Frame", mesh_fields.FRAME)


def crc(body):
    return body + binascii.crc_hqx(body, 0xFFFF).to_bytes(2, "big")


FRAMES = st.one_of(
    st.binary(max_size=200),
    st.binary(min_size=7, max_size=125)
    .map(  # with a good CRC, and anything in it
        lambda body: bytes([0x40 | body[0] & 31]) + body[1:]
    )
    .map(lambda body: body + binascii.crc_hqx(body, 0xFFFF).to_bytes(2, "big")),
    st.tuples(st.integers(0xC0, 0xFF), st.binary(max_size=160)).map(
        lambda parts: bytes([parts[0]]) + parts[1]
    ),
)
SOME = st.one_of(st.binary(max_size=64), st.binary(min_size=5, max_size=20).map(crc))
MEDIUM = st.one_of(
    SOME,
    st.tuples(st.sampled_from([b"J", b"T", b"C", b"F"]), st.binary(max_size=40)).map(b"".join),
)  # fmt: skip


def reads_mesh(data):
    frame = MeshFrame()
    assert 0 <= mesh.decode(data, frame) < len(mesh.REASONS)


def reads_skin(data):
    frame = SkinFrame()
    assert 0 <= skin.decode(data, frame) < len(skin.REASONS)


def reads_radio(data):
    frame = RadioFrame()
    assert 0 <= radio.decode(data, frame) < len(radio.REASONS)


def reads_line(data):
    decoder = cobs.Decoder(32)
    frames = decoder.feed(data)
    assert all(len(frame) <= 32 for frame in frames)
    assert len(frames) + decoder.dropped <= data.count(0) + len(data) // 32 + 1


def reads_sealed(data):
    one, path = network_sealer(2), Wire(is_group=len(data) % 2 == 1)
    one._contacts[0] = (GroupContact if path.is_group else Contact)(one, path)
    assert one.open(path, data) is None
    theirs = one.counts["for other members"] + one.counts["handshake messages"]
    assert sum(one.dropped.values()) + (theirs if path.is_group else 0) == 1
    if seal.is_sealed(data):
        seal.fields(data)


def reads_heard(data):
    heard = read_heard(data)
    assert heard is None or heard[0] in TOLD


def reads_alarm(data):
    alarm = read_alarm(3, data, 100)
    assert alarm is None or alarm.kind in KINDS


def orders(data):
    order, got = Order(None, 10, 8), []
    for k in range(0, len(data) - 3, 4):
        seq, before = int.from_bytes(data[k : k + 2], "big"), data[k + 2] << 8 | data[k + 3]
        got += order.take(seq, before, b"x", k)
        assert len(order.held) <= 8
    got += order.release(1 << 40)
    assert len(got) + order.late == len(data) // 4


DECODERS = [
    (reads_mesh, FRAMES), (reads_skin, SOME), (reads_radio, SOME), (reads_line, SOME),
    (reads_sealed, FRAMES), (reads_heard, MEDIUM), (reads_alarm, SOME), (orders, SOME),
]  # fmt: skip


def hundred(seed):
    """Many inputs for little: noise, noise with a good CRC, and what begins like a frame."""
    chance = random.Random(seed)
    found = []
    for _ in range(100):
        data = chance.randbytes(chance.randrange(130))
        shape = chance.randrange(4)
        if shape == 1:
            data = crc(data[:16])
        elif shape == 2:
            data = crc(bytes([0x40 | chance.randrange(32)]) + data)
        elif shape == 3:
            data = bytes([chance.choice(b"JTCRF\xc1\x00\xff")]) + data
        found.append(data)
    return found


HUNDRED = st.integers(0, 2**64).map(hundred)


def fuzz(reads, inputs, count):
    @settings(max_examples=count, deadline=None, database=None)
    @given(inputs)
    def feed(data):
        reads(data)

    feed()


@pytest.mark.parametrize(("reads", "inputs"), DECODERS)
def test_decoders(reads, inputs):
    fuzz(reads, inputs, FEW)


@pytest.mark.slow
@pytest.mark.parametrize(("reads", "inputs"), DECODERS)
def test_decoders_a_hundred_thousand_times(reads, inputs):
    count = 0

    def read_all(many):
        nonlocal count
        for data in many:
            count += 1
            reads(data)

    fuzz(read_all, HUNDRED, MANY // 100)
    assert count >= MANY


def test_a_channel_hears_what_is_no_frame_and_goes_on():
    async def main():
        medium = Medium()
        medium.open(("127.0.0.1", 0))
        fuzz(lambda data: medium.take(data, ("127.0.0.1", 9)), MEDIUM, FEW)
        medium.close()

    asyncio.run(main())


@pytest.mark.slow
def test_a_channel_hears_a_hundred_thousand():
    async def main():
        medium, count = Medium(), 0
        medium.open(("127.0.0.1", 0))
        for seed in range(MANY // 100):
            for data in hundred(seed):
                count += 1
                medium.take(data, ("127.0.0.1", 9))
        medium.close()
        return count

    assert asyncio.run(main()) == MANY


ASKED = st.one_of(
    st.binary(max_size=60),
    st.dictionaries(
        st.sampled_from(["do", "to", "payload", "port", "loss", "at_cm", "speed_cm_s", "in_order"]),
        st.one_of(
            st.none(), st.booleans(), st.integers(), st.floats(), st.text(max_size=6),
            st.sampled_from(["status", "send", "cut", "restore", "loose", "locate", "00"]),
            st.lists(st.floats() | st.text(max_size=2), max_size=3),
        ),
    ).map(lambda request: json.dumps(request).encode()),
)  # fmt: skip


@pytest.mark.parametrize("count", [100, pytest.param(5000, marks=pytest.mark.slow)])
def test_whatever_is_asked_of_a_node_gets_an_answer(tmp_path, count):
    from innervate.live.main import Process
    from innervate.live.nodefile import Loaded, parse

    table = parse({
        "kind": "mesh", "number": 0, "nodes": 2, "role": "gateway", "state": str(tmp_path / "s"),
        "link": [{"kind": "udp", "bind": "127.0.0.1:0", "peers": ["127.0.0.1:9"]}],
    })  # fmt: skip

    class Lines:
        """Takes an answer and hangs up."""

        got = 0

        async def line(self, answer):
            json.dumps(answer)
            self.got += 1
            raise ConnectionResetError

    async def main():
        process = Process(Loaded(table, tmp_path / "n0.toml"))
        await process.node.start()
        asked, lines = [], Lines()
        fuzz(asked.append, ASKED, count)
        for line in asked:
            with suppress(ConnectionResetError):
                async with asyncio.timeout(5):
                    await status.answer(line, process._answer, lines)
        assert lines.got == len(asked)
        await process.node.stop()

    asyncio.run(main())
