"""Parts of a mesh node alone: duplicate window, what was forwarded, queue, neighbours."""

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from innervate.networks.mesh.protocol import duplicates, neighbours
from innervate.networks.mesh.protocol import queue as mesh_queue
from innervate.networks.mesh.protocol.constants import NOBODY, PARITY, REPORT_DROPPED
from innervate.networks.mesh.protocol.fields import FORWARDED, QUEUE
from tests.networks.mesh.bench import DEFAULTS, Frame, Node, Params
from tests.networks.mesh.net import Net, line

WINDOW = 75
ORIGIN = 7


def node_with(**settings):
    node, params = Node(), Params()
    for name, value in {**DEFAULTS, "nodes": 32, **settings}.items():
        setattr(params, name, value)
    node.number, node.choice, node.rng = 0, -1, 12345
    duplicates.clear_duplicates(node, params)
    neighbours.clear_neighbours(node, params)
    return node, params


@settings(max_examples=150, deadline=None)
@given(st.integers(0, 65535), st.lists(st.integers(-120, 120), max_size=60))
def test_the_window_is_a_set_that_forgets_what_is_old(start, steps):
    """Against a model: a set of numbers, of which those 76 or more behind the newest count."""
    node, params = node_with()
    newest, known = start + 65536, {start + 65536}
    assert duplicates.accept(node, params, ORIGIN, start, 0)
    for step in steps:
        seq = newest + step
        fresh = seq not in known and newest - seq <= WINDOW
        assert bool(duplicates.accept(node, params, ORIGIN, seq & 65535, 0)) == fresh, step
        if fresh:
            known.add(seq)
            newest = max(newest, seq)


def test_first_opens_the_window_once_for_one_that_started_anew():
    node, params = node_with()
    assert duplicates.accept(node, params, ORIGIN, 30_000, 0)
    assert not duplicates.accept(node, params, ORIGIN, 20_000, 0), "too old, and says nothing"
    assert duplicates.accept(node, params, ORIGIN, 20_000, 1), "it started anew"
    assert not duplicates.accept(node, params, ORIGIN, 20_000, 1), "sent again"
    assert duplicates.accept(node, params, ORIGIN, 20_001, 1), "FIRST until it is acknowledged"
    assert not duplicates.accept(node, params, ORIGIN, 20_000, 1), "and the window stays"


def test_old_numbers_do_not_keep_the_window_of_an_origin_alive():
    """Who started anew and whose FIRST was lost is heard when the window has run out."""
    node, params = node_with(forget=3)
    assert duplicates.accept(node, params, ORIGIN, 30_000, 0)
    for _ in range(3):
        assert not duplicates.accept(node, params, ORIGIN, 20_000, 0)
        duplicates.age(node, params)
    assert duplicates.accept(node, params, ORIGIN, 20_001, 0)


def frame_of(seq, parity=0, origin=3, path=(3,), sender=3):
    frame = Frame()
    frame.kind, frame.flags, frame.origin, frame.seq = 8, parity and PARITY, origin, seq
    frame.path_len, frame.link_src, frame.dest = len(path), sender, 9
    frame.path[: len(path)] = path
    return frame


def test_a_forwarded_packet_is_known_until_64_more_have_gone_through():
    node, _ = node_with()
    assert not duplicates.record_packet(node, frame_of(0))
    for seq in range(1, FORWARDED):
        assert not duplicates.record_packet(node, frame_of(seq))
    assert duplicates.record_packet(node, frame_of(0))
    duplicates.record_packet(node, frame_of(FORWARDED))
    assert not duplicates.record_packet(node, frame_of(0))


def test_a_retry_of_the_other_parity_replaces_the_entry():
    node, _ = node_with()
    assert not duplicates.record_packet(node, frame_of(1))
    duplicates.skip(node, 3, 1, 5)
    assert not duplicates.record_packet(node, frame_of(1, parity=1))
    assert not duplicates.is_skipped(node, 3, 1, 5), "tried anew: everybody may be asked"
    assert duplicates.record_packet(node, frame_of(1, parity=1))
    assert sum(origin == 3 for origin in node.done_origin) == 1


def test_a_retry_finds_no_neighbour_skipped_where_its_packet_was_forgotten():
    """A bridge passes on 64 packets in less than an end-to-end timeout (decision 0073)."""
    node, _ = node_with()
    duplicates.record_packet(node, frame_of(1))
    duplicates.skip(node, 3, 1, 5)
    for seq in range(2, 2 + FORWARDED):
        duplicates.record_packet(node, frame_of(seq))
    assert not duplicates.record_packet(node, frame_of(1, parity=1))
    assert not duplicates.is_skipped(node, 3, 1, 5)


def test_a_packet_comes_back_once_by_the_same_way():
    node, _ = node_with()
    assert not duplicates.record_packet(node, frame_of(1, path=(3,)))
    back = frame_of(1, path=(3, 0, 4), sender=4)
    assert not duplicates.record_return(node, back)
    assert duplicates.record_return(node, back), "its giver did not hear our ack"
    assert not duplicates.record_return(node, frame_of(1, path=(3, 0, 4, 0, 5), sender=5))


