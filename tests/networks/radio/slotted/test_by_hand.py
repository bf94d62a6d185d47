"""The slotted loops with arrivals that are written here, where nothing is left to a draw."""

from dataclasses import replace

import numpy as np
import pytest

from innervate.networks.radio.slotted import chance, contend, drive, turns
from innervate.networks.radio.slotted.draws import UNIT, choose, draw, generator
from innervate.networks.radio.slotted.drive import Dcf, Job, Setting, dcf_here, poisson_table
from innervate.networks.radio.slotted.model import _measure
from innervate.networks.radio.slotted.recorder import (
    COLLISIONS,
    DISASTER,
    DONE,
    LIMIT,
    NEVER,
    POISSON,
    SATURATED,
    deliver,
    new_recorder,
    opening,
    ready,
)

LATE = 10**6
TIMES = Dcf(slot_us=50, payload_us=8184, success_us=8982, collision_us=8713, window=32, stages=5)


def offered(*arrivals, traffic=POISSON):
    """A recorder of stations whose packets are offered at these times, as many of each."""
    packets = len(arrivals[0])
    made = new_recorder(traffic, len(arrivals), packets, generator(1, "by hand"))
    if traffic == POISSON:
        made.arrivals[:] = np.ravel(arrivals)
        made.offer[:] = [times[0] for times in arrivals]
    return made


def served(recorder):
    """(station, offered, end) of every success."""
    count = int(recorder.counts[DONE])
    columns = recorder.station, recorder.offered, recorder.end
    return list(zip(*(column[:count].tolist() for column in columns), strict=True))


def test_who_has_a_packet_and_when_the_channel_is_looked_at_next():
    made = offered([5], [6], [NEVER])
    found = np.zeros(3, np.int64)
    assert (ready(made, 4, found), ready(made, 5, found), found[0]) == (0, 1, 0)
    assert (ready(made, 6, found), found[:2].tolist()) == (2, [0, 1])
    assert [opening(made, at, 10) for at in (0, 4, 5, 6)] == [10, 14, 5, 6]
    made.offer[0] = 6
    assert [opening(made, at, 3) for at in (0, 1, 2, 3)] == [6, 7, 8, 6]


@pytest.mark.parametrize(("traffic", "next_"), [(SATURATED, 70), (DISASTER, NEVER), (POISSON, 9)])
def test_after_a_success_the_next_packet_is_offered(traffic, next_):
    made = offered([3, 9], [4, 8], traffic=traffic)
    made.counts[COLLISIONS] = 6
    began = int(made.offer[0])
    deliver(made, 0, 70)
    assert served(made) == [(0, began, 70)]
    assert (made.offer[0], made.sent.tolist(), made.before[0]) == (next_, [1, 0], 6)


def test_a_run_ends_with_the_first_station_that_has_nothing_left():
    made = offered([3, 9], [4, 8])
    for end in (10, 20, 30):
        deliver(made, 0, end)
    assert served(made) == [(0, 3, 10), (0, 9, 20)]
    assert made.counts[LIMIT] == 2


def test_with_turns_a_packet_waits_for_that_of_its_station():
    made = offered([0, 40], [12, LATE])
    turns.take_turns(made, 1, 9)
    assert served(made) == [(0, 0, 9), (1, 12, 39), (0, 40, 49)]


def test_who_is_alone_reserves_nothing_and_who_is_not_reports():
    times = turns.Reservation(slot=1, turn=2, packet=5, lead=10, report=3, each=8)
    made = offered([0, 30, 100], [30, 31, LATE])
    turns.reserve(made, times)
    # Alone up to 7, and a slot; two collide at 30: a report, then turn after turn.
    first, second = sorted(served(made)[1:3])
    assert served(made)[0] == (0, 0, 7)
    assert {first[1:], second[1:]} <= {(30, 50), (30, 58)}
    assert [end for _, _, end in served(made)] == [7, 50, 58, 66, 107]
    assert made.counts[COLLISIONS] == 1


def branch(depth, collides=False):
    made = offered([0], [0], [0], [0], traffic=DISASTER)
    after = np.array(depth)
    added = turns._branch(made, np.arange(4), after, len(depth), 50)
    return added, after.tolist(), served(made), int(made.counts[COLLISIONS])


