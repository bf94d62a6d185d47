"""The cell's handlers on plain objects, branch by branch."""

import pytest

from innervate.dialect.arith import MASK30
from innervate.dialect.outbox import DELIVER, FLUSH, REPORT, SEND, SET_TIMER, URGENT
from innervate.networks.skin.protocol.constants import (
    DATA,
    DROP_LOOP,
    DROP_NO_ROUTE,
    MEMORY_LOST,
    NONE,
    ONE,
    REPORT_DROP,
    REPORT_FORGET,
    REPORT_PARENT,
    RESTART,
    SAMPLE,
    SOON,
    TICK,
)
from tests.networks.skin.bench import REAL, Box, OneCell, beacon, new_cell, params_of

W, E, UP, DOWN = range(4)
skin = REAL.skin


def timers(actions):
    return [(a, b) for kind, a, b, *_ in actions if kind == SET_TIMER]


def sample(hops=0):
    frame = Box().frame_class()
    frame.kind, frame.cell, frame.seq, frame.hops = DATA, 3, 200, hops
    frame.proximity, frame.temperature = 77, -5
    frame.force[:], frame.accel[:] = [1, 2, 3], [-4, 5, -6]
    return frame


def routed(**keys):
    bench = OneCell(**keys)
    bench.hear(W, dist=0, sq=1)
    bench.tick()
    skin.on_timer(bench.cell, bench.params, bench.now, SOON, bench.box.out)
    assert bench.parent == W
    return bench


def on_frame(bench, port, frame):
    skin.on_frame(bench.cell, bench.params, bench.now, port, frame, bench.box.out)
    return bench.box.take()


# Start.


def test_start_forgets_all_but_number_and_generator():
    bench = routed()
    bench.cell.seq, bench.cell.choice = 9, 2
    keep = (bench.cell.number, bench.cell.rng, bench.cell.choice)
    skin.on_start(bench.cell, bench.params, 1234, 0, bench.box.out)
    assert timers(bench.box.take()) == [(TICK, 1234)]
    cell = bench.cell
    assert (cell.number, cell.rng, cell.choice) == keep
    assert (cell.parent, cell.sq_known, cell.fd_known, cell.fd_dist) == (NONE, 0, 0, 255)
    assert cell.dist == [255] * 4
    assert cell.heard == cell.pf == cell.child == [0] * 4
    assert (cell.own_load, cell.seq, cell.soon, cell.sent_dist) == (1, 0, 0, -1)
    assert cell.sent_at == (1234 - bench.params.gap_us) & MASK30


def test_only_a_balancing_cell_draws_its_turn():
    for balancing, low, high in ((False, 0, 0), (True, 1, 30)):
        turns = set()
        for seed in range(40):
            cell = new_cell(seed=seed)
            params = params_of(balancing=balancing, balance_periods=30)
            skin.on_start(cell, params, 0, 0, Box().out)
            turns.add(cell.countdown)
        assert low <= min(turns) <= max(turns) <= high
        assert len(turns) == 1 or balancing


def test_after_a_loss_of_memory_a_cell_takes_no_parent_until_its_children_gave_it_up():
    for updates in ("periodic", "wave"):
        bench = OneCell(k=3, updates=updates)
        skin.on_start(bench.cell, bench.params, 0, MEMORY_LOST, bench.box.out)
        bench.says[W] = {"dist": 0, "sq": 1}
        waited = 0
        while bench.parent == NONE:
            sent = bench.sent(bench.period())
            assert waited == 0 or bench.parent == W or all(f.dist == 255 for f in sent.values())
            waited += 1
        assert waited > bench.params.k


# Frames.


@pytest.mark.parametrize("kind", [RESTART, 0, 9, 15])
def test_frames_of_another_kind_are_ignored(kind):
    bench = routed()
    frame = beacon(dist=5)
    frame.kind = kind
    assert on_frame(bench, W, frame) == []
    assert bench.cell.dist[W] == 0


def test_a_beacon_is_stored_port_by_port():
    bench = OneCell()
    bench.hear(UP, dist=3, sq=65_535, load=7, size=99, parent=1)
    cell = bench.cell
    assert (cell.dist[UP], cell.sq[UP], cell.load[UP], cell.size[UP]) == (3, 65_535, 7, 99)
    assert (cell.child[UP], cell.heard) == (1, [0, 0, 1, 0])
    assert cell.dist[W] == 255


def test_in_periodic_mode_hearing_changes_nothing_else():
    bench = OneCell(updates="periodic")
    assert bench.hear(W, dist=0, sq=1) == []
    assert bench.parent == NONE


def test_data_goes_on_to_the_parent():
    bench = routed()
    (action,) = on_frame(bench, E, sample(hops=4))
    assert action[:4] == (SEND, W, 0, 0)
    frame = action[4]
    assert (frame.kind, frame.cell, frame.seq, frame.hops) == (DATA, 3, 200, 5)
    assert (frame.proximity, frame.temperature) == (77, -5)
    assert (frame.force, frame.accel) == ([1, 2, 3], [-4, 5, -6])


