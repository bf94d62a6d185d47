"""A station that sends, the loop around it, and what a channel looks like from outside: by hand."""

from types import SimpleNamespace as Of
from typing import ClassVar

import numpy as np
import pytest

from innervate.networks.radio.sim import build as radio_build
from innervate.scenario.actions.channel import GARBLE, JOIN
from innervate.sim import heap
from innervate.sim.channel import build, loop, medium, traffic
from innervate.sim.channel.simulation import Channel
from innervate.sim.channel.world import RING, Heap
from innervate.sim.heap import AIRS, ENDS, OFFER, OUTCOME, READY, STARTS, TIMER, key_of
from innervate.sim.status import BROKEN, BUDGET, DONE, POOL_FULL, ROWS_FULL
from tests.networks.radio.runs import radio_plan

TA_US, SLOT_US = 30, 100
NEAR, FAR = 10, 20  # us from a station to the next one, and to the one behind it


def radio(**more):
    given = dict.fromkeys(("deaf", "air", "garble", "fade", "told", "present", "cd", "voc"), 0)
    return Of(
        **given | {"alive": 1, "candidate": 7, "ready_at": -1, "told_at": -1, "noted": 0} | more
    )


def world_of(one=None, **run):
    """Three stations; the first is as said."""
    given = dict.fromkeys(("broken", "oracle", "full_duplex", "rows", "sent", "packets", "trail",
                           "taps", "tap_limit", "row_limit", "sent_limit", "packet_limit", "now",
                           "trail_limit", "completed", "wanted", "status"), 0)  # fmt: skip
    given |= {"stations": 3, "ta_us": TA_US, "slot_us": SLOT_US, "broken_node": -1}
    return Of(
        run=[Of(**given | run)], radios=[one or radio(), radio(), radio(), radio()],
        air=[Of(start=0, end=0, spoilt=9, at_start=9, at_end=9) for _ in range(3 * AIRS)],
        frames=[Of() for _ in range(3 * AIRS)], heap=Heap([0] * 4096, [0]), told=[0] * 5,
        out=Of(limit=[0]), degree=[2, 2, 2],
        order=[1, 2, 0, 2, 0, 1, 0, 1, 2], delay=[NEAR, FAR, 0] * 3,
    )  # fmt: skip


def frame(kind=7, slots=2, count=0, handle=5):
    return Of(kind=kind, slots=slots, count=count, handle=handle)


def sent(world, what=None, time=1_000):
    def copy(to, one):
        to.kind = one.kind

    medium.transmit(world, 0, what or frame(), time, copy)
    return sorted(world.heap.keys[: world.heap.size[0]])


ON, OFF = 1_000 + TA_US, 1_000 + TA_US + 2 * SLOT_US


def test_who_sends_is_deaf_until_a_turnaround_after_its_frame():
    world = world_of(radio(air=2))
    assert sent(world) == sorted([
        key_of(OFF + TA_US, READY, 0, 0), key_of(ON + NEAR, STARTS, 1, 2),
        key_of(OFF + NEAR, ENDS, 1, 2),
    ])  # fmt: skip
    one, air = world.radios[0], world.air[2]
    assert (one.deaf, one.candidate, one.ready_at, one.air) == (
        medium.SENDING, medium.NOBODY, OFF + TA_US, 3)  # fmt: skip
    assert vars(air) == {"start": ON, "end": OFF, "spoilt": 0, "at_start": 0, "at_end": 0}
    assert (world.frames[2].kind, world.run[0].broken) == (7, 0)


def test_places_on_the_air_are_used_one_after_the_other():
    world = world_of(radio(air=AIRS - 1), full_duplex=1)
    sent(world)
    assert (world.radios[0].air, world.radios[0].deaf) == (0, medium.HEARING)


