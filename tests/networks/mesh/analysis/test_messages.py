"""Messages of made-up runs at the edges: of time, of numbers that come round, of each field."""

from dataclasses import replace

import pytest

from innervate.networks.mesh.analysis import messages
from innervate.networks.mesh.analysis.messages import (
    DELIVERED,
    IN_FLIGHT,
    LOST,
    REFUSED,
    SAME_US,
    UNASKED,
)  # fmt: skip
from innervate.networks.mesh.protocol.constants import (
    ALARM,
    ALL,
    DATA,
    NO_ACK,
    NO_ROOM,
    NO_ROUTE,
    PUT_OUT,
    REPORT_ACCEPTED,
    REPORT_EXPIRED,
    REPORT_FULL,
)  # fmt: skip
from innervate.networks.mesh.scenario.plan import Offer
from innervate.scenario.actions.field import (
    CUT,
    JAM,
    KILL,
    QUIET,
    RESTART,
    RESTORE,
    REVIVE,
)  # fmt: skip
from tests.networks.mesh.analysis.test_summary import S, fault, given, made, offer

END_US = 100 * S


def params(**changes):
    return made().plan.params | changes


def accepted(at_us, node=1, handle=0, seq=500):
    return (at_us, node, REPORT_ACCEPTED, handle, seq)


@pytest.mark.parametrize(
    ("changes", "wait_us"),
    [
        ({}, 1_500_000),  # sent at once, then five times more, each waited for
        ({"e2e_tries": 0, "e2e_us": 2_000_000}, 2_000_000),
        ({"e2e_us": 100_000}, 1_000_000),  # 0.6 s: no message is given up sooner than that
        ({"reliable": 0}, 1_000_000),
        ({"reliable": 0, "e2e_us": 90_000_000}, 1_000_000),
    ],
)
def test_a_message_can_be_on_its_way_until_its_last_try_is_given_up(changes, wait_us):
    for late, state, young in ((0, LOST, False), (1, IN_FLIGHT, True)):
        at_us = END_US - wait_us + late
        result = made(rows=[accepted(at_us)], offers=[offer(at_us)], params=params(**changes))
        assert messages.timeout_us(result.plan) == wait_us
        found = messages.messages(result)
        assert (found.state.tolist(), found.young.tolist()) == ([state], [young])


@pytest.mark.parametrize(("more", "state"), [
    ({}, IN_FLIGHT),
    ({"rows": [accepted(10 * S), (90 * S, 1, REPORT_EXPIRED, 0, NO_ACK)]}, LOST),
    ({"delivered": [given(60 * S, 4, 1, 500)]}, DELIVERED),
    ({"rows": []}, UNASKED),
    ({"rows": [(10 * S, 1, REPORT_FULL, 0, NO_ROOM)]}, REFUSED),
    ({"faults": [fault(50 * S, KILL, 1)]}, LOST), ({"faults": [fault(50 * S, RESTART, 1)]}, LOST),
    ({"faults": [fault(10 * S - 1, RESTART, 1)]}, IN_FLIGHT),
    ({"faults": [fault(50 * S, KILL, 2)]}, IN_FLIGHT),
    ({"faults": [fault(END_US, KILL, 1)]}, IN_FLIGHT),
    ({"offers": [replace(offer(10 * S), flags=0)]}, LOST),
])  # fmt: skip
def test_a_sender_that_waits_as_long_as_answers_take_keeps_a_message_longer(more, state):
    given_ = {"rows": [accepted(10 * S)], "offers": [offer(10 * S)]} | more
    result = made(**given_, params=params(e2e_adapt=1))
    found = messages.messages(result)
    assert (found.state.tolist(), found.young.tolist()) == ([state], [False])
    # It is as old as others that are known to be lost: it counts, as not delivered.
    assert len(messages.counted(found).state) == (state != UNASKED)


