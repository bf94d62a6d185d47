"""The loop of cables by hand: what stops it, commands among events, and what it leaves behind."""

from types import SimpleNamespace as Of

import pytest

from innervate.scenario.actions.cables import CUT, GIVE
from innervate.sim import wheel
from innervate.sim.cables import calls, commands, loop, recorder, wires
from innervate.sim.cables.loop import BATCH, ROWS_PER_EVENT
from innervate.sim.cables.wires import DELIVERED
from innervate.sim.cables.world import BROKEN_RANGE
from innervate.sim.status import BROKEN, BUDGET, DONE, POOL_FULL, ROWS_FULL
from tests.sim.cables.small import Do, small_world

LIMIT, ACTIONS = 5_000, 16
RUN = dict.fromkeys(
    ("broken", "rows", "deliveries", "delivery_limit", "trail", "trail_limit", "taps", "tap_limit",
     "next_command", "commands", "status"), 0,
)  # fmt: skip
FULL = BATCH * ACTIONS  # what the outboxes of a batch hold
POOL = BATCH * 16 + FULL  # that a batch may need


def pressing(free=POOL, **run):
    """Why it stops with so much of the pool left: 40 slots of timers, then 3,000 of frames."""
    pool = [wheel.NIL, 3_040 - free, 3_000]
    given = RUN | {"row_limit": LIMIT, "pool_slots": 40} | run
    return loop.pressing(Of(run=[Of(**given)], wheel=Of(pool=pool), out=Of(limit=[ACTIONS])))


@pytest.mark.parametrize(("why", "given"), [
    (DONE, {}), (POOL_FULL, {"free": POOL - 1}), (BROKEN, {"broken": 1, "free": 0}),
    (DONE, {"rows": LIMIT - BATCH * ROWS_PER_EVENT - FULL}),
    (ROWS_FULL, {"rows": LIMIT - BATCH * ROWS_PER_EVENT - FULL + 1}),
    (DONE, {"deliveries": 36, "delivery_limit": 36 + FULL}),
    (ROWS_FULL, {"deliveries": 37, "delivery_limit": 36 + FULL}),
    (DONE, {"deliveries": 37}), (DONE, {"trail": 37}),  # none are kept
    (DONE, {"trail": 36, "trail_limit": 36 + BATCH}),
    (ROWS_FULL, {"trail": 37, "trail_limit": 36 + BATCH}),
    (DONE, {"taps": 8, "tap_limit": 8}), (ROWS_FULL, {"taps": 9, "tap_limit": 8}),
    (ROWS_FULL, {"taps": 1}),
])  # fmt: skip
def test_the_loop_stops_before_a_table_is_full(why, given):
    assert pressing(**given) == why


SAMPLES = (10, 20, 30)  # slots 0, 1, 2 are due then


@pytest.fixture
def played(monkeypatch):
    """A loop whose events and commands are only noted, and whose tables have room."""
    world, said = small_world(), []
    run_of = world.run[0]
    monkeypatch.setattr(loop, "pressing", lambda _world: BROKEN if run_of.broken else DONE)
    for slot, at in enumerate(SAMPLES):
        wheel.insert(world.wheel, slot, at)
    monkeypatch.setattr(loop, "dispatch", lambda _world, _do, slot, time: said.append((slot, time)))
    for name in ("obey", "hand_in"):
        monkeypatch.setattr(
            commands, name,
            lambda _world, _do, command, name=name: said.append((name, command.at)),
        )  # fmt: skip
    world.run[0].next_command = world.run[0].commands = 0

    def run(until, budget=1000, *orders):
        for at, action in orders:
            world.commands.append(Of(at=at, action=action))
        world.commands[:] = world.commands[-len(orders) :] if orders else []
        world.run[0].commands = len(orders)
        said.clear()
        loop.bind(Do(world))(world, until, budget)
        return list(said), world.run[0].status

    run.world = world
    return run


def test_it_goes_up_to_a_time_and_not_to_it(played):
    assert played(20) == ([(0, 10)], DONE)
    assert played(21) == ([(1, 20)], DONE)
    assert played(31) == ([(2, 30)], DONE)


def test_commands_come_before_the_events_of_their_moment(played):
    orders = ((0, CUT), (20, GIVE), (20, CUT), (25, CUT), (31, CUT))
    assert played(31, 1000, *orders) == (
        [("obey", 0), (0, 10), ("hand_in", 20), ("obey", 20), (1, 20), ("obey", 25), (2, 30)], DONE,
    )  # fmt: skip
    assert played.world.run[0].next_command == 4


