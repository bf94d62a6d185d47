"""Calls of single nodes of an explored mesh: what a handler is told, and what it leaves."""

from types import SimpleNamespace as Of

import pytest

from innervate.dialect.outbox import DELIVER, REPORT, SEND, SET_TIMER, URGENT
from innervate.networks.mesh.protocol import constants as const
from innervate.networks.mesh.verify import local
from innervate.networks.mesh.verify import model as mesh_model
from innervate.networks.mesh.verify.local import GRAIN_US, NEVER, NONE, Locals, Packet
from innervate.networks.mesh.verify.model import MeshModel
from innervate.networks.mesh.verify.shape import NOW

HANDLERS = ("on_start", "on_frame", "on_timer", "on_input")


def made(act=lambda *told: None, robot=2, standby=(1,)):
    """Nodes of a line whose handlers note what they are told, and do what is said."""
    model = MeshModel(mesh_model.parse("line"), robot=robot, standby=standby)
    found = Locals(model, Of(), neat=False)
    found.told = []

    def handler(name):
        def called(node, gate, params, now, *rest):
            assert params is found.params
            assert rest[-1] is found.out
            found.told.append((name, now - NOW, *rest[:-1]))
            act(name, node, gate, now, *rest)

        return called

    found.entry = Of(**{name: handler(name) for name in HANDLERS})
    found._drop_idle = lambda *_: None
    return found


def put(out, *actions, frames=()):
    """Actions in an outbox, as handlers put them."""
    for place, (kind, a, b, c) in enumerate(actions):
        act = out.action[place]
        act.kind, act.a, act.b, act.c = kind, a, b, c
    for place, frame in frames:
        for name, value in frame.items():
            setattr(out.frame[place], name, value)
    out.count[0] = len(actions)


def test_a_node_that_is_switched_on_is_who_it_is_and_knows_nobody():
    nodes = made()
    for who, (rank, robot) in enumerate([(0, 0), (1, 0), (-1, 1)]):
        number = nodes.start(who, 0).state
        assert [nodes.field(number, name) for name in ("number", "rank", "robot", "rng")] == [
            who, rank, robot, 1]  # fmt: skip
        assert list(nodes.field(number, "neighbour")) == [const.ALL] * 3
        state = nodes.states[number]
        assert (state.gate is None) == (rank < 0)
        assert (state.timers, nodes.states[number].handed) == ((NEVER,) * const.TIMERS, NONE)
    assert nodes.told == [("on_start", 0, 0)] * 3
    nodes.start(0, 2)
    assert nodes.told[3:] == [("on_start", 0, 1)]
    assert nodes.calls == 4


def test_what_is_drawn_out_of_many_counts_from_each_start_anew():
    seen = []
    nodes = made(lambda name, node, *_: seen.append(nodes.boots))
    for boots in (0, 1, 2):
        number = nodes.start(0, boots).state
    nodes.call(number, (local.SENT,), 3)
    assert seen == [0, 1, 2, 0]


def told_of(event, elapsed=0):
    """What a handler of a node that is on is told of an event."""
    nodes = made()
    number = nodes.start(0, 0).state
    nodes.packet_of(frame())
    nodes.call(number, event, elapsed)
    return nodes, nodes.told[1:]


def frame(**keys):
    usual = {"kind": const.DATA, "flags": 1, "link_src": 2, "link_dst": 0, "origin": 2, "dest": 0,
             "seq": 9, "table_ver": 3, "ttl": 4, "rssi": -77, "path": [2, 1, 0], "path_len": 2,
             "body": [5, 6, 7], "length": 1} | keys  # fmt: skip
    return Of(**usual)


def test_a_handler_is_told_what_happened_and_when():
    nodes, told = told_of((local.FRAME, 0), 5)
    assert told == [("on_frame", 5, 0, nodes.frames[0])]
    assert told_of((local.TIMER, 3), 7)[1] == [("on_timer", 7, 3)]
    assert told_of((local.PASS,), 7)[1] == []
    nodes, told = told_of((local.SENT,), 1)
    assert told == [("on_input", 1, const.SENT, nodes.item)]
    assert nodes.item.ok == 1
    nodes, told = told_of((local.MESSAGE, 2, 6))
    assert told == [("on_input", 0, const.MESSAGE, nodes.item)]
    assert [getattr(nodes.item, name) for name in ("dest", "flags", "handle", "length")] == [
        2, const.END_TO_END, 6, 1]  # fmt: skip
    assert nodes.item.body[0] == 6
    nodes, told = told_of((local.SAMPLE,))
    assert told == [("on_input", 0, const.SAMPLE, nodes.item)]
    assert [getattr(nodes.item, name) for name in ("x", "y", "vx", "vy")] == [-100, 500, -50, 0]