def test_offers_from_the_end_of_a_run_on_were_never_made():
    result = made(offers=[offer(END_US - 1), offer(END_US), offer(END_US + 1)])
    assert messages.messages(result).offered_us.tolist() == [END_US - 1]


@pytest.mark.parametrize(
    ("action", "copies"),
    [(REVIVE, 0), (RESTART, 0), (KILL, 1), (CUT, 1), (RESTORE, 1), (JAM, 1), (QUIET, 1)],
)
def test_only_who_is_switched_on_again_counts_from_anew(action, copies):
    twice = [given(10 * S, 4, 1, 7), given(11 * S, 4, 1, 7)]
    for at_us, node in ((10 * S + 500_000, 1), (11 * S, 1)):  # at that very moment, too
        found = made(delivered=twice, faults=[fault(at_us, action, node)])
        assert messages.duplicates(found) == copies
    for at_us, node in ((10 * S, 1), (11 * S + 1, 1), (10 * S + 500_000, 4)):
        found = made(delivered=twice, faults=[fault(at_us, action, node)])
        assert messages.duplicates(found) == 1


@pytest.mark.parametrize(("apart_us", "copies"), [(0, 1), (SAME_US - 1, 1), (SAME_US, 0)])
def test_the_same_number_a_minute_later_is_another_packet(apart_us, copies):
    twice = [given(10 * S, 4, 1, 7), given(10 * S + apart_us, 4, 1, 7)]
    assert messages.duplicates(made(delivered=twice)) == copies


@pytest.mark.parametrize(
    "other", [given(11 * S, 3, 1, 7), given(11 * S, 4, 2, 7), given(11 * S, 4, 1, 8),
              given(11 * S, 4, 1, 7, ALARM)],
    ids=["receiver", "origin", "number", "type"],
)  # fmt: skip
def test_a_copy_is_the_same_in_all_that_names_a_packet(other):
    assert messages.duplicates(made(delivered=[given(10 * S, 4, 1, 7), other])) == 0
    three = [given(10 * S, 4, 1, 7), other, given(12 * S, 4, 1, 7), given(13 * S, 4, 1, 7)]
    assert messages.duplicates(made(delivered=three)) == 2


def test_a_run_that_delivered_nothing_delivered_nothing_twice():
    assert messages.duplicates(made()) == 0


def states(rows, offers, **more):
    return messages.messages(made(rows=rows, offers=offers, **more)).state.tolist()


def test_each_end_of_a_message_has_its_state():
    rows = [
        accepted(10 * S), (12 * S, 1, REPORT_EXPIRED, 0, NO_ACK),
        accepted(99 * S + 1, 1, 1, 501),
        accepted(99 * S + 2, 1, 2, 502), (99 * S + 9, 1, REPORT_EXPIRED, 2, NO_ROUTE),
        (99 * S + 3, 1, REPORT_FULL, 3, NO_ROOM),
        accepted(99 * S + 5, 2, 5, 9),
    ]  # fmt: skip
    offers = [offer(10 * S), *(offer(99 * S + k) for k in (1, 2, 3, 4)), offer(99 * S + 5, 2)]
    came = [given(99 * S + 90, 4, 2, 9)]
    assert states(rows, offers, delivered=came) == [
        LOST, IN_FLIGHT, LOST, REFUSED, UNASKED, DELIVERED]  # fmt: skip
    found = messages.messages(made(rows=rows, offers=offers, delivered=came))
    assert found.receiver.tolist() == [-1] * 5 + [4]
    # While some are on their way those as young do not count, nor who was off.
    assert messages.counted(found).offered_us.tolist() == [10 * S]
    assert messages.latencies_us(found).tolist() == [85]


