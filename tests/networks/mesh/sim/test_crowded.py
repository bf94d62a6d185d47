"""A mesh with more to send than goes: nobody makes it worse, and what can be delivered is."""

import pytest

from innervate.networks.mesh.protocol.backoff import (
    DROWNED_TRIES,
    STRAIN_FREE,
    STRAIN_HEAVY,
    STRAIN_MAX,
    is_drowned,
    is_held,
)
from innervate.networks.mesh.protocol.constants import (
    ACK,
    ALARM,
    ALARMS,
    CONTROL,
    DATA,
    DETOURED,
    E2E_ACK,
    END_TO_END,
    MESSAGES,
    NO_ACK,
    NO_ROOM,
    REPORT_ARRIVED,
    REPORT_EXPIRED,
    REPORT_FULL,
    REPORT_SUSPECT,
    REQUEST,
    RESPONSE,
    TABLE,
    TABLE_ACK,
    TABLES,
    WHOLE_GRAPH,
)
from innervate.networks.mesh.protocol.duplicates import (
    ANEW,
    UNREACHABLE,
    accept,
    clear_bad,
    forgive,
    is_bad,
    is_unreachable,
    mark_bad,
)
from innervate.networks.mesh.protocol.neighbours import DOUBT, SILENT, SUSPECT
from innervate.networks.mesh.protocol.retransmission import SEARCH_BACKOFF_MAX
from innervate.networks.mesh.protocol.send import most_tries
from tests.networks.mesh.bench import Bench

SETTLED = 5_000_000
LINE = [(0, 1), (1, 2)]
STAR = [(0, k) for k in range(1, 9)]


def settled(count, links, **settings):
    bench = Bench(count, links, **settings)
    bench.run(SETTLED)
    return bench


def on_a_full_channel(bench, until):
    """Everybody is heard, nobody answers node 0."""
    bench.lost = lambda frame, to: 0 in (frame.link_src, to)
    while bench.now < until:
        bench.nodes[0].heard = [bench.nodes[0].ticks] * 32
        bench.nodes[0].suspect = [k & SUSPECT for k in bench.nodes[0].suspect]
        bench.run(bench.now + 100_000)


def data_of(bench, node, since=SETTLED):
    return [at for at, i, f in bench.sent if i == node and f.kind == DATA and at >= since]


def without_acks_to(node):
    """A line on which node 0 has sent a message to node 2, and one node heard no acks of hops."""
    bench = settled(3, LINE)
    bench.lost = lambda frame, to: frame.kind == ACK and to == node
    bench.send(0, 2)
    bench.run(SETTLED + 200_000)
    return bench


def test_who_hears_its_packet_passed_on_needs_no_ack():
    bench = without_acks_to(0)
    assert len(data_of(bench, 0)) == 1
    assert not [row for row in bench.of(REPORT_SUSPECT) if row[1] == 0]
    assert len(bench.of(REPORT_ARRIVED)) == 1


def test_an_end_to_end_ack_that_passes_by_spares_the_last_hop():
    bench = without_acks_to(1)
    assert len(data_of(bench, 1)) == 1
    assert [f.kind for at, i, f in bench.sent if i == 2 and at >= SETTLED and f.kind != ACK] == [
        E2E_ACK
    ]


def test_who_is_never_answered_sends_less_and_less():
    bench = settled(9, STAR)
    for k in range(1, 9):
        bench.send(0, k, handle=k)
    on_a_full_channel(bench, SETTLED + 8_000_000)
    times = data_of(bench, 0)
    early = sum(at < SETTLED + 500_000 for at in times)
    late = sum(at >= SETTLED + 7_500_000 for at in times)
    assert bench.nodes[0].strain == STRAIN_MAX
    assert early > 3 * late, (early, late)


def test_strain_goes_when_answers_come():
    bench = settled(9, STAR)
    for k in range(1, 9):
        bench.send(0, k)
    on_a_full_channel(bench, SETTLED + 12_000_000)
    bench.lost = lambda frame, to: False
    before = bench.nodes[0].strain
    for _ in range(60):
        bench.send(0, 3)
        bench.run(bench.now + 200_000)
    assert bench.nodes[0].strain < before


