"""What is known of a team at one moment, from tables that are written here."""

from types import SimpleNamespace as Of

import pytest

from innervate.networks.radio.analysis.headline import timeout_us
from innervate.networks.radio.analysis.state import facts, pending, switched_on, waiting
from innervate.networks.radio.scenario.plan import Pairs, parameters
from innervate.scenario.actions.channel import JOIN, KILL, LEAVE
from innervate.sim.channel.world import RING

PARAMS = parameters(25)
TIMEOUT = timeout_us(PARAMS, 3)
NOW = 10 * TIMEOUT


def radio(*offered, alive=1, leaving=0, fresh=0):
    """A robot whose packets wait since these moments; the last has the number before `fresh`."""
    return Of(backlog=len(offered), fresh=fresh or len(offered), alive=alive, leaving=leaving,
              offered=offered)  # fmt: skip


def world(*radios, **run):
    places = [0] * (RING * len(radios))
    for i, one in enumerate(radios):
        for k, at in enumerate(one.offered):
            number = one.fresh - one.backlog + k
            places[RING * i + number % RING] = at
    counts = {"offers": 0, "completed": 0, "silent": 0, "dropped": 0, "partial": 0} | run
    return Of(radios=list(radios), offered=places, run=[Of(**counts)])


def plan(faults=(), **more):
    given = {"saturated": False, "wanted": 0, "absent": [0, 0, 0]} | more
    close = [[0, 60, 60], [60, 0, 60], [60, 60, 0]]
    return Of(stations=3, params=PARAMS, faults=list(faults), pairs=Pairs.of(close), **given)


def fault(action, at_us, node):
    return Of(action=action, at_us=at_us, node=node)


def test_packets_are_those_of_who_is_on_and_of_who_is_not():
    there = world(radio(NOW - 5), radio(7, 8, alive=0), radio(9, alive=0, leaving=2),
                  offers=20, completed=9, silent=2, dropped=3, partial=4)  # fmt: skip
    found = facts(there, plan(), NOW, NOW - 2000)
    assert (found.off, found.away) == ((1,), (2,))
    assert (found.offered, found.delivered, found.pending, found.abandoned) == (20, 7, 1, 3)
    assert (found.dropped, found.lost_silently, found.partial) == (3, 2, 4)
    assert pending(there, 3) == 1
    assert found.bounds is None
    narrow = plan()
    narrow.params = PARAMS | {"dmin_us": 61, "dmax_us": 70}
    assert facts(there, narrow, NOW, 0).bounds == {"believed_us": [61, 70]}


@pytest.mark.parametrize(("waited_us", "late"), [(TIMEOUT, 0), (TIMEOUT + 1, 1)])
def test_a_packet_is_overdue_when_it_has_waited_longer_than_the_timeout(waited_us, late):
    there = world(radio(), radio(NOW - waited_us, NOW - 3), radio())
    found = facts(there, plan(), NOW, 0)
    assert (found.overdue, found.waiting) == (late, (1,) * late)
    # A run that was to deliver them all has not: there every packet is.
    ended = facts(there, plan(wanted=3), NOW, 0, ended=True)
    assert (ended.overdue, ended.waiting) == (2, (1,))
    for other in (plan(wanted=3, saturated=True), plan()):
        assert facts(there, other, NOW, 0, ended=True).overdue == late
    assert facts(there, plan(wanted=3), NOW, 0).overdue == late


@pytest.mark.parametrize(("delivered_us", "still_ms"), [
    (0, 9.0), (NOW - 9_000, 9.0), (NOW - 4_000, 4.0), (NOW, 0.0),
])  # fmt: skip
def test_a_team_stands_still_since_the_newest_delivery_or_the_oldest_packet(delivered_us, still_ms):
    there = world(radio(), radio(NOW - 9_000, NOW - 3), radio(5, alive=0))
    assert facts(there, plan(), NOW, delivered_us).still_ms == still_ms
    assert facts(world(radio(), radio(), radio()), plan(), NOW, 0).still_ms == 0.0


def test_packets_wait_from_when_their_robot_was_switched_on_last():
    there = world(radio(), radio(100, 200, 900), radio())
    assert waiting(there, 1) == [100, 200, 900]
    assert waiting(there, 1, 200) == [200, 200, 900]
    faults = [fault(JOIN, 500, 1), fault(JOIN, 50, 1), fault(KILL, 700, 1), fault(JOIN, 901, 1)]
    late = plan(absent=[0, 1, 0])
    assert [switched_on(late, faults, at)[1] for at in (49, 50, 500, 900, 901)] == [
        0, 50, 50, 50, 901,
    ]  # fmt: skip
    assert switched_on(plan(faults[2:]), faults[:1], 900) == [0, 0, 0]  # it was on
    assert switched_on(plan([fault(LEAVE, 60, 2), fault(JOIN, 80, 2)]), (), 80) == [0, 0, 80]
    back = NOW - TIMEOUT + 5
    off, on = fault(KILL, back - 1, 1), fault(JOIN, back, 1)
    assert facts(there, plan([off, on]), NOW, 0).overdue == 0
    assert facts(there, plan([off]), NOW, 0, faults=[on]).overdue == 0
    assert facts(there, plan([on]), NOW, 0).overdue == facts(there, plan(), NOW, 0).overdue == 3


def test_numbers_of_packets_go_round():
    there = world(radio(), radio(11, 22, 33, fresh=RING + 1), radio())
    assert waiting(there, 1) == [11, 22, 33]


def test_at_the_beginning_all_are_on_that_do_not_join_later():
    there = world(*(radio(alive=0) for _ in range(3)))
    found = facts(there, plan(absent=[0, 1, 0]), 0, 0)
    assert (found.off, found.away) == ((), (1,))
