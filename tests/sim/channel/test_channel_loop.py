"""The loop of a channel by hand: commands, timers, offers, carriers, what a call asks for."""

from types import SimpleNamespace as Of

import pytest

from innervate.dialect.access import (
    CLOCK,
    FORCE,
    LEAVE,
    PACKET,
    QUEUE,
    REPORT_DELIVERED,
    REPORT_LEFT,
    RESULT,
)
from innervate.dialect.outbox import DELIVER, REPORT, SEND, SET_TIMER
from innervate.scenario.actions.channel import BEGIN, FADE, GARBLE, JOIN, KILL
from innervate.scenario.actions.channel import LEAVE as RETIRE
from innervate.sim.channel import loop, medium, traffic
from innervate.sim.channel.world import RING, TIMERS, Heap
from innervate.sim.heap import ENDS, OFFER, OUTCOME, READY, STARTS, TIMER, key_of
from innervate.sim.status import BROKEN, DONE, ON_INPUT, ON_START, POOL_FULL, ROWS_FULL

NEVER = medium.NEVER
OFFSET = 500  # of every station's clock, us


class Do:
    """Functions of a network that note how they are called, and put nothing out."""

    def __init__(self):
        self.said = []

    def __getattr__(self, name):
        def note(_world, *what):
            self.said.append((name, *what))

        return note

    def digest(self, _frame):
        return 1


def radio(**more):
    given = dict.fromkeys(("deaf", "present", "noted", "cd", "voc", "air", "first_offer", "fresh",
                           "next_offer", "backlog", "garble", "fade", "leaving"), 0)  # fmt: skip
    return Of(**given | {"alive": 1, "offset": OFFSET, "candidate": NEVER, "ready_at": NEVER,
                         "told_at": NEVER, "told": 0, "data_end": 0} | more)  # fmt: skip


RUN = dict.fromkeys(
    ("broken", "rows", "row_limit", "sent", "sent_limit", "packets", "packet_limit", "trail",
     "trail_limit", "taps", "tap_limit", "saturated", "forced", "fingerprint", "handled",
     "watchful", "broken_at", "offers", "dropped", "silent", "partial", "again",
     "completed", "wanted", "now", "decoded", "oracle", "full_duplex", "loss", "checks"), 0,
)  # fmt: skip


ACTIONS = 11  # of an outbox


def world_of(*radios, stations=2, **run):
    """Two stations, the first as said; each hears the other after 10 us."""
    given = RUN | {"stations": stations, "period": 0, "per_turn": 1, "slot_us": 100, "ta_us": 30}
    return Of(
        run=[Of(**given | run)],
        radios=[*radios, *(radio() for _ in range(stations + 1 - len(radios)))],
        stations=[Of(queued=0) for _ in range(stations)],
        due=[NEVER] * (stations * TIMERS), heap=Heap([0] * 4096, [0]),
        item=[Of(slots=9, handle=9, ago=9)],
        out=Of(count=[0], overflow=[0], action=[], frame=[], limit=[ACTIONS]),
        told=[0] * 4, got=[0] * (stations * RING), tries=[0] * (stations * RING),
        offered=[0] * (stations * RING), sizes=[5] * (stations * RING), commands=[],
        arrivals=[40, 70, 0], degree=[1] * stations, order=[1, 0, 0, 0], delay=[10, 0, 10, 0],
        air=[Of(start=0, end=0, spoilt=0, at_start=0, at_end=0) for _ in range(64)],
        frames=[Of(kind=7, count=0) for _ in range(64)], last=[NEVER] * 4,
        packets=[Of() for _ in range(4)], rows=[Of() for _ in range(4)],
    )  # fmt: skip


@pytest.fixture
def do():
    return Do()


def due(world):
    return sorted(world.heap.keys[: world.heap.size[0]])


def commanded(do, action, value=0, node=0, **state):
    world = world_of(radio(**state))
    world.commands = [Of(action=action, node=node, value=value, index=0)]
    loop.obey(world, do, 0, 9)
    return world


