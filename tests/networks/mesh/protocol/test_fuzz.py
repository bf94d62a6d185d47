"""Whatever a mesh node receives: it never raises, keeps every range, its outbox and its queue."""

import random

from hypothesis import given, settings
from hypothesis import strategies as st

from innervate.dialect.arith import MASK30
from innervate.networks.mesh.protocol import node as mesh
from innervate.networks.mesh.protocol.constants import SOURCE_ROUTE
from innervate.networks.mesh.protocol.fields import BODY
from tests.networks.mesh.bench import Frame
from tests.networks.mesh.net import Net, geometric

KINDS = [1, 2, 3, 4, 5, 8, 9, 10, 11, 12, 16]
SQUARE = dict(points=3, px=[0, 1000, 0] + [0] * 45, py=[0, 0, 1000] + [0] * 45,
              after=[1, 2, 0] + [0] * 45)  # fmt: skip


def any_frame(chance, count, me, epoch):
    """Any value that a field may have; mostly such as go together."""
    wild = chance.random() < 0.2
    frame = Frame()

    def who():
        if wild and chance.random() < 0.2:
            return chance.randrange(256)
        return chance.choice([me, chance.randrange(count), chance.randrange(count)])

    frame.kind = chance.choice(KINDS) if chance.random() < 0.95 else chance.randrange(64)
    frame.flags = chance.choice([0, 1, 3, 4, 9, 17, 64, chance.randrange(256)])
    frame.link_src, frame.link_dst = who(), chance.choice([me, 255, who()])
    frame.origin = who()
    frame.dest = 255 if frame.link_dst == 255 and chance.random() < 0.5 else who()
    frame.seq = chance.choice([chance.randrange(8), chance.randrange(65536)])
    frame.table_ver, frame.ttl = chance.randrange(256), chance.choice([0, 1, 2, 24, 255])
    frame.path_len = chance.choice([0, 1, 2, 23, 24])
    frame.path[:] = [who() for _ in frame.path]
    most = BODY if wild else max(0, 127 - 13 - frame.path_len)
    frame.length = chance.choice([0, 1, 2, 5, 7, 8, 16, most, chance.randrange(most + 1)])
    frame.length = min(frame.length, most)
    frame.body[:] = [chance.choice([who(), chance.randrange(4), chance.randrange(256)])
                     for _ in frame.body]  # fmt: skip
    if frame.flags & SOURCE_ROUTE and not wild:
        frame.body[0] = chance.randrange(4)
    if not wild:
        frame.body[1 if frame.kind == 1 else 0] = epoch
    frame.rssi = chance.choice([-128, -93, -60, 127])
    return frame


@settings(max_examples=12, deadline=None)
@given(st.integers(0, 10**6), st.sampled_from([0, 1, 2]), st.sampled_from([0, 1, 2, 3]))
def test_any_frame(seed, mode, failover):
    chance = random.Random(seed)
    count = chance.choice([2, 5, 12])
    net = Net(count, geometric(count, min(4, count - 1), seed), mode=mode, failover=failover,
              discovery=chance.choice([1, 2, 3]), flood=chance.randrange(3), seed=seed,
              mtu=chance.choice([64, 127]), activation=chance.randrange(2),
              watch=chance.randrange(2), monitor=chance.choice([254, 0, 1]),
              standbys=(1,), robots=(count - 1,), **SQUARE)  # fmt: skip
    if chance.random() < 0.7:
        net.run(4_000_000)
    net.thorough = True
    for _ in range(60):
        i = chance.choice([0, 1, count - 1])
        what = chance.random()
        if what < 0.7:
            frame = any_frame(chance, count, i, net.nodes[i].epoch)
            node, gate, now = net.nodes[i], net.gates[i], net.now & MASK30
            mesh.on_frame(node, gate, net.params, now, 0, frame, net.out)
            net.drain(i)
        elif what < 0.85:
            net.send(i, chance.randrange(256), bytes(chance.randrange(91)),
                     flags=chance.randrange(256))  # fmt: skip
        elif what < 0.9:
            net.sample(i, chance.randrange(-2000, 2000), chance.randrange(-2000, 2000))
        else:
            net.run(net.now + chance.choice([1000, 5000, 100_000]))