def test_who_is_deaf_breaks_the_run_and_sends_nothing():
    world = world_of(radio(deaf=medium.SENDING))
    assert sent(world) == []
    assert (world.run[0].broken, world.run[0].broken_node) == (medium.BROKEN_DEAF, 0)
    assert world.radios[0].air == 0


@pytest.mark.parametrize(("end", "broken"), [(0, 0), (1_000 - FAR, 0), (1_001 - FAR, 2)])
def test_a_place_is_free_once_the_last_has_heard_the_end(end, broken):
    world = world_of()
    world.air[0].end = end
    sent(world)
    assert world.run[0].broken == broken == (medium.BROKEN_AIR if broken else 0)


@pytest.mark.parametrize(("kind", "state", "spoilt", "edges"), [
    (medium.CRR, {"garble": 1}, 1, 2), (medium.CRR, {"fade": 1}, 2, 0), (medium.CRR, {}, 0, 2),
    (7, {"garble": 1, "fade": 1}, 0, 2),
])  # fmt: skip
def test_reservations_alone_are_garbled_and_what_is_hidden_nobody_hears(kind, state, spoilt, edges):
    world = world_of(radio(**state))
    assert len(sent(world, frame(kind))) == 1 + edges
    assert world.air[0].spoilt == spoilt


def test_nobody_is_told_of_who_is_alone():
    world = world_of()
    world.degree[0] = 0
    assert sent(world) == [key_of(OFF + TA_US, READY, 0, 0)]


@pytest.mark.parametrize(("far", "count", "at"), [
    (FAR, 1, OFF + TA_US), (TA_US + 1, 1, OFF + TA_US + 1), (FAR, 0, None),
])  # fmt: skip
def test_an_oracle_tells_when_all_could_know_and_the_radio_listens(far, count, at):
    world = world_of(oracle=1)
    world.delay[1] = far
    keys = sent(world, frame(count=count))
    assert [key >> heap.TIME_SHIFT for key in keys if key >> heap.RANK_SHIFT & 7 == OUTCOME] == (
        [at] if at else [])  # fmt: skip
    if at:
        assert (world.radios[0].told, world.radios[0].told_at) == (5, at)


def test_an_oracle_tells_who_is_alone_as_well():
    world = world_of(oracle=1)
    world.degree[0] = 0
    sent(world, frame(count=1))
    assert world.radios[0].told_at == OFF + TA_US


@pytest.mark.parametrize(("newest", "alive", "lacks"), [
    (-1, 1, True), (4, 1, True), (5, 1, False), (6, 1, False), (5 + 2**15 - 1, 1, False),
    (5 + 2**15, 1, True), (-1, 0, False), (4, 0, False),
])  # fmt: skip
def test_who_is_on_and_has_nothing_so_new_lacks_a_packet(newest, alive, lacks):
    world = world_of()
    world.radios[1].alive = world.radios[2].alive = alive
    world.last = [-1, -1, -1, newest, -1, -1, 5, -1, -1]  # station 2 has it
    assert traffic.lacking(world, 0, 5) == lacks


@pytest.mark.parametrize(("next_offer", "queued"), [(3, [66]), (4, []), (5, [])])
def test_a_stations_offers_end_where_the_next_ones_begin(next_offer, queued):
    world = world_of(radio(next_offer=next_offer))
    world.radios[1].first_offer, world.arrivals = 4, [11, 22, 55, 66, 77]
    traffic.schedule(world, 0)
    assert [key >> heap.TIME_SHIFT for key in world.heap.keys[: world.heap.size[0]]] == queued


def test_a_new_packet_begins_with_nobody_and_no_tries():
    world = world_of(radio(fresh=RING + 2, backlog=0))
    world.run[0].offers = 0
    world.got, world.tries, world.offered = [9] * RING, [9] * RING, [9] * RING
    assert traffic.make(world, 0, 50) == RING + 2
    assert (world.got[2], world.tries[2], world.offered[2]) == (0, 0, 50)
    assert (world.got[3], world.tries[1]) == (9, 9)


