import asyncio
from collections import Counter

import pytest

from innervate.cli import capturing
from innervate.cli.errors import UserError
from innervate.export import links
from innervate.export.reading import Capture
from innervate.live import status, tap
from innervate.live.keys import Sealer, ring_of
from innervate.live.state import State
from innervate.networks.mesh import frames as mesh
from innervate.networks.mesh.protocol.constants import DATA
from tests.live.net import Mesh, Skin, until

OUT, IN = 2, 1


async def serving(nodes, folder):
    """Status sockets that only know captures."""

    def server_of(node):
        return status.Server(
            folder / f"{node.name}.sock", lambda _, writer: tap.serve(node, writer)
        )

    servers = [server_of(node) for node in nodes]
    for server in servers:
        await server.start()
    return servers


def sent(nodes):
    return sum(path.counters["sent"] for node in nodes for path in node.paths)


def test_every_frame_of_sealed_nodes_is_captured_opened_while_they_run(tmp_path):
    async def main():
        net = Mesh(3, [(0, 1), (1, 2)])
        for i, node in enumerate(net.nodes):
            node.sealer = Sealer(ring_of("mesh", {1: bytes(32)}, 1), i, State(None))
        async with net:
            servers = await serving(net.nodes, tmp_path)
            with (tmp_path / "live.pcapng").open("wb") as file:
                recorder = capturing.Recorder([server.path for server in servers], file)
                running = asyncio.create_task(recorder.run(0))
                await until(lambda: all(node.taps for node in net.nodes))
                before = sent(net.nodes)
                receipt = net.nodes[0].send_message(2, b"hello")
                assert await receipt.wait() == "delivered"
                net.nodes[1].paths[0].take(b"no frame at all")
                await until(lambda: recorder.frames > 4)  # written while they run
                assert (tmp_path / "live.pcapng").stat().st_size > 500
                for node in net.nodes:
                    await node.stop()
                left = sent(net.nodes) - before
                await until(lambda: recorder.frames >= 2 * left)
                for server in servers:
                    await server.stop()
                assert await running == 0
        return left, recorder

    left, recorder = asyncio.run(main())
    read = Capture(tmp_path / "live.pcapng")
    packets = list(read.packets())
    assert recorder.sealed == ["n0", "n1", "n2"]
    assert recorder.missed == 0
    counts = Counter((packet.flags, packet.comment) for packet in packets)
    assert counts[OUT, ""] == left
    # What was on a cable when its receiver stopped came in nowhere.
    assert left - 2 <= counts[IN, ""] <= left
    assert counts[IN, "dropped: seal"] == 1
    assert [p.time_ns for p in packets] == sorted(p.time_ns for p in packets)
    whole = [packet.data for packet in packets if not packet.comment]
    assert {mesh.reason_of(data) for data in whole} == {mesh.OK}
    assert any(data[0] & 63 == DATA and b"hello" in data for data in whole)
    places = {links.place_of(one.description)[:3] for one in read.interfaces}
    assert places == {("node", 0, 0), ("node", 1, 0), ("node", 1, 1), ("node", 2, 0)}


def test_a_skins_nodes_are_captured_for_a_time(tmp_path):
    async def main():
        async with Skin(2, 1, [(0, 0)]) as net:
            nodes = [*net.cells, net.pc]
            servers = await serving(nodes, tmp_path)
            with (tmp_path / "live.pcapng").open("wb") as file:
                recorder = capturing.Recorder([server.path for server in servers], file)
                assert await recorder.run(0.4) == 0
            await until(lambda: not any(node.taps for node in nodes))
            for server in servers:
                await server.stop()

    asyncio.run(main())
    read = Capture(tmp_path / "live.pcapng")
    flags = Counter(packet.flags for packet in read.packets())
    assert flags[OUT] > 10
    assert flags[IN] > 10
    places = [links.place_of(one.description) for one in read.interfaces]
    assert {place.what for place in places} == {"cell", "pc"}


def test_a_reader_that_is_too_slow_costs_frames_and_not_memory(tmp_path, monkeypatch):
    monkeypatch.setattr(tap, "PENDING_MAX", 3)

    class Node:
        taps = ()

    told = []

    class Writer:
        async def line(self, answer):
            told.append(answer)
            if "frames" in answer:
                raise ConnectionResetError

    async def main():
        node = Node()
        node.taps = []
        monkeypatch.setattr(tap, "about", lambda _: {})
        task = asyncio.create_task(tap.serve(node, Writer()))
        await until(lambda: node.taps)
        for i in range(10):
            node.taps[0](i, 0, True, b"x", "")
        with pytest.raises(ConnectionResetError):
            await task
        assert node.taps == []

    asyncio.run(main())
    assert [(len(answer["frames"]), answer["missed"]) for answer in told[1:]] == [(3, 7)]


def test_without_a_node_there_is_nothing_to_capture(tmp_path, monkeypatch):
    monkeypatch.setenv("INNERVATE_RUN", str(tmp_path))
    with pytest.raises(UserError, match="no node runs here"):
        capturing.capture(out=tmp_path / "none.pcapng")
    assert list(tmp_path.iterdir()) == []
