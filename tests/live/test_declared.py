"""Nodes of networks that only declare their protocol: what they take, say and hand down."""

import asyncio
from types import SimpleNamespace

import pytest

from innervate import scenario as scenarios
from innervate.live import build as builds
from innervate.live import deployment
from innervate.live.declared import DeclaredNode, DeclaredStack, values_of
from innervate.live.deployment import Deployment
from innervate.live.errors import LiveError
from innervate.live.in_field import FieldDeployment
from innervate.live.nodefile import load
from innervate.network import networks
from innervate.networks.babel.protocol import fields
from tests.live import time_by_hand

FILE = """\
kind = "babel"
number = 1
{ports}
[protocol]
{protocol}
[[link]]
kind = "udp"
bind = "127.0.0.1:0"
peers = ["127.0.0.1:9", "127.0.0.1:10"]
"""
FRAME = {name: (length, low, high) for name, length, low, high, *_ in fields.FRAME}
PLAIN = next(name for name, (length, *_) in FRAME.items() if not length and name != "kind")


def built(tmp_path, ports="", protocol=""):
    path = tmp_path / "n1.toml"
    path.write_text(FILE.format(ports=ports, protocol=protocol))
    return builds.build(load(path))


@pytest.mark.parametrize(("ports", "found"), [("", [0, 1]), ("ports = [3, 1]", [3, 1])])
def test_a_nodes_paths_are_at_the_ports_of_its_file(tmp_path, ports, found):
    stack = built(tmp_path, ports).stack
    assert stack.port_of_path == found
    for path, port in enumerate(found):
        assert stack.ports_of(port, None, 0) == [path]
    assert stack.ports_of(7, None, 0) == []


@pytest.mark.parametrize("ports", ["ports = [1]", "ports = [1, 1]", "ports = [0, 1, 2]"])
def test_ports_that_do_not_fit_the_paths(tmp_path, ports):
    with pytest.raises(LiveError, match="port of each of its 2 paths, each once"):
        built(tmp_path, ports)


def test_a_protocols_parameters_are_those_of_the_file_within_their_ranges(tmp_path):
    name, _length, low, high, *_ = next(one for one in fields.PARAMS if one[3] > one[2])
    stack = built(tmp_path, protocol=f"{name} = {high}").stack
    assert getattr(stack.params, name) == high
    assert (stack.node.number, stack.number) == (1, 1)
    assert getattr(built(tmp_path, protocol=f"{name} = {low}").stack.params, name) == low
    with pytest.raises(LiveError, match=f"protocol.{name} = {high + 1} must be {low} to {high}"):
        built(tmp_path, protocol=f"{name} = {high + 1}")
    with pytest.raises(LiveError, match=f"protocol.{name} = {low - 1} must be"):
        built(tmp_path, protocol=f"{name} = {low - 1}")
    with pytest.raises(LiveError, match=r"protocol\.nothing is unknown; it knows "):
        built(tmp_path, protocol="nothing = 1")


@pytest.mark.parametrize("attempt", [0, 50])
def test_a_frame_that_no_wire_can_carry_is_counted_and_the_node_goes_on(
    tmp_path, monkeypatch, attempt
):
    def encode(frame):
        if frame.dist > 300:
            raise ValueError("dist does not fit into its bits")
        return b"frame"

    node, left = built(tmp_path), []
    monkeypatch.setattr(node.stack, "encode", encode)
    monkeypatch.setattr(node, "_leave", lambda paths, data: left.append((len(paths), data)))
    node.engine = SimpleNamespace(later=lambda _wait_us, do: do())
    for dist in (301, 300, 302):
        node._transmit(1, SimpleNamespace(dist=dist), attempt, 0)
    assert left == [(1, b"frame")]
    assert node.outcomes == {"not sent: dist does not fit into its bits": 2}


class Told:
    """In place of an engine."""

    def __init__(self):
        self.told = []

    def input(self, kind, item):
        self.told.append((kind, {name: getattr(item, name) for name in ("a", "many")}))


def node():
    declared = SimpleNamespace(FRAME=(("a", 0, -2, 3, "", ""), ("many", 2, 0, 9, "", "")))
    made = DeclaredNode.__new__(DeclaredNode)
    made.stack = SimpleNamespace(
        network=SimpleNamespace(fields=declared), item=SimpleNamespace(a=0, many=[0, 0])
    )
    made.engine, made.outcomes = Told(), {"inputs": 0}
    return made


@pytest.mark.parametrize(
    ("values", "given"),
    [
        ({}, (0, [0, 0])), ({"a": -2}, (-2, [0, 0])), ({"a": 3, "many": [0, 9]}, (3, [0, 9])),
        ({"a": -3}, None), ({"a": 4}, None), ({"a": True}, None), ({"a": 1.0}, None),
        ({"a": [1]}, None), ({"many": [1]}, None), ({"many": [1, 2, 3]}, None), ({"many": 1}, None),
        ({"many": [0, 10]}, None), ({"many": [-1, 0]}, None), ({"other": 1}, None),
    ],
)  # fmt: skip
def test_what_a_user_may_hand_down(values, given):
    one = node()
    if given is None:
        with pytest.raises(ValueError, match=r"no field of a frame|whole numbers from"):
            one.give(5, values)
        assert (one.engine.told, one.outcomes["inputs"]) == ([], 0)
    else:
        one.give(5, values)
        assert one.engine.told == [(5, dict(zip(("a", "many"), given, strict=True)))]
        assert one.outcomes["inputs"] == 1


