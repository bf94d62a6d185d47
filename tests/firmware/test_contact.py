"""First contact in C with live nodes, with its like, and with nobody who may not."""

import asyncio
import ctypes
import json
from pathlib import Path

import pytest

from innervate.live import noise
from innervate.live.keyring import PROLOGUE, About
from innervate.live.session import REKEY_US
from innervate.wire import seal
from tests.firmware import in_c
from tests.live import time_by_hand
from tests.live.pair import KEY, OTHER, Wire, begin, network_sealer

BEAT_S = 0.02
VECTOR = json.loads((Path(__file__).parents[1] / "fixtures" / "noise.json").read_text())["NNpsk0"]


def beats(*fars):
    """Has boards look at their clocks from now on."""

    async def go():
        while True:
            for far in fars:
                far.beat(round(asyncio.get_running_loop().time() * 1e6))
            await asyncio.sleep(BEAT_S)

    return asyncio.create_task(go())


def wired(far, wire):
    """A board at the far end of a live node's wire."""
    far.send = lambda data: asyncio.get_running_loop().call_soon(wire.hear, data)
    wire.others = [far]


def at_a_live_node(test, native, key=KEY, **more):
    """Runs a test with a live node (2), its wire and a board (1)."""

    async def main():
        far, wire = in_c.Far(native, 1, key, 5, **more), Wire()
        wired(far, wire)
        sealer = begin(network_sealer(2), wire)
        ticking = beats(far)
        try:
            await test(far, wire, sealer)
        finally:
            ticking.cancel()
            sealer.stop()

    time_by_hand.run(main())


def test_published_vectors(native):
    """Cacophony's, which the handshake of live nodes plays, too."""
    part = {name: bytes.fromhex(VECTOR[name]) for name in
            ("init_prologue", "init_ephemeral", "resp_ephemeral", "handshake_hash")}  # fmt: skip
    messages = [{k: bytes.fromhex(v) for k, v in one.items()} for one in VECTOR["messages"][:2]]
    keys = in_c.keys_of(
        in_c.crypto_of(native, in_c.drawn(1)), bytes.fromhex(VECTOR["init_psks"][0])
    )
    sides = [ctypes.create_string_buffer(in_c.ROOM) for _ in range(2)]
    for side in sides:
        prologue = part["init_prologue"]
        native.innervate_noise_begin(side, ctypes.byref(keys), prologue, len(prologue))
    places = []
    for message in messages:
        room = bytes(32) + message["payload"] + bytes(16)
        places.append(ctypes.create_string_buffer(room, len(room)))
    point, sizes = ctypes.create_string_buffer(32), [len(one["payload"]) for one in messages]
    native.innervate_point(keys.crypto, point, part["init_ephemeral"])
    native.innervate_noise_write(sides[0], places[0], point, sizes[0])
    assert places[0].raw == messages[0]["ciphertext"]
    assert native.innervate_noise_read(sides[1], places[0], len(places[0])) == sizes[0]
    far = part["init_ephemeral"], part["resp_ephemeral"]
    native.innervate_noise_write_second(sides[1], places[1], sizes[1], far[1], point)
    assert places[1].raw == messages[1]["ciphertext"]
    size = native.innervate_noise_read_second(sides[0], places[1], len(places[1]), far[0])
    assert places[1].raw[32 : 32 + size] == messages[1]["payload"]
    for side in sides:
        assert part["handshake_hash"] in side.raw[:64]


def test_a_board_and_a_live_node_shake_hands_and_speak(native):
    async def test(far, wire, sealer):
        wire.frame(b"waits for the first session")
        await asyncio.sleep(0.3)
        far.frame(b"from the board")
        wire.frame(b"for the board")
        await asyncio.sleep(0.1)
        assert wire.got == [(1, b"from the board")]
        assert far.got == [(2, b"waits for the first session"), (2, b"for the board")]
        assert not any(b"board" in said for said in (*far.said, *wire.said))
        assert far.refused == 0
        assert sealer.dropped == {}

    at_a_live_node(test, native)