def test_a_frame_is_a_value_and_comes_back_as_it_was():
    nodes = made()
    number = nodes.packet_of(frame())
    wanted = Packet(const.DATA, 1, 2, 0, 2, 0, 9, 3, 4, local.RSSI, bytes([2, 1]), bytes([5]))
    assert nodes.packets[number] == wanted
    assert nodes.packet_of(frame(rssi=-50)) == number, "all are heard alike"
    ack = nodes.packet_of(frame(kind=const.ACK))
    assert (ack, nodes.packets[ack].rssi) == (1, -77)
    again = nodes.frames[number]
    assert [getattr(again, name) for name in Packet._fields[:-2]] == list(wanted[:-2])
    assert (again.path_len, list(again.path[:3]), again.length, list(again.body[:2])) == (
        2, [2, 1, 0], 1, [5, 0])  # fmt: skip


DUE = NOW + 5 + 120


def acting(*actions, frames=(), **more):
    """A node to which something is done 5 us after it was switched on."""

    def act(name, node, gate, now, *rest):
        if name == "on_start":
            put(rest[-1], (SET_TIMER, 2, NOW + 90, 0), (SET_TIMER, 4, NOW + 3, 0))
        else:
            put(rest[-1], *actions, frames=frames)
            for name, value in more.items():
                setattr(node, name, value)

    nodes = made(act)
    return nodes, nodes.start(0, 0).state


def test_timers_go_on_and_the_one_that_fires_is_over():
    nodes, number = acting()
    assert nodes.states[number].timers == (NEVER, NEVER, 90, NEVER, 3, NEVER)
    for event, left in (((local.SENT,), (NEVER, NEVER, 85, NEVER, 0, NEVER)),
                        ((local.TIMER, 4), (NEVER, NEVER, 85, NEVER, NEVER, NEVER))):  # fmt: skip
        (out,) = nodes.call(number, event, 5)
        assert nodes.states[out.state].timers == left
        assert (out.broken, out.acks, out.delivered) == (0, (), ())
    nodes, number = acting((SET_TIMER, 0, DUE, 0))
    (out,) = nodes.call(number, (local.TIMER, 4), 5)
    assert nodes.states[out.state].timers == (120, NEVER, 85, NEVER, NEVER, NEVER)
    nodes.coarsen()
    nodes.memo.clear()
    (out,) = nodes.call(number, (local.TIMER, 4), 5)
    assert nodes.states[out.state].timers[0] == 120 // GRAIN_US * GRAIN_US


def test_what_was_called_before_is_not_called_again():
    nodes, number = acting()
    first = nodes.call(number, (local.SENT,), 5)
    assert nodes.call(number, (local.SENT,), 5) is first
    assert (nodes.calls, len(nodes.told)) == (2, 2)
    nodes.call(number, (local.SENT,), 6)
    assert nodes.calls == 3


def test_what_is_put_out_is_handed_down_acked_or_delivered():
    nodes, number = acting((SEND, 0, 0, URGENT), (DELIVER, 1, 0, 0), (REPORT, 4, 5, 6),
                           (SEND, 0, 0, 0), frames=[(k, vars(frame(seq=20 + k, path=[0] * 24,
                           path_len=0, body=[0] * 114))) for k in (0, 1, 3)])  # fmt: skip
    (out,) = nodes.call(number, (local.TIMER, 4), 5)
    acked, delivered, handed = (
        nodes.packets[one].seq
        for one in (*out.acks, *out.delivered, nodes.states[out.state].handed)
    )
    assert (acked, delivered, handed) == (20, 21, 23)
    assert out.broken == 0
    (still,) = nodes.call(out.state, (local.TIMER, 2), 90)
    assert still.broken == local.BROKEN_HELD, "another was handed down"
    (left,) = nodes.call(out.state, (local.SENT,), 0)
    assert left.broken == 0