@pytest.mark.parametrize("at", [20, 25])
def test_a_command_behind_the_end_is_not_obeyed(played, at):
    assert played(20, 1000, (at, CUT)) == ([(0, 10)], DONE)
    assert played.world.run[0].next_command == 0


@pytest.mark.parametrize(("budget", "batches"), [(1, 1), (BATCH, 1), (BATCH + 1, 2)])
def test_the_budget_counts_batches(played, budget, batches):
    wheel.remove(played.world.wheel, 0)
    orders = ((1, CUT), (2, CUT), (3, CUT))  # each ends a batch
    assert played(9, budget, *orders) == ([("obey", k + 1) for k in range(batches)], BUDGET)


def test_a_batch_has_so_many_events_and_the_last_may_be_all(played):
    world = played.world
    for slot in range(world.run[0].pool_slots + 70, world.run[0].pool_slots, -1):
        wheel.insert(world.wheel, slot, 40)
    said, status = played(41, BATCH)
    assert (len(said), status) == (BATCH, BUDGET)
    said, status = played(41, BATCH)
    assert (len(said), status) == (9, DONE)


def test_nothing_is_done_to_a_network_that_has_broken(played, monkeypatch):
    run = played.world.run[0]
    monkeypatch.setattr(loop, "dispatch", lambda *_: setattr(run, "broken", 3))
    assert played(31, 1000, (11, CUT)) == ([], BROKEN)
    assert run.next_command == 0


def test_every_event_goes_where_it_belongs(monkeypatch):
    world, said = small_world(), []
    for room, names in (
        (wires, ["release", "wire_free"]),
        (calls, ["on_event"]),
    ):
        for name in names:
            monkeypatch.setattr(
                room, name, lambda _w, _do, *what, name=name: said.append((name, *what))
            )
    run, events = world.run[0], world.wheel.events
    first = run.pool_slots
    events[first].kind, events[first + 1].kind = wires.DELAYED, wires.URGENT_BLOCK
    for slot in (0, run.tx_slots - 1, run.tx_slots, first - 1, first, first + 1):
        loop.dispatch(world, None, slot, 70)
    assert said == [
        ("on_event", 0, 70), ("on_event", run.tx_slots - 1, 70), ("wire_free", 0, 70),
        ("wire_free", first - 1 - run.tx_slots, 70), ("release", first, 70),
        ("on_event", first + 1, 70),
    ]  # fmt: skip


# What a network keeps that has no recorder of its own.


def world_of(**run):
    given = {"delivery_limit": 9, "deliveries": 2, "observe": 1, "rows": 0, "row_limit": 9,
             "broken": 0, "broken_node": -1}  # fmt: skip
    return Of(
        run=[Of(**given | run)], counters=[0] * 40, deliveries=[Of() for _ in range(5)],
        rows=[Of() for _ in range(2)], delays=[Of(high=0, count=0, sum=0)], delay_counts=[0] * 6000,
        words=[[5, 5], [5, 9]], low=[0, 0], high=[8, 8],
    )  # fmt: skip


def test_a_delivery_has_a_row_and_its_own_latency():
    world = world_of()
    recorder.keep_delivered(world, 70, 1, 3, 6, -1)
    recorder.keep_delivered(world, 80, 0, 2, 5, 44)
    assert [vars(row) for row in world.deliveries[2:4]] == [
        {"time": 70, "node": 1, "port": 3, "kind": 6, "latency": -1},
        {"time": 80, "node": 0, "port": 2, "kind": 5, "latency": 44},
    ]  # fmt: skip
    assert (world.counters[DELIVERED], world.run[0].deliveries) == (2, 4)
    world.run[0].delivery_limit = 0
    recorder.keep_delivered(world, 90, 1, 3, 6, 45)
    assert (world.counters[DELIVERED], world.run[0].deliveries) == (3, 4)
    assert (world.deliveries[3].latency, vars(world.delays[0])) == (
        44, {"high": 45, "count": 2, "sum": 89})  # fmt: skip


@pytest.mark.parametrize("observe", [0, 1])
def test_reports_are_kept_if_they_are_observed(observe):
    world = world_of(observe=observe)
    recorder.on_report(world, 70, 1, 2, 3, 4)
    assert world.run[0].rows == observe


@pytest.mark.parametrize(("node", "broken", "found"), [
    (0, 0, (0, -1)), (1, 0, (BROKEN_RANGE, 1)), (1, 4, (4, -1)),
])  # fmt: skip
def test_a_value_out_of_range_breaks_the_run_once(node, broken, found):
    world = world_of(broken=broken)
    recorder.check(world, node)
    assert (world.run[0].broken, world.run[0].broken_node) == found