def test_neighbours_that_are_silent_do_not_make_us_pause():
    bench = settled(9, STAR)
    bench.run(SETTLED + 3_000_000)
    bench.dead = set(range(1, 9))
    bench.send(0, 3)
    bench.run(SETTLED + 11_000_000)
    assert bench.nodes[0].strain == 0
    assert sum(k & DOUBT > 0 for k in bench.nodes[0].suspect) == 8


def test_who_did_not_answer_and_was_not_heard_since_is_tried_once():
    bench = settled(3, LINE)
    bench.dead = {1}
    bench.send(0, 1, flags=0)
    bench.run(SETTLED + 11_000_000)  # the suspicion has ended, the doubt has not
    assert len(data_of(bench, 0)) == 3
    bench.send(0, 1, flags=0)
    bench.run(bench.now + 1_000_000)
    assert len(data_of(bench, 0)) == 4


def test_tables_and_their_acks_are_tried_in_full_whoever_was_silent():
    bench = settled(3, LINE)
    node = bench.nodes[1]
    k = node.neighbour.index(0)
    node.suspect[k] = DOUBT
    for kind in (TABLE_ACK, TABLE):
        assert most_tries_of(node, bench.params, k, kind) == 3
    for kind in (DATA, RESPONSE):
        assert most_tries_of(node, bench.params, k, kind) == 1
    node.suspect[k] = 0
    for kind in (DATA, RESPONSE):
        assert most_tries_of(node, bench.params, k, kind) == 3
    node.suspect[bench.params.places - 1] = DOUBT
    assert most_tries_of(node, bench.params, -1, DATA) == 3, "who is in the table no more"


def most_tries_of(node, params, k, kind):
    node.q_kind[0] = kind
    return most_tries(node, params, 0, k)


@pytest.mark.parametrize(("mode", "left_out", "kept"), [(TABLES, 1, 1), (TABLES, 0, 0),
                                                        (WHOLE_GRAPH, 1, 0)])  # fmt: skip
def test_new_tables_give_hope_for_whom_they_know(mode, left_out, kept):
    bench = settled(3, LINE, mode=mode)
    node = bench.nodes[0]
    node.next[node.bank * bench.params.width + 2] = 255 if left_out else 1
    mark_bad(node, UNREACHABLE, 2)
    clear_bad(node, bench.params)
    assert is_unreachable(node, 2) == kept


def test_who_brings_something_from_there_is_asked_first_again():
    """Behind a bridge there is no other way: the near side was searched, and the packet given up.

    Node 0 has what is for 5 given back once by 1, the bridge, whose acks got lost.
    """
    clump = [(a, b) for a in (0, 6, 7, 8) for b in (6, 7, 8) if a < b]
    bench = settled(9, [(0, 1), (1, 2), (2, 3), (3, 4), (4, 5), *clump])
    mark_bad(bench.nodes[0], 1, 5)
    bench.send(5, 0)
    bench.run(bench.now + 50_000)
    bench.sent.clear()
    bench.send(0, 5)
    bench.run(bench.now + 50_000)
    first = [f.link_dst for _, i, f in bench.sent if i == 0 and f.kind == DATA]
    assert first == [1]


def test_after_some_ticks_who_gave_packets_back_is_asked_first_again():
    bench = settled(3, LINE)
    mark_bad(bench.nodes[0], 1, 2)
    round = bench.nodes[0].round
    bench.run(bench.now + 4_500_000)
    assert (bench.nodes[0].round, is_bad(bench.nodes[0], 1, 2)) == (round, 0)


def test_a_new_round_asks_again_who_gave_packets_back_but_not_for_whom_nobody_reaches():
    """Else, where links lose much and no table changes, ever more good neighbours came last."""
    bench = settled(3, LINE)
    node = bench.nodes[0]
    mark_bad(node, 1, 2)
    mark_bad(node, UNREACHABLE, 2)
    round = node.round
    bench.run(bench.now + 1_000_000)
    assert (node.round, is_bad(node, 1, 2)) == (round, 1)
    bench.run(bench.now + 20_000_000)
    assert node.round != round
    assert is_bad(node, 1, 2) == 0