@pytest.mark.parametrize("who", ["board", "node"])
def test_one_alone_that_asks_is_enough(native, who):
    async def test(far, wire, sealer):
        if who == "board":
            sealer.stop()
            wire.said.clear()
        else:
            far.beat = lambda now: None
        await asyncio.sleep(1.0)
        assert all(said[0] < seal.FIRST for said in (wire if who == "board" else far).said)
        far.frame(b"up")
        wire.frame(b"down")
        await asyncio.sleep(0.1)
        assert (wire.frames(), [frame for _, frame in far.got]) == ([b"up"], [b"down"])

    at_a_live_node(test, native)


def test_frames_flow_through_new_sessions_and_none_is_lost(native):
    async def test(far, wire, sealer):
        await asyncio.sleep(0.5)
        for k in range(round(1.2 * REKEY_US / 1e7)):
            far.frame(b"%d" % k)
            wire.frame(b"%d" % k)
            await asyncio.sleep(10)
        wanted = [b"%d" % i for i in range(k + 1)]
        assert wire.frames() == [frame for _, frame in far.got] == wanted
        assert 3 <= sealer.counts["handshakes"] <= 6
        assert far.refused == 0

    at_a_live_node(test, native)


def test_a_neighbour_that_lost_its_sessions_is_found_again(native):
    async def test(far, wire, sealer):
        await asyncio.sleep(0.5)
        again = in_c.Far(native, 1, KEY, 6)
        wired(again, wire)  # the board was switched off and on
        ticking = beats(again)
        await asyncio.sleep(0.5)
        again.frame(b"back")
        await asyncio.sleep(0.1)
        assert wire.frames() == [b"back"]
        sealer.stop()
        other = Wire()
        wired(again, other)  # and now the live node, which asks nobody
        begin(network_sealer(2), other).stop()
        for _ in range(50):
            again.frame(b"anybody")
            await asyncio.sleep(0.1)
        assert b"anybody" in other.frames()
        ticking.cancel()

    at_a_live_node(test, native)


def test_nobody_without_the_key_is_answered(native):
    async def test(far, wire, sealer):
        await asyncio.sleep(1.0)
        assert not far.is_up
        assert wire.sealer.dropped["sealed: wrong key or damaged"] > 2
        assert far.refused > 2
        assert all(said[0] >= seal.FIRST for said in far.said)

    at_a_live_node(test, native, key=OTHER)


def test_another_kind_of_network_is_not_answered(native):
    async def test(far, wire, sealer):
        await asyncio.sleep(1.0)
        assert not far.is_up
        assert far.refused > 2

    at_a_live_node(test, native, network=2)


def test_no_byte_of_any_message_can_be_changed_and_none_comes_twice(native):
    async def test(far, wire, sealer):
        await asyncio.sleep(0.3)
        wire.frame(b"once")
        await asyncio.sleep(0.1)
        assert len(far.got) == 1
        recorded = list(wire.said)
        said, refused = len(far.said), far.refused
        for data in recorded:
            for place in range(len(data)):
                wrong = bytearray(data)
                wrong[place] ^= 1 << place % 8
                far.hear(bytes(wrong))
        assert far.refused == refused + sum(map(len, recorded))
        for cut in range(len(recorded[0])):
            far.hear(recorded[0][:cut])
        for data in recorded:
            far.hear(data)
        assert len(far.got) == 1
        answers = {said[0] for said in far.said[said:]}
        assert answers <= {seal.SECOND}  # a question that was answered has its answer again
        wire.frame(b"and still")
        await asyncio.sleep(0.1)
        assert far.got[1:] == [(2, b"and still")]

    at_a_live_node(test, native)


def test_a_recording_is_worth_nothing_to_a_board_that_was_started_anew(native):
    async def test(far, wire, sealer):
        await asyncio.sleep(0.3)
        wire.frame(b"OPEN VALVE")
        await asyncio.sleep(0.1)
        assert far.got == [(2, b"OPEN VALVE")]
        again = in_c.Far(native, 1, KEY, 7)
        for _ in range(3):
            for data in wire.said:
                again.hear(data)
            again.beat(round(asyncio.get_running_loop().time() * 1e6))
        assert again.got == []
        assert not again.is_up

    at_a_live_node(test, native)


def test_the_same_question_has_the_same_answer_and_ones_own_has_none(native):
    a, b = (in_c.Far(native, number, KEY, 10 * number) for number in (1, 2))
    a.beat(0)
    b.hear(a.said[0])
    b.hear(a.said[0])
    assert b.said[0] == b.said[1]
    a.hear(a.said[0])
    assert (a.refused, a.said[1:]) == (1, [])
    a.hear(b.said[1])
    a.hear(b.said[1])
    assert a.refused == 2