def test_numbers_of_offers_come_round_after_65536():
    count, gap = messages.HANDLES, 1000
    offers = [Offer(k * gap, 2, 4, 0, 8, 0) for k in range(count + 2)]
    end = (count + 2) * gap
    rows = [accepted(k * gap, 2, k % count, k % 50_000) for k in (0, 1, count, count + 1)]
    rows.append((end - 10, 2, REPORT_EXPIRED, 0, NO_ACK))  # the newest 0: offer 65536
    found = messages.messages(made(rows=rows, offers=offers, ended_us=end))
    picked = [0, 1, 2, count - 1, count, count + 1]
    assert found.seq[picked].tolist() == [0, 1, -1, -1, count % 50_000, (count + 1) % 50_000]
    assert found.state[picked].tolist() == [LOST, LOST, UNASKED, UNASKED, LOST, IN_FLIGHT]


def test_what_is_given_up_at_the_moment_it_was_offered_is_lost():
    rows = [accepted(END_US - 9), (END_US - 9, 1, REPORT_EXPIRED, 0, NO_ROUTE)]
    assert states(rows, [offer(END_US - 9)]) == [LOST]


def test_what_was_given_up_before_the_first_offer_is_nobodys():
    early = (5 * S, 1, REPORT_EXPIRED, 0, NO_ACK)
    late = END_US - 10
    assert states([early, accepted(late)], [offer(late)]) == [IN_FLIGHT]


def test_a_delivery_is_of_the_newest_offer_with_its_number_before_it():
    rows = [accepted(10 * S, seq=7), accepted(20 * S, handle=1, seq=7),
            accepted(15 * S, 2, 2, 7)]  # fmt: skip
    offers = [offer(10 * S), offer(20 * S), offer(15 * S, 2)]
    came = [given(20 * S, 4, 1, 7, hops=5), given(30 * S, 4, 1, 7, hops=6)]
    found = messages.messages(made(rows=rows, offers=offers, delivered=came))
    assert found.delivered_us.tolist() == [-1, 20 * S, -1]
    assert found.hops.tolist() == [-1, 5, -1]
    early = made(rows=rows, offers=offers, delivered=[given(10 * S - 1, 4, 1, 7)])
    assert messages.messages(early).delivered_us.tolist() == [-1, -1, -1]


def test_what_a_node_sends_to_itself_is_delivered_at_once_and_to_nobody_else():
    offers = [offer(10 * S, 4), offer(11 * S, 3)]
    came = [given(10 * S, 4, 4, 0, hops=0), given(11 * S, 4, 4, 0, hops=0)]
    found = messages.messages(made(offers=offers, delivered=came))
    assert found.state.tolist() == [DELIVERED, UNASKED]


def test_broadcasts_are_no_part_of_ratios_and_latencies():
    rows = [accepted(10 * S), accepted(11 * S, 1, 1, 501)]
    offers = [offer(10 * S), offer(11 * S, 1, ALL)]
    found = messages.messages(
        made(rows=rows, offers=offers,
             delivered=[given(12 * S, 4, 1, 500), given(19 * S, 3, 1, 501)])
    )  # fmt: skip
    assert found.broadcast.tolist() == [False, True]
    assert messages.delivery_ratio(found) == 1.0
    assert messages.latencies_us(found).tolist() == [2 * S]
    assert messages.delivery_ratio(found.only(found.broadcast)) is None


def test_the_first_message_of_each_sender_after_a_time():
    rows = [accepted(k * S, node, k, 500 + k) for k, node in ((10, 1), (20, 1), (21, 2), (22, 1))]
    offers = [offer(k * S, node) for k, node in ((10, 1), (20, 1), (21, 2), (22, 1))]
    for handle, row in enumerate(rows):
        rows[handle] = (*row[:3], handle, row[4])
    found = messages.messages(made(rows=rows, offers=offers))
    assert messages.first_after(found, 20 * S).offered_us.tolist() == [20 * S, 21 * S]
    assert messages.first_after(found, 20 * S + 1).offered_us.tolist() == [21 * S, 22 * S]


