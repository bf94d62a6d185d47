"""A network of cables from outside of its loop: what is due, what is counted, built and grown."""

from types import SimpleNamespace as Of

import numpy as np
import pytest

from innervate.networks.skin.sim.build import build
from innervate.networks.skin.sim.simulate import SkinSimulation
from innervate.scenario.actions.cables import CUT, GIVE, KILL, LOOSE, LOSE
from innervate.sim import wheel
from innervate.sim.cables import build as cables
from innervate.sim.cables import world as w
from innervate.sim.cables.wires import LOSSY
from innervate.sim.counts import Counts
from innervate.sim.driver import Ended
from innervate.sim.status import DONE, POOL_FULL, ROWS_FULL
from innervate.sim.tables import get, put
from tests.networks.skin.runs import free, line, patch, plan_of

ONE = 1 << 30


def simulation(plain=False, keys=None, **kept):
    plan = plan_of(keys or line(2, data={"rate_hz": 100}, timing={"loss": 0.0}))
    return SkinSimulation(plan, build(plan, plain, **kept), lambda *_: None)


@pytest.fixture(scope="module")
def running():
    """Arrays of a line of two cells, of which each test puts in order what it needs."""
    return simulation()


def queued(running, *events):
    """Slots that are queued: (slot behind the first of the pool's, or of a timer, when)."""
    table, pool = running.world.wheel.events, running.world.wheel.pool
    first = int(get(running.world.run, 0, "pool_slots"))
    table["bucket"], table["time"] = wheel.NIL, 1
    pool[wheel.FRESH] = first + 2
    table["bucket"][first + 2 :], table["time"][first + 2 :] = 7, 2  # never used: left as it was
    for slot, at in events:
        table["bucket"][slot], table["time"][slot] = 7, at


@pytest.mark.parametrize(("events", "commands", "due"), [
    ([], 0, None), ([(0, 900), (1, 700)], 0, 700), ([(0, 700), (-1, 600)], 0, 600),
    ([(0, 900)], 1, 800), ([(0, 700)], 1, 700), ([], 1, 800),
])  # fmt: skip
def test_what_happens_next_is_an_event_or_a_command(running, events, commands, due):
    last = int(get(running.world.run, 0, "pool_slots")) + 1
    queued(running, *((slot if slot >= 0 else last, at) for slot, at in events))
    running.world = running.world._replace(commands=np.zeros(3, running.world.commands.dtype))
    running.world.commands["at"] = (500, 800, 100)  # one is done, and behind the last is room
    put(running.world.run, 0, next_command=1, commands=1 + commands)
    assert running.next_us() == due


def test_faults_are_put_among_the_commands_by_their_time(running):
    running.world = running.world._replace(commands=np.zeros(1, running.world.commands.dtype))
    put(running.world.run, 0, next_command=0, commands=0)
    fault = Of(at_us=50, action=CUT, end=1, node=-1, loss_q15=0, frames=0, index=3)
    running.schedule(fault)
    running.schedule(Of(**vars(fault) | {"at_us": 40, "action": LOSE, "frames": 6, "loss_q15": 9}))
    running.schedule(Of(**vars(fault) | {"at_us": 60, "action": LOOSE, "frames": 6, "loss_q15": 9}))
    running.schedule_row((45, GIVE, -1, 2, 5, -1))
    assert running.world.commands.tolist()[:4] == [
        (40, LOSE, 1, -1, 6, 3), (45, GIVE, -1, 2, 5, -1), (50, CUT, 1, -1, 0, 3),
        (60, LOOSE, 1, -1, 9, 3),
    ]  # fmt: skip
    assert int(get(running.world.run, 0, "commands")) == 4