@pytest.mark.parametrize("who", [1, UNREACHABLE])
def test_forgiven_is_who_is_somebody(who):
    node = settled(3, LINE).nodes[0]
    mark_bad(node, who, 2)
    forgive(node)
    assert is_bad(node, who, 2) == (who == UNREACHABLE)


def test_despair_fades_once_there_is_nobody_to_despair_of():
    bench = settled(4, [(0, 1), (1, 2), (1, 3)], told=1)
    bench.dead = {3}
    for _ in range(40):
        bench.send(0, 3)
        bench.run(bench.now + 2_000_000)
    assert bench.nodes[0].search_backoff == SEARCH_BACKOFF_MAX
    bench.run(bench.now + 130_000_000)
    assert bench.nodes[0].search_backoff == 0


def test_a_message_to_all_comes_once_however_many_are_on_their_way():
    bench = settled(3, LINE)
    old = [f for _, _, f in bench.sent]
    bench.send(0, 255, text=b"old")
    bench.run(bench.now + 500_000)
    (first,) = [f for _, i, f in bench.sent[len(old) :] if i == 0 and f.kind == DATA][:1]
    for k in range(70):
        bench.send(0, 255, text=bytes([k]))
        bench.run(bench.now + 50_000)
    bench.push(bench.now + 1, ("frame", 1, first))  # a late copy
    bench.run(bench.now + 500_000)
    came = [bytes(f.body[: f.length]) for _, i, f in bench.delivered if i == 2]
    assert came == [b"old"] + [bytes([k]) for k in range(70)]


def test_messages_for_somebody_dead_leave_room_for_others():
    bench = settled(4, [(0, 1), (1, 2), (1, 3)])
    bench.dead = {3}
    for handle in range(12):
        bench.send(0, 3, handle=handle)
        bench.run(bench.now + 300_000)
    bench.send(0, 2, handle=99)
    bench.run(bench.now + 1_000_000)
    assert not [row for row in bench.of(REPORT_FULL) if row[3] == 99]
    assert [row[3] for row in bench.of(REPORT_ARRIVED)] == [99]


def test_a_message_without_room_in_the_queue_waits_and_arrives():
    bench = settled(2, [(0, 1)], told=1)
    for handle in range(8):
        bench.send(0, 1, handle=handle)  # none has left when the next one comes
    assert not bench.of(REPORT_FULL)
    bench.send(0, 1, handle=8)
    assert [(row[3], row[4]) for row in bench.of(REPORT_FULL)] == [(8, NO_ROOM)]
    bench.run(SETTLED + 2_000_000)
    assert sorted(row[3] for row in bench.of(REPORT_ARRIVED)) == list(range(8))
    assert len([f for _, i, f in bench.delivered if i == 1 and f.kind == DATA]) == 8


def test_a_kept_message_ends_while_its_recipient_still_knows_that_it_had_it():
    bench = settled(2, [(0, 1)])
    bench.lost = lambda frame, to: frame.kind in (ACK, E2E_ACK)
    for handle in range(4):
        bench.send(0, 1, handle=handle)
    bench.run(SETTLED + 60_000_000)
    ends = bench.of(REPORT_EXPIRED)
    assert sorted((row[3], row[4]) for row in ends) == [(h, NO_ACK) for h in range(4)]
    assert max(data_of(bench, 0)) - SETTLED < bench.params.forget * bench.params.tick_us / 2
    assert len([f for _, i, f in bench.delivered if i == 1 and f.kind == DATA]) == 4


def test_copies_that_lost_their_way_are_not_a_new_start():
    bench = settled(2, [(0, 1)])
    node, params = bench.nodes[1], bench.params
    node.idle[0] = 0
    assert accept(node, params, 0, 1000, 1)
    assert accept(node, params, 0, 1000 + ANEW - 1, 0)
    assert not accept(node, params, 0, 1000, 1)  # the copy of the first says FIRST, too
    assert accept(node, params, 0, 1000 - ANEW, 1)  # an origin that started anew