# The loop.


@pytest.fixture
def ran(monkeypatch):
    """What the loop does with these events in its queue: (rank, time) or "told"."""
    world, said = world_of(), []

    def dispatch(_world, _do, key, time):
        said.append((key >> heap.RANK_SHIFT & 7, time))
        heap.pop(world.heap)

    def tell_all(_world, _do, time):
        said.append(("told", time))
        world.told[0] = 0

    monkeypatch.setattr(loop, "dispatch", dispatch)
    monkeypatch.setattr(loop, "tell_all", tell_all)

    def run(until, events, budget=99):
        for time, rank in events:
            heap.push(world.heap, key_of(time, rank, 0, 0))
        loop.bind(None)(world, until, budget)
        return said

    run.world, run.said = world, said
    return run


def test_it_goes_up_to_a_time_and_not_to_it(ran):
    assert ran(30, [(20, TIMER), (30, TIMER)]) == [(TIMER, 20)]
    assert (ran.world.run[0].status, ran.world.run[0].now) == (DONE, 20)
    assert ran(31, []) == [(TIMER, 20), (TIMER, 30)]


def test_of_an_empty_queue_nothing_is_left_that_was_in_it(ran):
    ran.world.heap.keys[0] = key_of(5, TIMER, 0, 0)
    assert ran(30, []) == []


def test_carriers_are_told_after_the_edges_of_a_moment_and_before_all_else(ran):
    ran.world.told[0], ran.world.run[0].now = 1, 20
    assert ran(40, [(20, ENDS), (20, STARTS), (20, READY), (20, OFFER)]) == [
        (ENDS, 20), (STARTS, 20), ("told", 20), (READY, 20), (OFFER, 20)]  # fmt: skip


def test_carriers_are_told_though_nothing_else_comes(ran):
    ran.world.told[0], ran.world.run[0].now = 1, 20
    assert ran(40, []) == [("told", 20)]


SO_FAR = [(2, 3, False), (3, 3, True), (4, 3, True), (3, 0, False)]  # of those that were wanted


@pytest.mark.parametrize(("completed", "wanted", "is_over"), SO_FAR)
def test_it_ends_with_the_last_packet_that_was_wanted(ran, completed, wanted, is_over):
    run = ran.world.run[0]
    run.completed, run.wanted = completed, wanted
    assert ran(40, [(20, TIMER)]) == ([] if is_over else [(TIMER, 20)])
    assert run.status == DONE


def test_it_stops_with_what_broke_it(ran, monkeypatch):
    monkeypatch.setattr(loop, "dispatch", lambda world, *_: setattr(world.run[0], "broken", 2))
    ran(40, [(20, TIMER), (21, TIMER)])
    assert (ran.world.run[0].status, ran.world.run[0].now) == (BROKEN, 20)


@pytest.mark.parametrize(("budget", "count"), [(1, loop.BATCH), (loop.BATCH + 1, 2 * loop.BATCH)])
def test_the_budget_counts_batches(ran, budget, count):
    ran(999, [(k, TIMER) for k in range(50)], budget)
    assert (len(ran.said), ran.world.run[0].status) == (count, BUDGET)


def test_it_does_nothing_while_a_table_is_full(ran):
    ran.world.run[0].taps = 1
    assert ran(40, [(20, TIMER)]) == []
    assert ran.world.run[0].status == ROWS_FULL


@pytest.mark.parametrize(("alive", "deaf", "told"), [(1, 0, True), (0, 0, False), (1, 1, False)])
def test_a_ready_radio_is_told_if_its_station_is_on_and_listens(alive, deaf, told):
    said = []
    world = world_of(radio(alive=alive, deaf=deaf, ready_at=70 if deaf else 80, offset=0))
    world.run[0].fingerprint = world.run[0].handled = world.run[0].watchful = 0
    world.out, world.radios[0].leaving = Of(count=[0]), 0
    do = Of(on_carrier=lambda _world, *what: said.append(what))
    key = key_of(80, READY, 0, 0)
    heap.push(world.heap, key)
    loop.dispatch(world, do, key, 80)
    assert bool(said) == told


