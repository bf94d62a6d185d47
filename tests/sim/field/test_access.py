"""Below a protocol in a field, by hand: what becomes of a frame from hand to air and back."""

from types import SimpleNamespace as Of

import pytest

from innervate.dialect.access import PACKET, REPORT_GAVE_UP
from innervate.dialect.arith import MASK30
from innervate.dialect.outbox import DELIVER, REPORT, SEND, SET_TIMER, URGENT
from innervate.sim import taps
from innervate.sim.field import access, calls, medium, queue
from innervate.sim.field.access import MAC, NEVER
from innervate.sim.field.medium import NONE
from innervate.sim.field.states import ALIVE, COMMITTED, DEAD, FREE, HELD, ON_AIR, VOID
from innervate.sim.status import ON_TIMER

OFFSET = 500
NOW = 1_000
NODES, PLACES = 2, 4
DIGEST = 77


class Do:
    """Functions of a network that note how they are called; a medium access asks for `wants`."""

    def __init__(self, world):
        self.said, self.world, self.wants, self.mark = [], world, [], DIGEST

    def __getattr__(self, name):
        def note(_world, *what):
            self.said.append((name, *(one for one in what if one is not self)))
            if name.startswith("mac_"):
                out = self.world.mac_out
                out.action[: len(self.wants)] = [
                    Of(kind=k, a=a, b=b, c=c) for k, a, b, c in self.wants]  # fmt: skip
                out.count[0] = len(self.wants)

        return note

    def copy_frame(self, to, frame):
        to.seq, to.kind = frame.seq, frame.kind

    def digest(self, _frame):
        return self.mark

    def frame_bytes(self, _frame):
        return 30


@pytest.fixture
def world():
    """Two nodes that hear each other; the second is the one that does something."""
    names = ("on_air", "broken", "fingerprint", "handled", "arrived", "blocked", "gave_up",
             "transmissions", "received", "watchful", "tap_limit", "trail_limit", "trail",
             "checks")  # fmt: skip
    run = dict.fromkeys(names, 0) | {
        "nodes": NODES, "free": PLACES, "collisions": 1, "turnaround": 192, "phy_bytes": 6,
        "byte_ns": 32_000, "rng": 12345, "capture": 4096, "sense": 50, "mac": 1, "told": 0,
        "timers": 4, "own_timers": 2, "broken_node": -1,
    }  # fmt: skip
    radio = {"state": ALIVE, "deaf": 0, "on_air": 0, "held": NONE, "hot": NONE, "told": 0,
             "tell_at": NEVER, "offset": OFFSET}  # fmt: skip
    return Of(
        run=[Of(**run)], radios=[Of(**radio) for _ in range(NODES)],
        air=[Of(node=0, state=FREE, start=0, end=0, digest=DIGEST) for _ in range(PLACES)],
        frames=[Of(seq=0, kind=3) for _ in range(PLACES)], free=list(range(PLACES)),
        on_air=[0] * PLACES, sums=[0, 0], got=[0, 0], power=[0, 100, 100, 0],
        prob=[0, 1 << 15, 1 << 15, 0],
        worst=[0] * (PLACES * NODES), heap=Of(keys=[0] * 32, size=[0]), due=[NEVER] * 8,
        mac_out=Of(count=[0], overflow=[0], action=[None] * 4),
        mac_item=[Of(us=0, urgent=9, attempt=9)], trail=[Of() for _ in range(4)],
    )  # fmt: skip


@pytest.fixture
def do(world):
    return Do(world)


def queued(world):
    """(when, rank, node, what) of what is in the queue."""
    keys = sorted(world.heap.keys[: world.heap.size[0]])
    return [(key >> queue.TIME_SHIFT, key >> queue.RANK_SHIFT & 7,
             key >> queue.STATION_SHIFT & (queue.STATIONS_MAX - 1), key & queue.WHAT_MASK)
            for key in keys]  # fmt: skip


def handed(do, flags=0, attempt=0):
    """Node 1 hands a frame down."""
    return access.hand_down(do.world, do, 1, Of(seq=9, kind=3), Of(b=attempt, c=flags), NOW)


PLACE = PLACES - 1  # the first that is given out
STARTS = (NOW + 192, queue.STARTS, 1, PLACE)
TELL = (NOW, queue.TELL, 1, 0)


@pytest.mark.parametrize(("flags", "attempt"), [(0, 3), (URGENT, 0)])
def test_a_frame_is_kept_and_its_medium_access_asked(do, world, flags, attempt):
    world.radios[1].offset = MASK30
    assert handed(do, flags, attempt) == DIGEST
    assert (world.frames[PLACE].seq, world.air[PLACE].digest) == (9, DIGEST)
    assert (world.air[PLACE].node, world.air[PLACE].state) == (1, HELD)
    assert world.radios[1].held == (NONE if flags else PLACE)
    assert world.radios[1].hot == PLACE
    item = world.mac_item[0]
    assert (item.us, item.urgent, item.attempt) == (36 * 32, flags, attempt)
    assert do.said == [("mac_on_input", 1, NOW - 1, PACKET)]
    assert queued(world) == []