def test_a_step_of_splitting():
    assert branch([1, 2, -1]) == (0, [0, 1, -1], [], 0)
    assert branch([2, 0, 1, -1]) == (0, [1, -1, 0, -1], [(1, 0, 50)], 0)
    added, depth, none, collisions = branch([0, 3, 0, -1])
    assert (added, depth[1], depth[3], none, collisions) == (2, 4, -1, [], 1)
    assert {depth[0], depth[2]} <= {0, 1}


def test_each_resolution_begins_anew():
    made = offered([0, 10, 40], [LATE, LATE, LATE])
    turns.split(made, 7)
    assert served(made) == [(0, 0, 7), (0, 10, 21), (0, 40, 49)]


def test_who_always_sends_when_it_has_a_packet():
    made = offered([0, 25, 100], [LATE, LATE, LATE])
    chance.attempt(made, UNIT, 10, 50, 5)
    assert served(made) == [(0, 0, 50), (0, 25, 105), (0, 100, 160)]
    slots = offered([1, 2, 3], [LATE, LATE, LATE])
    chance.attempt(slots, UNIT, 50, 50, 0)
    assert [end for *_, end in served(slots)] == [100, 150, 200]


def test_a_draw_is_looked_up_in_shares_up_to_it():
    at = draw(generator(3, "x"), UNIT)
    assert choose(generator(3, "x"), [at, UNIT]) == 1
    assert choose(generator(3, "x"), [at + 1, UNIT]) == 0
    assert choose(generator(3, "x"), [at - 1, at, at + 1, UNIT]) == 2


@pytest.mark.parametrize("mean", [0.001, 1.0, 7.5, 60.0])
def test_shares_of_a_poisson_number_add_up(mean):
    table = poisson_table(mean) / UNIT
    assert table[0] == pytest.approx(np.exp(-mean), abs=1e-9)
    assert table[-1] == pytest.approx(1.0, abs=1e-8)
    shares = np.diff(table, prepend=0.0)
    assert (shares * np.arange(len(table))).sum() == pytest.approx(mean, abs=1e-6)


RULES = contend.Contention(slot=10, packet=20, cost=10, turn=3, back=15, backoff=10, linear=0,
                           redraw=0)  # fmt: skip


def contended(*arrivals, **rules):
    made = offered(*arrivals)
    contend.contend(made, RULES._replace(**rules))
    return served(made), int(made.counts[COLLISIONS])


@pytest.mark.parametrize(("back", "second"), [(15, 61), (3, 56)])
def test_a_sender_sends_again_when_it_hears_again_that_the_channel_is_idle(back, second):
    made = new_recorder(SATURATED, 1, 2, generator(1, "x"))
    contend.contend(made, RULES._replace(back=back))
    assert [end for *_, end in served(made)] == [23, second]


def test_a_packet_is_sent_from_the_beginning_of_a_slot():
    assert contended([0, 101], [LATE, LATE])[0] == [(0, 0, 23), (0, 101, 133)]
    assert contended([110, 131], [LATE, LATE])[0] == [(0, 110, 133), (0, 131, 171)]


@pytest.mark.parametrize(("turn", "collisions"), [(5, 0), (6, 1)])
def test_who_decides_before_it_can_hear_another_collides_with_it(turn, collisions):
    """A carrier is heard a turn and half a slot after its decision; slots are of 10."""
    found, met = contended([0, LATE], [10, 9 * LATE], turn=turn)
    assert min(met, 1) == collisions
    if not collisions:
        assert found[:2] == [(0, 0, 25), (1, 10, 60)]


def test_counters_stand_still_while_others_send():
    """802.11 DCF in saturation, against a few lines for two stations."""
    made = new_recorder(SATURATED, 2, 40, generator(5, "dcf"))
    rules = contend.Counters(slot=10, success=100, cost=70, window=4, stages=2, at_once=0)
    contend.distribute(made, rules)
    rng = generator(5, "dcf")
    left, stage, time, ends, met = [draw(rng, 4), draw(rng, 4)], [0, 0], 0, [], 0
    while len(ends) < 80:
        wait = min(left)
        who = [i for i in (0, 1) if left[i] == wait]
        time += 10 * wait + (100 if len(who) == 1 else 70)
        met += len(who) > 1
        for i in (0, 1):
            if i in who:
                stage[i] = 0 if len(who) == 1 else min(stage[i] + 1, 2)
                left[i] = draw(rng, 4 << stage[i])
            else:
                left[i] -= wait + 1
        if len(who) == 1:
            ends.append((who[0], time))
    assert [(who, end) for who, _, end in served(made)] == ends
    assert made.counts[COLLISIONS] == met > 0


