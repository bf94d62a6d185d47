"""What is counted of frames in a field, and the queue of a node whose radio is busy: by hand."""

from types import SimpleNamespace as Of

import pytest

from innervate.dialect.arith import MASK30
from innervate.sim import heard, taps
from innervate.sim.field import access, calls, listening, medium
from innervate.sim.field.states import ALIVE, COMMITTED, DEAD, OFF, ON_AIR
from innervate.sim.status import BROKEN, DONE, POOL_FULL, ROWS_FULL

NODES, ROOM = 4, 3


def world_of():
    """Node 0 is heard by 1 and 2 (2 is cut off from it), node 1 by all; 3 hears nobody else."""
    prob = [0, 9, 9, 0, 9, 0, 9, 9, 0, 0, 0, 0, 0, 0, 0, 0]
    run = {"nodes": NODES, "room": ROOM, "rows": 0, "row_limit": 10, "deliveries": 0, "trail": 0,
           "delivery_limit": 10, "trail_limit": 10, "taps": 0, "tap_limit": 10, "broken": 0,
           "sense": 50, "moving": 0}  # fmt: skip
    places = NODES * ROOM
    return Of(
        run=[Of(**run)], counters=[0] * heard.COUNTERS, prob=prob,
        power=[0, 5, 0, 0, 5, 0, 5, 5, *[0] * 8],
        radios=[Of(state=ALIVE, first=0, waiting=0, held=medium.NONE, deaf=0, told=0, offset=100)
                for _ in range(NODES)],
        air=[Of(node=0, state=ON_AIR, end=500, receivers=2)],
        ring=[Of(what=None) for _ in range(places)], acts=[Of(b=0) for _ in range(places)],
        heap=Of(size=[0], keys=[0] * (64 * NODES + 64 + 2)),
        deliveries=[Of() for _ in range(11)], sums=[0] * NODES,
        words=[[7, 8, 9] for _ in range(NODES)] + [[1, 2, 3]], low=[0, 0, 0],
    )  # fmt: skip


def counted(world):
    names = {"sent": heard.SENT, "arrived": heard.ARRIVED, "delivered": heard.DELIVERED,
             **listening.LOST}  # fmt: skip
    return {name: world.counters[word] for name, word in names.items() if world.counters[word]}


@pytest.mark.parametrize(
    ("change", "why"),
    [
        ({}, DONE), ({"broken": 3, "rows": 11}, BROKEN),
        ({"rows": 10, "deliveries": 10, "trail": 10, "taps": 10}, DONE), ({"rows": 11}, ROWS_FULL),
        ({"deliveries": 11}, ROWS_FULL), ({"trail": 11}, ROWS_FULL), ({"taps": 11}, ROWS_FULL),
        ({"size": 2}, DONE), ({"size": 3}, POOL_FULL),
    ],
)  # fmt: skip
def test_the_loop_stops_while_there_is_room_for_one_event_more(change, why):
    world = world_of()
    world.heap.size[0] = change.pop("size", 0)
    vars(world.run[0]).update(change)
    assert listening.pressing(world) == why


def test_a_frame_is_counted_for_whoever_could_hear_it():
    world = world_of()
    listening.count_frame(world, 0, 1, taps.FINE)
    assert (world.air[0].receivers, counted(world)) == (2, {"sent": 2})
    world.air[0].node = 1
    listening.count_frame(world, 0, 1, taps.FINE)
    assert (world.air[0].receivers, counted(world)) == (3, {"sent": 5})
    listening.lose_all(world, 1, heard.FULL)
    listening.lose_all(world, 0, heard.BUSY)
    assert counted(world) == {"sent": 10, "queue": 3, "busy": 2}


@pytest.mark.parametrize(("why", "name"), [
    (taps.FINE, "arrived"), (taps.SENDING, "sending"), (taps.COLLISION, "collision"),
    (taps.NOISE, "noise"),
])  # fmt: skip
def test_what_became_of_a_frame_at_a_node_is_counted_once(why, name):
    world = world_of()
    listening.count_frame(world, 0, 0, why)
    assert counted(world) == {name: 1}


@pytest.mark.parametrize(
    ("time", "state", "off", "found"),
    [
        (500, ON_AIR, [], {"cut": 1}),
        (500, ON_AIR, [1], {"off": 1, "cut": 1}),
        (500, ON_AIR, [1, 2, 3], {"off": 2}),  # 3 could not have heard it
        (499, ON_AIR, [1, 2], {"broken_off": 2}),
        (499, COMMITTED, [1, 2], {}),
    ],
)
def test_who_was_off_or_cut_off_when_a_frame_ended(time, state, off, found):
    world = world_of()
    world.air[0].state = state
    for node in off:
        world.radios[node].state = DEAD
    listening.record_sent(world, 0, time, 20, None)
    assert counted(world) == found


