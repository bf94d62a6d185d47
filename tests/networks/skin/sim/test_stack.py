"""A skin as its medium is told of it, by hand: who is handed what, what is kept, what is felt."""

from types import SimpleNamespace as Of

import pytest

from innervate.dialect.arith import MASK16, MASK30
from innervate.networks.skin.protocol import cell as skin
from innervate.networks.skin.protocol import sink as skin_sink
from innervate.networks.skin.protocol.constants import (
    BEACON,
    COMMAND,
    DATA,
    EVERYBODY,
    GIVE,
    NONE,
    REPORT_BALANCE,
    REPORT_DROP,
    REPORT_FORGET,
    REPORT_PARENT,
    RULE_FEASIBLE,
    RULE_STATIC,
    RULE_STRICT,
    SOON,
    TICK,
)
from innervate.networks.skin.sim import observer, orders, proved, simulate, stack, touch
from innervate.networks.skin.sim.build import build, order_row
from innervate.networks.skin.sim.counters import (
    ADDRESSED,
    COMMAND_BLOCK,
    GIVEN,
    LOOPED,
    MISSED,
    NO_ROUTE,
    REACHED,
    REPEATED,
    STRAY,
)
from innervate.networks.skin.sim.orders import (
    CAME,
    HAD_A_WAY,
    HAD_NO_WAY,
    NOT_MEANT,
    SLOTS,
    WAS_OFF,
)
from innervate.scenario.actions.cables import GIVE as TO_GIVE
from innervate.sim.cables.wires import DELIVERED
from innervate.sim.cables.world import ALIVE, DEAD
from innervate.topology.layout import cell_places
from tests.networks.skin.runs import line, plan_of

CELLS, SINK = 3, 3


def world_of(rule=RULE_FEASIBLE, checks=1, **run):
    given = {"cells": CELLS, "checks": checks, "observe": 1, "delivery_limit": 9, "deliveries": 1,
             "rows": 0, "row_limit": 4, "broken": 0}  # fmt: skip
    return Of(
        run=[Of(**given | run)], cells=["c0", "c1", "c2"], pc=Of(own=[Of(command=0)]), out="out",
        params=[Of(rule=rule)], clocks=[Of(offset=100, rate=0)] * 4, wheel=Of(clock=[70, -1]),
        sample=[Of()], counters=[0] * 40, deliveries=[Of() for _ in range(3)],
        delays=[Of(high=0, count=0, sum=0) for _ in range(3)], delay_counts=[0] * (3 * 6000),
        watch=Of(forgot=[-1, 1, -1], due=[0] * (SLOTS * CELLS), due_number=[NONE] * SLOTS),
        alive=[ALIVE] * 4, rows=[Of() for _ in range(4)],
    )  # fmt: skip


@pytest.fixture
def said(monkeypatch):
    """Which functions of the protocol and of its watchers were called, without the world."""
    found = []

    def note(room, name, answer=None):
        def noted(*what):
            rest = [one for one in what if not (hasattr(one, "run") or hasattr(one, "rule"))]
            found.append((f"{room.__name__.rpartition('.')[2]}.{name}", *rest))
            return answer

        monkeypatch.setattr(room, name, noted)

    for name in ("on_start", "on_frame", "on_timer", "on_input"):
        note(skin, name)
        note(skin_sink, name)
    note(skin, "hear", 0)
    note(skin, "announce_soon")
    for name in (
        "on_started",
        "on_beacon",
        "on_counted",
        "on_routed",
        "on_forgotten",
        "on_stopped",
    ):
        note(proved, name)
    note(observer, "on_report")
    note(observer, "follow")
    note(stack, "check_route")
    note(stack, "check_range")
    note(orders, "reach")
    return found


@pytest.mark.parametrize("checks", [0, 1])
def test_who_starts_is_a_cell_or_the_pc(said, checks):
    world = world_of(checks=checks)
    stack.on_start(world, 1, 500, 1)
    stack.on_start(world, SINK, 600, 0)
    watched = [("proved.on_started", 70, 1, 1), ("proved.on_started", 70, SINK, 0)]
    cell, pc = ("cell.on_start", "c1", 500, 1, "out"), ("sink.on_start", world.pc, 600, 0, "out")
    assert said == [cell, *watched[:checks], pc, *watched[1 : 1 + checks]]


@pytest.mark.parametrize("checks", [0, 1])
def test_a_period_of_the_pc_is_looked_at_when_it_ends(said, checks):
    world = world_of(checks=checks)
    stack.on_timer(world, 1, 500, TICK)
    stack.on_timer(world, SINK, 500, SOON)
    stack.on_timer(world, SINK, 500, TICK)
    assert said == [("cell.on_timer", "c1", 500, TICK, "out"),
                    ("sink.on_timer", world.pc, 500, SOON, "out"),
                    ("sink.on_timer", world.pc, 500, TICK, "out"),
                    *[("proved.on_counted", 70)] * checks]  # fmt: skip


