"""What a mesh adds to its field's loop, by hand: room, memories, messages, rows, digests."""

from types import SimpleNamespace as Of

import pytest

from innervate.networks.mesh.protocol.constants import ACK, MESSAGE, REPORT_GRAPH, SAMPLE, SENT
from innervate.networks.mesh.sim import orders, recorder, stacks
from innervate.sim import taps
from innervate.sim.field import calls, medium
from innervate.sim.field.states import ALIVE, COMMITTED, DEAD, ON_AIR, VOID
from innervate.sim.status import BROKEN, DONE, POOL_FULL, ROWS_FULL

LIMITS = ("row", "sent", "delivered", "round", "trail", "tap")
COUNTS = ("rows", "sent", "delivered", "rounds", "trail", "taps")
NODES = 2


def pressing(size=0, **run):
    given = {"broken": 0, "duplicates": 5, "duplicate_limit": 5, "nodes": NODES}
    for limit, (name, count) in enumerate(zip(LIMITS, COUNTS, strict=True), 20):
        given |= {f"{name}_limit": limit, count: limit}
    keys = [0] * (64 * NODES + 64 + 3)
    return orders.pressing(Of(run=[Of(**given | run)], heap=Of(size=[size], keys=keys)))


@pytest.mark.parametrize(("given", "why"), [
    ({}, DONE), ({"broken": 1, "rows": 99}, BROKEN),
    *(({name: 21 + place}, ROWS_FULL) for place, name in enumerate(COUNTS)),
    ({"duplicates": 6}, orders.DUPLICATES_FULL), ({"size": 3}, DONE), ({"size": 4}, POOL_FULL),
])  # fmt: skip
def test_the_loop_stops_while_there_is_room_for_one_event_more(given, why):
    assert pressing(**given) == why


def node(**more):
    return Of(**{"number": 0, "rank": 0, "robot": 0, "rng": 0, "round": 0} | more)


@pytest.mark.parametrize("gate", [0, 1])
def test_who_loses_its_memory_stays_who_it_is(gate):
    own = node(number=1, rank=3, robot=1, rng=77)

    class Words:
        def __setitem__(self, i, word):
            setattr(own, ("number", "rank", "robot", "rng", "round")[i], word)

    own.round = 8
    world = Of(
        run=[Of(nodes=2, gate_words=2)], radios=[Of(gate=0), Of(gate=gate)], nodes=[node(), own],
        words=[None, Words(), [5, 5, 5, 5, 5]], low=[0] * 5, gates=[None, None],
        gate_words=[[7, 8, 9], [1, 2, 3]],
    )  # fmt: skip
    orders.wipe(world, 1)
    assert vars(own) == {"number": 1, "rank": 3, "robot": 1, "rng": 77, "round": 5}
    assert world.gate_words == [[1, 2, 9] if gate == 0 else [7, 8, 9], [1, 2, 3]]


@pytest.fixture
def given(monkeypatch):
    """What nodes were given: (node, when, kind)."""
    found = []
    monkeypatch.setattr(calls, "give", lambda _world, _do, *what: found.append(what))
    return found


@pytest.mark.parametrize(("index", "body"), [
    (1, [1, 0, 0, 0, 1]), (0x01020304, [4, 3, 2, 1, 4]), (0x10001, [1, 0, 1, 0, 1]),
])  # fmt: skip
def test_a_message_begins_with_the_number_of_its_offer(given, index, body):
    message = Of(node=1, dest=7, flags=3, length=5)
    world = Of(offers={index: message}, radios=[Of(state=ALIVE)] * 2, run=[Of(unasked=0)],
               item=[Of(handle=0, dest=0, flags=0, length=0, body=[9] * 8)])  # fmt: skip
    orders.offer(world, None, index, 70)
    item = world.item[0]
    assert (item.handle, item.dest, item.flags, item.length) == (index & 0xFFFF, 7, 3, 5)
    assert item.body == [*body, 9, 9, 9]
    assert (given, world.run[0].unasked) == ([(1, 70, MESSAGE)], 0)


@pytest.mark.parametrize("state", [0, DEAD])
def test_who_is_off_is_given_nothing_and_that_is_counted(given, state):
    world = Of(offers=[Of(node=0)], radios=[Of(state=state)], run=[Of(unasked=2)], item=[None])
    orders.offer(world, None, 0, 70)
    assert (given, world.run[0].unasked) == ([], 3)