def test_a_counter_begins_with_its_packet():
    made = offered([0, 500], [3, LATE])
    contend.distribute(made, contend.Counters(10, 40, 30, window=1, stages=0, at_once=1))
    assert served(made) == [(0, 0, 40), (1, 3, 80), (0, 500, 540)]
    late = offered([101, 150], [LATE, LATE])
    contend.distribute(late, contend.Counters(10, 40, 30, window=1, stages=0, at_once=1))
    assert served(late) == [(0, 101, 150), (0, 150, 190)]


def measured(until=None, warmup=0.0, stations=2):
    """Six packets of 40 ticks that end at 100, 200 ...; a slot is 10, then 10 are idle."""
    made = new_recorder(SATURATED, 2, 3, generator(1, "x"))
    for k in range(6):
        made.counts[COLLISIONS] = 10 * (k + 1)
        deliver(made, k % 2 if k < 4 else 0, 100 * (k + 1))
    made.counts[COLLISIONS] = 99
    times = replace(TIMES, slot_us=10, payload_us=40)
    return _measure(made, Setting("dcf", stations, 4, "saturated", warmup=warmup,
                                  until_slots=until, dcf=times), gap=10)  # fmt: skip


def test_all_of_a_run_counts_up_to_the_idle_slot_of_its_last_packet():
    found = measured()
    assert (found.elapsed_slots, found.duration_slots, found.airtime_slots) == (61, 60, 24)
    assert found.throughput == pytest.approx(240 / 610)
    assert (found.successes, found.order, found.collisions) == ([4, 2], [0, 1, 0, 1, 0, 0], 99)
    assert found.delay_slots.tolist() == [10, 20, 20, 20, 20, 10]
    assert measured(stations=0).delay_slots.tolist() == []


@pytest.mark.parametrize(("until", "count"), [(29.9, 2), (30, 3), (59.9, 5), (60, 6)])
def test_what_ends_later_does_not_count_and_time_ends_there(until, count):
    found = measured(until)
    assert sum(found.successes) == count
    assert found.elapsed_slots == (61 if count == 6 else until)
    assert found.collisions == (99 if count == 6 else 10 * (count + 1))


def test_the_warm_up_ends_with_the_idle_slot_of_its_last_packet():
    found = measured(warmup=0.5)
    assert (found.elapsed_slots, found.collisions) == (30, 99 - 30)
    assert (found.order, found.duration_slots) == ([1, 0, 0], 60)
    assert measured(until=45, warmup=0.5).elapsed_slots == pytest.approx(45 - 21)
    nothing = measured(until=5)
    assert (nothing.throughput, nothing.duration_slots, nothing.order) == (0.0, 0.0, [])


USUAL = {"mac": "tdma", "stations": 2, "packet_slots": 5, "traffic": "saturated"}
EDGES = [  # of an option: what is taken, and what is not any more
    ("p", (1e-9, 1), (0, -0.1, 1.001)), ("reading", ("A", "B"), ("C", "")),
    ("window", (0, 1, 500), (-1,)), ("backoff", ("binary", "linear"), ("cubic",)),
    ("backoff_slots", (1, 10_000), (0, 10_001)),
    ("turnaround_slots", (0, 0.5, 10_000), (-0.5, 10_000.5)),
    ("return_slots", (None, 0, 0.5, 10_000), (-0.5, 10_000.5)),
]  # fmt: skip


@pytest.mark.parametrize(("name", "taken", "refused"), EDGES)
def test_an_option_is_taken_up_to_its_edge_and_no_further(name, taken, refused):
    for value in taken:
        Setting(**USUAL, **{name: value}).check()
    for value in refused:
        with pytest.raises(ValueError, match=name if name != "p" else "p is a probability"):
            Setting(**USUAL, **{name: value}).check()