def test_frames_of_all_blocks_are_counted(running):
    running.world.counters[:] = [10**k % 97 + 3 * k for k in range(40)]
    running.world.alive[:] = (w.ALIVE, w.DEAD, w.OFF)
    numbers = running.world.counters.tolist()

    def every(word):
        return sum(numbers[word + block] for block in (0, 8, 24))

    assert running.counts() == Counts(
        nodes=3, off=(1, 2), sent=every(0), arrived=every(1), offered=numbers[16],
        lost_by={"cut": every(2), "noise": every(3), "off": every(4), "queue_full": every(5),
                 "broken_link": every(6)},
        delivered=numbers[17], dropped_by={"no_route": numbers[18], "loop": numbers[19]},
    )  # fmt: skip
    ended = Ended(70, 2, False, {"rows": 1, "deliveries": 2, "trail": 3})
    put(running.world.run, 0, handled=55)
    left = running.result(ended, True)
    assert (left.arrived, left.handled, left.counters) == (every(1), 55, numbers)
    assert (left.rows, left.deliveries, left.trail, left.ended_us) == (1, 2, 3, 70)
    assert (left.interrupted, left.has_deliveries) == (False, True)


@pytest.mark.parametrize(("at", "words"), [(-1, "0.000000"), (0, "0.000000"), (70, "0.000070")])
def test_what_broke_is_told_with_when_and_by_whom(running, at, words):
    put(running.world.run, 0, broken=w.BROKEN_OUTBOX, broken_node=1, broken_at=at)
    running.world.wheel.clock[wheel.NOW] = 99
    said = f"invariant broken at {words} s (seed 1): outbox of p0 r0 c1 overflowed"
    assert running.broken_line() == said
    put(running.world.run, 0, broken=0)


def test_the_sinks_ranges_are_looked_at_between(running):
    world = running.world
    world.wheel.clock[wheel.NOW] = 99
    assert running.broken_between() is None
    world.pc.size[1] = -1
    assert running.broken_between() == (w.BROKEN_RANGE, 2)
    assert int(get(world.run, 0, "broken_at")) == 99
    world.pc.size[1] = 0
    put(world.pc.own, 0, repair=2)
    assert running.broken_between() == (w.BROKEN_RANGE, 2)
    put(world.pc.own, 0, repair=0)


@pytest.mark.parametrize("plain", [True, False])
def test_room_for_frames_is_doubled_and_those_on_their_way_stay(plain):
    running = simulation(plain)
    world, first = running.world, int(get(running.world.run, 0, "pool_slots"))
    room = int(world.wheel.pool[wheel.LAST])
    put(world.frames, room - 1, seq=7)
    put(world.wheel.events, first + room - 1, time=70, bucket=5)
    world.wheel.links[-1] = 3
    for status in (ROWS_FULL, DONE):
        running.grow(status)
        assert running.world is world
    running.grow(POOL_FULL)
    grown = running.world
    assert int(grown.wheel.pool[wheel.LAST]) == len(grown.frames) == 2 * room
    assert len(grown.wheel.events) == first + 2 * room
    assert len(grown.wheel.links) == wheel.BUCKETS + first + 2 * room
    assert int(get(grown.frames, room - 1, "seq")) == 7
    assert int(get(grown.wheel.events, first + room - 1, "time")) == 70
    assert int(grown.wheel.links[wheel.BUCKETS + first + room - 1]) == 3
    put(grown.frames, 2 * room - 1, seq=9)
    assert int(get(grown.frames, 2 * room - 2, "seq")) == 0


# What a plan becomes.


def test_clocks_drift_within_their_limits_and_their_inverse_is_never_too_long():
    keys = patch(20, 10, (0, 0), timing={"drift_ppm": 1000})
    world = simulation(keys=keys).world
    steep = round(1000 * ONE / 1e6)
    rates = world.clocks["rate"].tolist()
    assert -steep <= min(rates) < -0.9 * steep < 0.9 * steep < max(rates) <= steep
    for rate, inverse in zip(rates, world.starts["inverse"].tolist(), strict=True):
        assert (inverse + 2) * (ONE + rate) >= 1 << 60 >= inverse * (ONE + rate)


