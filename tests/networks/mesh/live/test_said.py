"""What a live node says of itself, whom it would send to, what it does not take: fields by hand."""

import pytest

from innervate.networks.mesh.live.parameters import mesh_parameters
from innervate.networks.mesh.live.stack import MeshStack
from innervate.networks.mesh.protocol.constants import (
    ACK,
    ALL,
    ALTERNATE,
    DATA,
    SEARCH,
    TABLE_FREE,
    TABLES,
)
from innervate.networks.mesh.protocol.neighbours import FREE, SUSPECT

OWN, GATEWAY, NEAR, FAR, UP = 3, 0, 1, 4, 5
STRONG, WEAK = 4 * -93, 4 * -93 - 1  # quarters of dBm; a link is reported from -93 dBm on


def stack(rank=-1, **changes):
    made = MeshStack(OWN, rank, mesh_parameters(9, changes), 7)
    made.on_start(0, 0)
    node = made.node
    node.known, node.gateway, node.depth = 1, GATEWAY, 2
    for k, who in enumerate((NEAR, GATEWAY, FAR, UP)):
        node.neighbour[k], node.rssi[k] = who, STRONG
        node.round_depth[k], node.round_rssi[k] = 9, 0
    return made


def heard(one, who, **fields):
    k = list(one.node.neighbour).index(who)
    for name, value in fields.items():
        getattr(one.node, name)[k] = value


def table(one, nexts, alternates):
    base = one.node.bank * one.params.width
    for dest, who in nexts.items():
        one.node.next[base + dest] = who
    for dest, who in alternates.items():
        one.node.alt[base + dest] = who


@pytest.mark.parametrize(("rssi", "mode", "failover", "uplinks", "onward"), [
    (STRONG, TABLES, SEARCH, [], [GATEWAY, NEAR, FAR]), (WEAK, TABLES, SEARCH, [], [NEAR, FAR]),
    (WEAK, TABLES, ALTERNATE, [], [NEAR, FAR]), (WEAK, TABLES, ALTERNATE - 1, [], [NEAR]),
    (WEAK, TABLE_FREE, SEARCH, [], []), (WEAK, TABLE_FREE, SEARCH, [(UP, 1)], [UP]),
    (WEAK, TABLE_FREE, SEARCH, [(UP, 1), (FAR, 0)], [FAR, UP]),  # the nearer one first
    (STRONG, TABLES, SEARCH, [(NEAR, 1), (UP, 1)], [GATEWAY, NEAR, FAR, UP]),
])  # fmt: skip
def test_whom_a_message_for_the_gateway_goes_to(rssi, mode, failover, uplinks, onward):
    one = stack(mode=mode, failover=max(failover, 0))
    table(one, {GATEWAY: NEAR}, {GATEWAY: FAR})
    heard(one, GATEWAY, rssi=rssi)
    for who, depth in uplinks:
        heard(one, who, round_depth=depth)
    assert one.status(0)["onward"] == onward


def test_who_does_not_answer_is_left_out_of_it():
    one = stack()
    table(one, {GATEWAY: NEAR}, {GATEWAY: FAR})
    heard(one, NEAR, suspect=SUSPECT)
    assert one.status(0)["onward"] == [GATEWAY, FAR]


@pytest.mark.parametrize("fields", [{"known": 0}, {"gateway": ALL}, {"gateway": OWN}])
def test_without_a_gateway_there_is_nobody(fields):
    one = stack()
    for name, value in fields.items():
        setattr(one.node, name, value)
    assert one.status(0)["onward"] == []


@pytest.mark.parametrize(("asked", "acked", "quality"), [
    (0, 0, None), (3, 2, 0.6667), (4, 4, 1.0), (3, 5, 1.0), (7, 0, 0.0),
])  # fmt: skip
def test_a_neighbours_share_of_acknowledged_frames(asked, acked, quality):
    one = stack()
    one.asked[NEAR], one.acked[NEAR] = asked, acked
    heard(one, FAR, suspect=SUSPECT)
    one.places[NEAR] = [2, 0]
    told = {near["node"]: near for near in one.status(0)["neighbours"]}
    assert list(told) == [NEAR, GATEWAY, FAR, UP]
    assert told[NEAR] == {"node": NEAR, "quality": quality, "suspect": False, "ports": [2, 0]}
    assert told[FAR] == {"node": FAR, "quality": None, "suspect": True, "ports": []}