def test_a_point_that_gives_no_secret_is_not_answered(native):
    ring = network_sealer(2).ring
    state, point = noise.Symmetric(noise.NETWORK, PROLOGUE + bytes((1,)), KEY), bytes(32)
    state.mix_hash(point)
    state.mix_key(point)
    message = point + state.encrypt(About(2, 1, bytes(8), 77, "", "").encode())
    far = in_c.Far(native, 1, KEY, 5)
    far.hear(ring.close(1, bytes((seal.FIRST + 1,)) + message))
    assert (far.refused, far.said) == (1, [])


def test_a_session_of_which_nothing_comes_never_came_about(native):
    a, b = (in_c.Far(native, number, KEY, 10 * number) for number in (1, 2))
    a.send = b.hear
    a.beat(0)
    a.send = lambda data: None
    a.hear(b.said[0])
    for ms in range(20, 4000, 20):
        a.beat(1000 * ms)
        assert a.is_up == (ms <= 2000)
        assert not a.is_up or {said[0] for said in a.said[1:]} == {seal.CONTROL}
    assert a.said[-1][0] == seal.FIRST + 1


def test_questions_that_come_to_nothing_push_out_no_session_that_is_heard(native):
    far, used, older = in_c.Far(native, 1, KEY, 1), *(in_c.Far(native, 2, KEY, k) for k in (2, 3))
    for other in (older, used):
        other.beat(0)
        far.hear(other.said[-1])
        other.hear(far.said[-1])  # and says that it is there
        far.hear(other.said[-1])
    for k in range(10):
        asks = in_c.Far(native, 3, KEY, 10 + k)
        asks.beat(0)
        far.beat(1_000_000 * (k + 1))
        far.hear(asks.said[0])
        for other in (older, used):
            other.frame(b"%d" % k)
            far.hear(other.said[-1])
    assert [frame for _, frame in far.got] == [b"%d" % (k // 2) for k in range(20)]


def test_with_aes_the_handshake_has_its_own_name(native):
    keys = in_c.keys_of(in_c.crypto_of(native, in_c.drawn(1), is_aes=True), KEY)
    place, wanted = ctypes.create_string_buffer(in_c.ROOM), object.__new__(noise.Symmetric)
    native.innervate_noise_begin(place, ctypes.byref(keys), b"here", 4)
    wanted.ck = wanted.h = b"Noise_NNpsk0_25519_AESGCM_SHA256"  # 32 bytes are their own hash
    wanted.mix_hash(b"here")
    wanted.mix_key_and_hash(KEY)
    assert place.raw[8:104] == wanted.h + wanted.ck + wanted.k


@pytest.mark.parametrize("is_aes", [False, True])
def test_two_boards_shake_hands_with_chacha_or_with_aes(native, is_aes):
    a, b = (in_c.Far(native, number, KEY, 10 * number, is_aes) for number in (1, 2))
    a.send, b.send = b.hear, a.hear
    for now in range(0, 1_000_000, 20_000):
        a.beat(now)
        b.beat(now + 7000)
    a.frame(b"from a")
    b.frame(b"from b")
    assert (a.got, b.got) == ([(2, b"from b")], [(1, b"from a")])
    assert a.refused == b.refused == 0


def test_aes_and_chacha_do_not_meet(native):
    async def test(far, wire, sealer):
        await asyncio.sleep(1.0)
        assert not far.is_up
        assert sealer.dropped["sealed: wrong key or damaged"] > 2

    at_a_live_node(test, native, is_aes=True)


def test_the_clocks_end_is_no_end(native):
    a, b = (in_c.Far(native, number, KEY, 10 * number) for number in (1, 2))
    a.send, b.send = b.hear, a.hear
    for second in range(0, 2 * 1074 * 4):
        now = 2**30 - 1_000_000 + second * 250_000
        a.beat(now)
        b.beat(now)
        if second % 8 == 0 and second > 8:
            a.frame(b"%d" % second)
            b.frame(b"%d" % second)
    assert len(a.got) == len(b.got) == 2 * 1074 * 4 // 8 - 2
    assert a.refused == b.refused == 0
