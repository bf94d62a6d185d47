"""A router over a layer that says what was received: hops do not acknowledge."""

from innervate.networks.mesh.protocol import node as mesh
from innervate.networks.mesh.protocol.constants import (
    ACK,
    DATA,
    REPORT_ARRIVED,
    REPORT_HOP,
    REPORT_SUSPECT,
    SENT,
)
from tests.networks.mesh.bench import MASK30, Bench, Item

ALL_PAIRS = [(a, b) for a in range(4) for b in range(a)]
SETTLED_US = 9_000_000


def settled(**settings):
    bench = Bench(4, ALL_PAIRS, told=1, hop_acks=0, **settings)
    bench.run(SETTLED_US)
    bench.sent.clear()
    return bench


def test_a_message_needs_two_frames_and_its_owner_hears_of_both():
    bench = settled()
    bench.send(1, 2, handle=7)
    bench.run(SETTLED_US + 100_000)
    assert [(i, frame.kind) for _, i, frame in bench.sent] == [(1, 8), (2, 9)]
    assert [row[1:4] for row in bench.of(REPORT_HOP)] == [(1, REPORT_HOP, 7)]
    assert [row[1:4] for row in bench.of(REPORT_ARRIVED)] == [(1, REPORT_ARRIVED, 7)]
    assert ACK not in {frame.kind for _, _, frame in bench.sent}


def test_what_the_layer_below_gives_up_goes_another_way():
    bench = settled()
    bench.send(1, 2)
    for tries in range(1, 4):
        assert [frame.link_dst for _, _, frame in bench.sent] == [2] * tries
        bench.queue = [event for event in bench.queue if event[2][0] != "sent"]
        tell(bench, 1, 0)
        bench.run(bench.now + 200)
    assert [row[3] for row in bench.of(REPORT_SUSPECT)] == [2]
    last = bench.sent[-1][2]
    assert (last.kind, last.dest, last.link_dst in (0, 3)) == (DATA, 2, True)


def tell(bench, i, ok):
    """The layer below says what became of a node's frame."""
    item = Item()
    item.ok = ok
    node, gate, now = bench.nodes[i], bench.gates[i], bench.now & MASK30
    mesh.on_input(node, gate, bench.params, now, SENT, item, bench.out)
    bench.drain(i)