def test_reasons_of_those_given_up_and_refused_are_counted():
    why = (NO_ROUTE, NO_ACK, NO_ACK, PUT_OUT, 99)
    rows = [(k * S, 1, REPORT_EXPIRED, k, reason) for k, reason in enumerate(why)]
    rows += [(9 * S, 1, REPORT_FULL, 9, NO_ROOM), (9 * S, 1, REPORT_ACCEPTED, 9, NO_ACK)]
    assert messages.give_ups(made(rows=rows)) == {
        "no_route": 1, "no_ack": 2, "put_out": 1, "no_room": 1, "reason_99": 1}  # fmt: skip


def test_shares_and_deaths():
    assert messages.ratio(1, 4) == 0.25
    assert messages.ratio(0, 0) is None
    happened = [fault(3 * S, KILL, 1), fault(4 * S, RESTART, 2), fault(5 * S, KILL, 2)]
    assert messages.deaths_us(made(faults=happened).plan, END_US) == [3 * S, 5 * S]


def test_deliveries_of_other_types_are_no_messages():
    rows, offers = [accepted(10 * S)], [offer(10 * S)]
    for kind, state in ((ALARM, LOST), (DATA, DELIVERED)):
        assert states(rows, offers, delivered=[given(11 * S, 4, 1, 500, kind)]) == [state]


def took_effect(*faults, absent=(), ended_us=END_US):
    result = made(faults=[fault(*one) for one in faults])
    result.plan.absent = [int(node in absent) for node in range(result.plan.nodes)]
    found = messages.took_effect(result.plan, ended_us)
    return [(one.at_us // S, one.action) for one in found]


def test_what_changes_nothing_has_not_happened():
    dies = [(S, KILL, 1), (2 * S, KILL, 1), (3 * S, KILL, 2)]
    assert took_effect(*dies) == [(1, KILL), (3, KILL)]
    assert took_effect((S, REVIVE, 1), (2 * S, KILL, 1), (3 * S, REVIVE, 1)) == [
        (2, KILL), (3, REVIVE),
    ]  # fmt: skip
    assert took_effect((S, REVIVE, 1), (2 * S, REVIVE, 1), absent=[1]) == [(1, REVIVE)]
    assert took_effect((S, RESTART, 1), (2 * S, RESTART, 1)) == [(1, RESTART), (2, RESTART)]
    assert took_effect((S, KILL, 1), (2 * S, RESTART, 1), (3 * S, KILL, 1))[-1] == (3, KILL)
    cuts = [(S, RESTORE, 1, 2), (2 * S, CUT, 1, 2), (3 * S, CUT, 2, 1), (4 * S, CUT, 1, 3),
            (5 * S, RESTORE, 2, 1), (6 * S, RESTORE, 1, 2)]  # fmt: skip
    assert took_effect(*cuts) == [(2, CUT), (4, CUT), (5, RESTORE)]
    assert took_effect((S, JAM, 1), (2 * S, JAM, 1), (3 * S, QUIET, 1)) == [
        (1, JAM), (2, JAM), (3, QUIET),
    ]  # fmt: skip


def test_what_was_to_happen_after_the_end_has_not_happened():
    dies = [(S, KILL, 1), (5 * S, KILL, 2)]
    assert took_effect(*dies, ended_us=5 * S + 1) == [(1, KILL), (5, KILL)]
    assert took_effect(*dies, ended_us=5 * S) == [(1, KILL)]
    plan = made(faults=[fault(*one) for one in dies]).plan
    assert messages.deaths_us(plan, END_US) == [S, 5 * S]
    assert messages.deaths_us(plan, S) == []


def test_who_was_handed_what_when_is_in_order_of_time_then_node_then_handle():
    places = [(0, 0, 0), (0, 0, 65_535), (0, 1, 0), (0, 255, 65_535), (1, 0, 0), (1 << 37, 3, 4)]
    keys = [int(messages._key(*place)) for place in places]
    assert keys == sorted(set(keys))