def test_inputs_go_to_cells_and_to_the_pc(said):
    world = world_of()
    item = world.sample[0]
    stack.on_input(world, 2, 500, 6)
    stack.on_input(world, SINK, 500, 7)
    assert said == [("cell.on_input", "c2", 500, 6, item, "out"),
                    ("sink.on_input", world.pc, 500, 7, item, "out")]  # fmt: skip


@pytest.mark.parametrize(("rule", "checks", "news"), [
    (RULE_STRICT, 1, 1), (RULE_STRICT, 0, 1), (RULE_FEASIBLE, 1, 0), (RULE_FEASIBLE, 1, 1),
])  # fmt: skip
def test_a_beacon_is_heard_and_its_news_are_told_soon(said, monkeypatch, rule, checks, news):
    world, beacon = world_of(rule, checks), Of(kind=BEACON)
    monkeypatch.setattr(skin, "hear", lambda *what: said.append(("hear", what[2])) or news)
    stack.on_frame(world, 1, MASK30, 2, beacon)
    watched = [("proved.on_beacon", MASK30, 1, 2, beacon)] * (rule == RULE_STRICT and checks)
    assert said == [*watched, ("hear", 2), *[("cell.announce_soon", "c1", 99, "out")] * news]


@pytest.mark.parametrize("kind", [DATA, COMMAND])
def test_other_frames_are_handed_on_with_the_nodes_time(said, kind):
    world, frame = world_of(), Of(kind=kind)
    stack.on_frame(world, 1, MASK30, 2, frame)
    stack.on_frame(world, SINK, 400, 0, frame)
    stack.on_frame(world, SINK, 400, 1, Of(kind=BEACON))
    assert said[:2] == [("cell.on_frame", "c1", 99, 2, frame, "out"),
                        ("sink.on_frame", world.pc, 500, 0, frame, "out")]  # fmt: skip
    assert said[2][0] == "sink.on_frame"


def frame(kind=DATA, **more):
    given = {"cell": 3, "seq": 4, "hops": 5, "proximity": 6, "force": [1, 2, 3], "temperature": 7,
             "accel": [8, 9, 10], "sq": 11, "dist": 12, "load": 13, "size": 14, "parent": 1,
             "made_at": 60, "kind": kind}  # fmt: skip
    return Of(**given | more)


TOLD = {
    DATA: ({"cell": 2}, {"seq": 5}, {"hops": 6}, {"proximity": 7}, {"force": [2, 2, 3]},
           {"force": [1, 3, 3]}, {"force": [1, 2, 4]}, {"accel": [8, 9, 11]}, {"temperature": 8}),
    COMMAND: ({"cell": 2}, {"sq": 12}, {"hops": 6}, {"dist": 13}, {"proximity": 7}),
    BEACON: ({"dist": 13}, {"sq": 12}, {"load": 14}, {"size": 15}, {"parent": 0}),
}  # fmt: skip


@pytest.mark.parametrize("kind", TOLD)
def test_a_digest_is_of_what_a_frame_of_its_kind_says(kind):
    marks = [stack.digest(frame(kind, **change)) for change in ({}, *TOLD[kind])]
    assert len(set(marks)) == len(marks)
    assert stack.digest(frame(kind, made_at=61)) == marks[0]
    assert len({stack.digest(frame(one)) for one in TOLD}) == 3
    assert stack.block_of(frame(kind)) == (COMMAND_BLOCK if kind == COMMAND else 0)


@pytest.mark.parametrize(("code", "b", "checks", "calls"), [
    (REPORT_PARENT, 2, 1, ["check_route", "on_routed"]), (REPORT_PARENT, NONE, 1, ["check_route"]),
    (REPORT_BALANCE, 2, 1, ["check_route"]), (REPORT_PARENT, 2, 0, []),
    (REPORT_FORGET, 0, 1, ["on_forgotten"]), (REPORT_FORGET, 0, 0, []), (REPORT_DROP, 0, 1, []),
])  # fmt: skip
def test_reports_of_routes_are_checked_at_once(said, code, b, checks, calls):
    stack.on_report(world_of(checks=checks), 90, 1, code, 0, b)
    assert said[0] == ("observer.on_report", 90, 1, code, 0, b)
    assert [what[0].partition(".")[2] for what in said[1:]] == calls
    if "on_forgotten" in calls:
        assert said[-1] == ("proved.on_forgotten", 1, proved.HOLD)


def test_who_had_forgotten_nothing_is_not_asked_what_it_announced(said):
    stack.on_report(world_of(), 90, 0, REPORT_PARENT, 0, 2)
    assert [what[0] for what in said] == ["observer.on_report", "stack.check_route"]


