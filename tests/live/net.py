"""Live nodes of one process, joined by in-process links, for tests."""

import asyncio
import time
from contextlib import asynccontextmanager

from innervate.live import local
from innervate.live.up import Processes
from innervate.networks.mesh.live.node import MeshNode
from innervate.networks.mesh.live.parameters import mesh_parameters
from innervate.networks.mesh.live.stack import MeshStack
from innervate.networks.skin.live.node import CellNode, SinkNode
from innervate.networks.skin.live.parameters import skin_parameters
from innervate.networks.skin.live.stack import CellStack, SinkStack

WAIT_S = 20.0
LINE = {
    "kind": "mesh", "nodes": 3, "radio": {"profile": "ip"},
    "link": [{"a": 0, "b": 1}, {"a": 1, "b": 2}],
    "protocol": {"ack_us": 30_000, "e2e_s": 0.3},
}  # fmt: skip


async def until(what, limit_s=WAIT_S):
    """Wait until `what()` is true, looking every few milliseconds; the seconds it took."""
    began = time.monotonic()
    while not what():
        assert time.monotonic() - began < limit_s, "it did not happen in time"
        await asyncio.sleep(0.005)
    return time.monotonic() - began


@asynccontextmanager
async def running(plan, folder, cables="udp", *others):
    """The processes of a plan, up and later down again."""
    network = Processes(plan, folder, cables, *others)
    await network.up()
    try:
        yield network
    finally:
        await network.down()


class Mesh:
    """Mesh nodes joined by `links` [(a, b), ...]; node 0 is the gateway.

    Timers are those of the profile, but a hop waits longer: a busy machine is no dead neighbour.
    """

    def __init__(self, count, links, standbys=(), **settings):
        params = mesh_parameters(count, {"ack_us": 30_000, "e2e_us": 300_000, **settings})
        ends = [[] for _ in range(count)]
        self.cables = {}
        for a, b in links:
            here, there = local.pair(f"{a}-{b}", (len(ends[a]), len(ends[b])))
            ends[a].append(here)
            ends[b].append(there)
            self.cables[a, b] = here.path, there.path
        self.nodes = []
        for i in range(count):
            rank = 0 if i == 0 else 1 + standbys.index(i) if i in standbys else -1
            stack = MeshStack(i, rank, params, 7919 * (i + 1) ** 3)
            self.nodes.append(MeshNode(f"n{i}", stack, ends[i]))

    async def __aenter__(self):
        for node in reversed(self.nodes):
            await node.start()
        await until(self.has_tables)
        return self

    async def __aexit__(self, *_):
        for node in self.nodes:
            await node.stop()

    def has_tables(self):
        return all(node.stack.node.version for node in self.nodes)

    def cut(self, a, b, cut=True):
        for path in self.cables[a, b]:
            path.cut = cut


class Skin:
    """A patch of cells, and the PC on cables to some of them: `interfaces` [(cell, port), ...]."""

    def __init__(self, columns, rows, interfaces, rate_hz=50.0, **settings):
        params = skin_parameters(settings)
        count = columns * rows
        ends = [[] for _ in range(count)]
        ports = [[] for _ in range(count)]
        self.cables = {}

        def join(a, port_a, b, port_b):
            here, there = local.pair(f"{a}-{b}", (len(ends[a]), len(ends[b])))
            for node, link, port in ((a, here, port_a), (b, there, port_b)):
                ends[node].append(link)
                ports[node].append(port)
            self.cables[a, b] = here.path, there.path

        for cell in range(count):
            if cell % columns + 1 < columns:
                join(cell, 1, cell + 1, 0)
            if cell + columns < count:
                join(cell, 3, cell + columns, 2)
        pc = []
        for i, (cell, port) in enumerate(interfaces):
            here, there = local.pair(f"pc-{cell}", (i, len(ends[cell])))
            pc.append(here)
            ends[cell].append(there)
            ports[cell].append(port)
            self.cables["pc", i] = here.path, there.path
        self.cells = []
        for i in range(count):
            stack = CellStack(i, params, 7919 * (i + 1) ** 3, ports[i])
            self.cells.append(CellNode(f"c{i}", stack, ends[i]))
            self.cells[i].rate_hz = rate_hz
        self.pc = SinkNode("pc", SinkStack(params, len(interfaces)), pc)
        self.heard = {}
        self.pc.receive_touch(lambda touch: self.heard.__setitem__(touch.cell, time.monotonic()))

    async def __aenter__(self):
        for node in (*self.cells, self.pc):
            await node.start()
        return self

    async def __aexit__(self, *_):
        for node in (*self.cells, self.pc):
            await node.stop()

    def fresh(self, but=()):
        """True once every cell was heard since now."""
        since = time.monotonic()
        cells = [i for i in range(len(self.cells)) if i not in but]
        return lambda: all(self.heard.get(i, 0) > since for i in cells)