@pytest.mark.parametrize(
    ("told", "flags", "held"), [(0, 0, NONE), (1, 0, PLACE), (1, URGENT, NONE)]
)
def test_without_a_medium_access_it_goes_on_the_air_at_once(do, world, told, flags, held):
    world.run[0].mac, world.run[0].told = 0, told
    assert handed(do, flags) == DIGEST
    assert world.air[PLACE].state == COMMITTED
    assert (world.radios[1].held, world.radios[1].deaf) == (held, 1)
    assert (queued(world), do.said) == ([STARTS], [])


def test_a_frame_beside_another_breaks_the_run_unless_it_is_urgent(do, world):
    world.radios[1].held = 2
    assert handed(do) == 0
    assert (world.run[0].broken, world.run[0].broken_node) == (medium.BROKEN_HELD, 1)
    world.run[0].broken = 0
    assert handed(do, URGENT) == DIGEST
    assert (world.run[0].broken, world.radios[1].held) == (0, 2)


@pytest.mark.parametrize(("mac", "flags", "blocked", "told"), [
    (1, 0, 0, []), (1, URGENT, 1, []), (0, 0, 1, [TELL]), (0, URGENT, 1, []),
])  # fmt: skip
def test_while_a_radio_sends_what_cannot_wait_is_given_up(do, world, mac, flags, blocked, told):
    world.run[0].mac, world.radios[1].deaf = mac, 1
    assert handed(do, flags) == (0 if blocked else DIGEST)
    run = world.run[0]
    assert (run.blocked, run.gave_up, queued(world)) == (blocked, len(told), told)
    assert run.free == PLACES - 1 + blocked


def test_without_a_place_nothing_is_sent(do, world):
    world.run[0].free = 0
    assert handed(do) == 0
    assert (do.said, world.run[0].broken) == ([], medium.BROKEN_AIR)


def test_a_frame_that_is_given_up_gives_its_place_back_and_its_node_is_told(world):
    medium.reserve(world, 1, HELD)
    world.radios[1].held = PLACE
    access.give_up(world, 1, NOW)
    assert (world.air[PLACE].state, world.run[0].free) == (FREE, PLACES)
    assert (world.radios[1].held, world.radios[1].tell_at) == (NONE, NOW)
    assert (queued(world), world.run[0].gave_up) == ([TELL], 1)


def drained(do, *wants):
    """What a medium access has put out is carried out: True if it hands its frame up."""
    do.wants = list(wants)
    do.mac_on_timer(do.world, 1, NOW, 0)
    found = access.drain_mac(do.world, do, 1, NOW, MAC + ON_TIMER)
    assert do.world.mac_out.count[0] == 0
    return found


@pytest.mark.parametrize(("flags", "place"), [(0, 2), (URGENT, 3)])
def test_a_medium_access_sends_the_frame_it_holds_or_the_urgent_one(do, world, flags, place):
    world.radios[1].held, world.radios[1].hot = 2, 3
    world.air[2].node = world.air[3].node = 1
    assert not drained(do, (SEND, 0, 0, flags))
    assert [world.air[k].state for k in (2, 3)] == [
        COMMITTED if k == place else FREE for k in (2, 3)]  # fmt: skip
    assert queued(world) == [(NOW + 192, queue.STARTS, 1, place)]


def test_its_timers_are_behind_those_of_the_protocol(do, world):
    drained(do, (SET_TIMER, 1, NOW + OFFSET + 40, 0))
    assert world.due == [NEVER] * 7 + [NOW + 40]
    assert queued(world) == [(NOW + 40, queue.TIMER, 1, 3)]


@pytest.mark.parametrize(("wants", "gave_up", "up"), [
    ((REPORT, REPORT_GAVE_UP, 0, 0), 1, False), ((REPORT, REPORT_GAVE_UP + 1, 0, 0), 0, False),
    ((DELIVER, 0, 0, 0), 0, True), ((DELIVER, REPORT_GAVE_UP, 0, 0), 0, True),
])  # fmt: skip
def test_it_gives_a_frame_up_or_hands_it_up(do, world, wants, gave_up, up):
    assert drained(do, wants) == up
    assert world.run[0].gave_up == gave_up