def test_data_without_a_route_or_in_a_ring_is_dropped():
    bench = OneCell()
    assert [a[:4] for a in on_frame(bench, E, sample())] == [
        (REPORT, REPORT_DROP, DROP_NO_ROUTE, 0)
    ]
    bench = routed(max_depth=6)
    assert on_frame(bench, E, sample(hops=5))[0][0] == SEND
    assert [a[:4] for a in on_frame(bench, E, sample(hops=6))] == [
        (REPORT, REPORT_DROP, DROP_LOOP, 0)
    ]


def test_a_beacon_is_copied_without_touching_what_data_uses():
    to, frm = sample(), beacon(dist=4, sq=5, load=6, size=7, parent=1)
    skin.copy_frame(to, frm)
    assert (to.kind, to.dist, to.sq, to.load, to.size, to.parent) == (1, 4, 5, 6, 7, 1)
    assert to.proximity == 77
    skin.copy_frame(frm, sample(hops=2))
    assert (frm.kind, frm.hops, frm.force) == (DATA, 2, [1, 2, 3])


# Samples.


def test_a_sample_is_sent_and_counted():
    bench = routed()
    bench.cell.seq = 255
    skin.on_input(bench.cell, bench.params, 0, SAMPLE, sample(hops=9), bench.box.out)
    (action,) = bench.box.take()
    frame = action[4]
    assert (action[0], action[1], frame.kind) == (SEND, W, DATA)
    assert (frame.cell, frame.seq, frame.hops, frame.proximity) == (7, 255, 0, 77)
    assert bench.cell.seq == 0


def test_a_sample_without_a_route_is_dropped_and_counted():
    bench = OneCell()
    skin.on_input(bench.cell, bench.params, 0, SAMPLE, sample(), bench.box.out)
    assert [a[:4] for a in bench.box.take()] == [(REPORT, REPORT_DROP, DROP_NO_ROUTE, 0)]
    assert bench.cell.seq == 1


# Ticks.


def test_a_tick_sends_on_every_port_and_sets_the_next():
    bench = routed()
    start = bench.now
    actions = bench.period()
    sent = bench.sent(actions)
    assert sorted(sent) == [W, E, UP, DOWN]
    assert {(f.dist, f.sq, f.load) for f in sent.values()} == {(1, 1, 1)}
    assert timers(actions) == [(TICK, start + 2 * bench.params.beacon_us)]
    flags = {a: c for kind, a, _b, c, _f in actions if kind == SEND}
    assert flags[W] == URGENT


def test_a_broken_port_is_still_spoken_to_but_its_queue_is_given_up():
    bench = routed(k=2)
    for _ in range(2):
        bench.period(W)
    flags = {a: c for kind, a, _b, c, _f in bench.period(W) if kind == SEND}
    assert flags[W] == URGENT | FLUSH


def test_a_late_tick_does_not_make_up_for_lost_ones():
    bench = routed()
    bench.now = bench.cell.tick_at + 3 * bench.params.beacon_us
    actions = bench.tick()
    assert timers(actions) == [(TICK, bench.now + bench.params.beacon_us)]


def test_ticks_run_through_the_wrap_of_the_clock():
    bench = OneCell()
    near_end = MASK30 - 1000
    skin.on_start(bench.cell, bench.params, near_end, 0, bench.box.out)
    bench.box.take()
    skin.on_timer(bench.cell, bench.params, near_end, TICK, bench.box.out)
    at = (near_end + bench.params.beacon_us) & MASK30
    assert timers(bench.box.take()) == [(TICK, at)]
    assert at < near_end


def test_the_load_counts_children_on_whole_ports_and_saturates():
    bench = OneCell(k=1)
    bench.hear(W, dist=9, load=5, parent=1)
    bench.hear(E, dist=9, load=6, parent=0)
    bench.hear(UP, dist=9, load=7, parent=1)
    bench.tick()
    assert bench.cell.own_load == 1 + 5 + 7
    bench.period(UP)
    assert bench.cell.own_load == 1 + 5
    bench.hear(W, dist=9, load=4095, parent=1)
    bench.period()
    assert bench.cell.own_load == 4095


def test_the_distance_saturates():
    bench = routed(max_depth=254)
    bench.cell.dist[W] = 253
    assert skin.distance(bench.cell) == 254
    bench.cell.dist[W] = 255
    assert skin.distance(bench.cell) == 255


def test_a_cell_that_never_had_a_route_says_load_0():
    bench = OneCell()
    assert {f.load for f in bench.sent(bench.tick()).values()} == {0}
    bench.hear(W, dist=0, sq=1)
    assert {f.load for f in bench.sent(bench.tick()).values()} == {1}
    bench.hear(W, dist=255, sq=1)
    assert {(f.dist, f.load) for f in bench.sent(bench.tick()).values()} == {(255, 1)}


