"""When robots are off: what the scenario does to them, and when they left."""

from innervate.dialect.access import REPORT_LEFT
from innervate.networks.radio.analysis import air as radio_air
from innervate.networks.radio.scenario.plan import RadioFault
from innervate.scenario.actions.channel import JOIN, KILL, LEAVE
from tests.networks.radio.analysis.test_summary import made


def test_what_happens_to_a_robot_at_one_moment_happens_in_the_order_of_the_scenario():
    def off(*actions, absent=0, rows=()):
        faults = [RadioFault(700, action, 0, 0, i) for i, action in enumerate(actions)]
        told = made(rows=[(700, 0, REPORT_LEFT)] * rows.count("left"), faults=faults,
                    absent=[absent, 0])  # fmt: skip
        return radio_air.off_times(told)[0].tolist()

    never, gone = [], [[700, radio_air.FOREVER]]
    assert off(JOIN, KILL) == gone
    assert off(KILL, JOIN) == [[700, 700]]
    assert off(JOIN, KILL, absent=1) == [[0, 700], *gone]
    assert off(LEAVE, JOIN, rows=["left"]) == [[700, 700]]
    assert off(JOIN, LEAVE, rows=["left"], absent=1) == [[0, 700], *gone]
    assert off(LEAVE, JOIN) == never  # it still had packets


def test_one_that_was_told_to_leave_before_leaves_behind_all_that_happens_then():
    faults = [RadioFault(100, LEAVE, 0, 0, 0), RadioFault(700, JOIN, 0, 0, 1)]
    result = made(rows=[(700, 0, REPORT_LEFT)], faults=faults)
    assert radio_air.off_times(result)[0].tolist() == [[700, radio_air.FOREVER]]
