"""Crossings of a fence: a robot that leaves a square twice, and what was raised and told of it."""

import pytest

from innervate.networks.mesh.analysis.alarms import Crossing, FalseAlarm, alarms, all_crossings
from innervate.networks.mesh.analysis.messages import NEVER
from innervate.networks.mesh.protocol import constants as c
from innervate.scenario.robots import Walk
from tests.networks.mesh.analysis.test_summary import S, given, made

END = 22 * S
ROBOT, OTHER, WITNESS, MONITOR = 3, 2, 1, 4
# At 1 m/s through the middle of a square of 10 m: out at 5 s, 2 m away at 7 s, back at 9 s, out
# again at 19 s. Samples are 10 cm apart, places rounded to 10 cm: seen from 0.2 s before on.
WALK = Walk(ROBOT, ((0, 500, 500), (7 * S, 1200, 500), (14 * S, 500, 500), (30 * S, 2100, 500)))
SEEN, SEEN_AGAIN = 4_800_000, 18_800_000
FIRST = Crossing(
    ROBOT, 5 * S, 9 * S, NEVER, NEVER, NEVER, NEVER, False, NEVER, NEVER, pytest.approx(2.0), False
)
SECOND = FIRST._replace(crossed_us=19 * S, back_us=END, overrun_m=pytest.approx(3.0))


def crossed(raised=(), told=(), walks=(WALK,), ended_us=END, **params):
    """Rows of who raised an alarm (when, who, a, of whom), and deliveries (when, of whom, ...)."""
    result = made(
        [(at, who, c.REPORT_ALARM, what, whose) for at, who, what, whose in raised],
        delivered=[given(at, MONITOR, whose, 9, kind=kind, hops=hops, flags=flags,
                         body=(whose, 0, 0, what))
                   for at, whose, what, kind, hops, flags in told],
        walks=list(walks), ended_us=ended_us, sample_us=100_000,
    )  # fmt: skip
    unit = {"unit_cm": 10, "px": [0, 100, 100, 0], "py": [0, 0, 100, 100], "clear_margin": 5}
    result.plan.params |= unit | params
    return all_crossings(result)


def test_what_nobody_noticed():
    assert crossed() == [FIRST, SECOND]
    assert crossed(points=0) == []


def test_who_begins_outside_has_crossed_at_the_beginning():
    walk = Walk(ROBOT, ((2 * S, 1200, 500), (4 * S, 1000, 500), (6 * S, 800, 500)))
    (found,) = crossed([(0, ROBOT, c.CROSS, ROBOT)], walks=[walk])
    assert (found.crossed_us, found.back_us, found.raised_us) == (0, 4 * S, 0)
    assert found.overrun_m == pytest.approx(2.0)


RAISED = [
    ([(SEEN - 1, ROBOT, c.CROSS, ROBOT)], None, None),
    ([(SEEN, WITNESS, c.CROSS, ROBOT), (5 * S, ROBOT, c.CROSS, ROBOT)], (SEEN, WITNESS), None),
    ([(6 * S, ROBOT, c.PREDICT, ROBOT), (7 * S, ROBOT, c.CROSS, ROBOT)], (7 * S, ROBOT), None),
    ([(6 * S, OTHER, c.CROSS, OTHER)], None, None),
    ([(SEEN_AGAIN - 1, ROBOT, c.CROSS, ROBOT)], (SEEN_AGAIN - 1, ROBOT), None),
    ([(SEEN_AGAIN, ROBOT, c.CROSS, ROBOT)], None, (SEEN_AGAIN, ROBOT)),
]


@pytest.mark.parametrize(("rows", "first", "second"), RAISED)
def test_which_crossing_an_alarm_was_raised_of_and_by_whom(rows, first, second):
    expected = [
        one if raised is None else one._replace(raised_us=raised[0], raised_by=raised[1])
        for one, raised in ((FIRST, first), (SECOND, second))
    ]
    assert crossed(rows) == expected


def told(at, what=c.CROSS, whose=ROBOT, kind=c.ALARM, hops=3, flags=0):
    return (at, whose, what, kind, hops, flags)