def test_routes_are_those_of_the_table_in_use_to_others():
    one = stack()
    table(one, {GATEWAY: NEAR, OWN: NEAR, 8: FAR}, {GATEWAY: FREE, 8: NEAR})
    assert one.status(0)["routes"] == {"0": [NEAR, FREE], "8": [FAR, NEAR]}


@pytest.mark.parametrize(("rank", "leading", "role"), [
    (-1, 0, "node"), (0, 1, "gateway"), (0, 0, "standby"), (2, 0, "standby"),
])  # fmt: skip
def test_what_a_node_is(rank, leading, role):
    one = stack(rank)
    one.node.leading, one.node.epoch, one.node.round, one.node.version = leading, 7, 8, 9
    one.node.round_trip = 12_345
    one.node.q_state[0] = one.node.q_state[5] = 1
    told = one.status(0)
    assert (told["kind"], told["number"], told["role"], told["gateway"]) == ("mesh", OWN, role, 0)
    assert (told["epoch"], told["round"], told["table"], told["queue"]) == (7, 8, 9, 2)
    assert told["round_trip_ms"] == 12.345
    assert "robot" not in told


@pytest.mark.parametrize(("mode", "failover", "gives"), [
    (TABLES, SEARCH, True), (TABLE_FREE, SEARCH, False), (TABLES, ALTERNATE, False),
])  # fmt: skip
def test_packets_are_given_back_only_where_tables_are_searched_around(mode, failover, gives):
    assert stack(mode=mode, failover=failover).status(0)["gives_back"] == gives


@pytest.mark.parametrize(("placed", "at_cm"), [(0, None), (1, [120, -30])])
def test_a_robot_says_where_it_is_in_centimetres(placed, at_cm):
    one = stack(unit_cm=10)
    one.node.robot, one.node.placed, one.node.x, one.node.y = 1, placed, 12, -3
    assert one.status(0)["robot"]["at_cm"] == at_cm


@pytest.mark.parametrize(("fields", "sender", "why"), [
    ({}, None, ""), ({}, NEAR, ""), ({}, FAR, "sealed by another than it is from"),
    ({"link_src": 9}, None, "from no node of ours"), ({"link_src": OWN}, None, "our own"),
    ({"kind": ACK}, None, "ack of nothing"), ({"kind": ACK, "link_dst": FAR}, None, ""),
    ({"kind": ACK, "seq": 8}, None, ""),
])  # fmt: skip
def test_what_is_not_taken_and_why(fields, sender, why):
    one = stack()
    one._note_question((NEAR, GATEWAY, 8))
    given = {"kind": DATA, "link_src": NEAR, "link_dst": OWN, "origin": GATEWAY, "dest": OWN,
             "seq": 7, "path_len": 1, "length": 1}  # fmt: skip
    for name, value in (given | fields).items():
        setattr(one.inbox, name, value)
    one.inbox.path[0] = GATEWAY
    assert one.objection(sender) == why


@pytest.mark.parametrize(("heard_on", "first", "again"), [
    ([], None, None), ([2], [2], [2]), ([2, 1], [1], [1, 2]), ([2, 1, 2], [2], [2, 1]),
    ([1, 1], [1], [1]),
])  # fmt: skip
def test_a_frame_leaves_where_its_receiver_was_heard_last_and_again_wherever(
    heard_on, first, again
):
    one = stack()
    for port in heard_on:
        one._place(NEAR, port)
    frame = one.inbox
    frame.link_dst, frame.flags = NEAR, 0
    assert (one.ports_of(0, frame, 0), one.ports_of(0, frame, 1)) == (first, again)
    frame.link_dst = ALL
    assert one.ports_of(0, frame, 0) is None
