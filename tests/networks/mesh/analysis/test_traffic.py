"""What a mesh's headline is told of messages and crossings, on both sides of each condition."""

import pytest

from innervate.networks.mesh.analysis.alarms import Crossing, FalseAlarm
from innervate.networks.mesh.analysis.headline import Traffic, traffic
from innervate.networks.mesh.analysis.messages import NEVER, messages
from innervate.networks.mesh.protocol.constants import REPORT_ACCEPTED
from innervate.scenario.actions.field import CUT, JAM, KILL, QUIET, RESTART, RESTORE, REVIVE
from tests.networks.mesh.analysis.test_summary import S, fault, given, made, offer


def sent(*came):
    """Messages of node 1 at 10 s, 20 s ...; `came` says which are delivered."""
    times = [10 * S * (k + 1) for k in range(len(came))]
    rows = [(at, 1, REPORT_ACCEPTED, k, k + 1) for k, at in enumerate(times)]
    told = [given(at + 5, 4, 1, k + 1) for k, at in enumerate(times) if came[k]]
    offers = [offer(at) for at in times]
    return messages(made(rows=rows, delivered=told, offers=offers))


def crossing(robot, accepted_us=NEVER, is_open=False):
    return Crossing(robot, S, 2 * S, S, robot, accepted_us, NEVER, False, 1, NEVER, 0.5, is_open)


def test_what_is_decided_is_counted_and_who_it_is_about_is_named():
    crossings = [crossing(3, 2 * S), crossing(2), crossing(4, is_open=True), crossing(2)]
    found = traffic(sent(True, False, True), crossings, 5, 6, [])
    assert found == Traffic(decided=3, delivered=2, crossings=3, learned=1, doubled=5, looped=6,
                            flows=True, about=(1, 2))  # fmt: skip
    assert traffic(sent(True), [], 0, 0, []).about == ()
    false = [FalseAlarm(robot, S, robot, 2 * S, NEVER, 0.5) for robot in (4, 4, 3)]
    found = traffic(sent(True), [crossing(2)], 0, 0, [], false)
    assert (found.false, found.about, found.crossings, found.learned) == (3, (2, 3, 4), 1, 0)
    assert traffic(sent(), [crossing(3, 2 * S)], 0, 0, []) == Traffic(crossings=1, learned=1)


@pytest.mark.parametrize("action", [KILL, CUT, JAM, RESTART, REVIVE, RESTORE, QUIET])
def test_it_flows_if_something_came_that_was_sent_after_the_last_harm(action):
    is_harm = action in (KILL, CUT, JAM, RESTART)
    came = sent(True, True, False)  # the newest that came is of 20 s
    for at_us, flows in ((20 * S - 1, True), (20 * S, not is_harm), (25 * S, not is_harm)):
        assert traffic(came, [], 0, 0, [fault(at_us, action, 2)]).flows == flows
    both = [fault(5 * S, KILL, 1), fault(25 * S, action, 2), fault(6 * S, CUT, 1, 2)]
    assert traffic(came, [], 0, 0, both).flows == (not is_harm)
    assert not traffic(sent(False), [], 0, 0, []).flows
