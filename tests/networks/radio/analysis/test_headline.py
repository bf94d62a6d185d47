"""The first line of a radio team: both sides of everything that changes it."""

import pytest

from innervate.analysis.headline import DEGRADED, DOWN, NO_DATA, OK
from innervate.networks.radio.analysis.headline import RadioFacts, headline, timeout_us
from innervate.networks.radio.analysis.live import Still, of_stations
from innervate.networks.radio.analysis.state import facts
from innervate.networks.radio.analysis.summary import facts as facts_of_run
from innervate.networks.radio.analysis.summary import summarize
from innervate.networks.radio.scenario.plan import RadioFault
from innervate.scenario.actions.channel import JOIN, KILL, LEAVE
from innervate.sim.tables import get
from tests.networks.radio.runs import START_US, radio_plan, run

WELL = RadioFacts(5, offered=10, delivered=10, ended=True)
PARAMS = radio_plan(5).params


def of(**changed):
    found = headline(WELL._replace(**changed))
    return found.level, found.text, found.nodes


def test_all_is_well():
    assert of() == (OK, "All 10 packets were delivered.", ())
    assert of(ended=False, delivered=8, pending=2) == (
        OK, "8 of 10 packets were delivered, 2 wait.", (),
    )  # fmt: skip
    assert of(ended=False, delivered=9, pending=1)[1] == "9 of 10 packets were delivered, 1 waits."
    assert of(delivered=8, pending=2)[1] == "8 of 10 packets were delivered, 2 still waited."
    assert of(ended=False, delivered=0, pending=10)[:2] == (
        OK, "Of 10 packets none has been delivered yet.",
    )  # fmt: skip
    assert of(offered=1, delivered=1)[1] == "The packet was delivered."


@pytest.mark.parametrize(("offered", "abandoned", "ended", "text"), [
    (0, 0, True, "No packet was offered."),
    (3, 3, True, "No packet was offered to a robot that stayed."),
    (3, 3, False, "No packet has been offered to a robot that stayed."),
])  # fmt: skip
def test_of_what_was_not_offered_nothing_is_known(offered, abandoned, ended, text):
    gone = {"offered": offered, "abandoned": abandoned, "delivered": 0, "away": (1,)}
    assert of(**gone, ended=ended) == (NO_DATA, text, ())
    assert of(**gone | {"offered": offered + 1}, pending=1, ended=False)[0] == OK


def test_four_robots_are_named():
    left = "; all 10 packets were delivered."
    assert of(off=(0, 1, 2, 3, 4))[1] == "No robot is on" + left
    assert of(off=(0, 1, 2), away=(3, 4))[1] == "No robot is on" + left
    assert of(stations=9, off=(1, 2, 3, 4))[1] == "Robots 1, 2, 3 and 4 are off" + left
    assert of(stations=9, off=(0, 1, 2, 3, 4))[1] == "5 robots are off" + left


@pytest.mark.parametrize(("still_ms", "words"), [
    (999.4, "999 ms"), (999.6, "1 s"), (1000.0, "1 s"), (1234.5, "1.23 s"), (50.04, "50 ms"),
])  # fmt: skip
def test_how_long_nothing_is_delivered(still_ms, words):
    text = of(ended=False, delivered=9, pending=1, still_ms=still_ms, timeout_ms=9.0)[1]
    assert text.startswith(f"Nothing has been delivered for {words} although 1 packet waits;")


@pytest.mark.parametrize(("action", "text"), [
    (KILL, "Robot 1 is off with 1 packet not sent; all 3 packets were delivered."),
    (LEAVE, "All 3 packets were delivered."),
])  # fmt: skip
def test_what_is_done_at_the_very_beginning_is_done(action, text):
    done = run(4, faults=[RadioFault(0, action, 1, 0, 0)], plain=True, duration_s=1.0)
    assert summarize(done)["headline"]["text"] == text