@pytest.mark.parametrize(("place", "speed"), [(5, 7), (-5, -7), (40_000, 200), (-40_000, -200)])
def test_a_robot_is_told_its_place_and_its_speed_as_far_as_they_fit(given, place, speed):
    walk = Of(node=1, told_x=place, told_y=-place, vx=speed, vy=-speed)
    world = Of(walks=[None, walk], item=[Of(x=9, y=9, vx=9, vy=9)])
    orders.tell_place(world, None, 1, 70)
    item = world.item[0]
    sign = 1 if place > 0 else -1
    x, vx = sign * min(abs(place), 32_767), sign * min(abs(speed), 127)
    assert (item.x, item.y, item.vx, item.vy) == (x, -x, vx, -vx)
    assert given == [(1, 70, SAMPLE)]


@pytest.mark.parametrize("told", [0, 1])
def test_a_router_is_told_of_its_frame_if_it_wants_to_be(given, told):
    world = Of(run=[Of(told=told)], item=[Of(ok=9)])
    orders.tell_sent(world, None, 1, 70, 0)
    assert given == [(1, 70, SENT)] * told
    assert world.item[0].ok == (0 if told else 9)


@pytest.mark.parametrize(("kind", "rssi"), [(ACK, 5), (ACK + 1, -70)])
def test_how_loud_a_frame_is_stands_in_it_but_for_acks(monkeypatch, kind, rssi):
    monkeypatch.setattr(
        medium, "rssi_dbm", lambda _world, sender, node: -70 if (sender, node) == (3, 1) else 0
    )
    world = Of(frames=[Of(kind=kind, rssi=5)], air=[Of(node=3)])
    orders.note_heard(world, 1, 0)
    assert world.frames[0].rssi == rssi


@pytest.mark.parametrize(("code", "count"), [(REPORT_GRAPH, 1), (REPORT_GRAPH + 1, 0)])
def test_a_round_has_a_row_when_a_gateway_reports_its_graph(monkeypatch, code, count):
    rounds = []
    monkeypatch.setattr(recorder, "record_round", lambda _world, *what: rounds.append(what))
    orders.note_report(None, 1, 70, code)
    assert rounds == [(1, 70)] * count


@pytest.mark.parametrize(("word", "broken"), [(8, 0), (9, medium.BROKEN_RANGE)])
def test_a_value_out_of_range_breaks_the_run(word, broken):
    world = Of(run=[Of(broken=0, broken_node=-1)], words=[[0], [word]], low=[0], high=[8], spans=[])
    orders.check(world, None, 1, 70)
    assert (world.run[0].broken, world.run[0].broken_node) == (broken, 1 if broken else -1)


# Rows.


def frame(**more):
    given = {"kind": 2, "flags": 3, "link_src": 1, "link_dst": 4, "origin": 1, "dest": 6, "seq": 7,
             "path_len": 2, "length": 4, "path": [1, 4, 9], "body": [21, 22, 23, 24, 25],
             "table_ver": 8, "ttl": 9, "rssi": -60}  # fmt: skip
    return Of(**given | more)


def rows_of(**run):
    given = {"sent": 1, "sent_limit": 9, "delivered": 1, "delivered_limit": 9, "checks": 0,
             "nodes": 3, "rounds": 1, "round_limit": 9, "row": 2, "good": 2}  # fmt: skip
    return Of(run=[Of(**given | run)], sent=[Of(), Of()], delivered=[Of(), Of()],
              rounds=[Of(), Of()], air=[Of(start=60, node=1, state=ON_AIR)],
              frames=[frame()])  # fmt: skip


def test_what_was_on_the_air_has_a_row_with_all_that_it_said():
    world = rows_of()
    recorder.record_sent(world, 0, 90, 33, 5)
    assert vars(world.sent[1]) == {
        "time": 60, "end": 90, "node": 1, "kind": 2, "flags": 3, "link_dst": 4, "origin": 1,
        "dest": 6, "seq": 7, "path_len": 2, "bytes": 33, "receivers": 5,
    }  # fmt: skip
    assert world.run[0].sent == 2
    for state in (COMMITTED, VOID):  # not yet, or not any more
        world.air[0].state = state
        recorder.record_sent(world, 0, 90, 33, 5)
    quiet = rows_of(sent_limit=0)
    recorder.record_sent(quiet, 0, 90, 33, 5)
    assert (world.run[0].sent, quiet.run[0].sent) == (2, 1)


