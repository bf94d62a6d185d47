"""Alarms held against where a robot was: of a crossing if they stood then, else false."""

import pytest

from innervate.networks.mesh.analysis.alarms import FalseAlarm, judged
from innervate.networks.mesh.analysis.messages import NEVER
from innervate.networks.mesh.analysis.said import said
from innervate.networks.mesh.protocol import constants as c
from innervate.scenario.actions.field import CUT, KILL, RESTART, REVIVE
from innervate.scenario.robots import Walk
from tests.networks.mesh.analysis.test_summary import S, fault, given, made

END = 30 * S
ROBOT, OTHER, WITNESS, MONITOR = 3, 2, 1, 4
# At 1 m/s through a square of 10 m: out at 5 s, back at 9 s, out again at 19 s, back at 21 s.
WAY = ((0, 500, 500), (7 * S, 1200, 500), (14 * S, 500, 500), (20 * S, 1100, 500),
       (26 * S, 500, 500))  # fmt: skip
NOISY, EXACT = Walk(ROBOT, WAY, 1_000_000), Walk(ROBOT, WAY)


def found(*rows, told=(), walk=NOISY, faults=(), ended_us=END):
    """Judged: rows are (when, who, what) raised of the robot, `told` when CROSS came."""
    result = made(
        [(at, who, c.REPORT_ALARM, what, ROBOT) for at, who, what in rows],
        delivered=[given(at, MONITOR, ROBOT, 9, kind=c.ALARM, body=(ROBOT, 0, 0, c.CROSS))
                   for at in told],
        walks=[walk], ended_us=ended_us, faults=list(faults), sample_us=20_000,
    )  # fmt: skip
    return result, judged(result)


def own(at, what=c.CROSS):
    return (round(at * S), ROBOT, what)


def crossed(judged):
    """When each crossing was, was raised and accepted, s; None = never."""
    return [tuple(None if at == NEVER else at / S
                  for at in (one.crossed_us, one.raised_us, one.accepted_us))
            for one in judged.crossings]  # fmt: skip


def test_an_alarm_that_is_taken_back_before_the_crossing_is_false():
    _, it = found(own(3), own(3.5, c.CLEAR), told=[3 * S + 4_000])
    assert crossed(it) == [(5, None, None), (19, None, None)]
    (one,) = it.false
    assert one == FalseAlarm(ROBOT, 3 * S, ROBOT, 3_500_000, 3 * S + 4_000, pytest.approx(2.0))


@pytest.mark.parametrize("early_s", [0.001, 0.5, 4.0])
def test_an_alarm_that_stands_when_the_robot_crosses_is_of_that_crossing(early_s):
    at = 5 - early_s
    _, it = found(own(at), own(9.5, c.CLEAR), told=[round(at * S) + 4_000])
    assert it.false == []
    assert crossed(it)[0] == (5, pytest.approx(at), pytest.approx(at + 0.004))
    assert it.crossings[0].overrun_m == pytest.approx(max(0, 0.004 - early_s))


def test_of_alarms_before_and_after_the_crossing_each_counts_once():
    """False, then one that stands, taken back and raised again outside: one crossing, one false."""
    rows = [own(4.9), own(4.92, c.CLEAR), own(4.98), own(5.1, c.CLEAR), own(5.2), own(9.3, c.CLEAR)]
    _, it = found(*rows, told=[4_904_000, 4_984_000, 5_204_000])
    assert crossed(it) == [(5, 4.98, 4.984), (19, None, None)]
    assert [(one.raised_us, one.accepted_us) for one in it.false] == [(4_900_000, 4_904_000)]


def test_who_is_inside_again_raises_a_false_alarm_not_that_of_the_crossing():
    rows = [own(9.2), own(9.4, c.CLEAR), own(18), own(18.5, c.CLEAR)]
    _, it = found(*rows, told=[9_204_000, 18_004_000])
    assert crossed(it) == [(5, None, None), (19, None, None)]
    assert [one.raised_us for one in it.false] == [9_200_000, 18 * S]


def test_what_the_monitor_is_told_later_is_of_the_alarm_before():
    rows = [own(3), own(3.5, c.CLEAR), own(4), own(4.5, c.CLEAR), own(6), own(9.3, c.CLEAR)]
    _, it = found(*rows, told=[3_900_000, 6_200_000, 7 * S])
    assert [one.accepted_us for one in it.false] == [3_900_000, NEVER]
    assert crossed(it)[0] == (5, 6, 6.2)


def test_an_alarm_that_stands_from_one_crossing_to_the_next_makes_them_one():
    """It was five metres inside, and did not know it; without errors that is judged by samples."""
    _, it = found(own(5), own(22, c.CLEAR), told=[5_004_000])
    assert crossed(it) == [(5, 5, 5.004)]
    assert it.crossings[0].back_us == 21 * S
    _, exact = found(own(5), own(22, c.CLEAR), told=[5_004_000], walk=EXACT)
    assert crossed(exact) == [(5, 5, 5.004), (19, None, None)]
    assert exact.false == []


def test_without_errors_an_alarm_within_what_is_rounded_is_of_the_crossing():
    _, it = found(own(4.99), own(9.3, c.CLEAR), told=[4_994_000], walk=EXACT)
    assert (crossed(it)[0], it.false) == ((5, 4.99, 4.994), [])
    _, it = found(own(4.5), own(4.6, c.CLEAR), walk=EXACT)
    assert [one.raised_us for one in it.false] == [4_500_000]


def test_one_that_is_not_taken_back_is_false_as_long_as_the_robot_is_inside():
    for ended_us, false in ((4 * S, 1), (5_100_000, 0)):
        _, it = found(own(3.5), ended_us=ended_us)
        assert len(it.false) == false
        assert all(one.until_us == ended_us for one in it.false)


SAID = [
    ([own(1), own(2), own(3, c.CLEAR), own(4)], [(1, ROBOT, 3), (4, ROBOT, 30)]),
    ([(1 * S, WITNESS, c.CROSS), own(2), own(3, c.CLEAR)], [(1, WITNESS, 3)]),
    ([own(1), (2 * S, MONITOR, c.CLEAR), own(3), own(4, c.CLEAR)], [(1, ROBOT, 4)]),
    ([own(1, c.PREDICT), own(2, c.LOST), own(3, c.CLEAR)], []),
]  # fmt: skip


@pytest.mark.parametrize(("rows", "spans"), SAID)
def test_an_alarm_stands_until_the_robot_takes_it_back(rows, spans):
    result, _ = found(*rows)
    assert [(one.raised_us / S, one.raised_by, one.until_us / S)
            for one in said(result, ROBOT)] == spans  # fmt: skip
    assert said(result, OTHER) == []


@pytest.mark.parametrize(("action", "ends"), [(KILL, True), (RESTART, True), (REVIVE, False),
                                              (CUT, False)])  # fmt: skip
def test_a_robot_that_dies_forgets_its_alarm(action, ends):
    result, _ = found(own(1), own(3), own(4, c.CLEAR), faults=[fault(2 * S, action, ROBOT, OTHER)])
    until = [one.until_us for one in said(result, ROBOT)]
    assert until == ([2 * S, 4 * S] if ends else [4 * S])


def test_without_a_fence_nothing_is_judged():
    result, _ = found(own(1))
    result.plan.params["points"] = 0
    assert judged(result) == ([], [])
