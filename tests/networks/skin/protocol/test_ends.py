"""The PC's handlers and the static baseline's, branch by branch."""

import pytest

from innervate.dialect.arith import MASK30
from innervate.dialect.outbox import DELIVER, SEND, SET_TIMER
from innervate.networks.skin.protocol.constants import DATA, MEMORY_LOST, NONE, RESTART, SOON, TICK
from tests.networks.skin.bench import REAL, Box, OneCell, beacon, params_of, sink_state
from tests.networks.skin.net import Net

sink, static = REAL.skin_sink, REAL.skin_static
W, E, UP, DOWN = range(4)


class Pc:
    """The PC on its own."""

    def __init__(self, ports=2, **keys):
        self.params = params_of(**keys)
        self.state = sink_state(REAL, ports)
        self.box = Box(limit=16)
        self.now = 0
        sink.on_start(self.state, self.params, 0, 0, self.box.out)

    @property
    def own(self):
        return self.state.own[0]

    def tick(self, handler=sink.on_timer):
        self.box.take()
        handler(self.state, self.params, self.now, TICK, self.box.out)
        self.now += self.params.beacon_us
        return self.box.take()

    def hear(self, port, handler=sink.on_frame, kind=None, **said):
        self.box.take()
        frame = beacon(**said)
        if kind is not None:
            frame.kind = kind
        handler(self.state, self.params, self.now, port, frame, self.box.out)
        return self.box.take()


def sent(actions):
    return [frame for kind, *_, frame in actions if kind == SEND]


def test_the_pc_listens_for_k_periods_then_counts():
    pc = Pc(k=3, m=2)
    assert all(not sent(pc.tick()) for _ in range(3))
    numbers = [sent(pc.tick())[0].sq for _ in range(6)]
    assert numbers == [0, 1, 1, 2, 2, 3]


def test_the_pc_speaks_on_every_port_of_what_it_serves():
    pc = Pc(ports=3, k=1, m=1)
    pc.tick()
    pc.hear(1, load=40, parent=1)
    pc.hear(2, load=50, parent=0)
    frames = sent(pc.tick())
    assert [(f.dist, f.load, f.size, f.parent) for f in frames] == [
        (0, 0, 0, 0), (0, 0, 40, 0), (0, 0, 0, 0),
    ]  # fmt: skip
    # "S_i = last load heard on i if its parent flag was set"
    pc.hear(1, load=40, parent=0)
    assert [f.size for f in sent(pc.tick())] == [0, 0, 0]


# E27 "adopt that sq"; load 0 marks a cell that never had a route: its number means nothing
def test_the_pc_goes_on_from_the_newest_number():
    pc = Pc(k=2, m=1)
    pc.hear(0, sq=500, load=0)
    assert not pc.own.sq_known
    pc.hear(0, sq=65_000, load=3)
    pc.hear(1, sq=64_999, load=3)
    assert (pc.own.sq, pc.own.sq_known) == (65_000, 1)
    for _ in range(2):
        pc.tick()
    assert sent(pc.tick())[0].sq == 65_001
    pc.hear(0, sq=65_003, load=3)
    assert sent(pc.tick())[0].sq == 65_004


def test_numbers_wrap():
    pc = Pc(k=1, m=1)
    pc.hear(0, sq=65_535, load=1)
    pc.tick()
    assert [sent(pc.tick())[0].sq for _ in range(2)] == [0, 1]


def test_data_is_delivered_and_other_kinds_are_not():
    pc = Pc()
    (action,) = pc.hear(1, kind=DATA)
    assert action[:2] == (DELIVER, DATA)
    assert pc.hear(1, kind=RESTART) == []
    assert pc.hear(1, kind=11) == []


def test_the_pc_ticks_on_time_and_does_not_make_up_for_late_ones():
    pc = Pc(k=1)
    assert [(a, b) for kind, a, b, *_ in pc.tick() if kind == SET_TIMER] == [(TICK, 4000)]
    pc.now = 90_000
    assert [(a, b) for kind, a, b, *_ in pc.tick() if kind == SET_TIMER] == [(TICK, 94_000)]
    assert pc.own.tick_at <= MASK30


def test_a_restart_forgets_and_listens_again():
    pc = Pc(k=2, m=1)
    for _ in range(5):
        pc.tick()
    pc.hear(0, load=9, parent=1)
    sink.on_start(pc.state, pc.params, pc.now, 1, pc.box.out)
    assert (pc.own.sq_known, pc.own.listen, pc.state.size) == (0, 2, [0, 0])
    assert sink.on_input(pc.state, pc.params, 0, 1, None, pc.box.out) is None


# The static baseline.


def joined(**keys):
    bench = OneCell(rule="static", k=2, **keys)
    hear(bench, W, dist=0, sq=1)
    return bench


def hear(bench, port, kind=None, **said):
    frame = beacon(**said)
    if kind is not None:
        frame.kind = kind
    static.on_frame(bench.cell, bench.params, bench.now, port, frame, bench.box.out)
    return bench.box.take()


