"""docs/wire.md says enough: a node that was written from it alone is one of the mesh."""

import asyncio

import pytest

from innervate.live import local
from innervate.live.enrolment import Authority
from innervate.live.identity import load
from innervate.live.keys import Sealer, ring_of
from innervate.live.receipts import DELIVERED
from innervate.live.state import State
from innervate.networks.mesh.live.node import MeshNode
from innervate.networks.mesh.live.parameters import mesh_parameters
from innervate.networks.mesh.live.stack import MeshStack
from tests.live.net import until
from tests.live.sealed_by_the_page import Identity, SealedEnd
from tests.networks.mesh.live.by_the_page import ASKS_END_TO_END, DATA, END_TO_END_ACK, Stranger

KEY, USE = bytes(range(32)), 3


@pytest.mark.parametrize("sealed", ["", "key", "identities"])
def test_a_node_written_from_the_page_alone_relays_sends_and_receives(sealed, tmp_path):
    """0 - 1 - stranger - 3: all that 3 knows of the others came by the stranger."""
    authority, own, psk, key = Authority(tmp_path), None, KEY, USE
    if sealed == "identities":
        own = Identity(authority.enrol(2).read_text())
        psk, key = own.shared, 0

    def sealer(number):
        if sealed == "identities":
            ring = ring_of("mesh", {}, 0, load(authority.enrol(number), number))
        else:
            ring = ring_of("mesh", {USE: KEY}, USE)
        return Sealer(ring, number, State(None)) if sealed else None

    async def main():
        params = mesh_parameters(4, {})
        cables = [local.pair(name) for name in ("01", "12", "23")]
        ends = {0: [cables[0][0]], 1: [cables[0][1], cables[1][0]], 3: [cables[2][1]]}
        ends[1][1].path.port = 1
        nodes = {
            i: MeshNode(f"n{i}", MeshStack(i, -(i > 0), params, 99 + i), ends[i], sealer(i))
            for i in ends
        }
        stranger = Stranger(2, [])
        for link in (cables[1][1], cables[2][0]):
            end = SealedEnd(link.path, 2, psk, key, stranger.take, own) if sealed else link.path
            stranger.ends.append(end)
            await link.open(end.came if sealed else stranger.take)
        heard = {i: [] for i in nodes}
        for i, node in nodes.items():
            node.receive_messages(lambda *said, to=heard[i]: to.append(said[:2]))
            await node.start()
        for end in stranger.ends if sealed else ():
            end.call()
        try:
            await until(lambda: stranger.next and all(n.stack.node.version for n in nodes.values()))
            assert stranger.next == {0: 1, 1: 1, 3: 3}
            if sealed:
                assert [(end.who, end.for_whom) for end in stranger.ends] == [(1, 2), (3, 2)]
            asked = [(0, 3, b"by it"), (3, 0, b"back"), (1, 2, b"to it"), (3, 2, b"to it, too")]
            for origin, to, text in asked:
                assert await nodes[origin].send_message(to, text).wait() == DELIVERED, text
            await stranger.send(DATA, 1, 0, b"from it", ASKS_END_TO_END)
            await until(lambda: any(kind == END_TO_END_ACK for kind, _, _ in stranger.got))
            await stranger.send(DATA, 3, 3, b"from it")
            await until(lambda: len(heard[3]) == 2)
        finally:
            for node in nodes.values():
                await node.stop()
        return heard, [(origin, said) for kind, origin, said in stranger.got if kind == DATA]

    heard, got = asyncio.run(main())
    assert heard == {0: [(3, b"back"), (2, b"from it")], 1: [], 3: [(0, b"by it"), (2, b"from it")]}
    assert got == [(1, b"to it"), (3, b"to it, too")]