def test_its_outbox_and_its_calls_are_watched(do, world):
    world.run[0].watchful = world.run[0].trail_limit = 1
    drained(do)
    assert (world.trail[0].handler, world.trail[0].node) == (MAC + ON_TIMER, 1)
    assert world.run[0].broken == 0
    world.mac_out.overflow[0] = 1
    drained(do)
    assert (world.run[0].broken, world.run[0].broken_node) == (medium.BROKEN_OUTBOX, 1)


@pytest.mark.parametrize("mac", [0, 1])
def test_who_starts_hears_nothing_of_what_is_on_the_air(do, world, mac):
    world.run[0].mac, world.run[0].on_air, world.radios[1].told = mac, 1, 1
    world.air[0].end = NOW + 5
    access.power_on(world, do, 1, NOW, 0)
    assert world.worst[:2] == [0, medium.DEAF]
    assert world.radios[1].told == 0
    assert do.said == ([("mac_on_start", 1, NOW + OFFSET, 0)] if mac else [])
    assert bool(world.run[0].fingerprint) == mac


def test_who_stops_takes_all_its_frames_along(do, world):
    for place, (node, state) in enumerate([(1, HELD), (1, COMMITTED), (1, ON_AIR), (0, HELD)]):
        world.air[place].node, world.air[place].state = node, state
    world.run[0].free, world.run[0].on_air, world.on_air[0], world.sums = 0, 1, 2, [100, 0]
    access.power_off(world, do, 1, NOW)
    assert [air.state for air in world.air] == [FREE, VOID, VOID, HELD]
    assert do.said == [("record_sent", place, NOW, 30, 0) for place in range(3)]
    assert (world.run[0].on_air, world.sums) == (0, [0, 0])


@pytest.mark.parametrize(("heard", "told", "says"), [
    (50, 0, [1]), (49, 1, [0]), (50, 1, []), (49, 0, []),
])  # fmt: skip
def test_a_medium_access_learns_the_carrier_when_its_timer_is_due(do, world, heard, told, says):
    world.sums[1], world.radios[1].told = heard, told
    access.expire_below(world, do, 1, 3, NOW)
    now = NOW + OFFSET
    assert do.said == [*(("mac_on_carrier", 1, now, cd, 0) for cd in says),
                       ("mac_on_timer", 1, now, 1)]  # fmt: skip
    assert (world.radios[1].told, world.run[0].handled) == (heard >= 50, 1)


@pytest.mark.parametrize(("mac", "wants", "taken"), [
    (1, [(DELIVER, 0, 0, 0)], True), (1, [], False), (0, [], True),
])  # fmt: skip
def test_a_frame_that_was_received_goes_up_if_the_medium_access_lets_it(
    do, world, monkeypatch, mac, wants, taken
):
    world.run[0].mac, do.wants = mac, wants
    monkeypatch.setattr(calls, "take", lambda _world, _do, *what: do.said.append(("take", *what)))
    access.arrive(world, do, 1, 2, NOW)
    frame = world.frames[2]
    below = [("mac_on_frame", 1, NOW + OFFSET, frame)] if mac else []
    up = [("take", 1, frame, NOW)] if taken else []
    heard = [("note_heard", 1, 2), ("tap", 2, 1, NOW, 0, taps.FINE)]
    assert do.said == heard + below + up
    assert world.run[0].arrived == 1


@pytest.fixture
def on_air(world, monkeypatch):
    """A frame of node 1 is on the air, and node 0 will receive it."""
    place = medium.reserve(world, 1, HELD)
    medium.commit(world, place, NOW - 192)
    medium.start(world, place, NOW, 30)
    world.radios[1].held, world.heap.size[0] = place, 0
    monkeypatch.setattr(access, "arrive", lambda _w, do, *what: do.said.append(("arrive", *what)))
    return place


@pytest.mark.parametrize("held", [True, False])
def test_at_its_end_receivers_come_first_and_the_sender_is_told(do, world, on_air, held):
    if not held:
        world.radios[1].held = 0
    access.end(world, do, on_air, NOW + 50)
    said = [("record_sent", on_air, NOW + 50, 30, 1), ("arrive", 0, on_air, NOW + 50)]
    assert do.said == said + ([("tell_sent", 1, NOW + 50, 1)] if held else [])
    assert world.radios[1].held == (NONE if held else 0)
    assert (world.air[on_air].state, world.run[0].on_air, world.sums) == (FREE, 0, [0, 0])


def test_of_a_frame_whose_sender_died_only_the_place_is_left(do, world, on_air):
    world.air[on_air].state = VOID
    access.end(world, do, on_air, NOW + 50)
    assert (do.said, world.air[on_air].state, world.radios[1].held) == ([], FREE, on_air)