def test_alarms_go_first_then_control_then_messages_each_in_order():
    net = Net(2, line(2))
    node, out = net.nodes[1], net.out
    ranks = [2, 1, 0, 2, 1, 0]
    for rank in ranks:
        mesh_queue.enqueue(node, 0, rank, 255, out)
    went = []
    while (i := mesh_queue.pick_due(node, net.params, 0)) >= 0:
        went.append(i)
        mesh_queue.drop(node, net.params, i)
    assert went == [2, 5, 1, 4, 0, 3]


def test_a_flooded_alarm_does_not_wait_behind_one_to_a_dead_hop():
    net = Net(2, line(2))
    node = net.nodes[1]
    for dest in (0, 255):
        i = mesh_queue.enqueue(node, 0, mesh_queue.ALARMS, 255, net.out)
        node.q_link_dst[i] = dest
    assert node.q_link_dst[mesh_queue.pick_due(node, net.params, 0)] == 255


@pytest.mark.parametrize("rank", [0, 1, 2])
def test_the_last_places_are_for_what_is_more_urgent(rank):
    net = Net(2, line(2))
    node = net.nodes[1]
    taken = 0
    while mesh_queue.has_room(node, rank):
        assert mesh_queue.enqueue(node, 0, rank, 255, net.out) >= 0, "room was promised"
        taken += 1
    assert taken == QUEUE - rank


def test_an_alarm_puts_out_the_newest_of_what_is_least_urgent():
    net = Net(2, line(2))
    node, out = net.nodes[1], net.out
    for k, rank in enumerate([1, 2, 2, 1, 2, 1, 1, 1]):
        i = mesh_queue.enqueue(node, 0, rank, 255, out)
        node.q_seq[i] = k
    node.q_state[4] = mesh_queue.DOWN
    out.count[0] = 0
    assert mesh_queue.has_room(node, 0)
    assert mesh_queue.enqueue(node, 0, 0, 255, out) == 2, "place 4 is under way, 2 newer than 1"
    assert (out.action[0].a, out.action[0].c) == (REPORT_DROPPED, 2)
    for k in range(QUEUE):
        node.q_rank[k] = 0
    assert not mesh_queue.has_room(node, 0), "full of alarms: no ack for what is not kept"
    assert mesh_queue.enqueue(node, 0, 0, 255, out) == -1


def test_of_more_neighbours_than_places_the_loudest_are_kept():
    node, params = node_with(places=4)
    for who, rssi in [(1, -80), (2, -70), (3, -90), (4, -60)]:
        neighbours.hear(node, params, who, rssi)
    assert neighbours.hear(node, params, 5, -95) == -1
    assert neighbours.hear(node, params, 6, -75) >= 0
    assert sorted(who for who in node.neighbour[:4]) == [1, 2, 4, 6]


def test_rssi_is_smoothed_by_a_quarter():
    node, params = node_with()
    k = neighbours.hear(node, params, 1, -80)
    neighbours.hear(node, params, 1, -60)
    assert node.rssi[k] == -75 * 4


def test_a_suspect_is_trusted_when_its_time_is_over_or_it_is_heard():
    node, params = node_with()
    net = Net(2, line(2))
    neighbours.hear(node, params, 1, -60)
    node.ticks, node.tick_at = 65_530, 100  # ticks wrap on the way
    for now in (100, 101):  # at a tick, and right after it: it lasts suspect_us, not less
        ticks = params.suspect_us // params.tick_us + (now > node.tick_at)
        for free in ("heard", "acks somebody", "time"):
            neighbours.suspect(node, params, now, 1, 0, net.out)
            begun, node.ticks = node.ticks, (node.ticks + ticks - 1) & 65_535
            neighbours.sweep(node, params)
            assert neighbours.is_suspect(node, params, 1), (now, free)
            if free == "heard":
                neighbours.hear(node, params, 1, -60)
            elif free == "time":
                node.ticks = (node.ticks + 1) & 65_535
                neighbours.sweep(node, params)
            else:
                neighbours.hear_again(node, params, 1)
            assert not neighbours.is_suspect(node, params, 1), (now, free)
            node.ticks = begun


def test_neighbours_that_are_silent_for_three_periods_are_forgotten():
    node, params = node_with(period_max=10)
    neighbours.hear(node, params, 1, -60)
    node.ticks = 32
    neighbours.sweep(node, params)
    assert neighbours.place_of(node, params, 1) >= 0
    node.ticks = 33
    neighbours.sweep(node, params)
    assert neighbours.place_of(node, params, 1) == -1
    assert neighbours.loudest(node, params, 255, 255) == NOBODY


def test_an_ack_for_somebody_else_tells_nothing_of_our_link():
    """Its rssi is that of another link: of the frame that is acknowledged."""
    net = Net(3, [(0, 1), (0, 2), (1, 2)], rssi={(1, 2): -90, (2, 1): -90})
    net.run(3_000_000)
    net.send(0, 1)
    net.run(3_100_000)
    node = net.nodes[2]
    assert node.rssi[neighbours.place_of(node, net.params, 1)] == -90 * 4
