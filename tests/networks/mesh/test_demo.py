"""What the demo tells of a mesh, calls in words, and its boards, from values set by hand."""

import struct
from types import SimpleNamespace as Of

import pytest

from innervate.firmware.records import layout, records_of
from innervate.live.errors import LiveError
from innervate.networks.mesh import board, demo, run
from innervate.networks.mesh import frames as wire
from innervate.networks.mesh.analysis.messages import NEVER
from innervate.networks.mesh.payloads import PIECE_AHEAD, PIECE_STRUCT
from innervate.networks.mesh.protocol import constants as const
from innervate.networks.mesh.protocol import fields
from innervate.sim.field.access import MAC
from innervate.sim.status import ON_FRAME, ON_INPUT, ON_START, ON_TIMER
from tests.networks.mesh import shown


def crossing(**more):
    usual = {"crossed_us": 9_000_000, "raised_us": 9_004_000, "accepted_us": 9_020_000, "hops": 2,
             "overrun_m": 0.1234}  # fmt: skip
    return Of(**usual | more)


def told(monkeypatch, crossings, faults=(), tables_s=1.5, alarms=1):
    monkeypatch.setattr(demo, "all_crossings", lambda result: crossings)
    monkeypatch.setattr(demo, "sentences", lambda result, summary: ["alarms.", "messages."])
    summary = {"links": 9, "discovery": {"tables_s": tables_s}, "gateways": [{"at_s": 0.25}],
               "alarms": {"sent": alarms}, "duration_s": 30.0, "wall_s": 0.126}  # fmt: skip
    plan = Of(nodes=6, faults=[Of(at_us=at) for at in faults])
    return demo.lines(Of(mesh=summary, plan=plan, result=None))


def test_the_demo_tells_in_order_of_time_what_happened(monkeypatch):
    assert told(monkeypatch, [crossing()], (2_000_000, 2_000_000, 500_000)) == [
        "6 nodes, each with about 3 others in good reach", "",
        "   0.500 s   1 node switched off; nobody is told",
        "   1.750 s   every node knows the way to every other",
        "   2.000 s   2 nodes switched off; nobody is told",
        "   9.000 s   the robot is outside the fence",
        "     +4 ms   it notices, and raises the alarm",
        "  +20.0 ms   the monitor has it, over 2 hops; the robot got 12.3 cm out",
        "", "messages.", "", "30 s were simulated in 0.13 s.",
    ]  # fmt: skip


def test_the_demo_says_nothing_of_what_never_happened(monkeypatch):
    silent = crossing(raised_us=NEVER, accepted_us=NEVER)
    assert told(monkeypatch, [silent], tables_s=None, alarms=0)[1:6] == [
        "", "   9.000 s   the robot is outside the fence", "", "alarms.", "messages.",
    ]  # fmt: skip


@pytest.mark.parametrize(("handler", "port", "said"), [
    (ON_START, 0, "switched on"), (ON_START, 1, "restarted"),
    (ON_FRAME, const.ALARM, "received an alarm"), (ON_FRAME, 99, "received a packet of type 99"),
    (ON_TIMER, const.TX, "a frame is due"), (ON_TIMER, 99, "timer 99"),
    (ON_INPUT, const.SENT, "its frame has left"), (ON_INPUT, 99, "input 99"),
    (MAC, 0, "its medium access"), (MAC + 1, 0, "its medium access"),
])  # fmt: skip
def test_a_call_is_said_in_words(handler, port, said):
    plan = Of(names=["n0", "n1"])
    row = {"node": 1, "handler": handler, "port": port}
    assert run.call_words(plan, row) == f"node n1: {said}"


def test_what_never_was_is_null():
    assert run._or_null([3.0, NEVER, 0]) == [3, None, 0]


@pytest.mark.parametrize(("kind", "flags", "dest", "seq", "is_piece"), [
    (const.DATA, const.ORDERED, 3, 5, True), (const.DATA, const.ORDERED, const.ALL, 5, False),
    (const.DATA, 0, 3, 5, False), (const.GRAPH, const.ORDERED, 3, 5, False),
    (const.DATA, const.ORDERED, 3, 6, False),
    (const.DATA, const.ORDERED | const.SOURCE_ROUTE, 3, 5, False),
])  # fmt: skip
def test_a_piece_is_shown_as_one_where_it_can_be_one(kind, flags, dest, seq, is_piece):
    body = struct.pack(PIECE_STRUCT, 5 + PIECE_AHEAD, 3, 1, 9, 99) + b"ab"
    frame = Of(**dict.fromkeys([name for name, *_ in wire.COMMON], 0) | {
        "kind": kind, "flags": flags, "dest": dest, "seq": seq, "path": [], "path_len": 0,
        "body": list(body), "length": len(body)})  # fmt: skip
    names = [name for name, _ in shown.fields(frame)]
    assert ("in_order" in names) == is_piece
    if is_piece:
        assert shown.fields(frame)[-6:] == [
            ("mark", 5 + PIECE_AHEAD), ("message", 3), ("in_order", 1), ("at", 9), ("size", 99),
            ("data", [97, 98])]  # fmt: skip