@pytest.mark.parametrize(
    ("node", "observe", "told"), [(1, 1, True), (1, 0, False), (SINK, 1, False)]
)
def test_a_cell_that_stops_has_no_parent_any_more(said, node, observe, told):
    stack.on_stop(world_of(observe=observe), 90, node)
    assert said == ([("observer.follow", 90, 1, NONE), ("proved.on_stopped", 1)] if told else [])


def test_cells_ranges_are_checked_after_every_call(said):
    for node in (2, SINK):
        stack.check(world_of(), node)
    assert said == [("stack.check_range", 2)]


@pytest.mark.parametrize("limit", [0, 9])
def test_a_sample_at_the_pc_has_a_row_and_its_latency(said, limit):
    world = world_of(delivery_limit=limit)
    for row in world.deliveries:
        row.force, row.accel = [0] * 3, [0] * 3
    stack.on_deliver(world, MASK30 + 41, SINK, 1, frame(made_at=5))
    assert (world.counters[DELIVERED], world.delays[1].sum, world.delays[1].count) == (1, 35, 1)
    if limit:
        assert vars(world.deliveries[1]) == {
            "time": MASK30 + 41, "port": 1, "cell": 3, "seq": 4, "hops": 5, "latency": 35,
            "proximity": 6, "temperature": 7, "force": [1, 2, 3], "accel": [8, 9, 10],
        }  # fmt: skip
    assert world.run[0].deliveries == (2 if limit else 1)
    stack.on_deliver(world, 90, 2, 0, frame(COMMAND))
    assert said == [("orders.reach", 90, 2, frame(COMMAND))]
    assert world.counters[DELIVERED] == 1


# Commands.


def order(whom=NONE, at=80, value=(5 << 16) | 6):
    return Of(end=whom, at=at, value=value)


@pytest.fixture
def world():
    made = world_of()
    made.cells = [Of(parent=parent) for parent in (2, NONE, 0)]
    made.alive[2] = DEAD
    return made


SLOT = 1  # of the PC's first command


def due(world, slot=SLOT):
    return world.watch.due[slot * CELLS : (slot + 1) * CELLS]


@pytest.mark.parametrize(("whom", "states", "cell", "many"), [
    (NONE, [HAD_A_WAY, HAD_NO_WAY, WAS_OFF], EVERYBODY, 3), (1, [0, HAD_NO_WAY, 0], 1, 1),
    (0, [HAD_A_WAY, 0, 0], 0, 1),
])  # fmt: skip
def test_a_command_is_for_those_that_it_names_as_they_are(world, whom, states, cell, many):
    assert orders.begin(world, order(whom, at=MASK30 + 81)) == GIVE
    assert (due(world), world.watch.due_number[SLOT]) == (states, 1)
    item = world.sample[0]
    assert vars(item) == {"cell": cell, "dist": 5, "proximity": 6, "made_at": 80}
    assert (world.counters[GIVEN], world.counters[ADDRESSED]) == (1, many)
    row = {"time": MASK30 + 81, "node": CELLS, "code": orders.ORDER_GIVEN, "a": 1, "b": whom}
    assert (vars(world.rows[0]), world.run[0].rows) == (row, 1)


def test_a_pc_that_is_off_gives_nothing_and_all_miss_it(world):
    world.alive[SINK] = DEAD
    assert orders.begin(world, order()) == 0
    missed = [
        world.counters[MISSED + state - WAS_OFF] for state in (WAS_OFF, HAD_NO_WAY, HAD_A_WAY)
    ]
    assert (missed, due(world), world.watch.due_number[SLOT]) == ([1, 1, 1], [0] * 3, NONE)


def test_a_slot_that_is_used_again_is_settled_first(world):
    world.pc.own[0].command = MASK16
    world.watch.due_number[0] = 0
    world.watch.due[:CELLS] = [CAME, HAD_A_WAY, NOT_MEANT]
    orders.begin(world, order(2))
    assert world.counters[MISSED + HAD_A_WAY - WAS_OFF] == 1
    assert (due(world, 0), world.watch.due_number[0]) == ([0, 0, WAS_OFF], 0)


@pytest.mark.parametrize("observe", [0, 1])
@pytest.mark.parametrize(("state", "number", "counter"), [
    (HAD_A_WAY, 1, REACHED), (WAS_OFF, 1, REACHED), (CAME, 1, REPEATED), (NOT_MEANT, 1, STRAY),
    (HAD_A_WAY, 1 + SLOTS, STRAY),
])  # fmt: skip
def test_a_command_that_comes_is_counted_once_by_what_it_finds(
    world, observe, state, number, counter
):
    world.run[0].observe, world.watch.due_number[SLOT] = observe, 1
    world.watch.due[SLOT * CELLS + 2] = state
    orders.reach(world, MASK30 + 41, 2, Of(sq=number, made_at=5))
    assert {k for k, count in enumerate(world.counters) if count} == {counter}
    is_first = counter == REACHED
    assert due(world)[2] == (CAME if is_first else state)
    assert (world.delays[2].count, world.delays[2].sum) == ((1, 35) if is_first else (0, 0))
    assert world.run[0].rows == (is_first and observe)
    if world.run[0].rows:
        row = {"time": MASK30 + 41, "node": 2, "code": orders.ORDER_CAME, "a": 1, "b": 35}
        assert vars(world.rows[0]) == row