ACCEPTED = [
    ([told(SEEN - 1)], {}, {}),
    ([told(6 * S), told(6 * S + 1, hops=2)], {"accepted_us": 6 * S, "row": 0, "hops": 3,
                                            "overrun_m": pytest.approx(1.0)}, {}),
    ([told(SEEN, flags=c.FLOOD)], {"accepted_us": SEEN, "row": 0, "hops": 3, "flooded": True,
                               "overrun_m": 0.0}, {}),
    ([told(6 * S, kind=c.DATA), told(7 * S, flags=8, hops=1)],
     {"accepted_us": 7 * S, "row": 1, "hops": 1, "overrun_m": pytest.approx(2.0)}, {}),
    ([told(6 * S, whose=OTHER)], {}, {}),
    ([told(SEEN_AGAIN)], {}, {"accepted_us": SEEN_AGAIN, "row": 0, "hops": 3, "overrun_m": 0.0}),
    ([told(20 * S, hops=5)], {}, {"accepted_us": 20 * S, "row": 0, "hops": 5,
                                 "overrun_m": pytest.approx(1.0)}),
    ([told(k * S, c.PREDICT) for k in (1, 2, 5)], {"warned_us": 2 * S}, {}),
    ([told(0, c.PREDICT)], {"warned_us": 0}, {}),
    ([told(9 * S - 1, c.PREDICT)], {}, {}),
    ([told(9 * S, c.PREDICT)], {}, {"warned_us": 9 * S}),
    ([told(19 * S, c.PREDICT)], {}, {}),
]  # fmt: skip


@pytest.mark.parametrize(("rows", "first", "second"), ACCEPTED)
def test_what_the_monitor_was_told_of_each(rows, first, second):
    assert crossed(told=rows) == [FIRST._replace(**first), SECOND._replace(**second)]


def test_a_run_that_ends_too_soon_to_say_that_an_alarm_is_lost():
    for ended_us, is_open in ((19 * S + 1_499_999, True), (19 * S + 1_500_000, False)):
        assert crossed(ended_us=ended_us)[1].open == is_open  # 6 tries of 250 ms
    (_, told_of) = crossed(told=[told(19 * S)], ended_us=19 * S + 1)
    assert not told_of.open


@pytest.mark.parametrize(("far_cm", "stays"), [(940, 2), (950, 1), (960, 1)])
def test_who_was_not_well_inside_has_not_crossed_anew(far_cm, stays):
    """Out at 5 s, back at 6 s; 50 cm are well inside. Samples are at whole seconds and halves."""
    points = ((0, 500, 500), (5 * S, 1000, 500), (5_500_000, 1050, 500), (6 * S, 1000, 500),
              (6_500_000, far_cm, 500), (7 * S, 1000, 500), (8 * S, 1100, 500))  # fmt: skip
    found = crossed(walks=[Walk(ROBOT, points)])
    spans = [(5 * S, END)] if stays == 1 else [(5 * S, 6 * S), (7 * S, END)]
    assert [(one.crossed_us, one.back_us) for one in found] == spans


def test_crossings_of_all_robots_come_in_order_of_time():
    other = Walk(OTHER, ((0, 500, 500), (5 * S, 1000, 500), (30 * S, 3500, 500)))
    late = Walk(0, ((0, 500, 500), (10 * S, 1000, 500), (30 * S, 3000, 500)))
    found = crossed(walks=[WALK, late, other])
    assert [(one.crossed_us, one.robot) for one in found] == [
        (5 * S, OTHER), (5 * S, ROBOT), (10 * S, 0), (19 * S, ROBOT)
    ]  # fmt: skip


def test_rows_of_other_kinds_raise_nothing():
    result = made([(6 * S, ROBOT, c.REPORT_ROUND, c.CROSS, ROBOT)], walks=[WALK], ended_us=END)
    assert {one.raised_us for one in all_crossings(result)} == {NEVER}


def test_the_summary_counts_what_is_decided():
    def one(**fields):
        return FIRST._replace(overrun_m=2.0, **fields)

    found = [
        one(),
        one(raised_us=5 * S, raised_by=ROBOT),
        one(raised_us=6 * S, raised_by=WITNESS, accepted_us=6 * S + 4000, flooded=True,
            warned_us=4 * S),
        one(raised_us=6 * S, raised_by=ROBOT, accepted_us=6 * S + 2000),
        one(accepted_us=6 * S, flooded=False, warned_us=4_500_000),
        one(flooded=True),  # no more than it was accepted
        one(open=True, raised_us=5 * S, raised_by=WITNESS, warned_us=1, flooded=True),
    ]  # fmt: skip
    false = [FalseAlarm(ROBOT, 5 * S, ROBOT, 6 * S, accepted_us, 1.0)
             for accepted_us in (5 * S + 1, NEVER, 5 * S + 2)]  # fmt: skip
    assert alarms(found, false, 1.5) == {
        "sent": 6, "delivered": 3, "noticed": 3, "by_witness": 1, "by_flood": 1, "warned": 2,
        "latency_ms": {"p50": pytest.approx(3.0), "p99": pytest.approx(3.98), "max": 4.0},
        "overrun_m": {"p50": 2.0, "p99": 2.0, "max": 2.0},
        "warning_ms": {"p50": pytest.approx(750.0), "p99": pytest.approx(995.0), "max": 1000.0},
        "after_ms": {"p50": 1002.0, "p99": pytest.approx(1003.96), "max": 1004.0},
        "false": 3, "false_delivered": 2, "false_per_hour": 2.0,
    }  # fmt: skip
    assert alarms(found)["false_per_hour"] is None