def test_frames_of_one_call_have_room_for_all_acks_and_a_whole_queue():
    """Each up to where its body is in use: of an ack to a gathered frame nothing of it is."""
    places, whole = layout(records_of(board.node(32))["frame"])
    ack, *_ = dict(places)["body"]
    assert fields.GATHERED * ack + (fields.QUEUE + 2) * whole == board.FRAME_BYTES
    assert board.node(32).frame_bytes == board.FRAME_BYTES


@pytest.mark.parametrize(
    ("nodes", "size"),
    [(1, 0), (board.CLASSES[0], 0), (board.CLASSES[0] + 1, 1), (board.CLASSES[-1], -1)],
)
def test_a_board_is_of_the_smallest_class_that_holds_its_network(nodes, size):
    role = board.node(nodes)
    assert role.nodes == board.CLASSES[size]
    assert role.parameters.endswith(f"{board.OF_CLASS[role.nodes]}_parameters")
    for wrong in (0, -1, board.CLASSES[-1] + 1):
        with pytest.raises(LiveError, match=f"{wrong} nodes: a node's arrays hold 1 to"):
            board.node(wrong)


@pytest.mark.parametrize(("changes", "why"), [
    ({"nodes": 33}, "33 nodes do not fit into a class of 32"), ({"nodes": 0}, "0 nodes do not"),
    ({"nodes": 5, "monitor": 5}, "monitor=5 is none of 5 nodes"),
    ({"queue": fields.QUEUE + 1}, "queue=9 does not fit into 8 places"),
    ({"kept": fields.WAITING + 1}, "kept=.* does not fit into"),
    ({"mtu": const.MTU + 1}, "mtu=.* is more than a board's"),
])  # fmt: skip
def test_what_does_not_fit_onto_a_board_is_refused(changes, why):
    with pytest.raises(LiveError, match=f"^here: {why}"):
        board.node_parameters(32, changes, "here")


def test_a_boards_parameters_are_a_nodes_with_room_for_its_class():
    made = board.node_parameters(32, {"nodes": 5, "monitor": 4, "queue": fields.QUEUE})
    assert (made["width"], made["row"], made["places"]) == (
        32, fields.row_bytes(32), fields.places(32))  # fmt: skip
    assert (made["queue"], made["kept"], made["monitor"]) == (fields.QUEUE, fields.WAITING, 4)
    assert board.node_parameters(32, {"nodes": 5, "monitor": const.MONITOR})["monitor"] == (
        const.MONITOR)  # fmt: skip
    waits = board.csma_parameters({"busy_max": 3})
    assert waits == {"backoff_us": 320, "exponent_min": 3, "exponent_max": 6, "busy_max": 3}
    with pytest.raises(LiveError):
        board.csma_parameters({"busy": 3})


def always(declared):
    """Numbers that have but one value: C has it in place of the field."""
    return {name: low for name, length, low, high, *_ in declared if not length and low == high}


def test_what_a_class_of_boards_says_of_itself_is_the_same_in_all_nodes_of_it():
    for size in (32, 254):
        role = board.node(size)
        params = board.node_parameters(size, {})
        for name, value in always(role.params).items():
            assert params[name] == value
        assert always(role.params).keys() == {"width", "row", "places", "queue", "kept"}
        assert always(role.state).keys() == {"places", "kept", "q_room", "wait_room"}


def test_a_live_node_has_the_rooms_that_its_parameters_say():
    params = Of(width=64, mtu=100, places=7, queue=5, kept=3)
    role = board.live_node(params)
    assert (role.nodes, role.coded.size_max) == (64, 100)
    room = fields.room(100)
    assert [form.most["body"] for form in role.coded.forms] == [(room, "length")] * 2
    assert role.coded.forms[1].most["path"] == (const.PATH_MAX, "path")
    declared = fields.node(64, 5, 3, 100, 7)
    assert [one[:2] for one in role.state] == [one[:2] for one in declared]
    rooms = {"q_room": fields.room(100), "wait_room": fields.wait_room(100)}
    assert always(role.state) == {"places": 5, "kept": 3, **rooms}
    sizes = {"width": 64, "row": fields.row_bytes(64), "places": 7}
    assert always(role.params) == {**sizes, "queue": 5, "kept": 3}
    assert (role.gate, role.frame, role.item) == (
        fields.gate(64, 7), fields.frame(100), fields.item(100))  # fmt: skip