@pytest.fixture
def queued(monkeypatch):
    """A world, what puts frames into the queue of node 1, and what was handed down of it."""
    world, down = world_of(), []

    def hand_down(_world, _do, node, frame, act, time):
        down.append((node, frame.what, act.b, time))

    monkeypatch.setattr(access, "hand_down", hand_down)
    do = Of(copy_frame=lambda kept, frame: setattr(kept, "what", frame))
    return world, lambda what: listening.put_off(world, do, 1, what, Of(b=ord(what))), down


def test_frames_wait_in_order_round_and_round_and_what_has_no_room_is_lost(queued):
    world, put_off, down = queued
    sent = iter("abcdefghij")
    for _ in range(ROOM):
        put_off(next(sent))
    put_off("z")
    assert (world.radios[1].waiting, counted(world)) == (ROOM, {"sent": 3, "queue": 3})
    for time in range(5):
        listening.next_one(world, None, 1, time)
        put_off(next(sent))
    assert down == [(1, what, ord(what), time) for time, what in enumerate("abcde")]
    for time in range(4):
        listening.next_one(world, None, 1, time)
    assert [what for _, what, _, _ in down] == list("abcdefgh")
    assert counted(world) == {"sent": 3, "queue": 3}
    assert world.radios[1].waiting == 0


@pytest.mark.parametrize("change", [{"held": 0}, {"state": DEAD}, {"state": OFF}])
def test_nothing_leaves_the_queue_while_a_frame_is_under_way_or_the_node_is_off(queued, change):
    world, put_off, down = queued
    put_off("a")
    vars(world.radios[1]).update(change)
    listening.next_one(world, None, 1, 0)
    assert (down, world.radios[1].waiting) == ([], 1)


@pytest.mark.parametrize("ok", [0, 1])
def test_when_a_frame_has_gone_its_node_is_told_and_the_next_one_goes(queued, ok):
    world, put_off, down = queued
    put_off("a")
    told = []
    do = Of(tell_end=lambda _world, _do, *what: told.append(what))
    listening.tell_sent(world, do, 1, 60, ok)
    assert told == [(1, 60, ok)]
    assert down == [(1, "a", ord("a"), 60)]
    assert counted(world) == ({} if ok else {"sent": 3, "busy": 3})


def noted(monkeypatch):
    """What nodes are handed, and what is finished after it."""
    found = []
    do = Of(
        on_carrier=lambda _world, *what: found.append(("carrier", *what)),
        on_sent=lambda _world, *what: found.append(("sent", *what)),
        take_item=lambda _world, index: found.append(("item", index)),
    )
    monkeypatch.setattr(calls, "finish", lambda _world, _do, *what: found.append(("finish", *what)))
    monkeypatch.setattr(calls, "give", lambda _world, _do, *what: found.append(("give", *what)))
    return do, found


def test_carriers_are_told_as_they_change_to_whoever_listens(monkeypatch):
    world = world_of()
    do, found = noted(monkeypatch)
    world.sums = [50, 49, 90, 90]
    world.radios[2].deaf, world.radios[3].state = 1, DEAD
    listening.tell_changes(world, do, MASK30 - 99)
    assert found == [("carrier", 0, 0, 1, 0), ("finish", 0, MASK30 - 99, listening.ON_CARRIER, 1)]
    assert [radio.told for radio in world.radios] == [1, 0, 0, 0]
    found.clear()
    listening.tell_changes(world, do, 7)
    assert found == []
    world.sums[0], world.sums[1] = 49, 50
    listening.tell_changes(world, do, 7)
    assert [what for what in found if what[0] == "carrier"] == [
        ("carrier", 0, 107, 0, 0), ("carrier", 1, 107, 1, 0)]  # fmt: skip


def test_what_a_node_is_told_of_its_frame_by_its_own_clock(monkeypatch):
    do, found = noted(monkeypatch)
    listening.tell_gone(world_of(), do, 2, MASK30 - 90, 1)
    assert found == [("sent", 2, 9, 1), ("finish", 2, MASK30 - 90, listening.ON_SENT, 1)]


@pytest.mark.parametrize(("state", "given"), [(ALIVE, True), (OFF, False), (DEAD, False)])
def test_what_users_offer_goes_to_nodes_that_are_on(monkeypatch, state, given):
    world = world_of()
    do, found = noted(monkeypatch)
    world.offers = [None, Of(node=3, kind=6)]
    world.radios[3].state = state
    listening.offer(world, do, 1, 80)
    assert found == ([("item", 1), ("give", 3, 80, 6)] if given else [])
    assert counted(world) == {}