# Touch.


def felt(x_um, y_um, time, places=((0, 0),), node=0, span=(10_000, 900, 500)):
    world = Of(
        sample=[Of(force=[9] * 3, accel=[9] * 3)],
        carrier=Of(x=[x for x, _ in places], y=[y for _, y in places], span=span,
                   place=[70_000, 70_000, x_um, y_um][2 - 2 * node :]),
    )  # fmt: skip
    touch.read_sensors(world, node, time)
    return world.sample[0]


@pytest.mark.parametrize(("x", "y", "pressed", "near"), [
    (0, 0, 900, 4095), (5_000, 0, 675, 3839), (0, -5_000, 675, 3839), (9_990, 0, 1, 3073),
    (10_000, 0, 0, 3071), (20_000, 0, 0, 0), (19_990, 0, 0, 4), (-10_000, 10_000, 0, 2047),
])  # fmt: skip
def test_a_touch_presses_within_its_radius_and_is_near_within_two(x, y, pressed, near):
    one = felt(x, y, 0)
    assert (one.force, one.proximity) == ([pressed] * 3, pytest.approx(near, abs=1))


@pytest.mark.parametrize(("time", "at"), [(0, 0), (499, 0), (500, 1), (1_499, 2), (9_999, 2)])
def test_a_touch_moves_a_place_a_step_and_stays_at_the_last(time, at):
    places = [(0, 0), (30_000, 0), (60_000, 0)]
    for k, (x, y) in enumerate(places):
        assert (felt(x, y, time, places, node=1).force[0] == 900) == (k == at)


def test_at_rest_a_cell_feels_its_weight():
    one = felt(0, 0, MASK30 + 71, places=())
    assert vars(one) == {"made_at": 70, "proximity": 0, "temperature": 4, "force": [0] * 3,
                         "accel": [0, 0, 256]}  # fmt: skip


# From a plan.


@pytest.mark.parametrize(("keys", "orders_too", "ways", "slots", "waits"), [
    ({}, False, 0, 0, False), ({}, True, 1, SLOTS, True),
    ({"data": {"rate_hz": 10}}, False, 2, 0, True),
    ({"data": {"rate_hz": 10}, "command": [{"at_s": 0.1}]}, False, 3, SLOTS, True),
])  # fmt: skip
def test_latencies_are_kept_by_way(keys, orders_too, ways, slots, waits):
    made = build(plan_of(line(3, **keys)), True, orders=orders_too)
    assert len(made.delays) == ways
    assert (len(made.watch.due), len(made.watch.due_number)) == (3 * slots, slots)
    assert (len(made.queue) > 1) == waits
    assert set(made.watch.port) == set(made.watch.apart) == set(made.watch.ring) == {NONE}
    assert set(made.watch.routed) == set(made.watch.joined) == {0}


def test_a_command_of_the_pc_is_a_row():
    given = Of(at_us=70, cell=4, code=5, value=6)
    assert order_row(Of(graph=Of(sink=9)), given) == (70, TO_GIVE, 4, 9, (5 << 16) | 6, -1)


@pytest.mark.parametrize(("script", "rule", "name"), [
    ((), RULE_STATIC, "static"), ((), RULE_FEASIBLE, "skin"), (("tick",), RULE_STATIC, ""),
])  # fmt: skip
def test_a_loop_is_called_by_what_it_is_compiled_for(script, rule, name):
    assert simulate.loop_name(Of(script=script, params={"rule": rule})) == name


def test_a_touch_and_all_cells_have_their_places_in_micrometres():
    plan = plan_of(line(3, data={"rate_hz": 10}))
    assert build(plan, True).carrier == ([], [], [0, 0, 1], [])
    plan.touch = Of(x_um=[1, 2], y_um=[3, 4], radius_um=5, force_mn=6, step_us=7)
    felt = build(plan, True).carrier
    places = [round(1000 * x) for place in cell_places(plan.graph) for x in place]
    assert felt == ([1, 2], [3, 4], [5, 6, 7], places)
    assert places == [0, 0, 14_000, 0, 28_000, 0]


def test_why_cells_gave_samples_up_is_told_by_name():
    assert simulate.SkinSimulation.dropped == {"no_route": NO_ROUTE, "loop": LOOPED}