def started(node, cause):
    now = 9 + OFFSET
    return [("on_start", node, now, cause)]


@pytest.mark.parametrize(("action", "state", "said"), [
    (JOIN, {"alive": 0}, started(0, loop.LATE)), (JOIN, {}, []),
    (RETIRE, {}, [("on_input", 0, 9 + OFFSET, LEAVE)]), (RETIRE, {"alive": 0}, []),
    (KILL, {}, []), (KILL, {"alive": 0}, []),
])  # fmt: skip
def test_what_is_done_to_a_station_depends_on_whether_it_is_on(do, action, state, said):
    world = commanded(do, action, **state)
    assert do.said == said
    one = world.radios[0]
    assert one.alive == (0 if action == KILL or (state and action != JOIN) else 1)
    assert one.leaving == (action == RETIRE and not state)


def test_at_the_beginning_all_start_that_are_not_away(do):
    world = world_of(radio(alive=0), radio(alive=0, leaving=1))
    world.commands = [Of(action=BEGIN, node=0, value=0, index=0)]
    loop.obey(world, do, 0, 9)
    assert do.said == started(0, loop.COLD)
    assert [one.alive for one in world.radios[:2]] == [1, 0]


def test_reservations_are_garbled_or_hidden_so_often(do):
    assert commanded(do, GARBLE, 3).radios[0].garble == 3
    assert commanded(do, FADE, 2).radios[0].fade == 2


def test_who_starts_knows_nothing_of_before(do):
    world = world_of(radio(alive=0, deaf=1, candidate=4, cd=1, voc=1, noted=3, leaving=1,
                           ready_at=5, told_at=6, present=1))  # fmt: skip
    world.due = [1, 2, 3, 4]
    loop.switch_on(world, do, 0, 9, loop.LATE)
    one = world.radios[0]
    assert (one.deaf, one.candidate, one.leaving, one.ready_at, one.told_at) == (
        0, NEVER, 0, NEVER, NEVER)  # fmt: skip
    assert world.due == [NEVER, NEVER, 3, 4]
    assert world.told[:2] == [1, 0]  # it is told at once that somebody sends
    assert due(world) == [key_of(9, OFFER, 0, 1)]


@pytest.mark.parametrize(("time", "slot", "ago"), [(0, 0, 0), (99, 0, 99), (100, 1, 0),
                                                   (250, 0, 50), (399, 1, 99)])  # fmt: skip
def test_a_shared_clock_says_whose_slot_it_is_and_since_when(do, time, slot, ago):
    world = world_of(period=100)
    loop.tell_clock(world, do, 1, time)
    assert do.said == [("on_input", 1, time + OFFSET, CLOCK)]
    assert (world.item[0].slots, world.item[0].handle, world.item[0].ago) == (0, slot, ago)
    loop.tell_clock(world_of(), do, 1, time)
    assert len(do.said) == 1  # others have no such clock


@pytest.mark.parametrize(("told_at", "alive", "says"), [(80, 1, True), (79, 1, False),
                                                        (80, 0, False)])  # fmt: skip
def test_an_oracle_says_how_many_received_the_packet(do, told_at, alive, says):
    world = world_of(radio(told_at=told_at, alive=alive, told=RING + 3))
    world.got[3] = 4
    loop.tell_outcome(world, do, 0, 80)
    assert do.said == ([("on_input", 0, 80 + OFFSET, RESULT)] if says else [])
    if says:
        assert (world.item[0].slots, world.item[0].ago, world.item[0].handle) == (0, 0, 4)