@pytest.mark.parametrize(("length", "body"), [
    (0, [0, 0, 0, 0]), (1, [21, 0, 0, 0]), (2, [21, 22, 0, 0]), (3, [21, 22, 23, 0]),
    (4, [21, 22, 23, 24]), (5, [21, 22, 23, 24]),
])  # fmt: skip
def test_a_delivery_has_a_row_with_the_first_bytes_that_there_are(length, body):
    world = rows_of()
    recorder.record_delivered(world, 2, frame(length=length, path=[1, 1]), 90)
    row = vars(world.delivered[1])
    assert [row.pop(f"body{i}") for i in range(4)] == body
    assert row == {"time": 90, "node": 2, "kind": 2, "flags": 3, "origin": 1, "dest": 6, "seq": 7,
                   "path_len": 2, "looped": 1}  # fmt: skip
    assert world.run[0].delivered == 2
    quiet = rows_of(delivered_limit=0)
    recorder.record_delivered(quiet, 2, frame(), 90)
    assert quiet.run[0].delivered == 1


@pytest.mark.parametrize(("checks", "origin", "path_len", "count"), [
    (1, 1, 2, 1), (0, 1, 2, 0), (1, 3, 2, 0), (1, 2, 1, 1), (1, 1, 0, 0),
])  # fmt: skip
def test_deliveries_of_nodes_are_looked_at_for_the_same_twice(
    monkeypatch, checks, origin, path_len, count
):
    looked = []
    monkeypatch.setattr(recorder, "check_once", lambda _world, *what: looked.append(what))
    one = frame(origin=origin, path_len=path_len)
    recorder.record_delivered(rows_of(checks=checks), 2, one, 90)
    assert looked == [(2, one, 90)] * count


@pytest.mark.parametrize("first", range(1, 30, 4))
def test_a_place_in_a_table_is_its_own_or_the_next_that_is_free(first):
    keys, some = [0] * 8, range(first, first + 8 * 11, 11)
    places = []
    for key in some:
        places.append(recorder.place_of(keys, key))
        keys[places[-1]] = key
    assert sorted(places) == list(range(8))
    assert [recorder.place_of(keys, key) for key in some] == places


def test_a_round_counts_the_links_that_a_gateway_knows_and_those_that_are_good():
    """Nodes 0 to 2; links of node 0 stand in bits 1 and 2 of its row, that of 1 in bit 2."""
    world = rows_of()
    world.gates, world.radios = [None, Of(known=[0b110, 0, 0b100, 0, 0, 0])], [None, Of(gate=1)]
    world.nodes = [None, Of(round=6)]
    world.good = [0, 1, 0, 1, 0, 1, 0, 1, 0]
    recorder.record_round(world, 1, 90)
    assert vars(world.rounds[1]) == {
        "time": 90, "node": 1, "round": 6, "links": 3, "good": 2, "both": 2,
    }  # fmt: skip
    assert world.run[0].rounds == 2
    world.run[0].round_limit = 0
    recorder.record_round(world, 1, 90)
    assert world.run[0].rounds == 2


@pytest.mark.parametrize("limit", [0, 9])
def test_a_frame_is_kept_for_a_capture_with_its_sender_and_its_start(monkeypatch, limit):
    monkeypatch.setattr(recorder, "copy_frame", lambda to, one: setattr(to, "seq", one.seq))
    world = rows_of(tap_limit=limit, taps=0)
    world.taps, world.tapped = [Of()], [Of()]
    recorder.tap(world, 0, 2, 90, 0, taps.NOISE)
    row = {"time": 90, "start": 60, "at": 2, "sender": 1, "out": 0, "why": taps.NOISE}
    assert vars(world.taps[0]) == (row if limit else {})
    assert vars(world.tapped[0]) == ({"seq": 7} if limit else {})


CHANGES = ({"kind": 3}, {"flags": 2}, {"link_src": 2}, {"link_dst": 5}, {"origin": 2}, {"dest": 7},
           {"seq": 8}, {"path_len": 3}, {"length": 5}, {"table_ver": 9}, {"ttl": 8},
           {"path": [1, 5, 9]}, {"path": [4, 1, 9]}, {"body": [21, 22, 23, 25]},
           {"body": [20, 22, 23, 24]})  # fmt: skip


def test_a_digest_is_of_what_a_frame_has_on_the_wire():
    marks = [stacks.digest(frame(**change)) for change in ({}, *CHANGES)]
    assert len(set(marks)) == len(marks)
    same = ({"rssi": -61}, {"path": [1, 4, 8]}, {"body": [21, 22, 23, 24, 99]})
    assert {stacks.digest(frame(**change)) for change in same} == {marks[0]}
    acks = [stacks.digest(frame(kind=ACK, **change)) for change in ({}, {"rssi": -61}, {"seq": 8})]
    assert len(set(acks)) == 3
    assert stacks.digest(frame(kind=ACK, ttl=1, body=[])) == acks[0]