@pytest.mark.parametrize(
    ("there", "absent", "level", "text", "nodes"),
    [
        ({"answering": False}, {}, NO_DATA, "No robot answers.", (0, 1, 2, 3, 4)),
        ({"offered": 0, "delivered": 0}, {"ended": False, "offered": 0, "delivered": 0},
         NO_DATA, "No packet was offered.", ()),
        ({"off": (0, 1, 2, 3, 4)}, {}, DOWN, "No robot is on; ", (0, 1, 2, 3, 4)),
        ({"off": (0, 1, 2), "away": (3, 4)}, {}, DOWN, "No robot is on; ", (0, 1, 2, 3, 4)),
        ({"away": (0, 1, 2, 3)}, {"away": (0, 1, 2)}, DOWN,
         "Robot 4 is alone: nobody can receive its packets; ", (4,)),
        ({"stations": 1}, {"stations": 2}, DOWN, "Robot 0 is alone", (0,)),
        ({"delivered": 0, "pending": 10}, {"delivered": 1, "pending": 9}, DOWN,
         "Nothing got through; of 10 packets none was delivered.", (0, 1, 2, 3, 4)),
        ({"delivered": 0, "pending": 10}, {"delivered": 0, "pending": 10, "ended": False}, DOWN,
         "Nothing got through", (0, 1, 2, 3, 4)),
        ({"delivered": 9, "pending": 1, "still_ms": 1001, "waiting": (3,)},
         {"delivered": 9, "pending": 1, "still_ms": 1000}, DOWN,
         "Nothing has been delivered for 1 s although 1 packet waits; 9 of 10", (3,)),
        ({"delivered": 9, "pending": 1, "still_ms": 1001}, {"still_ms": 1001}, DOWN,
         "Nothing has been delivered for 1 s", ()),
        ({"delivered": 0, "lost_silently": 10}, {"delivered": 10, "lost_silently": 0}, DOWN,
         "Not one packet was received; 10 packets were lost silently", (0, 1, 2, 3, 4)),
        ({"delivered": 9, "lost_silently": 1}, {}, DEGRADED,
         "1 packet was lost silently, taken for delivered by the sender; 9 of 10 packets", ()),
        ({"off": (3,)}, {"away": (3,)}, DEGRADED, "Robot 3 is off; all 10 packets", (3,)),
        ({"off": (1, 3), "delivered": 6, "abandoned": 4},
         {"away": (1, 3), "delivered": 6, "abandoned": 4},
         DEGRADED, "Robots 1 and 3 are off with 4 packets not sent; all 6 packets were", (1, 3)),
        ({"off": (1,), "away": (3,), "delivered": 6, "abandoned": 4}, {}, DEGRADED,
         "Robot 1 is off; all 6 packets were delivered.", (1,)),
        ({"dropped": 1, "delivered": 9}, {}, DEGRADED, "1 packet found a full queue; 9 of 10", ()),
        ({"delivered": 9, "pending": 1, "overdue": 1, "waiting": (2,)},
         {"delivered": 9, "pending": 1}, DEGRADED,
         "1 packet was not delivered in time; 9 of 10 packets were delivered.", (2,)),
        ({"partial": 1}, {}, DEGRADED, "1 delivered packet did not reach every robot;", ()),
        ({"hidden": ((0, 3),)}, {}, DEGRADED,
         "1 pair of robots does not hear each other; all 10", (0, 3)),
        ({"bounds": {}, "stations_wrong": (1,)}, {}, DEGRADED,
         "Delays lie outside what stations believe; all 10", (1,)),
        ({"bounds": {"believed_us": [52, 104]}}, {}, DEGRADED,
         "Delays lie outside the 52 to 104 us that stations believe; all", ()),
    ],
)  # fmt: skip
def test_both_sides(there, absent, level, text, nodes):
    found = headline(WELL._replace(**there))
    assert (found.level, found.nodes) == (level, nodes)
    assert found.text.startswith(text)
    assert found.text.endswith(".")
    assert headline(WELL._replace(**absent)).level == OK


def test_delays_measured_among_hidden_pairs_are_none():
    text = of(hidden=((0, 3),), bounds={"believed_us": [52, 104]})[1]
    assert text == "1 pair of robots does not hear each other; all 10 packets were delivered."


def test_worst_news_come_first():
    text = of(
        lost_silently=2, off=(1,), overdue=3, partial=4, delivered=8, still_ms=2000, pending=3
    )
    order = ["Nothing has been", "lost silently", "robot 1 is off", "did not reach", "8 of 10"]
    places = [text[1].index(words) for words in order]
    assert places == sorted(places)


