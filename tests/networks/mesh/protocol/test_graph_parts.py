"""The whole graph in more parts than a queue has places: all of it comes, and what is missed."""

from itertools import pairwise

import pytest

from innervate.networks.mesh.protocol.constants import (
    ALL,
    CRC_BYTES,
    CURRENT,
    GIVEN_UP,
    GRAPH,
    HEADER_BYTES,
    REPORT_TABLE,
    REPORT_TABLES,
    TABLE_ACK,
    TO_SEND,
    UNDER_WAY,
    WHOLE_GRAPH,
)
from innervate.networks.mesh.protocol.fields import QUEUE
from innervate.networks.mesh.protocol.frames import get16
from innervate.networks.mesh.protocol.graph_jobs import TOLD, pump_graph
from innervate.networks.mesh.protocol.jobs import give_jobs, note_lost_table, on_ack
from innervate.networks.mesh.protocol.queue import kick
from innervate.networks.mesh.protocol.table import (
    PART_HEAD,
    all_parts,
    graph_bytes,
    on_graph,
    part_bytes,
)
from tests.networks.mesh.bench import Bench, Frame

LINE = [(0, 1), (1, 2)]
SETTLED = 9_000_000
GIVES_UP = 40_000_000  # by then it has asked in vain as often as it does
COUNT = 12  # parts of the graph, of eight bytes each
WHOLE = all_parts(COUNT)


def bench_of(part, **settings):
    """Three nodes that speak of a graph of 32, `part` bytes of it in a frame."""
    mtu = HEADER_BYTES + CRC_BYTES + 1 + PART_HEAD + part
    return Bench(3, LINE, mode=WHOLE_GRAPH, nodes=32, mtu=mtu, **settings)


def parts_by(bench, node, since=0):
    """Numbers of the parts that a node sent, copies left out, by the packet's number."""
    sent = {f.seq: f.body[3] >> 4 for at, i, f in bench.sent
            if i == node and f.kind == GRAPH and at >= since}  # fmt: skip
    return list(sent.values())


def answers_of(bench, node, since=0):
    return len({f.seq for at, i, f in bench.sent
                if f.kind == TABLE_ACK and f.origin == node and at >= since})  # fmt: skip


