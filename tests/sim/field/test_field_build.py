"""A field from a plan and from outside of its loop: tables, commands, what is due, what is kept."""

from types import SimpleNamespace as Of

import pytest

from innervate.dialect.access import ALL
from innervate.dialect.arith import MASK30
from innervate.dialect.outbox import URGENT
from innervate.dialect.rng import FIXED_POINT, seeded
from innervate.scenario.actions.field import CUT, JAM, KILL
from innervate.scenario.declared.field import AirTable, Fault, FieldPlan, Heard
from innervate.sim import heap, heard, taps
from innervate.sim.came import Came
from innervate.sim.counts import Counts
from innervate.sim.field import access, declared, medium, powers, queue
from innervate.sim.field.build import build
from innervate.sim.field.declared import DeclaredField
from innervate.sim.field.loop import BOOT
from innervate.sim.field.medium import NONE
from innervate.sim.field.states import ALIVE, DEAD, OFF
from innervate.sim.own import Unfit, frames_of
from innervate.sim.recorded import Recorded
from innervate.sim.status import POOL_FULL, ROWS_FULL
from innervate.sim.tables import get, uniform

STATE = tuple((name, 0, -9, 9, "", "") for name in ("number", "value"))
FRAME = (("kind", 0, 0, 9, "", ""), ("seq", 0, 0, 255, "", ""))
PARAMS = (("hops", 0, 1, 15, "", ""),)
RSSI = [-5_000, -6_000, -7_000, -6_500, -5_000, -8_000, -7_500, -8_500, -5_000]


def network_of(over=""):
    protocol = Of(TIMERS=2, OUTBOX=5)
    return Of(protocol=protocol, fields=Of(STATE=STATE, FRAME=FRAME, PARAMS=PARAMS), over=over)


def plan_of(**more):
    given = {
        "scenario": None, "kind": "flood", "seed": 3, "duration_us": 9_000, "nodes": 3,
        "params": {"hops": 4}, "positions_cm": [], "heard": Heard(list(RSSI), [30_000] * 9),
        "good": [], "starts_us": [70, 50, 60], "absent": [0, 0, 1],
        "inputs": [Of(at_us=80, node=2, kind=6, item={"seq": 7})],
        "faults": [Fault(50, KILL, 2), Fault(55, CUT, 0, 1), Fault(60, JAM, 1, -1, -6_000)],
        "air": AirTable(bits_per_s=200_000, preamble_bytes=4, turnaround_us=99, capture_db=6.0,
                        sense_db=5.0, queue_frames=7, backoff_us=111, busy_max=9),
    }  # fmt: skip
    return FieldPlan(**given | more)


def run_of(world):
    return {name: int(get(world.run, 0, name)) for name in world.run.dtype.names}


@pytest.mark.parametrize("over", ["", "csma"])
def test_a_plan_becomes_the_numbers_of_its_air(over):
    world = build(plan_of(), network_of(over), False, Recorded())
    run = run_of(world)
    strengths = powers.strength_table()
    assert {name: run[name] for name in ("nodes", "own_timers", "mac", "collisions", "turnaround",
                                         "byte_ns", "phy_bytes", "told", "room")} == {
        "nodes": 3, "own_timers": 2, "mac": int(bool(over)), "collisions": 1, "turnaround": 99,
        "byte_ns": 40_000, "phy_bytes": 4, "told": 1, "room": 7}  # fmt: skip
    assert run["sense"] == powers.strength(strengths, -9_500 - 500)
    assert run["capture"] == powers.capture_ratio(600)
    assert run["free"] == len(world.air) == 3 * 4 + 64
    assert run["timers"] * 3 == len(world.due)
    assert run["timers"] > 2 if over else run["timers"] == 2
    assert set(world.due.tolist()) == {-1}
    assert int(get(world.params, 0, "hops")) == 4
    if over:
        names = ("backoff_us", "exponent_min", "exponent_max", "busy_max")
        assert [int(get(world.mac_params, 0, name)) for name in names] == [111, 3, 6, 9]
        drawn = uniform(3, "macs", 3, FIXED_POINT - 1) + 1  # a stream of their own
        assert world.macs["rng"].tolist() == drawn.tolist()


@pytest.mark.parametrize("seed", range(1, 9))
def test_what_is_lost_is_drawn_from_a_stream_of_the_mediums_own(seed):
    world = build(plan_of(seed=seed), network_of(), False, Recorded())
    drawn = int(uniform(seed, "medium", 1, 1 << 30)[0])
    assert run_of(world)["rng"] == seeded(drawn)