def test_without_drift_all_clocks_run_alike():
    world = simulation(keys=line(9, timing={"drift_ppm": 0})).world
    assert set(world.clocks["rate"].tolist()) == {0}
    assert len(set(world.clocks["offset"].tolist())) == 10


def test_latencies_and_losses_of_cables_are_those_of_the_plan():
    world = simulation(keys=line(60, timing={"hop_latency_us": [70, 72], "loss": 0.25})).world
    assert set(world.ends["latency"].tolist()) == {70, 71, 72}
    assert set(world.buffers["loss"].tolist()) == {8192}
    assert set(world.ends["impaired"].tolist()) == {LOSSY}
    assert set(simulation().world.ends["impaired"].tolist()) == {0}


def test_who_has_many_interfaces_may_do_something_at_each_at_once():
    spokes = [("pc", f"n{i}") for i in range(30)]
    world = simulation(keys=free(spokes)).world
    assert int(world.out.limit[0]) == len(world.out.action) == 34
    assert int(get(world.pc.own, 0, "ports")) == len(world.pc.size) == 30
    assert int(simulation().world.out.limit[0]) == 16


def test_every_cell_has_its_number_and_a_generator_of_its_own():
    world = simulation(keys=patch(20, 15, (0, 0))).world
    assert world.cells["number"].tolist() == list(range(300))
    assert len(set(world.cells["rng"].tolist())) == 300
    assert min(world.cells["rng"].tolist()) > 0


@pytest.mark.parametrize(("kept", "limits"), [
    ({}, (1, 1, 1, 0, 0, 0)), ({"checks": False}, (0, 1, 0, 0, 0, 0)),
    ({"observe": False}, (1, 1, 1, 0, 0, 0)),  # what is checked is observed
    ({"observe": False, "checks": False}, (0, 0, 0, 0, 0, 0)),
    ({"checks": False, "trail": True}, (0, 1, 1, 0, 1, 0)),
    ({"deliveries": True}, (1, 1, 1, 1, 0, 0)),
    ({"tap": True}, (1, 1, 1, 0, 0, 1)),
])  # fmt: skip
def test_what_is_kept_has_room(kept, limits):
    world = simulation(plain=True, **kept).world
    run = world.run[0]
    found = (run.checks, run.observe, run.watchful,
             run.delivery_limit, run.trail_limit, run.tap_limit)  # fmt: skip
    assert tuple(map(bool, found)) == tuple(map(bool, limits))
    assert run.row_limit == len(world.rows)
    assert len(world.deliveries) >= run.delivery_limit
    assert len(world.trail) >= run.trail_limit
    assert len(world.taps) == len(world.tapped)
    # Beyond it a batch and a command fit in, each of whose 16 actions empties a queue.
    burst = (cables.BATCH + 1) * 16 * (1 + run.queue_frames)
    assert not run.tap_limit or len(world.taps) >= run.tap_limit + burst


def test_commands_are_in_order_of_time_faults_first_behind_the_one_that_begins():
    keys = line(2, data={"rate_hz": 100})
    cell = {"row": 0, "column": 1}
    keys["event"] = [{"at_s": at, "action": "kill", "cell": cell} for at in (0.3, 0.2)]
    keys["command"] = [{"at_s": 0.2, "code": 5}, {"at_s": 0.1}]
    world = simulation(keys=keys).world
    rows = [(at, action) for at, action, *_ in world.commands.tolist()]
    assert rows == [(0, -1), (100_000, GIVE), (200_000, KILL), (200_000, GIVE), (300_000, KILL)]
    assert int(get(world.run, 0, "commands")) == 5


def test_beacons_alone_never_wait():
    world = simulation(keys=line(2)).world
    assert int(get(world.run, 0, "pool_slots")) == int(get(world.run, 0, "tx_slots")) == 3 * 4
    waiting = simulation(keys=line(2, data={"rate_hz": 100, "queue": 5})).world
    assert int(get(waiting.run, 0, "pool_slots")) == 3 * 4 + len(waiting.ends)
    assert len(waiting.queue) == 5 * len(waiting.ends)
