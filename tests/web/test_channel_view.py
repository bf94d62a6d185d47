"""A network of one's own on a channel, on the page."""

import math
from types import SimpleNamespace

import numpy as np
import pytest

from innervate import scenario
from innervate.scenario.actions.channel import JOIN, KILL, LEAVE
from innervate.web.channel_view import ChannelView
from innervate.web.errors import Refused
from innervate.web.messages import Cut, Kill, Revive
from innervate.web.simulated import Simulated
from tests.own import alone, made

__all__ = ["alone"]


@pytest.mark.slow  # compiles a protocol that no other test runs
def test_its_nodes_are_shown_switched_off_and_on(alone):
    talk = made(alone / "talk", "channel")
    (talk.folder / "more.py").write_text(
        '"""More."""\n\n\ndef twice(node, params):\n    """Twice the value."""\n'
        '    return 2 * node.value\n\n\nSHOWS = {"twice": ("raw", twice)}\n'
    )
    talk.change("network.py", '    frames="frames",\n',
                '    frames="frames",\n    shows="more:SHOWS",\n')  # fmt: skip
    source = Simulated(scenario.plan(scenario.load(talk.scenario, ["event=[]"])))
    source.prepare()
    scene = source.scene()
    assert [node["label"] for node in scene["nodes"]] == [f"node {i}" for i in range(6)]
    assert scene["fields"][-1] == {"name": "twice", "unit": "raw", "meaning": "Twice the value."}
    source.do(Kill(2))
    with pytest.raises(Refused, match="off already"):
        source.do(Kill(2))
    with pytest.raises(Refused, match="no links"):
        source.do(Cut(0))
    assert source.fields()["node_up"].tolist() == [1, 1, 0, 1, 1, 1]
    source.do(Revive(2))
    source.run_to_end()
    state = source.fields()
    assert state["node_up"].tolist() == [1] * 6
    assert state["fields"]["value"] == [7] * 6
    assert state["fields"]["twice"] == [14.0] * 6


@pytest.fixture
def view():
    """A view of four nodes, without a simulation: what one leaves in its tables is put there."""
    made = object.__new__(ChannelView)
    made.plan = SimpleNamespace(nodes=4, absent=[0, 0, 1, 0], kind="x")
    made.shown, made.own = [{"name": "value"}], {}
    # Of more than there are nodes.
    states = np.zeros(6, [("value", np.int64)])
    radios = np.zeros(6, [("alive", np.int64), ("leaving", np.int64)])
    world = SimpleNamespace(run={"handled": [0]}, radios=radios, stations=states,
                            params=np.zeros(1, [("a", np.int64)]))  # fmt: skip
    made.engine = SimpleNamespace(world=world)
    return made


def test_who_is_on_is_who_was_there_at_first_and_then_who_was_switched_on(view):
    assert view.arrays(False)["node_up"].tolist() == [1, 1, 0, 1]
    assert view.arrays(False)["absent"].tolist() == [0, 0, 1, 0]
    assert (view.arrays(False)["unconnected"], view.arrays(False)["away"]) == (0, 1)
    view.engine.world.run["handled"] = [1]
    assert view.arrays(False)["unconnected"] == 4
    view.engine.world.radios["alive"][[0, 2, 5]] = 1
    view.engine.world.stations["value"] = [5, 6, 7, 8, 0, 9]
    told = view.arrays(True)
    assert (told["node_up"].tolist(), told["unconnected"], told["apart"]) == ([1, 0, 1, 0], 2, 0)
    assert (told["link_up"].tolist(), told["flights"]) == ([], [])
    assert told["fields"] == {"value": [5, 6, 7, 8]}


def test_who_has_left_is_not_among_those_that_are_switched_off(view):
    view.engine.world.run["handled"] = [1]
    view.engine.world.radios["leaving"][[1, 2, 4]] = 2
    view.engine.world.radios["alive"][1] = 1  # it tells the others yet
    told = view.arrays(False)
    assert (told["absent"].tolist(), told["unconnected"], told["away"]) == ([0, 0, 1, 0], 2, 1)


@pytest.mark.parametrize(("absent", "action", "expected"), [
    ([0, 0, 1, 0], KILL, True), ([0] * 4, LEAVE, True), ([0] * 4, KILL, False),
])  # fmt: skip
def test_legends_name_the_absent_where_somebody_is_at_times(view, absent, action, expected):
    view.plan.absent, view.plan.faults = absent, [view.make(7, 0, {"action": action, "node": 1})]
    assert view.has_absent() is expected


def test_nodes_that_are_on_are_switched_off_and_others_on(view):
    fault = view.make(7, 3, view.kill(1, False))
    assert (fault.at_us, fault.index, fault.action, fault.node) == (7, 3, KILL, 1)
    assert view.takes(fault)
    mended = view.make(8, 4, view.kill(2, True))
    assert (mended.action, mended.node, view.takes(mended)) == (JOIN, 2, False)


@pytest.mark.parametrize(("does", "number", "is_mended", "message"), [
    ("kill", 1, True, "this node is on"), ("kill", 2, False, "this node is off already"),
    ("kill", 4, False, "no node 4"), ("cut", 0, False, "have no links"),
])  # fmt: skip
def test_what_cannot_be_done_is_refused(view, does, number, is_mended, message):
    with pytest.raises(Refused, match=message):
        getattr(view, does)(number, is_mended)


def test_nodes_lie_in_a_circle_so_far_apart(view):
    view.plan.nodes = 12
    places = [(one["x"], one["y"]) for one in view.scene()["nodes"]]
    radius = 1.5 * 12 / (2 * math.pi)
    assert [math.hypot(*place) for place in places] == pytest.approx([radius] * 12, abs=0.001)
    assert places[0] == pytest.approx((radius, 0), abs=0.001)
    assert places[3] == pytest.approx((0, radius), abs=0.001)
    assert view.scene()["links"] == []