@pytest.mark.parametrize(("state", "run", "count", "kind"), [
    ({"backlog": 3, "fresh": 8}, {}, 3, PACKET),
    ({"backlog": 3, "fresh": 1}, {"forced": 1}, 3, FORCE),
    ({"backlog": 99, "fresh": 99}, {}, QUEUE, PACKET), ({}, {"saturated": 1}, 3, PACKET),
    ({}, {"saturated": 1, "per_turn": 2}, 5, PACKET),
    ({}, {"saturated": 1, "per_turn": 99}, QUEUE, PACKET),
    ({}, {}, 0, PACKET), ({"backlog": 3, "leaving": 1}, {}, 0, PACKET),
    ({"backlog": 3, "alive": 0}, {}, 0, PACKET),
])  # fmt: skip
def test_packets_that_wait_are_handed_down_while_there_is_room(do, state, run, count, kind):
    world = world_of(radio(**state), **run)
    handles = []

    def take(name, node, now, *what):
        world.stations[node].queued += 1
        handles.append(world.item[0].handle)
        assert (now, what) == (9 + OFFSET, (kind,))

    do.on_input = lambda _world, *what: take("on_input", *what)
    loop.offer(world, do, 0, 9)
    first = 0 if run.get("saturated") else (state.get("fresh", 0) - state.get("backlog", 0)) & 65535
    assert handles == [(first + k) & 65535 for k in range(count)]
    assert world.run[0].handled == count


def test_a_carrier_is_told_as_one_or_several(do):
    for present, told in ((0, (0, 0)), (1, (1, 1)), (2, (1, 0))):
        world = world_of(radio(present=present))
        loop.tell_carrier(world, do, 0, 9)
        assert do.said.pop() == ("on_carrier", 0, 9 + OFFSET, *told)
        assert (world.radios[0].cd, world.radios[0].voc) == told


@pytest.mark.parametrize(("state", "says"), [({}, True), ({"alive": 0}, False), (
    {"deaf": medium.SENDING}, False), ({"deaf": medium.HEARING}, True)])  # fmt: skip
def test_all_whose_carrier_changed_are_told_once(do, state, says):
    world = world_of(radio(noted=3, **state), radio(noted=1))
    world.told[:3] = [2, 0, 1]
    loop.tell_all(world, do, 9)
    heard = [what[1] for what in do.said if what[0] == "on_carrier"]
    assert heard == ([0, 1] if says else [1])
    assert world.told[0] == 0
    assert world.radios[1].noted == 0


def dispatched(world, do, rank, node=0, what=0, time=80):
    key = key_of(time, rank, node, what)
    world.heap.keys[0], world.heap.size[0] = key, 1
    loop.dispatch(world, do, key, time)
    return do.said


@pytest.mark.parametrize(
    ("due_at", "alive", "fires"), [(80, 1, True), (81, 1, False), (80, 0, False)]
)
def test_a_timer_fires_once_if_it_is_still_set_to_this_time(do, due_at, alive, fires):
    world = world_of(radio(alive=alive))
    world.due[1] = due_at
    assert dispatched(world, do, TIMER, what=1) == (
        [("on_timer", 0, 80 + OFFSET, 1)] if fires else [])  # fmt: skip
    assert world.due[1] == (NEVER if fires else due_at)


@pytest.mark.parametrize(("ready_at", "deaf"), [(80, 0), (90, 1)])
def test_a_radio_that_is_ready_listens_and_is_told_what_there_is(do, ready_at, deaf):
    world = world_of(radio(deaf=1, ready_at=ready_at))
    said = dispatched(world, do, READY)
    assert world.radios[0].deaf == deaf
    assert said == ([] if deaf else [("on_carrier", 0, 80 + OFFSET, 0, 0)])


def test_an_offer_makes_a_packet_and_plans_the_next(do):
    world = world_of(radio(next_offer=0), radio(first_offer=2))
    do.on_input = lambda _world, *what: setattr(world.stations[0], "queued", 1)
    dispatched(world, do, OFFER, time=40)
    one = world.radios[0]
    assert (one.next_offer, one.backlog, one.fresh, world.offered[0]) == (1, 1, 1, 40)
    assert due(world) == [key_of(70, OFFER, 0, 0)]