def test_the_end_of_a_signal_cut_short_is_nobodys(monkeypatch):
    world = world_of()
    world.air[0].start, world.air[0].end, world.air[0].at_end = 60, 75, 0
    world.radios[1].present = 1
    heap.push(world.heap, key_of(99, ENDS, 1, 0))
    loop.edge(world, None, ENDS, 1, 0, 99)  # due at 85 since its sender died
    assert (world.heap.size[0], world.radios[1].present, world.told[0]) == (0, 1, 0)


def test_who_broke_the_run_first_and_when_stays(monkeypatch):
    world = world_of()
    run = world.run[0]
    run.fingerprint = run.handled = 0
    run.watchful, run.broken_at = 1, -1
    world.out = Of(count=[0])
    world.radios[0].leaving = 0
    do = Of(watch=lambda *_: setattr(run, "broken", 2))
    for time in (70, 80):
        loop.finish(world, do, 0, time, 0, 0)
    assert run.broken_at == 70
    run.broken_node, world.out = 4, Of(count=[0], overflow=[1], action=[], frame=[])
    loop.drain(world, do, 0, 90)
    assert (run.broken, run.broken_node) == (2, 4)


# From outside.


class Watched(Channel):
    tables: ClassVar = {}


def channel(**plan):
    made = radio_plan(3, **plan)
    return Watched(made, radio_build.build(made, False, observe=False), lambda *_: None)


def test_a_channel_says_when_something_happens_next():
    running = channel()
    running.world.heap.size[0] = 0
    assert running.next_us() is None
    heap.push(running.world.heap, key_of(90, TIMER, 0, 0))
    assert running.next_us() == 90
    running.world.run["now"], running.world.told[0] = 70, 1
    assert (running.next_us(), running.clock_us()) == (70, 70)


@pytest.mark.parametrize(("completed", "wanted", "is_over"), SO_FAR)
def test_a_channel_is_complete_with_the_last_packet_that_was_wanted(completed, wanted, is_over):
    running = channel()
    running.world.run["completed"], running.world.run["wanted"] = completed, wanted
    assert running.is_complete() == is_over


def test_what_is_done_to_a_channel_is_put_behind_what_was_planned():
    running = channel()
    before = running.world.commands.tolist()
    running.schedule(Of(at_us=70, action=JOIN, node=2, value=6, index=4))
    running.schedule(Of(at_us=60, action=GARBLE, node=1, value=3, index=5))
    assert running.world.commands.tolist() == [
        *before, (JOIN, 2, 6, 4), (GARBLE, 1, 3, 5)]  # fmt: skip
    keys = running.world.heap.keys[: int(running.world.heap.size[0])].tolist()
    count = len(before)
    assert {key_of(70, heap.COMMAND, 0, count), key_of(60, heap.COMMAND, 0, count + 1)} <= set(keys)


@pytest.mark.parametrize("plain", [True, False])
def test_the_queue_grows_and_keeps_its_events(plain):
    keys = [3, 5, 9] if plain else np.array([3, 5, 9])

    class World(Of):
        def _replace(self, **changes):
            return World(**{**vars(self), **changes})

    world = World(heap=Heap(keys, [3]))
    grown = build.grow_heap(world)
    assert list(grown.heap.keys) == [3, 5, 9, 0, 0, 0]
    assert grown.heap.size == [3]


def test_a_channel_grows_if_its_queue_is_full():
    running = channel()
    room = len(running.world.heap.keys)
    running.grow(ROWS_FULL)
    assert len(running.world.heap.keys) == room
    running.grow(POOL_FULL)
    assert len(running.world.heap.keys) == 2 * room
