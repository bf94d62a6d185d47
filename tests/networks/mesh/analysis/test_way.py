"""The way of an alarm from what was on the air: which copies are of it, which hop follows which."""

from types import SimpleNamespace as Of

import pytest

from innervate.networks.mesh.analysis.alarms import Crossing
from innervate.networks.mesh.analysis.messages import NEVER
from innervate.networks.mesh.analysis.way import copies, way
from innervate.networks.mesh.protocol.constants import ALARM, ALL, DATA, FLOOD
from innervate.networks.mesh.scenario.plan import ONE
from tests.networks.mesh.analysis.test_summary import S, given, made

ROBOT, MONITOR = 2, 4
LONG_US = 2_000
ACCEPTED = S + 70_000
CROSSED = Crossing(ROBOT, S, 9 * S, S, ROBOT, ACCEPTED, 0, False, 2, NEVER, 0.0, False)
UNHEARD = CROSSED._replace(accepted_us=NEVER, row=NEVER, hops=NEVER)


def sent(start, node, to, length, *, seq=9, origin=ROBOT, flags=0, kind=ALARM):
    return (start, start + LONG_US, node, kind, flags, to, origin, MONITOR, seq, length, 30, 1)


def run(*frames, chances=(), robots=()):
    """What was on the air; chances of reception by (sender, receiver), else 1."""
    prob = [ONE] * 25
    for (node, other), share in dict(chances).items():
        prob[5 * node + other] = share
    told = [given(ACCEPTED, MONITOR, ROBOT, 9, ALARM, 2)]
    return made(sent=frames, delivered=told, robots=[int(node in robots) for node in range(5)],
                radio=Of(prob_q15=prob))  # fmt: skip


def test_copies_are_those_of_its_number_since_the_robot_crossed():
    frames = [
        sent(S + 500, 3, 4, 2), sent(S, ROBOT, 3, 1), sent(S - 1, ROBOT, 3, 1),
        sent(S + 100, ROBOT, 3, 1, seq=8), sent(S + 100, 1, 3, 1, origin=1),
        sent(S + 100, ROBOT, 3, 1, kind=DATA), sent(S + 200, 1, ALL, 2, flags=FLOOD),
    ]  # fmt: skip
    found = copies(run(*frames), CROSSED)
    assert [(hop.start_us, hop.end_us, hop.node, hop.to) for hop in found] == [
        (S, S + LONG_US, ROBOT, 3), (S + 200, S + 200 + LONG_US, 1, ALL),
        (S + 500, S + 500 + LONG_US, 3, 4),
    ]  # fmt: skip
    assert [(hop.path_len, hop.flooded, hop.receivers) for hop in found] == [
        (1, False, 1), (2, True, 1), (2, False, 1),
    ]  # fmt: skip


@pytest.mark.parametrize(("at", "counts"), [
    (S - 1, False), (S, True), (3 * S - 1, True), (3 * S, False),
])  # fmt: skip
def test_of_an_alarm_that_never_came_it_is_what_its_raiser_sent_for_two_seconds(at, counts):
    result = run(sent(at, ROBOT, 3, 1, seq=77), sent(S, 3, 4, 2, origin=3))
    found = copies(result, UNHEARD)
    assert [hop.start_us for hop in found] == [at] * counts
    assert copies(result, UNHEARD._replace(raised_us=NEVER)) == []
    assert way(result, UNHEARD) == []


def nodes(*frames, crossing=CROSSED, **more):
    return [hop.node for hop in way(run(*frames, **more), crossing)]


@pytest.mark.parametrize(("start", "found"), [
    (S + 66_000, [ROBOT, 3]), (S + 66_001, [3]),  # it cannot be passed on before it has come
])  # fmt: skip
def test_a_hop_ends_before_the_next_begins(start, found):
    last = sent(ACCEPTED - LONG_US, 3, MONITOR, 2)
    assert nodes(sent(start, ROBOT, 3, 1), last) == found


def test_a_routed_copy_goes_to_whom_it_names():
    last = sent(ACCEPTED - LONG_US, 3, MONITOR, 2)
    assert nodes(sent(S, ROBOT, 1, 1), sent(S + 9, ROBOT, 3, 1), last) == [ROBOT, 3]
    assert nodes(sent(S, ROBOT, 1, 1), last) == [3]
    assert nodes(sent(S, 3, 3, 1), last) == [3]  # nobody hands it to himself
    assert nodes(sent(S, ROBOT, ALL, 1, flags=FLOOD), last) == [3]
    assert nodes(sent(S, ROBOT, 3, 2), last) == [3]


FLOODED = CROSSED._replace(flooded=True)


def flood(start, node, length):
    return sent(start, node, ALL, length, flags=FLOOD)


def test_the_last_hop_of_a_flood_ends_as_the_monitor_accepts_it():
    early, last = flood(S + 30_000, 1, 2), flood(ACCEPTED - LONG_US, 3, 2)
    rare = {(3, MONITOR): 1}
    assert nodes(flood(S, ROBOT, 1), early, last, crossing=FLOODED, chances=rare) == [ROBOT, 3]
    assert nodes(flood(S, ROBOT, 1), early, crossing=FLOODED) == [ROBOT, 1]
    assert nodes(flood(S, ROBOT, 1), early, crossing=FLOODED, chances={(1, MONITOR): 0}) == []


def test_before_the_last_it_is_the_earliest_that_was_likely_heard():
    frames = flood(S, 0, 1), flood(S + 10_000, 1, 1), flood(ACCEPTED - LONG_US, 3, 2)
    for chance, first in ((ONE // 2, 0), (ONE // 2 - 1, 1)):
        assert nodes(*frames, crossing=FLOODED, chances={(0, 3): chance}) == [first, 3]
    rare = {(0, 3): 5, (1, 3): 6}  # none was likely: the earliest all the same
    assert nodes(*frames, crossing=FLOODED, chances=rare) == [0, 3]


@pytest.mark.parametrize("robots", [(0,), (3,), (0, 3)])
def test_of_robots_which_move_nobody_knows_who_hears_them(robots):
    frames = flood(S, 0, 1), flood(ACCEPTED - LONG_US, 3, 2)
    silent = {(0, 3): 0}
    assert nodes(*frames, crossing=FLOODED, chances=silent) == [3]
    assert nodes(*frames, crossing=FLOODED, chances=silent, robots=robots) == [0, 3]