@pytest.mark.parametrize(("sense_db", "cdb"), [(0.0, -9_500), (30.0, -12_500), (12.5, -10_750)])
def test_what_is_sensed_lies_so_far_below_what_is_received(sense_db, cdb):
    run = run_of(build(plan_of(air=AirTable(sense_db=sense_db)), network_of(), False, Recorded()))
    assert run["sense"] == powers.strength(powers.strength_table(), cdb)


def test_what_no_radio_could_sense_is_one_at_least():
    air = AirTable(sense_db=60.0)
    assert run_of(build(plan_of(air=air), network_of(), False, Recorded()))["sense"] == 1


def test_nobody_hears_himself():
    world = build(plan_of(), network_of(), False, Recorded())
    strengths = powers.strength_table()
    power = [0 if i % 4 == 0 else powers.strength(strengths, cdb) for i, cdb in enumerate(RSSI)]
    assert world.power.tolist() == power
    assert world.prob.tolist() == [0, 30_000, 30_000, 30_000, 0, 30_000, 30_000, 30_000, 0]
    assert world.rssi.tolist() == RSSI
    assert (len(world.ring), len(world.acts), world.cut.tolist()) == (21, 21, [0] * 9)


def test_nodes_have_their_numbers_clocks_and_nothing_under_way():
    world = build(plan_of(), network_of("csma"), False, Recorded())
    assert world.stations["number"].tolist() == [0, 1, 2, 0]
    assert world.radios["held"].tolist() == world.radios["tell_at"].tolist() == [NONE] * 3
    assert len(set(world.radios["offset"].tolist())) == 3
    assert len(set(world.macs["rng"].tolist())) == 3


def test_nodes_are_switched_on_first_of_all_that_is_done_at_their_moment():
    world = build(plan_of(), network_of(), False, Recorded())
    assert [tuple(row) for row in world.commands.tolist()] == [
        (50, BOOT, 1, 0, 0), (50, KILL, 2, 0, 0), (55, CUT, 0, 1, 0), (60, JAM, 1, 0, -6_000),
        (70, BOOT, 0, 0, 0),
    ]  # fmt: skip
    run = run_of(world)
    assert (run["commands"], run["offers"]) == (5, 1)
    assert world.offers.tolist() == [(80, 2, 6)]
    assert [column.tolist() for column in world.came] == [[80], [0]]
    assert int(get(world.items, 0, "seq")) == 7
    keys = sorted(world.heap.keys[: int(world.heap.size[0])].tolist())
    assert keys == [queue.key_of(50, queue.COMMAND, 0, 0), queue.key_of(80, queue.OFFER, 0, 0)]


@pytest.mark.parametrize(("kept", "limits"), [
    ({}, (1, 1, 0, 0, 1, 1)), ({"observe": False, "checks": False}, (0, 0, 0, 0, 0, 0)),
    ({"tap": True}, (1, 1, 0, 1, 1, 1)), ({"trail": True, "checks": False}, (1, 1, 1, 0, 0, 1)),
])  # fmt: skip
def test_what_is_kept_has_room_for_one_event_more(kept, limits):
    world = build(plan_of(), network_of(), False, Recorded(**kept))
    run, margin = run_of(world), 2 * 3 * 6  # frames and carriers
    names = ("row_limit", "delivery_limit", "trail_limit", "tap_limit", "checks", "watchful")
    assert tuple(int(run[name] > 0) for name in names) == limits
    for name, table in zip(names, (world.rows, world.deliveries, world.trail, world.taps),
                           strict=False):  # fmt: skip
        assert len(table) == (run[name] + margin if run[name] else 1)
    assert len(world.tapped) == len(world.taps)


# From outside.


@pytest.fixture
def running():
    plan = plan_of()
    return DeclaredField(plan, build(plan, network_of(), False, Recorded()), None)


def keys_of(running):
    return sorted(running.world.heap.keys[: int(running.world.heap.size[0])].tolist())


@pytest.mark.parametrize(("at", "is_first"), [(40, True), (49, True), (50, False), (99, False)])
def test_the_queue_knows_the_next_command_alone(running, at, is_first):
    timer = heap.key_of(45, queue.TIMER, 1, 0)
    heap.push(running.world.heap, timer)
    running.schedule(Fault(at, KILL, 1, 2, 8))
    first = min(at, 50)
    command, offer = queue.key_of(first, queue.COMMAND, 0, 0), queue.key_of(80, queue.OFFER, 0, 0)
    assert keys_of(running) == sorted([timer, command, offer])
    assert running.next_us() == min(first, 45)
    rows = [tuple(row) for row in running.world.commands.tolist()]
    assert rows.count((at, KILL, 1, 2, 8)) == 1
    assert rows == sorted(rows, key=lambda row: row[0])
    assert (rows[0] == (at, KILL, 1, 2, 8)) == is_first
    assert run_of(running.world)["commands"] == 6