def test_the_timeout_grows_with_what_a_turn_takes():
    few, many = timeout_us(radio_plan(2).params, 2), timeout_us(radio_plan(20).params, 20)
    slow = timeout_us(radio_plan(2, ta=2000).params, 2)
    turn = 26 * 208 + 2 * 104
    assert (few, many) == (8 * turn + 1024 * 208, 80 * turn + 1024 * 208)
    assert slow == few + 8 * 4000
    seven = timeout_us(radio_plan(2).params | {"per_turn": 7}, 2)
    assert seven == few + 8 * 6 * 25 * 208


# What runs leave.


def test_a_disaster_that_comes_to_its_end():
    result = run(4, plain=True)
    assert summarize(result)["headline"] == {
        "level": "ok", "text": "All 4 packets were delivered.",
    }  # fmt: skip
    short = run(4, plain=True, duration_s=(START_US + 20_000) / 1e6)
    found = headline(facts_of_run(short))
    assert found.level in (DEGRADED, DOWN)
    assert found.nodes


def test_a_run_that_stands_still_is_not_green():
    # Nobody hears anybody: packets wait for good.
    deaf = [[0, -1], [-1, 0]]
    found = headline(facts_of_run(run(2, plain=True, delays_us=deaf, duration_s=2.0)))
    assert (found.level, found.nodes) == (DOWN, (0, 1))
    assert found.text.startswith("Nothing has been delivered for 1.9 s although 2 packets wait")


def fault(at_us, action, node):
    return RadioFault(at_us=at_us, action=action, node=node, value=0, index=0)


def of_three(faults, arrivals, absent=(0, 0, 0), duration_s=0.5):
    return facts_of_run(
        run(3, packet_slots=5, plain=True, faults=faults, arrivals=arrivals, wanted=0,
            absent=list(absent), duration_s=duration_s)
    )  # fmt: skip


def test_packets_of_who_died_and_of_who_left():
    arrivals = [[1000, 300_000], [2000], [3000, 200_000, 400_000]]
    died = of_three([fault(100_000, KILL, 2)], arrivals)
    left = of_three([fault(100_000, LEAVE, 2)], arrivals)
    assert (died.off, died.away) == ((2,), ())
    assert (left.off, left.away) == ((), (2,))
    for found in (died, left):
        assert (found.offered, found.delivered, found.abandoned, found.pending) == (6, 4, 2, 0)
    assert headline(died).text.startswith("Robot 2 is off with 2 packets not sent; all 4 packets")
    names = ["s0", "s1", "arm", "s3"].__getitem__
    assert headline(died, names).text.startswith("Robot arm is off with 2 packets")
    assert headline(left) == (OK, "All 4 packets were delivered.", ())


def test_who_has_not_come_yet_is_no_fault():
    arrivals = [[1000], [2000], []]
    late = of_three([fault(900_000, JOIN, 2)], arrivals, absent=(0, 0, 1))
    assert (late.off, late.away) == ((), (2,))
    assert headline(late).level == OK
    came = of_three([fault(100_000, JOIN, 2)], [[1000], [2000], [3000]], absent=(0, 0, 1))
    assert (came.off, came.away, came.delivered) == ((), (), 3)


def test_every_packet_is_accounted_for():
    arrivals = [[1000 + 700 * i for i in range(40)] for _ in range(3)]
    found = of_three([fault(20_000, KILL, 1)], arrivals, duration_s=0.05)
    parts = (found.delivered, found.lost_silently, found.pending, found.abandoned, found.dropped)
    assert found.offered == sum(parts)
    assert found.pending > 0
    assert found.abandoned > 0


def test_time_switched_off_is_no_waiting():
    # Two packets of robot 2 wait while it is off; it comes back just before the end.
    faults = [fault(1000, KILL, 2), fault(990_000, JOIN, 2)]
    back = of_three(faults, [[500], [], [2000, 3000]], duration_s=1.0)
    assert (back.pending, back.overdue) == (2, 0)
    assert headline(back).level == OK
    # Had it been on all the time, they would be late.
    result = run(3, packet_slots=5, plain=True, arrivals=[[], [], [2000]], wanted=0,
                 delays_us=[[0, 52, -1], [52, 0, -1], [-1, -1, 0]], duration_s=1.0)  # fmt: skip
    assert facts_of_run(result).waiting == (2,)