@pytest.mark.parametrize(("checks", "mark", "broken"), [
    (1, DIGEST, 0), (1, DIGEST + 1, medium.BROKEN_FRAME), (0, DIGEST + 1, 0),
])  # fmt: skip
def test_a_frame_that_a_receiver_changed_breaks_a_run_that_is_checked(
    do, world, on_air, checks, mark, broken
):
    world.run[0].checks, do.mark = checks, mark
    access.end(world, do, on_air, NOW + 50)
    assert world.run[0].broken == broken


def test_a_frame_that_is_committed_starts_and_one_that_is_void_does_not(do, world):
    world.run[0].free = 2
    for place, state in ((2, COMMITTED), (3, VOID)):
        world.air[place].node, world.air[place].state = 1, state
        access.dispatch_below(world, do, queue.STARTS, 1, place, NOW)
    assert [air.state for air in world.air[2:]] == [ON_AIR, FREE]
    assert world.air[2].end == NOW + 36 * 32
    assert do.said == [("tap", 2, 1, NOW, 1, taps.FINE), ("note_carriers", NOW),
                       ("note_carriers", NOW)]  # fmt: skip


def test_when_a_frame_ends_carriers_may_have_changed(do, world, on_air):
    access.dispatch_below(world, do, queue.ENDS, 1, on_air, NOW + 50)
    assert do.said[-1] == ("note_carriers", NOW + 50)


@pytest.mark.parametrize(("tell_at", "told"), [(NOW, True), (NOW + 1, False), (NEVER, False)])
def test_a_node_is_told_once_that_its_frame_was_given_up(do, world, tell_at, told):
    world.radios[1].tell_at = tell_at
    for _ in range(2):
        access.dispatch_below(world, do, queue.TELL, 1, 0, NOW)
    assert do.said == ([("tell_sent", 1, NOW, 0)] if told else [])
    assert world.radios[1].tell_at == (NEVER if told else tell_at)


# Signals that change.


def test_a_jammer_is_as_loud_as_it_was_said_to_be_last(world):
    for power, heard in ((70, 70), (20, 20), (0, 0)):
        world.radios[1].noise = getattr(world.radios[1], "noise", 0)
        medium.set_noise(world, 1, power)
        assert (world.sums, world.radios[1].noise) == ([0, heard], power)


def test_a_jammer_meets_what_is_on_the_air_unless_the_medium_is_ideal(world, on_air):
    world.radios[0].noise = 0
    world.run[0].collisions = 0
    medium.set_noise(world, 0, 70)
    assert (world.worst[on_air * NODES], world.sums[0]) == (0, 100)
    world.run[0].collisions = 1
    medium.set_noise(world, 0, 70)
    medium.set_noise(world, 0, 0)
    assert (world.worst[on_air * NODES], world.sums[0]) == (70, 100)  # the worst there was


@pytest.mark.parametrize("sends", [0, 1])
def test_a_cut_takes_a_signal_away_both_ways_and_back(world, monkeypatch, sends):
    monkeypatch.setattr(medium.powers, "strength", lambda table, cdb: table[cdb])
    world.cut, world.strengths, world.rssi = [0] * 4, [0, 100, 40], [0, 1, 2, 0]
    world.power, world.sums = [0, 100, 40, 0], [7, 100 * sends]
    world.radios[0].on_air = sends
    medium.set_cut(world, 1, 0, 1)
    assert (world.cut, world.power, world.sums) == ([0, 1, 1, 0], [0] * 4, [7, 0])
    medium.set_cut(world, 1, 0, 0)
    assert (world.cut, world.power, world.sums) == ([0] * 4, [0, 100, 40, 0], [7, 100 * sends])


@pytest.mark.parametrize(("deaf", "heard", "busy"), [(0, 49, 0), (0, 50, 1), (1, 0, 1)])
def test_a_channel_is_busy_for_who_sends_and_who_hears_enough(world, deaf, heard, busy):
    world.radios[1].deaf, world.sums[1] = deaf, heard
    assert bool(medium.senses(world, 1)) == busy


def test_who_has_died_holds_nothing_and_is_told_nothing(world):
    vars(world.radios[1]).update(deaf=1, held=2, tell_at=NOW)
    medium.die(world, 1)
    one = world.radios[1]
    assert (one.state, one.deaf, one.held, one.tell_at) == (DEAD, 0, NONE, NONE)


@pytest.mark.parametrize(("prob", "met", "why"), [
    (1, 5, taps.COLLISION), (1, medium.DEAF, taps.SENDING), (0, 5, None),
])  # fmt: skip
def test_a_frame_is_missed_by_who_could_have_heard_it(world, prob, met, why):
    world.air[2].node, world.air[2].end, world.prob[2], world.worst[4] = 1, 90, prob, met
    seen = []
    medium.miss_frame(world, 2, 0, taps.COLLISION, lambda _world, *what: seen.append(what))
    assert seen == ([(2, 0, 90, 0, why)] if why else [])