@pytest.mark.parametrize(
    ("changes", "sound"),
    [
        ({}, True), ({"slot_us": 0}, False), ({"payload_us": 0}, False), ({"success_us": 0}, False),
        ({"collision_us": 0}, False), ({"collision_us": 1}, True), ({"window": 0}, False),
        ({"window": 1, "stages": 20}, True), ({"window": 1, "stages": 21}, False),
        ({"window": 2, "stages": 20}, False), ({"stages": -1}, False), ({"stages": 0}, True),
        ({"window": 1 << 20, "stages": 0}, True), ({"window": (1 << 20) + 1, "stages": 0}, False),
    ],
)  # fmt: skip
def test_times_of_a_dcf_are_sound_up_to_their_edges(changes, sound):
    made = replace(TIMES, **changes)
    assert made.sound == sound
    if sound:
        Setting(**USUAL, dcf=made).check()
    else:
        with pytest.raises(ValueError, match="dcf needs times > 0"):
            Setting(**USUAL, dcf=made).check()


def test_a_dcf_on_the_papers_channel_ends_with_a_slot_an_answer_and_a_slot():
    assert dcf_here(5) == Dcf(208, 1040, 1040 + 624, 1040 + 208, window=16, stages=6)


SETTINGS = [
    ({"stations": 1}, {"stations": 0}), ({"stations": 10_000}, {"stations": 10_001}),
    ({"packet_slots": 1}, {"packet_slots": 0}),
    ({"packet_slots": 10_000}, {"packet_slots": 10_001}),
    ({"packets": 1}, {"packets": 0}), ({"packets": 50_000_000}, {"packets": 50_000_001}),
    ({"seed": 0}, {"seed": -1}), ({"warmup": 0}, {"warmup": -0.01}),
    ({"warmup": 0.999}, {"warmup": 1}),
    ({"traffic": "poisson", "load": 50}, {"traffic": "poisson", "load": 50.1}),
    ({"traffic": "poisson", "load": 1e-9}, {"traffic": "poisson", "load": 0}),
    ({"traffic": "poisson", "load": 1}, {"traffic": "poisson"}), ({}, {"load": 1}),
    ({"mac": "nonpersistent", "stations": 0, "traffic": "poisson", "load": 1},
     {"mac": "nonpersistent", "stations": 0}),
    ({"mac": "nonpersistent", "stations": 0, "traffic": "poisson", "load": 1},
     {"stations": 0, "traffic": "poisson", "load": 1}),
    ({"mac": "nonpersistent", "stations": 0, "traffic": "poisson", "load": 1, "packets": 10**8},
     {"mac": "nonpersistent", "stations": 0, "traffic": "poisson", "load": 1,
      "packets": 10**8 + 1}),
]  # fmt: skip


@pytest.mark.parametrize(("taken", "refused"), SETTINGS)
def test_a_setting_is_taken_up_to_its_edge_and_no_further(taken, refused):
    Setting(**USUAL | taken).check()
    with pytest.raises(ValueError, match=r"are|is|belongs|needs"):
        Setting(**USUAL | refused).check()


def driven(mac, traffic=SATURATED, stations=3, load=None, **options):
    """What a protocol's loop is called with, and the idle time of its last packet."""
    called = []
    setting = Setting(mac, 0 if load else stations, 5, "poisson", load=load, **options)
    made = Job(setting, new_recorder(traffic, stations, 4, generator(1, "x")), plain=True)
    with pytest.MonkeyPatch.context() as patched:
        patched.setattr(drive, "loop", lambda function, plain: lambda recorder, *values:
                        called.append((function.__name__, *values)))  # fmt: skip
        gap = drive.drive(made)
    ((name, *values),) = called
    return name, values[0] if len(values) == 1 else values, gap


TURN, PACKET, SLOT = {"turnaround_slots": 2.5}, 5 * 208, 208