def test_before_the_beginning_nobody_is_off():
    result = run(3, plain=True, duration_s=0.01)
    found = facts(result.world, result.plan, 0, 0)
    assert (found.off, found.away) == ((), ())


# What running stations say.


def station(accepted, delivered, queued=0):
    counters = {"packets accepted": accepted, "packets delivered": delivered}
    return {"kind": "radio", "queued": queued, "counters": counters}


def test_running_stations():
    told = {i: station(4, 4) for i in range(5)}
    assert headline(of_stations(told, 5, (), 0.0, PARAMS)).text == "All 20 packets were delivered."
    four = {i: told[i] for i in range(4)}
    quiet = headline(of_stations(four, 5, (4,), 0.0, PARAMS), absent="silent")
    assert quiet[::2] == (DEGRADED, (4,))
    assert quiet.text.startswith("Robot 4 is silent; ")  # nobody knows whether it is off
    assert headline(of_stations({}, 5, (0, 1, 2, 3, 4), 0.0, PARAMS)).level == NO_DATA
    two = {i: station(1, 1) for i in range(2)}
    assert headline(of_stations(two, 2, (), 0.0, PARAMS)).text == "Both packets were delivered."
    idle = {i: station(0, 0) for i in range(5)}
    assert headline(of_stations(idle, 5, (), 0.0, PARAMS)).level == OK


def test_stations_here_that_are_not_alone_and_one_whose_team_elsewhere_died():
    def told(*others):
        return {0: {**station(1, 1), "number": 3, "others": list(others)}}

    assert headline(of_stations(told(7), 2, (1,), 0.0, PARAMS), absent="silent").level == DEGRADED
    assert headline(of_stations(told(7), 1, (), 0.0, PARAMS)).level == OK
    told_once = told() | {1: {**station(0, 0), "number": 7, "others": [3]}}
    assert headline(of_stations(told_once, 2, (1,), 0.0, PARAMS)).level == DOWN  # 7 is cut off here
    heard = {"paths": [{"heard_s": 90.0}]}
    died = headline(of_stations({0: told()[0] | heard}, 1, (), 0.0, PARAMS))
    assert died[:2] == (DOWN, "Robot 0 is alone: nobody can receive its packets; the packet was "
                              "delivered.")  # fmt: skip


def test_running_stations_that_stand_still():
    told = {0: station(4, 3, 1), 1: station(2, 2)}
    limit_ms = timeout_us(PARAMS, 2) / 1e3
    assert headline(of_stations(told, 2, (), limit_ms, PARAMS)).level == OK
    found = headline(of_stations(told, 2, (), limit_ms + 1, PARAMS))
    assert (found.level, found.nodes) == (DOWN, (0,))


def test_how_long_running_stations_stand_still():
    still = Still()
    assert still.note(0, [station(4, 3, 1)]) == 0
    assert still.note(5000, [station(4, 3, 1)]) == 5
    assert still.note(9000, [station(5, 4, 1)]) == 0  # one came through
    assert still.note(10_000, [station(5, 4, 1)]) == 1
    assert still.note(20_000, [station(5, 4, 0)]) == 0  # nobody waits
    assert still.note(30_000, [station(6, 4, 1)]) == 0


def test_a_station_off_the_channel_keeps_its_packets():
    told = {0: station(4, 3, 1), 1: station(2, 2), 2: station(0, 0)}
    found = of_stations(told, 3, (0,), 0.0, PARAMS)
    assert (found.pending, found.abandoned) == (0, 1)
    assert (
        headline(found).text
        == "Robot 0 is off with 1 packet not sent; all 5 packets were delivered."
    )


def test_a_world_of_arrays_says_the_same_as_one_of_lists():
    plain, compiled = (run(4, plain=how) for how in (True, False))
    assert get(plain.world.run, 0, "completed") == get(compiled.world.run, 0, "completed")
    assert facts_of_run(plain) == facts_of_run(compiled)