def test_what_is_due_may_be_due_in_the_channel_below(running):
    running.world.heap.size[0] = 0
    assert running.next_us() is None
    heap.push(running.world.heap, queue.key_of(90, queue.TIMER, 0, 0))
    below = Of(told=[0], heap=Of(keys=[0] * 4, size=[0]))
    running.world = running.world._replace(below=below)
    assert running.next_us() == 90
    heap.push(below.heap, heap.key_of(70, heap.TIMER, 0, 0))
    assert running.next_us() == 70
    running.world.run["now"], below.told[0] = 65, 1
    assert (running.next_us(), running.clock_us()) == (65, 65)


def test_a_full_queue_grows_and_nothing_else(running):
    room = len(running.world.heap.keys)
    running.grow(ROWS_FULL)
    assert len(running.world.heap.keys) == room
    running.grow(POOL_FULL)
    assert len(running.world.heap.keys) == 2 * room


def test_who_is_about_to_start_is_not_off_and_who_is_not_there_yet_is(running):
    running.world.radios["state"], running.plan.absent = (OFF, OFF, ALIVE), [0, 1, 1]
    running.message_times = []
    assert running.counts().off == (1,)


def test_frames_and_messages_are_counted_by_name(running):
    running.world.counters[:] = [3, 10, 17, 24, 31, 38, 45, 80, 0, 59, 66]
    running.world.radios["state"], running.plan.absent = (ALIVE, DEAD, OFF), [1, 1, 1]
    running.world.run["now"], running.message_times = 70, [0, 70, 70, 71]
    assert running.counts() == Counts(
        nodes=3, off=(1, 2), sent=3, arrived=10, offered=3, delivered=80,
        lost_by={"collision": 17, "sending": 24, "noise": 31, "off": 38, "broken_off": 45,
                 "busy": 59, "queue": 66}, is_shared=True,
    )  # fmt: skip


def test_what_broke_is_told_with_when_and_by_whom(running):
    running.world.run["broken"], running.world.run["broken_node"] = medium.BROKEN_HELD, 2
    running.world.run["now"] = 1_500_000
    what = "node 2 handed down a frame while another was under way"
    assert running.broken_line() == f"invariant broken at 1.500000 s (seed 3): {what}"


# What the medium is told of a declared protocol.


def copy(to, frame):
    to.seq = frame.seq


def kind_of(frame):
    return 40 + frame.seq


def noted(*names):
    fields = tuple((name, 0, 0, 9, "", "") for name in ("seq", *names))
    made = frames_of(fields) | {"copy_frame": copy, "kind_of": kind_of}
    return Of(**declared._noted("rssi" in names, **made))


def kept_world(**run):
    given = {"taps": 0, "tap_limit": 9, "deliveries": 0, "delivery_limit": 9, "nodes": 2, "room": 2,
             "blocked": 0, "offers": 0}  # fmt: skip
    return Of(
        run=[Of(**given | run)], counters=[0] * heard.COUNTERS, prob=[0, 9, 9, 0],
        radios=[Of(held=NONE, waiting=0, first=1) for _ in range(2)], deliveries=[Of()],
        air=[Of(node=1, start=60, state=3, receivers=0)], frames=[Of(seq=8, rssi=0)],
        taps=[Of(), Of()], tapped=[Of(), Of()], rssi=[0, -6_000, -9_000, 0],
        offers=[Of(time=70), Of(time=0), Of(time=MASK30 + 1)], items=[Of(seq=k) for k in range(3)],
        item=[Of(seq=0, made_at=9)], ring=[Of() for _ in range(4)], acts=[Of() for _ in range(4)],
        came=Came([0, 70], [0, 0]),
    )  # fmt: skip


@pytest.mark.parametrize("limit", [0, 9])
def test_a_frame_is_counted_and_kept_with_its_sender_and_its_start(limit):
    world = kept_world(tap_limit=limit)
    noted().tap(world, 0, 1, 90, 1, taps.FINE)
    assert (world.counters[heard.SENT], world.air[0].receivers) == (1, 1)
    row = {"time": 90, "start": 60, "at": 1, "sender": 1, "out": 1, "why": taps.FINE}
    assert vars(world.taps[0]) == (row if limit else {})
    assert vars(world.tapped[0]) == ({"seq": 8} if limit else {})


@pytest.mark.parametrize(("names", "made_at", "time", "latency"), [
    ((), 60, 90, -1), (("made_at",), 60, 90, 30), (("made_at",), 0, 90, -1),
    (("made_at",), 5, MASK30 + 26, 20), (("made_at",), 1, 1, 0),
])  # fmt: skip
def test_a_delivery_took_as_long_as_since_it_was_handed_in(names, made_at, time, latency):
    world = kept_world()
    noted(*names).record_delivered(world, 1, Of(seq=2, made_at=made_at), time)
    assert (world.deliveries[0].kind, world.deliveries[0].latency) == (42, latency)