@pytest.mark.parametrize(
    ("options", "lead", "report", "each", "turn"),
    [
        ({}, PACKET + 2 * SLOT + 5 * SLOT, 0, PACKET + SLOT, 0),
        ({"window": 0}, PACKET + 2 * SLOT, 0, PACKET + SLOT, 0),
        ({"window": 2, **TURN}, PACKET + 2 * 520 + 4 * SLOT, 0, PACKET + SLOT + 520, 520),
        ({"reading": "B"}, PACKET + 5 * SLOT, SLOT, PACKET, 0),
        ({"reading": "B", "window": 0, **TURN}, PACKET + 2 * 520, SLOT, PACKET + 520, 520),
    ],
)
def test_what_a_reservation_takes(options, lead, report, each, turn):
    times = turns.Reservation(SLOT, turn, PACKET, lead, report, each)
    is_b = options.get("reading") == "B"
    assert driven("csma-cd-r", **options) == ("reserve", times, 0 if is_b else SLOT)
    assert driven("csma-cd-r", stations=1, **options)[-1] == SLOT


@pytest.mark.parametrize(
    ("mac", "options", "cost", "turn", "back", "rules"),
    [
        ("csma-cd-d1", {}, SLOT, 0, 0, (208, 0, 0)),
        ("csma-cd-d2", {}, PACKET + SLOT, 0, 0, (208, 0, 0)),
        ("csma-cd-d2", TURN, PACKET + SLOT, 520, 520, (208, 0, 0)),
        ("csma-cd-d2", TURN | {"return_slots": 0}, PACKET + SLOT, 520, 0, (208, 0, 0)),
        ("csma-cd-d2p", TURN | {"return_slots": 1}, PACKET + SLOT, 520, 208, (208, 0, 1)),
        ("csma-cd-d2", {"backoff": "linear", "backoff_slots": 3}, PACKET + SLOT, 0, 0, (624, 1, 0)),
        ("csma-cd-d2", {"turnaround_slots": 0.999}, PACKET + SLOT, 208, 208, (208, 0, 0)),
    ],
)
def test_what_a_collision_and_its_backoff_take(mac, options, cost, turn, back, rules):
    expected = contend.Contention(SLOT, PACKET, cost, turn, back, *rules)
    assert driven(mac, **options) == ("contend", expected, SLOT)


@pytest.mark.parametrize(("traffic", "at_once"), [(SATURATED, 0), (POISSON, 0), (DISASTER, 1)])
def test_in_a_disaster_counters_begin_at_once(traffic, at_once):
    expected = contend.Counters(208, PACKET + 3 * SLOT, PACKET + SLOT, 16, 6, at_once)
    assert driven("dcf", traffic) == ("distribute", expected, 0)
    expected = contend.Counters(50, 8982, 8713, 32, 5, at_once)
    assert driven("dcf", traffic, dcf=TIMES) == ("distribute", expected, 0)


def test_steps_of_those_who_send_by_chance():
    p = round(UNIT / 3)
    assert driven("slotted-aloha") == ("attempt", [p, PACKET, PACKET, 0], 0)
    assert driven("nonpersistent") == ("attempt", [p, SLOT, PACKET, SLOT], SLOT)
    assert driven("p-persistent", p=0.25) == ("attempt", [UNIT // 4, SLOT, PACKET, SLOT], SLOT)
    assert driven("tree") == ("split", PACKET, 0)
    assert driven("tdma") == ("take_turns", [SLOT, PACKET], SLOT)


def test_how_many_come_to_an_infinite_population_in_a_step():
    """Of a load of 2 packets a packet time of 5 slots, 0.4 come in a slot."""
    assert chance.STEPS_PER_PACKET == 1000

    def mean(table):
        return float((np.diff(table / UNIT, prepend=0.0) * np.arange(len(table))).sum())

    name, (table, *steps), gap = driven("slotted-aloha", load=2.0)
    assert (name, steps, gap, mean(table)) == ("pool", [PACKET] * 2 + [0], 0, pytest.approx(2.0))
    name, (table, *steps), gap = driven("nonpersistent", load=2.0)
    assert (name, steps, gap) == ("pool", [SLOT, PACKET, SLOT], SLOT)
    assert mean(table) == pytest.approx(0.4)
    for given, p in (({}, 0.1), ({"p": 0.5}, 0.5)):
        name, (table, after, *steps), gap = driven("p-persistent", load=2.0, **given)
        assert (name, steps, gap) == ("persist", [round(p * UNIT), SLOT, PACKET], SLOT)
        assert (mean(table), mean(after)) == (pytest.approx(0.4), pytest.approx(2.4))
