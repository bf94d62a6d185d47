"""Nodes whose every frame went through bytes do what nodes do that hand over records."""

import pytest

from innervate.dialect.arith import MASK30
from innervate.networks.mesh import frames as wire
from innervate.networks.mesh.protocol import node as mesh
from innervate.networks.mesh.protocol.constants import (
    ACK,
    ALARM,
    DATA,
    E2E_ACK,
    GRAPH,
    RESPONSE,
    SAMPLE,
    TABLE,
)
from tests.networks.mesh.bench import Bench, Frame, Item

GRID = [(a, a + 1) for a in range(11) if a % 4 != 3] + [(a, a + 4) for a in range(8)]


class Wired(Bench):
    """A bench whose frames travel as bytes."""

    def push(self, at, what):
        if what[0] == "frame":
            kind, to, sent = what
            frame = Frame()
            data = wire.encode(sent, self.params.mtu)
            assert wire.decode(data, frame, self.params.mtu) == wire.OK
            assert len(data) == wire.size_of(sent)
            what = (kind, to, frame)
        super().push(at, what)


def story(bench_class, **settings):
    """Discovery, tables, messages, deaths: what was reported and delivered."""
    bench = bench_class(12, GRID, **settings)
    bench.run(6_000_000)
    bench.send(11, 0, b"first")
    bench.send(3, 254, b"to the monitor", flags=34)
    bench.run(8_000_000)
    bench.dead |= {5, 6}
    for node in (8, 9, 11):
        bench.send(node, 3, bytes(27))
    bench.run(25_000_000)
    bench.start(9, cause=1)
    bench.run(28_000_000)
    assert bench.nodes[9].known
    kinds = {frame.kind for _at, _who, frame in bench.sent}
    handed = [
        (at, who, f.kind, f.origin, f.seq, f.body[: f.length]) for at, who, f in bench.delivered
    ]
    return bench.reports, handed, kinds


@pytest.mark.parametrize("mtu", [64, 127])
@pytest.mark.parametrize("mode", [0, 1, 2])
@pytest.mark.few(2)
def test_frames_as_bytes_change_nothing(mode, mtu):
    reports, handed, kinds = story(Bench, mode=mode, mtu=mtu)
    assert story(Wired, mode=mode, mtu=mtu) == (reports, handed, kinds)
    assert len(handed) >= 5
    assert {RESPONSE, DATA, E2E_ACK, ACK} < kinds
    assert (TABLE in kinds) == (mode == 0)
    assert (GRAPH in kinds) == (mode == 1)


def sample(bench, i, x, vx):
    item = Item()
    item.x, item.y, item.vx = x, 500, vx
    now = bench.now & MASK30
    mesh.on_input(bench.nodes[i], bench.gates[i], bench.params, now, SAMPLE, item, bench.out)
    bench.drain(i)


def test_alarms_travel_as_bytes():
    def walk(bench_class):
        bench = bench_class(12, GRID, robots=(11,), points=4, monitor=0)
        px, py, after = bench.params.px, bench.params.py, bench.params.after
        px[:4], py[:4], after[:4] = [0, 1000, 1000, 0], [0, 0, 1000, 1000], [1, 2, 3, 0]
        bench.run(6_000_000)
        for k, x in enumerate((900, 1010, 1050, 900)):
            sample(bench, 11, x, 50 if k < 2 else -50)
            bench.run(6_000_000 + 1_000_000 * (k + 1))
        return bench.reports, [(at, f.kind, f.body[: f.length]) for at, _w, f in bench.delivered]

    reports, handed = walk(Bench)
    assert walk(Wired) == (reports, handed)
    assert [body[3] for _at, kind, body in handed if kind == ALARM] == [1, 3]