def test_before_it_is_started_nothing_can_be_handed_down():
    one = node()
    one.engine = None
    with pytest.raises(ValueError, match="node not started"):
        one.give(1, {"a": 1})


def test_a_record_is_told_without_what_is_its_drivers():
    names = ("number", "rng", "choice", "asked", "x", "y")
    declared = [(name, 2 * (name == "y"), 0, 0, "", "") for name in names]
    record = SimpleNamespace(number=1, rng=2, choice=3, asked=4, x=5, y=(6, 7))
    assert values_of(record, declared) == {"x": 5, "y": [6, 7]}


def test_several_frames_that_came_in_the_same_bytes_are_all_handled():
    class Coder:
        reasons = ("ok", "short")
        encode = staticmethod(bytes)

        def read(self, data, frame):
            for one in data:
                setattr(frame, PLAIN, FRAME[PLAIN][1] + one)
                yield 0
            if len(data) > 2:
                yield 1  # the rest is none

    stack = DeclaredStack(networks()["babel"], 1, {}, 7, [0, 1])
    stack.coder, heard = Coder(), []
    stack.on_frame = lambda now, port: heard.append((port, getattr(stack.inbox, PLAIN)))

    async def main():
        one = DeclaredNode("n1", stack, [])
        async with one:
            heard.clear()
            path = SimpleNamespace(
                cut=False, carries=True, loss=0.0, counters=one.outcomes, port=1, heard_at=0
            )
            one._receive(path, b"\x00\x01")
            one._receive(path, b"\x02\x03\x04")
            return one.counters()["frames"]

    least = FRAME[PLAIN][1]
    assert time_by_hand.run(main()) == 5
    assert heard == [(1, least + k) for k in range(5)]


LINE = {"kind": "babel", "nodes": 3, "shape": "line"}


def planned(**more):
    return scenarios.plan(scenarios.from_dict({**LINE, **more}))


def test_the_cables_of_a_plan_and_the_ports_they_are_at():
    plan = planned()
    made = Deployment(plan)
    assert (made.names, made.links) == (["n0", "n1", "n2"], [(0, 1), (1, 2)])
    graph = plan.graph
    for cable, ends in enumerate(made.links):
        here, there = (made.port_of(node, cable) for node in ends)
        end = 4 * ends[0] + here
        assert graph.peer[end] == 4 * ends[1] + there
    head, tables = made.file(1, [1, 0])
    assert head == {"ports": [made.port_of(1, 1), made.port_of(1, 0)]}
    assert tables == {"protocol": dict(plan.params)}
    tables["protocol"].clear()
    assert plan.params, "it is the plan's own"
    with pytest.raises(LookupError):
        made.channel()


def test_a_fault_of_a_cable_has_its_number_from_either_end():
    made = Deployment(planned())
    words = {number: word for number, word in enumerate(networks()["babel"].actions)}
    cut = next(number for number, word in words.items() if word == "cut")
    kill = next(number for number, word in words.items() if word == "kill")
    for cable, ends in enumerate(made._ends):
        for end in ends:
            fault = SimpleNamespace(action=cut, end=end, node=-1)
            assert (made.word(fault), made.cable_of(fault)) == ("cut", cable)
    assert made.cable_of(SimpleNamespace(action=kill, end=-1, node=2)) == -1


def test_inputs_are_handed_to_their_nodes_in_order_of_time(monkeypatch):
    asked = []

    async def ask(where, request):
        asked.append((round(asyncio.get_running_loop().time() - 1000, 6), where, request))

    monkeypatch.setattr(deployment, "ask", ask)
    made = Deployment(planned())
    one = [SimpleNamespace(at_us=at, node=node, kind=kind, item={"x": at})
           for at, node, kind in ((2_000_000, 0, 1), (500_000, 2, 3))]  # fmt: skip
    made.plan = SimpleNamespace(inputs=one)
    stage = SimpleNamespace(socket=lambda name: f"{name}.sock")

    async def main():
        for other in made.others(stage):
            await other

    time_by_hand.run(main())
    assert asked == [
        (0.5, "n2.sock", {"do": "input", "kind": 3, "item": {"x": 500_000}}),
        (2.0, "n0.sock", {"do": "input", "kind": 1, "item": {"x": 2_000_000}}),
    ]
    asked.clear()
    made.slower = lambda: 3
    time_by_hand.run(main())
    assert [one[0] for one in asked] == [1.5, 6.0]


def test_a_link_of_a_field_is_found_whichever_end_is_named_first():
    made = FieldDeployment.__new__(FieldDeployment)
    made.names, made.links = ["n0", "n1", "n2"], [(0, 1), (1, 2)]
    made.word = lambda fault: fault.what
    fault = SimpleNamespace(what="cut", node=2, other=1, index=4)
    assert made.cable_of(fault) == 1
    assert made.cable_of(SimpleNamespace(what="cut", node=0, other=1)) == 0
    assert made.cable_of(SimpleNamespace(what="kill", node=0, other=1)) == -1
    fault.other = 0
    with pytest.raises(LiveError, match=r"event\.4: n0 and n2 do not hear each other"):
        made.cable_of(fault)


@pytest.mark.parametrize(("etx", "hellos"), [(0, 3), (1, 4)])
def test_a_network_says_after_what_silence_a_path_is_broken(etx, hellos):
    params = {**fields.DEFAULTS, "etx": etx}
    stack = DeclaredStack(networks()["babel"], 1, params, 1, [0])
    assert stack.silent_us == hellos * params["hello_us"]
