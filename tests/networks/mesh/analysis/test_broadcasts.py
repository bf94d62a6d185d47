"""Whom messages to all reached: everybody who was on for as long as they could come, or not."""

import pytest

from innervate.networks.mesh.analysis.messages import messages
from innervate.networks.mesh.protocol.constants import ALARM, ALL, DATA, REPORT_ACCEPTED
from innervate.scenario.actions.field import CUT, KILL, RESTART, REVIVE
from tests.networks.mesh.analysis.test_summary import S, fault, given, made, offer

AT = 10 * S
WAIT = 1_500_000  # that a message may take in these runs


def broadcast(*receivers, at_us=AT, kind=DATA, **plan):
    """A message of node 1 to all five, and who had it."""
    return made(
        rows=[(at_us, 1, REPORT_ACCEPTED, 0, 500)],
        offers=[offer(at_us, 1, ALL)],
        delivered=[given(at_us + 10, node, 1, 500, kind) for node in receivers],
        **plan,
    )


@pytest.mark.parametrize(("receivers", "partial"), [
    ((0, 2, 3, 4), False), ((0, 2, 2, 3, 4), False), ((0, 1, 2, 3, 4), False),
    ((0, 2, 2, 3), True), ((0, 1, 2, 3), True), ((), True),
])  # fmt: skip
def test_everybody_but_its_sender_has_to_have_it(receivers, partial):
    assert messages(broadcast(*receivers)).partial.tolist() == [partial]


@pytest.mark.parametrize(("action", "at_us", "partial"), [
    (KILL, AT - 1, False), (KILL, AT, False), (KILL, AT + WAIT, False), (KILL, AT + WAIT + 1, True),
    (RESTART, AT + 5, False), (RESTART, AT - 1, True), (CUT, AT + 5, True),
    (REVIVE, AT + 5, False), (REVIVE, AT - 1, True),
])  # fmt: skip
def test_only_who_is_on_all_the_time_is_missed(action, at_us, partial):
    faults = [fault(5 * S, KILL, 4)] * (action == REVIVE) + [fault(at_us, action, 4)]
    found = messages(broadcast(0, 2, 3, faults=faults))
    assert found.partial.tolist() == [partial]


def test_who_is_not_there_yet_is_not_missed():
    assert not messages(broadcast(0, 2, 3, absent=[0, 0, 0, 0, 1])).partial.any()
    assert not messages(broadcast(0, 2, 3, starts_us=[0, 0, 0, 0, AT + 1])).partial.any()


def test_what_is_no_such_message_or_cannot_be_judged_yet_is_not_partial():
    assert messages(broadcast(0, 2, 3, 4, kind=ALARM)).partial.all()  # an alarm of that number
    assert not messages(broadcast(0, ended_us=AT + WAIT - 1)).partial.any()
    assert messages(broadcast(0, ended_us=AT + WAIT)).partial.all()
    assert not messages(made(offers=[offer(AT, 1, ALL)])).partial.any()  # its sender was off
    alone = made(rows=[(AT, 1, REPORT_ACCEPTED, 0, 500)], offers=[offer(AT)])
    assert not messages(alone).partial.any()  # to one node


def test_each_broadcast_is_judged_by_itself():
    rows = [(AT + k * S, 1, REPORT_ACCEPTED, k, 500 + k) for k in range(3)]
    offers = [offer(AT, 1, ALL), offer(AT + S), offer(AT + 2 * S, 1, ALL)]
    came = [given(AT + 2 * S + 9, node, 1, 502) for node in (0, 2, 3, 4)]
    found = messages(made(rows=rows, offers=offers, delivered=[given(AT, 0, 1, 500), *came]))
    assert found.partial.tolist() == [True, False, False]