def fire(bench, timer):
    static.on_timer(bench.cell, bench.params, bench.now, timer, bench.box.out)
    return bench.box.take()


def kinds(actions):
    return [frame.kind for kind, *_, frame in actions if kind == SEND]


def test_static_the_first_set_up_frame_decides():
    bench = OneCell(rule="static")
    static.on_start(bench.cell, bench.params, 0, 0, bench.box.out)
    assert bench.cell.sent_dist == 255
    actions = hear(bench, E, dist=5, sq=3)
    assert bench.cell.parent == E
    low, high = bench.params.forward_min_us, bench.params.forward_max_us
    (wait,) = [b for kind, a, b, *_ in actions if kind == SET_TIMER and a == SOON]
    assert low <= wait - bench.now <= high
    hear(bench, W, dist=1, sq=3)  # nearer, but second
    assert bench.cell.parent == E
    frames = sent(fire(bench, SOON))
    assert {(f.dist, f.sq) for f in frames} == {(6, 3)}
    assert [f.parent for f in frames] == [0, 1, 0, 0]


@pytest.mark.parametrize(
    "said", [{"dist": 255, "sq": 3}, {"dist": 64, "sq": 3}, {"dist": 1, "sq": 3, "parent": 1}]
)
def test_static_what_is_no_set_up(said):
    bench = OneCell(rule="static")
    hear(bench, E, **said)
    assert bench.cell.parent == NONE


def test_static_a_new_number_moves_a_cell():
    bench = joined()
    hear(bench, E, dist=3, sq=2)
    assert bench.cell.parent == E
    hear(bench, W, dist=0, sq=1)
    assert bench.cell.parent == E


def test_static_a_broken_parent_restarts_everything():
    bench = joined()
    assert kinds(fire(bench, TICK)) == [1] * 4
    fire(bench, TICK)
    actions = fire(bench, TICK)
    assert bench.cell.parent == NONE
    assert kinds(actions) == [RESTART] * 4 + [1] * 4
    # and it goes on saying so until it is set up anew
    assert kinds(fire(bench, TICK)) == [RESTART] * 4 + [1] * 4


def test_static_a_restart_is_passed_on_once():
    bench = joined()
    assert kinds(hear(bench, E, RESTART, sq=9)) == []  # of another set-up
    assert kinds(hear(bench, E, RESTART, sq=1)) == [RESTART] * 4
    assert bench.cell.parent == NONE
    assert kinds(hear(bench, E, RESTART, sq=1)) == []


def test_static_a_cell_that_lost_its_memory_has_the_network_set_up_anew():
    bench = OneCell(rule="static", k=2)
    static.on_start(bench.cell, bench.params, 0, MEMORY_LOST, bench.box.out)
    bench.box.take()
    hear(bench, W, dist=0, sq=5)
    assert bench.cell.parent == NONE
    assert RESTART in kinds(fire(bench, TICK))
    hear(bench, W, dist=0, sq=6)
    assert bench.cell.parent == W


def test_static_a_late_tick_and_data():
    bench = joined()
    bench.now = bench.cell.tick_at + 9 * bench.params.beacon_us
    actions = fire(bench, TICK)
    assert (SET_TIMER, TICK, bench.now + bench.params.beacon_us) in [a[:3] for a in actions]
    frame = Box().frame_class()
    frame.kind = DATA
    static.on_frame(bench.cell, bench.params, 0, E, frame, bench.box.out)
    assert [a[:2] for a in bench.box.take()] == [(SEND, W)]


def test_static_the_pc_waits_out_the_dead_time():
    pc = Pc(rule="static", k=2, restart_s=0.5)
    assert not sent(pc.tick(static.sink_timer))
    assert not sent(pc.tick(static.sink_timer))
    assert [f.sq for f in sent(pc.tick(static.sink_timer))] == [1, 1]
    assert [f.sq for f in sent(pc.tick(static.sink_timer))] == [1, 1]
    assert pc.hear(0, static.sink_frame, RESTART, sq=7) == []
    (action,) = pc.hear(0, static.sink_frame, RESTART, sq=1)
    assert action[:3] == (SET_TIMER, SOON, pc.now + 500_000)
    assert pc.hear(1, static.sink_frame, RESTART, sq=1) == []  # already known
    static.sink_timer(pc.state, pc.params, pc.now, SOON, pc.box.out)
    assert [f.sq for f in sent(pc.box.take())] == [2, 2]
    assert pc.own.repair == 0
    pc.hear(0, static.sink_frame, load=5, parent=1)
    assert pc.state.size == [5, 0]


def test_static_a_skin_comes_up_without_a_restart():
    # The PC's silence while it listens is no failure.
    for first in (True, False):
        net = Net([("pc", "a"), ("a", "b"), ("b", "c")], rule="static", k=3)
        order = [3, 0, 1, 2] if first else [0, 1, 2, 3]
        for _ in range(12):
            net.turn(order)
            for cell in range(3):
                net.soon(cell)
        assert [net.distance(cell) for cell in range(3)] == [1, 2, 3], f"PC first: {first}"
        assert net.pc.own[0].sq == 1, f"PC first: {first}"