@pytest.mark.parametrize("part", [7, 8, 10, 12, 30])
def test_all_parts_are_flooded_once_however_many(part):
    bench = bench_of(part)
    count = -(-graph_bytes(bench.params) // part_bytes(bench.params))
    assert (count > QUEUE) == (part < 12)
    bench.run(SETTLED)
    assert parts_by(bench, 0) == list(range(count))
    assert sorted({i for _, i, *_ in bench.of(REPORT_TABLE)}) == [0, 1, 2]
    assert [row[-1] for row in bench.of(REPORT_TABLES)] == [0], "nobody was given up"
    assert [answers_of(bench, node) for node in (1, 2)] == [1, 1]


def missing(*parts, to=2, floods=1):
    """What loses these parts on their way to a node in the first floods of each."""
    lost = {}

    def is_lost(frame, at):
        if frame.kind != GRAPH or at != to or frame.body[3] >> 4 not in parts:
            return False
        of_part = lost.setdefault(frame.body[3] >> 4, {})
        return of_part.setdefault(frame.seq, len(of_part)) < floods

    return is_lost


def names_in(bench):
    """Whom each question names, by the gateway; a question is behind the last of 12 parts."""
    asked = {f.seq: list(f.body[PART_HEAD : f.length]) for _, i, f in bench.sent
             if i == 0 and f.kind == GRAPH and f.body[3] >> 4 == COUNT}  # fmt: skip
    return list(asked.values())


def told_by(bench, node):
    """Which parts a node said it has, once for each answer."""
    return list({f.seq: get16(f, 3) for _, i, f in bench.sent
                 if i == node and f.kind == TABLE_ACK and f.origin == node}.values())  # fmt: skip


def test_who_told_nothing_is_asked_by_name_and_no_part_comes_again():
    bench = bench_of(8, period=60)
    bench.lost = lambda frame, to: frame.kind == TABLE_ACK and frame.origin == 2
    bench.run(GIVES_UP)
    tries = bench.params.job_tries
    assert parts_by(bench, 0) == [*range(COUNT), *[COUNT] * tries]
    assert names_in(bench) == [[2]] * tries
    assert parts_by(bench, 1) == parts_by(bench, 0), "and passed on"
    assert told_by(bench, 1) == [WHOLE], "whom nobody asks says no more"
    assert told_by(bench, 2) == [WHOLE] * (1 + tries)
    assert bench.gates[0].job[2] == GIVEN_UP


def test_the_few_that_are_asked_answer_sooner_than_all():
    bench = bench_of(8, period=60, job_tries=8)
    bench.lost = lambda frame, to: frame.kind == TABLE_ACK and frame.origin == 2
    bench.run(2 * GIVES_UP)
    asked = {f.seq: at for at, i, f in bench.sent if i == 1 and f.kind == GRAPH
             and f.body[3] >> 4 == COUNT}  # fmt: skip
    said = [at for at, i, f in bench.sent if i == 2 and f.kind == TABLE_ACK and f.origin == 2]
    waits = [min(at - when for at in said if at > when) for when in asked.values()]
    assert len(waits) >= 8
    assert max(waits) < bench.params.spread_us + 10_000


def test_the_missing_parts_alone_come_again():
    """Who hears the last part says which it has, and once more when it has all."""
    bench = bench_of(8, period=60)
    bench.lost = missing(0, 5)
    bench.run(GIVES_UP)
    assert parts_by(bench, 0) == [*range(COUNT), 0, 5]
    assert told_by(bench, 2) == [WHOLE & ~(1 << 0 | 1 << 5), WHOLE]
    assert answers_of(bench, 1) == 1
    assert bench.gates[0].job[2] == CURRENT
    assert bench.nodes[2].version == bench.gates[0].version


def test_who_missed_the_last_part_is_asked_and_tells_what_it_has():
    bench = bench_of(8, period=60)
    bench.lost = missing(3, COUNT - 1)
    bench.run(GIVES_UP)
    assert parts_by(bench, 0) == [*range(COUNT), COUNT, 3, COUNT - 1]
    assert names_in(bench) == [[2]]
    assert told_by(bench, 2) == [WHOLE & ~(1 << 3 | 1 << COUNT - 1), WHOLE]
    assert bench.gates[0].job[2] == CURRENT


def test_what_a_node_told_is_as_old_as_the_flood_after_it():
    """Whose parts were sent once more, and who did not say it has them, is asked."""
    bench = bench_of(8, period=60)
    bench.lost = missing(3, floods=2)
    bench.run(GIVES_UP)
    assert parts_by(bench, 0) == [*range(COUNT), 3, COUNT, 3]
    assert told_by(bench, 2) == [WHOLE & ~(1 << 3)] * 2 + [WHOLE]


def test_who_lost_its_graph_is_sent_all_of_it():
    bench = bench_of(8, period=60)
    bench.run(SETTLED)
    bench.sent.clear()
    bench.start(2, cause=1)
    bench.run(2 * SETTLED)
    assert parts_by(bench, 0) == list(range(COUNT))
    assert told_by(bench, 1) == []
    assert told_by(bench, 2) == [WHOLE]
    assert bench.nodes[2].version == bench.gates[0].version


def test_who_was_given_up_and_has_no_graph_is_sent_all_of_it():
    bench = bench_of(8, period=60)
    bench.lost = lambda frame, to: frame.kind == TABLE_ACK and frame.origin == 2
    bench.run(GIVES_UP)
    assert bench.gates[0].job[2] == GIVEN_UP
    bench.lost = lambda frame, to: False
    bench.sent.clear()
    bench.start(2, cause=1)
    bench.run(GIVES_UP + SETTLED)
    assert parts_by(bench, 0) == list(range(COUNT))
    assert bench.gates[0].job[2] == CURRENT


def settled():
    """A gateway whose nodes have its graph, and that gate."""
    bench = bench_of(8, period=60)
    bench.run(SETTLED)
    bench.sent.clear()
    return bench, bench.gates[0]


def flooded_by(bench, gate):
    """Parts that the gateway floods now, and whom it asks."""
    pump_graph(bench.nodes[0], gate, bench.params, bench.now, bench.out)
    kick(bench.nodes[0], bench.params, bench.now, bench.out)
    bench.drain(0)
    bench.run(bench.now + 1_000_000)
    return parts_by(bench, 0), names_in(bench)


@pytest.mark.parametrize(("kept", "sent"), [(TOLD | WHOLE & ~2, [1]), (TOLD - 1, [COUNT])])
def test_what_is_known_of_a_node_stays_known_when_it_has_its_turn_again(kept, sent):
    bench, gate = settled()
    gate.job[2], gate.job_parts[2], gate.mark_a[2] = GIVEN_UP, kept, 0
    give_jobs(bench.nodes[0], gate, bench.params, 0, bench.out)
    assert flooded_by(bench, gate)[0] == sent


def test_of_a_table_nothing_is_known_when_it_is_sent_anew():
    """A table may be the same, and its version another: then the node begins anew with it."""
    bench = Bench(3, LINE)
    bench.run(SETTLED)
    gate = bench.gates[0]
    gate.job[2], gate.mark_a[2], gate.job_parts[2] = GIVEN_UP, 0, TOLD - 1
    give_jobs(bench.nodes[0], gate, bench.params, 0, bench.out)
    assert gate.job[2] == TO_SEND
    assert gate.job_parts[2] & TOLD - 1 == 0


def test_what_a_node_has_is_what_it_says_now():
    """Who was started anew has no longer what it had told before."""
    bench, gate = settled()
    gate.job[1:3], gate.job_parts[1:3] = [UNDER_WAY] * 2, [TOLD - 1, TOLD | 6]
    gate.job_next[1:3], gate.job_due[1:3] = [1] * 2, [bench.now + SETTLED] * 2
    frame = Frame()
    frame.kind, frame.origin, frame.length = TABLE_ACK, 2, 5
    frame.body[:5] = [bench.nodes[0].epoch, gate.version >> 8, gate.version & 255, 0, 9]
    on_ack(bench.nodes[0], gate, bench.params, bench.now, frame, bench.out)
    assert gate.job_parts[2] == TOLD | 9
    assert gate.job_next[2] == 1, "a flood does not begin before all have told"
    assert gate.job[2] == UNDER_WAY
    assert not any(bench.nodes[0].q_state)


def test_as_soon_as_all_have_told_what_is_missing_comes():
    bench = bench_of(8, period=60)
    bench.lost = missing(3, COUNT - 1)
    bench.run(GIVES_UP)
    told = next(at for at, i, f in bench.sent if f.kind == TABLE_ACK and i == 1 and f.origin == 2)
    again = max(at for at, i, f in bench.sent if i == 0 and f.kind == GRAPH and f.body[3] >> 4 == 3)
    copies = bench.params.copies * (bench.params.jitter_us + 10_000)
    assert 0 < again - told < copies


@pytest.mark.parametrize("state", [TO_SEND, UNDER_WAY])
def test_who_has_no_graph_yet_still_acknowledges_the_one_on_its_way(state):
    _, gate = settled()
    gate.job[2], before = state, gate.job_a[2]
    note_lost_table(gate, 2)
    assert gate.job[2] == state
    assert gate.job_a[2] == before != 0


def test_a_question_names_as_many_as_there_is_room_for():
    bench, gate = settled()
    for s in range(16, 32):
        gate.job[s], gate.job_parts[s], gate.job_next[s] = UNDER_WAY, TOLD - 1, 0
    assert flooded_by(bench, gate)[1] == [list(range(16, 24))], "as long as a part"
    assert {f.length + 1 + HEADER_BYTES + CRC_BYTES for _, i, f in bench.sent
            if i == 0 and f.kind == GRAPH} == {bench.params.mtu}  # fmt: skip


@pytest.mark.parametrize(("first", "sent"), [(16, [COUNT]), (15, [*range(QUEUE)])])
def test_where_more_than_half_told_nothing_all_parts_come_again(first, sent):
    """What was lost beside the gateway everybody misses: to ask all first would take longer."""
    bench, gate = settled()
    for s in range(first, 32):
        gate.job[s], gate.job_parts[s], gate.job_next[s] = UNDER_WAY, TOLD - 1, 0
    assert flooded_by(bench, gate)[0] == sent, "as many as the queue holds"


def test_who_may_still_tell_what_it_has_is_not_sent_all_parts():
    bench, gate = settled()
    for s in range(1, 32):
        gate.job[s], gate.job_parts[s], gate.job_next[s] = UNDER_WAY, TOLD - 1, 1
        gate.job_due[s] = bench.now + SETTLED
    assert flooded_by(bench, gate) == ([], [])
    assert gate.job_parts[31] == TOLD - 1


def test_who_told_what_it_has_is_not_asked_beside_who_did_not():
    bench, gate = settled()
    gate.job[1:3], gate.job_next[1:3] = [UNDER_WAY] * 2, [0] * 2
    gate.job_parts[1:3] = [TOLD | WHOLE & ~2, TOLD - 1]
    assert flooded_by(bench, gate) == ([1, COUNT], [[2]])


def test_who_has_been_asked_is_not_asked_again_for_another():
    bench, gate = settled()
    gate.job[1:3], gate.job_next[1:3] = [UNDER_WAY] * 2, [0, 1]
    gate.job_parts[1:3] = [TOLD | WHOLE & ~2, TOLD - 1]
    gate.job_due[2] = bench.now + SETTLED
    assert flooded_by(bench, gate) == ([1], [])


def test_a_graph_of_another_epoch_is_nobody_s():
    bench, gate = settled()
    bench.nodes[0].epoch ^= 1
    gate.job[1], gate.job_next[1], gate.job_parts[1] = UNDER_WAY, 0, TOLD - 1
    assert flooded_by(bench, gate) == ([COUNT], [[1]])
    assert parts_by(bench, 1) == []
    assert told_by(bench, 1) == []


def test_a_part_behind_the_question_changes_nothing():
    bench, _ = settled()
    node = bench.nodes[1]
    before = node.part_count, node.parts, node.new_version
    frame = Frame()
    frame.kind, frame.origin, frame.seq, frame.link_dst, frame.length = GRAPH, 0, 9, ALL, 5
    frame.body[:5] = [node.epoch, 7, 7, 16 * (COUNT + 1) + COUNT, 1]
    on_graph(node, bench.params, bench.now, frame, bench.out)
    assert (node.part_count, node.parts, node.new_version) == before
    assert not any(node.q_state)


def test_not_all_say_at_once_that_they_have_the_graph():
    bench = Bench(6, [(0, k) for k in range(1, 6)], mode=WHOLE_GRAPH)
    bench.run(SETTLED)
    last = max(at for at, i, f in bench.sent if i == 0 and f.kind == GRAPH)
    said = [at for at, i, f in bench.sent if f.kind == TABLE_ACK and f.origin == i]
    assert max(said) - last > bench.params.spread_us // 2


def test_the_gateway_sends_each_part_as_often_as_all_others_do():
    """One that finds the channel full of the part before would be missed by all (decision 0073)."""
    bench = bench_of(30)
    bench.run(SETTLED)
    for node in range(3):
        sent = [(f.seq, f.link_dst) for _, i, f in bench.sent if i == node and f.kind == GRAPH]
        assert sent
        assert {sent.count(one) for one in sent} == {bench.params.copies}
        assert {to for _, to in sent} == {ALL}


def test_what_is_new_begins_with_its_first_part():
    """While parts of the graph before wait for places in the queue."""
    bench = bench_of(8, period=60)
    bench.run(SETTLED)
    bench.sent.clear()
    gate = bench.gates[0]
    gate.part = 5
    gate.job[1], gate.job_parts[1] = TO_SEND, TOLD
    pump_graph(bench.nodes[0], gate, bench.params, bench.now, bench.out)
    bench.drain(0)
    bench.run(bench.now + 2_000_000)
    assert parts_by(bench, 0) == list(range(QUEUE))


@pytest.mark.parametrize(("part", "share"), [(8, 1), (30, 2)])
def test_more_parts_than_a_queue_holds_come_no_sooner_than_they_are_passed_on(part, share):
    """Else all of 145 nodes miss one: it finds the channel full of the others (decision 0079)."""
    bench = bench_of(part)
    bench.run(SETTLED)
    first = {}
    for at, i, f in bench.sent:
        if i == 0 and f.kind == GRAPH:
            first.setdefault(f.seq, at)
    assert (len(first) > QUEUE) == (share == 1)
    times = sorted(first.values())
    gaps = [later - at for at, later in pairwise(times)]
    assert min(gaps) == bench.params.jitter_us // share