def test_an_outcome_is_told_and_edges_of_signals_go_on(do):
    world = world_of(radio(told_at=80))
    assert dispatched(world, do, OUTCOME)[0][0] == "on_input"
    world = world_of()
    world.air[0].start, world.air[0].end = 60, 75
    world.heap.keys[0], world.heap.size[0] = key_of(70, STARTS, 1, 0), 1
    loop.edge(world, do, STARTS, 1, 0, 70)
    assert (world.radios[1].present, world.radios[1].candidate) == (1, 0)
    world.heap.keys[0], world.heap.size[0] = key_of(85, ENDS, 1, 0), 1
    del do.said[:]
    loop.edge(world, do, ENDS, 1, 0, 85)
    assert do.said == [("record_received", 1, 0, 85, True, True),
                       ("on_frame", 1, 85 + OFFSET, world.frames[0])]  # fmt: skip
    assert world.run[0].decoded == 1


def drained(do, *actions, **run):
    """A world in which a station's call at 80 us has put these out."""
    world = world_of(**run)
    world.out.count[0] = len(actions)
    world.out.action = [Of(kind=kind, a=a, b=b, c=c) for kind, a, b, c in actions]
    world.out.frame = [Of(kind=7, count=count, slots=2) for count in (0, 1, 2)]
    loop.drain(world, do, 0, 80)
    assert world.out.count[0] == 0
    return world


@pytest.mark.parametrize(("at", "fires"), [(580, 80), (600, 100), (570, 80), (580 - 2**20, 80)])
def test_a_timer_is_set_by_the_stations_clock_and_never_before_now(do, at, fires):
    world = drained(do, (SET_TIMER, 1, at & (2**30 - 1), 0))
    assert world.due[:2] == [NEVER, fires]
    assert due(world) == [key_of(fires, TIMER, 0, 1)]


def test_a_timer_that_is_set_already_is_not_queued_again(do):
    world = drained(do, (SET_TIMER, 1, 600, 0), (SET_TIMER, 1, 600, 0))
    assert len(due(world)) == 1


def test_what_is_sent_is_noted_and_goes_on_the_air(do):
    world = drained(do, (SEND, 0, 0, 0), (DELIVER, 0, 0, 0))
    frames = world.out.frame
    assert do.said == [("record_sent", 0, frames[0], 80), ("copy_frame", frames[0]),
                       ("note_received", 0, frames[1], 80)]  # fmt: skip
    assert (world.air[0].start, world.air[0].end) == (110, 310)  # a turnaround, two slots


def test_packets_in_a_frame_are_noted(do):
    drained(do, (SET_TIMER, 1, 600, 0), (SEND, 0, 0, 0))
    assert [what[0] for what in do.said] == ["record_sent", "note_sent", "copy_frame"]


@pytest.mark.parametrize(("count", "handles"), [(1, [65535]), (3, [65535, 0, 1])])
def test_packets_reported_delivered_are_noted_one_by_one(do, count, handles):
    world = drained(do, (REPORT, REPORT_DELIVERED, 65535, count))
    assert do.said == [("note_delivered", 0, handle, 80) for handle in handles]
    assert world.radios[0].noted == 2


def test_who_has_reported_that_it_left_is_gone_once_it_listens(do):
    world = drained(do, (REPORT, REPORT_LEFT, 0, 0))
    assert world.radios[0].leaving == 2
    for deaf in (1, 0):
        world.radios[0].deaf = deaf
        loop.finish(world, do, 0, 80, ON_INPUT, 0)
        assert world.radios[0].alive == deaf


@pytest.mark.parametrize(("state", "saturated", "asks"), [
    ({}, 0, False), ({"backlog": 1}, 0, True), ({}, 1, True), ({"leaving": 1}, 1, False),
])  # fmt: skip
def test_who_has_delivered_is_asked_for_more(do, state, saturated, asks):
    world = world_of(radio(noted=3, **state), saturated=saturated)
    loop.finish(world, do, 0, 80, ON_START, 0)
    assert world.radios[0].noted == 1
    assert due(world) == ([key_of(80, OFFER, 0, 1)] if asks else [])