HELD = [  # strain, rank, kind, flags -> held in a pause
    (STRAIN_MAX, ALARMS, ALARM, DETOURED, 0),
    (STRAIN_MAX, ALARMS, E2E_ACK, 0, 0),
    (STRAIN_MAX, CONTROL, REQUEST, 0, 0),
    (STRAIN_MAX, CONTROL, TABLE, 0, 0),
    (STRAIN_MAX, CONTROL, E2E_ACK, 0, 1),
    (STRAIN_MAX, MESSAGES, DATA, 0, 1),
    (STRAIN_HEAVY, MESSAGES, DATA, 0, 0),
    (STRAIN_HEAVY, MESSAGES, DATA, DETOURED, 1),
    (STRAIN_HEAVY, CONTROL, E2E_ACK, DETOURED, 0),
]


@pytest.mark.parametrize(("strain", "rank", "kind", "flags", "held"), HELD)
def test_what_pauses(strain, rank, kind, flags, held):
    node = settled(2, [(0, 1)]).nodes[0]
    node.strain, node.q_rank[0], node.q_kind[0], node.q_flags[0] = strain, rank, kind, flags
    assert is_held(node, 0) == held


SOUGHT = END_TO_END | DETOURED
DROWNED = [  # strain, suspect, tries, kind, flags -> the search ends here
    (STRAIN_FREE + 1, 0, DROWNED_TRIES, DATA, SOUGHT, 1),
    (STRAIN_FREE + 1, 0, DROWNED_TRIES, E2E_ACK, DETOURED, 1),
    (STRAIN_FREE, 0, DROWNED_TRIES, DATA, SOUGHT, 0),
    (STRAIN_FREE + 1, 0, DROWNED_TRIES - 1, DATA, SOUGHT, 0),
    (STRAIN_FREE + 1, SILENT, DROWNED_TRIES, DATA, SOUGHT, 0),
    (
        STRAIN_FREE + 1,
        DOUBT,
        DROWNED_TRIES,
        DATA,
        SOUGHT,
        1,
    ),  # it failed before, and was heard since
    (STRAIN_FREE + 1, 0, DROWNED_TRIES, DATA, END_TO_END, 0),
    (STRAIN_FREE + 1, 0, DROWNED_TRIES, DATA, DETOURED, 0),  # nobody sends it again
    (STRAIN_FREE + 1, 0, DROWNED_TRIES, E2E_ACK, 0, 0),
    (STRAIN_FREE + 1, 0, DROWNED_TRIES, ALARM, SOUGHT, 0),
    (STRAIN_FREE + 1, 0, DROWNED_TRIES, RESPONSE, SOUGHT, 0),
    (STRAIN_FREE + 1, 0, DROWNED_TRIES, TABLE, SOUGHT, 0),
]


@pytest.mark.parametrize(("strain", "suspect", "tries", "kind", "flags", "drowned"), DROWNED)
def test_what_drowns(strain, suspect, tries, kind, flags, drowned):
    node = settled(2, [(0, 1)]).nodes[0]
    node.suspect[0], node.q_tries[0] = suspect, tries
    node.strain, node.q_kind[0], node.q_flags[0] = strain, kind, flags
    assert is_drowned(node, 0, 0) == drowned
    assert not is_drowned(node, 0, -1), "of who is in the table no more nothing is known"


@pytest.mark.parametrize("heard", [True, False])
def test_a_search_in_a_full_channel_ends_at_who_lives_and_goes_round_who_does_not(heard):
    """What node 1 does not acknowledge another gets; if that is silent, too, all others."""
    bench = settled(9, STAR, transmissions=DROWNED_TRIES)
    node = bench.nodes[0]
    bench.lost = lambda frame, to: 0 in (frame.link_src, to)
    node.strain = STRAIN_MAX - 1
    bench.send(0, 1)
    while not bench.of(REPORT_EXPIRED):
        if heard:
            node.suspect = [k & ~SILENT for k in node.suspect]
        bench.run(bench.now + 1_000)
    asked = {f.link_dst for _, i, f in bench.sent if i == 0 and f.kind == DATA}
    assert 1 in asked
    assert len(asked) == (2 if heard else 8)