def test_a_frame_stays_handed_down_until_it_has_left():
    nodes, number = acting((SEND, 0, 0, 0))
    (out,) = nodes.call(number, (local.TIMER, 4), 5)
    nodes.entry.on_timer = nodes.entry.on_input = lambda *_: None
    (still,) = nodes.call(out.state, (local.TIMER, 2), 90)
    assert nodes.states[still.state].handed == nodes.states[out.state].handed != NONE
    (left,) = nodes.call(out.state, (local.SENT,), 0)
    assert nodes.states[left.state].handed == NONE


def raising(error):
    def act(*_):
        raise error

    return act


@pytest.mark.parametrize("error", [IndexError(), ValueError(), ZeroDivisionError()])
def test_a_handler_that_crashes_leaves_the_state_as_it_was(error):
    nodes, number = acting()
    nodes.entry.on_timer = raising(error)
    (out,) = nodes.call(number, (local.TIMER, 4), 5)
    assert (out.broken, out.state) == (local.BROKEN_CRASH, number)


def test_an_outbox_without_room_and_a_field_out_of_range_are_broken():
    nodes, number = acting(choice=3, ttl=300)
    nodes.entry.on_timer = lambda *told: told[-1].overflow.__setitem__(0, 1)
    (out,) = nodes.call(number, (local.TIMER, 4), 5)
    assert out.broken == local.BROKEN_OUTBOX
    nodes.entry.on_timer = lambda *_: None
    (out,) = nodes.call(number, (local.TIMER, 2), 90)
    assert out.broken == 0, "the outbox is emptied"
    nodes.entry.on_timer = lambda node, *_: setattr(node, "rank", 10_000)
    (out,) = nodes.call(number, (local.TIMER, 4), 6)
    assert (out.broken, out.state) == (local.BROKEN_RANGE, number)


def test_a_gateways_record_is_brought_to_life_with_its_nodes():
    nodes = made(lambda name, node, gate, now, *rest: gate is not None and setattr(
        gate, "step", {"on_start": 1, "on_timer": 2}.get(name, gate.step)))  # fmt: skip
    first, other = nodes.start(0, 0).state, nodes.start(1, 0).state
    place = nodes.gate_shape.place["step"]
    (out,) = nodes.call(first, (local.TIMER, 4), 0)
    (kept,) = nodes.call(other, (local.SENT,), 0)
    assert [nodes.states[one].gate[place] for one in (out.state, kept.state)] == [2, 1]


def test_every_draw_out_of_few_is_tried_with_every_other():
    def act(name, node, gate, now, *rest):
        if name == "on_timer":
            for many in (3, 2):
                node.asked = many
                node.due = node.due * 3 + node.choice

    nodes = made(act)
    found = nodes.call(nodes.start(0, 0).state, (local.TIMER, 4), 0)
    scripts = sorted((*one.script, *(0,) * (2 - len(one.script))) for one in found)
    assert scripts == [(0, 0), (0, 1), (1, 0), (1, 1), (2, 0), (2, 1)]


@pytest.mark.parametrize(("path", "broken"), [
    ([], 0), ([1], 0), ([1, 2, 1], 0), ([1, 2, 1, 2], local.BROKEN_ROUND),
    ([0, 1, 2, 0, 1], local.BROKEN_ROUND), ([0, 1, 2, 0, 2], 0), ([2, 2, 2], local.BROKEN_ROUND),
])  # fmt: skip
def test_a_packet_that_takes_a_hop_twice_goes_round(path, broken):
    assert local.goes_round(Of(path=bytes(path), kind=const.DATA)) == broken


def test_a_request_that_is_said_again_has_its_sender_in_its_path_for_each_hop():
    assert local.goes_round(Of(path=bytes([2, 2, 2, 2]), kind=const.REQUEST)) == 0
    assert local.goes_round(Of(path=bytes([1, 2, 1, 2]), kind=const.REQUEST)) == local.BROKEN_ROUND


def test_what_is_broken_has_a_number_of_its_own_each():
    names = [name for name in vars(local) if name.startswith("BROKEN_")]
    assert sorted(getattr(local, name) for name in names) == list(range(1, 13))