# A batch of events, of which one may have each of the two stations fill its outbox.
MOST = loop.BATCH * (24 + ACTIONS) + 2 * ACTIONS
LIMITS = (("rows", "row"), ("sent", "sent"), ("packets", "packet"), ("trail", "trail"))


@pytest.mark.parametrize(("run", "why"), [
    ({}, DONE), ({"broken": 3}, BROKEN), ({"taps": 1}, ROWS_FULL),
    ({"taps": 1, "tap_limit": 1}, DONE),
    *(({name: 100, f"{limit}_limit": 100 + MOST - more}, ROWS_FULL if more else DONE)
      for name, limit in LIMITS
      for more in (0, 1)),
])  # fmt: skip
def test_the_loop_stops_before_a_table_is_full(run, why):
    assert loop.pressing(world_of(**run)) == why


@pytest.mark.parametrize(("size", "why"), [(4096 - 136, DONE), (4096 - 135, POOL_FULL)])
def test_the_loop_stops_before_the_queue_is_full(size, why):
    world = world_of()
    world.heap.size[0] = size  # four events of each of two stations, and eight of each of a batch
    assert loop.pressing(world) == why


@pytest.mark.parametrize(("received", "alive", "silent"), [
    (0, 1, 1), (1, 1, 0), (0, 0, 1), (1, 0, 0),
])  # fmt: skip
def test_a_packet_that_nobody_received_is_counted(received, alive, silent):
    world = world_of(radio(backlog=2, data_end=70), radio(alive=alive), packet_limit=9)
    world.got[4], world.tries[4], world.offered[4] = received, 3, 11
    world.last[2] = RING + 4 if received else NEVER
    traffic.note_delivered(world, 0, RING + 4, 80)
    run, row = world.run[0], world.packets[0]
    assert (run.silent, run.partial) == (silent, 0)
    assert (run.completed, run.packets, world.radios[0].backlog) == (1, 1, 1)
    assert vars(row) == {
        "offered": 11, "end": 70, "time": 80, "node": 0, "handle": RING + 4, "slots": 5,
        "receivers": received, "listeners": max(received, alive), "tries": 3,
    }  # fmt: skip


def test_a_packet_that_some_did_not_receive_is_partial():
    world = world_of(radio(backlog=1))
    world.degree[0], world.got[0] = 2, 1
    traffic.note_delivered(world, 0, 0, 80)
    assert (world.run[0].silent, world.run[0].partial, world.run[0].packets) == (0, 1, 0)


@pytest.mark.parametrize(("before", "first", "got", "again"), [
    (NEVER, 7, [7, 8], 0), (6, 7, [7, 8], 0), (7, 7, [8], 1), (8, 7, [], 2),
    (65535, 0, [0, 1], 0), (7 + 2**15, 7, [], 2), (8 + 2**15, 7, [7, 8], 0),
])  # fmt: skip
def test_a_packet_counts_once_at_a_receiver(before, first, got, again):
    world = world_of()
    world.last[1 * 2 + 0] = before & 65535 if before != NEVER else NEVER
    traffic.note_received(world, 1, Of(source=0, count=2, handle=first), 80)
    assert [i for i in range(RING) if world.got[i]] == got
    assert world.run[0].again == again
    assert world.last == [NEVER, NEVER, (before & 65535) if not got else first + 1, NEVER]


def test_more_packets_than_can_be_remembered_are_dropped():
    world = world_of(radio(backlog=RING - QUEUE - 1, fresh=65535))
    assert traffic.make(world, 0, 50) == 65535
    assert (world.radios[0].fresh, world.offered[RING - 1], world.run[0].dropped) == (0, 50, 0)
    assert traffic.make(world, 0, 51) == NEVER
    assert (world.run[0].offers, world.run[0].dropped) == (2, 1)


def test_a_sent_packet_is_over_when_its_frame_is():
    world = world_of()
    traffic.note_sent(world, 0, Of(slots=4, count=2, handle=RING - 1), 80)
    assert world.radios[0].data_end == 80 + 30 + 400
    assert (world.tries[RING - 1], world.tries[0]) == (1, 1)