@pytest.mark.parametrize(("index", "made_at"), [(0, 70), (1, 1), (2, 1)])
def test_what_a_node_is_handed_knows_when_it_was(index, made_at):
    world = kept_world()
    noted("made_at").take_item(world, index)
    assert (world.item[0].seq, world.item[0].made_at) == (index, made_at)
    noted().take_item(world, 1)
    assert (world.item[0].seq, world.item[0].made_at) == (1, made_at)


def test_how_loud_a_frame_was_at_its_receiver_is_known_if_it_is_asked_for():
    world = kept_world()
    noted().note_heard(world, 0, 0)
    assert world.frames[0].rssi == 0
    noted("rssi").note_heard(world, 0, 0)
    assert world.frames[0].rssi == -90  # from 1 to 0, not back


@pytest.mark.parametrize(("held", "waiting", "flags", "waits"), [
    (NONE, 0, 0, False), (2, 0, 0, True), (NONE, 1, 0, True), (2, 1, URGENT, False),
])  # fmt: skip
def test_a_frame_waits_for_those_before_it_unless_it_is_urgent(
    monkeypatch, held, waiting, flags, waits
):
    down = []
    monkeypatch.setattr(access, "hand_down", lambda *what: down.append(what[4]) or 5)
    world = kept_world()
    world.radios[1].held, world.radios[1].waiting = held, waiting
    do, act = Of(digest=lambda frame: 6, copy_frame=copy), Of(b=99, c=flags | 6)
    found = noted().hand_down(world, do, 1, Of(seq=3), act, 90)
    assert (act.b, act.c) == (access.ATTEMPT_MAX, flags)
    assert (found, len(down)) == ((6, 0) if waits else (5, 1))
    assert world.radios[1].waiting == waiting + waits
    noted().hand_down(world, do, 1, Of(seq=3), Of(b=-4, c=URGENT), 90)
    assert down[-1].b == 0


@pytest.mark.parametrize(("to", "taken"), [(1, True), (0, False), (ALL, True)])
def test_a_frame_for_another_node_is_not_handed_up(to, taken):
    said = []
    protocol = Of(**dict.fromkeys(("on_start", "on_timer", "on_input"), print))
    protocol.on_frame = lambda *what: said.append(what[2:5])
    entries = declared._entries(protocol, {"to"}, lambda world, node: None)
    world = Of(stations=[None] * 2, params=[None], out=None)
    frame = Of(to=to)
    entries["on_frame"](world, 1, 90, frame)
    assert said == ([(90, 0, frame)] if taken else [])


def test_a_frame_is_as_long_as_the_layout_of_its_kind(monkeypatch):
    monkeypatch.setattr(declared, "sizes_of", lambda frames: {1: 20, 2: 35})
    size = declared._frame_bytes(None)
    assert [size(Of(kind=kind)) for kind in (1, 2, 3)] == [20, 35, 35]


def test_who_loses_its_memory_has_an_empty_queue():
    """Its record is for `on_start` to set anew, as over cables, and where it is explored."""
    checks = declared._checks([])
    world = kept_world()
    world.radios[1].waiting, world.words = 2, [[9], [1], [-1]]
    checks["wipe"](world, 1)
    assert (world.radios[1].first, world.radios[1].waiting) == (0, 0)
    assert world.words == [[9], [1], [-1]]


@pytest.mark.parametrize(("value", "broken"), [(5, 64), (9, medium.BROKEN_RANGE)])
def test_after_a_call_ranges_are_checked_before_own_invariants_by_the_nodes_clock(value, broken):
    seen = []

    def holds(state, params, now):
        seen.append(now)
        return False

    check = declared._checks([holds])["check"]
    run = Of(broken=0, broken_node=-1, checks=1)
    world = Of(run=[run], words=[[value]], low=[0], high=[8], spans=[], radios=[Of(offset=100)],
               stations=[None], params=[None])  # fmt: skip
    check(world, None, 0, MASK30)
    assert (run.broken, run.broken_node) == (broken, 0)
    assert seen == ([99] if broken == 64 else [])


@pytest.mark.parametrize("network", [Of(has=lambda _: False), Of(has=lambda _: True, frames=Of())])
def test_frames_of_no_known_length_are_said(network, monkeypatch):
    monkeypatch.setattr(declared, "networks", lambda: {"flood": network})
    with pytest.raises(Unfit, match="LAYOUTS is missing: it says how long a frame is on the air"):
        declared.simulation(plan_of())