# E27 "after FD_HOLD periods without a route: fd = (none, 255)"
def test_fd_is_forgotten_after_fd_hold_periods():
    for silent in (False, True):
        bench = routed(k=2) if not silent else OneCell(k=2)
        hold = bench.params.hold_periods
        assert hold == 2 + 4 * 32
        bench.hear(W, dist=255, sq=1)
        bench.tick()
        codes = [code for _ in range(hold) for code, _a, _b in bench.reported(bench.period())]
        assert codes.count(REPORT_FORGET) == (0 if silent else 1)
        assert (bench.cell.fd_known, bench.cell.fd_dist, bench.cell.sq_known) == (0, 255, 0)


def test_a_route_in_between_starts_the_hold_anew():
    bench = routed(k=2)
    bench.hear(W, dist=255, sq=1)
    for _ in range(100):
        bench.period()
    bench.hear(W, dist=0, sq=2)
    bench.period()
    assert bench.cell.hold == 0
    bench.hear(W, dist=255, sq=2)
    for _ in range(100):
        assert not bench.reported(bench.period())[1:]
    assert bench.cell.fd_known


# Triggered updates.


def news_of(bench, port, **said):
    actions = bench.hear(port, **said)
    return timers(actions), bench.reported(actions)


@pytest.mark.parametrize("updates", ["triggered", "wave"])
def test_news_is_sent_after_the_gap(updates):
    bench = OneCell(updates=updates)
    bench.tick()
    sent_at = bench.cell.sent_at
    bench.now += 100
    found = news_of(bench, W, dist=0, sq=1)
    assert found == ([(SOON, sent_at + bench.params.gap_us)], [(REPORT_PARENT, NONE, W)])
    # ... once only, although there is more news
    assert news_of(bench, W, dist=3, sq=1) == ([], [])
    skin.on_timer(bench.cell, bench.params, bench.now, SOON, bench.box.out)
    sent = bench.sent(bench.box.take())
    assert {f.dist for f in sent.values()} == {4}
    assert bench.cell.soon == 0


def test_news_long_after_the_last_beacon_is_sent_at_once():
    bench = OneCell(updates="triggered")
    bench.tick()
    bench.now += 2000
    actions = bench.hear(W, dist=0, sq=1)
    assert timers(actions) == []
    assert {port: beacon.dist for port, beacon in bench.sent(actions).items()} == dict.fromkeys(
        range(4), 1
    )


def test_the_timer_of_stale_news_sends_nothing():
    bench = OneCell(updates="triggered")
    bench.tick()
    bench.hear(W, dist=0, sq=1)
    bench.hear(W, dist=255, sq=1)
    skin.on_timer(bench.cell, bench.params, bench.now, SOON, bench.box.out)
    assert bench.box.take() == []


def test_only_a_wave_carries_a_new_number_on():
    for updates, timer in (("triggered", []), ("wave", [SOON])):
        bench = routed(updates=updates)
        assert [t for t, _ in news_of(bench, W, dist=0, sq=2)[0]] == timer
        # an older number is no news
        bench = routed(updates=updates)
        assert news_of(bench, W, dist=0, sq=0)[0] == []


def test_a_wave_lets_a_tick_pass_silently_soon_after_a_beacon():
    bench = routed(updates="wave")
    bench.hear(W, dist=0, sq=2)
    bench.now = bench.cell.tick_at - bench.params.skip_us + 1
    skin.on_timer(bench.cell, bench.params, bench.now, SOON, bench.box.out)
    assert len(bench.sent(bench.box.take())) == 4
    assert bench.sent(bench.tick()) == {}
    # the next one is late enough
    assert len(bench.sent(bench.tick())) == 4


def test_a_wave_does_not_keep_silent_about_news():
    bench = routed(updates="wave")
    bench.hear(E, dist=2, sq=1)
    bench.now = bench.cell.tick_at - 500
    skin.announce(bench.cell, bench.now, bench.box.out)
    bench.box.take()
    bench.cell.pf[W] = ONE - 1
    bench.cell.heard[W] = 0
    assert len(bench.sent(bench.tick())) == 4


def test_a_nearer_port_is_taken_at_once_and_a_tie_is_not():
    bench = OneCell(updates="triggered")
    bench.hear(W, dist=3, sq=1)
    assert bench.reported(bench.hear(E, dist=3, sq=1)) == []
    assert bench.reported(bench.hear(UP, dist=2, sq=1)) == [(REPORT_PARENT, W, UP)]
    # a child, however near, and one that is farther are not
    assert bench.reported(bench.hear(DOWN, dist=0, sq=1, parent=1)) == []
    assert bench.reported(bench.hear(E, dist=9, sq=2)) == []


def test_a_parent_that_gets_worse_has_all_ports_looked_at():
    bench = OneCell(updates="triggered")
    bench.hear(W, dist=1, sq=1)
    bench.hear(E, dist=2, sq=4)
    actions = bench.hear(W, dist=5, sq=2)
    assert bench.reported(actions) == [(REPORT_PARENT, W, E)]
    assert bench.parent == E


def test_nothing_is_delivered_by_a_cell():
    bench = routed()
    assert all(kind != DELIVER for kind, *_ in bench.period() + on_frame(bench, E, sample()))
