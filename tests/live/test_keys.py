import asyncio
import os

import pytest
from hypothesis import given, settings

from innervate.live.errors import LiveError
from innervate.live.keyring import read_key
from innervate.live.keys import Sealer, ring_of
from innervate.live.receipts import DELIVERED
from innervate.live.state import State
from innervate.live.udp import UdpLink
from innervate.networks.mesh.live.node import MeshNode
from innervate.networks.mesh.live.parameters import mesh_parameters
from innervate.networks.mesh.live.stack import MeshStack
from tests.live.pair import KEY, OTHER
from tests.live.test_fuzz import FRAMES, HUNDRED


def test_keys_are_read_from_files(tmp_path):
    (tmp_path / "net.key").write_text(KEY.hex() + "\n")
    assert read_key("file:net.key", tmp_path) == KEY
    with pytest.raises(LiveError, match="64 hexadecimal"):
        read_key("abc", tmp_path)
    with pytest.raises(LiveError, match="cannot be read"):
        read_key("file:none.key", tmp_path)


def fuzz_node(sealed):
    params = mesh_parameters(4, {})
    sealer_ = Sealer(ring_of("mesh", {1: KEY}, 1), 0, State(None)) if sealed else None
    link = UdpLink(("127.0.0.1", 0), [("127.0.0.1", 9)])
    return MeshNode("n0", MeshStack(0, 0, params, 5), [link], sealer_)


ONE = FRAMES.map(lambda data: [data])


def check_fuzzed(examples, sealed, inputs=ONE):
    async def main():
        node = fuzz_node(sealed)
        await node.start()
        count = 0

        @settings(max_examples=examples, deadline=None, database=None)
        @given(inputs)
        def feed(many):
            nonlocal count
            for data in many:
                count += 1
                node._receive(node.paths[0], data)

        feed()
        dropped = sum(n for what, n in node.counters().items() if what.startswith("dropped"))
        taken = node.counters()["frames"]
        sent = node.paths[0].counters["sent"]
        await node.stop()
        return count, dropped, taken, sent

    count, dropped, taken, sent = asyncio.run(main())
    assert dropped + taken == count
    assert count >= examples * (100 if inputs is not ONE else 1)
    return taken, sent


def test_random_frames_are_dropped_and_counted_and_never_raise():
    check_fuzzed(200, sealed=False)
    check_fuzzed(20, False, HUNDRED)


def test_random_frames_are_dropped_by_a_node_with_a_key():
    for examples, inputs in ((200, ONE), (20, HUNDRED)):
        taken, _ = check_fuzzed(examples, True, inputs)
        assert taken == 0


@pytest.mark.slow
@pytest.mark.parametrize("sealed", [False, True])
def test_a_hundred_thousand_random_frames(sealed):
    check_fuzzed(1000, sealed, HUNDRED)


def test_sealed_nodes_talk_and_a_stranger_with_another_key_is_not_heard():
    async def main():
        params = mesh_parameters(3, {"ack_us": 30_000})
        ports = [free_port() for _ in range(3)]
        nodes = []
        for i, key in enumerate((KEY, KEY, OTHER)):
            peers = [("127.0.0.1", port) for k, port in enumerate(ports) if k != i]
            stack = MeshStack(i, 0 if i == 0 else -1, params, int.from_bytes(os.urandom(4), "big"))
            own = Sealer(ring_of("mesh", {1: key}, 1), i, State(None))
            nodes.append(MeshNode(f"n{i}", stack, [UdpLink(("127.0.0.1", ports[i]), peers)], own))
        for node in nodes:
            await node.start()
        state = await nodes[0].send_message(1, b"secret").wait()
        near = [row["node"] for row in nodes[0].status()["neighbours"]]
        dropped = nodes[2].counters()["dropped: sealed: wrong key or damaged"]
        for node in nodes:
            await node.stop()
        return state, near, dropped

    state, near, dropped = asyncio.run(main())
    assert (state, near) == (DELIVERED, [1])
    assert dropped > 0


def free_port():
    import socket

    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as sock:
        sock.bind(("127.0.0.1", 0))
        return sock.getsockname()[1]
