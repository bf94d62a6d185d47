"""Networks of one's own over cables: shapes, cables by name, events, inputs, what is refused."""

import math

import pytest

from innervate import scenario as scenarios
from innervate.scenario.actions.cables import ACTIONS
from innervate.scenario.cables import CablesPlan
from innervate.scenario.errors import ScenarioError

RING = {"kind": "babel", "nodes": 4, "duration_s": 2.0}


def planned(**changes):
    return scenarios.plan(scenarios.from_dict(RING | changes))


def cables(made):
    return sorted("-".join(map(made.graph.label_end, pair)) for pair in made.graph.links())


@pytest.mark.parametrize(
    ("shape", "nodes", "joined"),
    [
        ("line", 2, ["n0 E-n1 W"]),
        ("line", 4, ["n0 E-n1 W", "n1 E-n2 W", "n2 E-n3 W"]),
        ("ring", 3, ["n0 E-n1 W", "n0 W-n2 E", "n1 E-n2 W"]),
        ("grid", 5, ["n0 E-n1 W", "n0 down-n3 up", "n1 E-n2 W", "n1 down-n4 up", "n3 E-n4 W"]),
        ("grid", 4, ["n0 E-n1 W", "n0 down-n2 up", "n1 down-n3 up", "n2 E-n3 W"]),
        ("tree", 6, ["n0 E-n2 up", "n0 W-n1 up", "n0 down-n3 up", "n1 E-n5 up", "n1 W-n4 up"]),
    ],
)
def test_shapes(shape, nodes, joined):
    made = planned(shape=shape, nodes=nodes)
    assert made.graph.cells == nodes
    assert cables(made) == joined


def test_cables_of_which_nothing_is_said_are_the_same_in_a_file_and_in_code():
    made = planned()
    bare = CablesPlan(made.scenario, made.graph, "babel", made.seed, 1, made.params)
    for one in (made, bare):
        assert (one.start_us, one.latency_us, one.wire_us) == (1_000, (80, 160), 60)
        assert (one.queue_frames, one.loss_q15, one.data_period_us) == (8, 0, 0)
        assert not one.latency_per_frame


@pytest.mark.parametrize("nodes", [2, 9, 10, 16, 17, 40])
def test_a_grid_has_rows_of_the_root_of_its_nodes(nodes):
    wide = math.ceil(nodes**0.5)
    made = planned(shape="grid", nodes=nodes)
    across = sum(1 for k in range(1, nodes) if k % wide)
    assert len(cables(made)) == across + max(0, nodes - wide)


def test_cables_by_name_in_order():
    made = planned(cables=["a.E-b.W", "b-c", "c-a"])
    assert made.graph.names == ("a", "b", "c")
    assert cables(made) == ["a E-b W", "a W-c E", "b E-c W"]


@pytest.mark.parametrize(
    ("table", "is_to"),
    [
        ({"action": "cut", "link": "n1-n2"}, {"end": 5, "node": -1, "loss": 0, "frames": 0}),
        ({"action": "cut", "link": "n2-n1"}, {"end": 5, "node": -1, "loss": 0, "frames": 0}),
        ({"action": "restore", "link": "n3-n0"}, {"end": 0, "node": -1, "loss": 0, "frames": 0}),
        ({"action": "loose", "link": "n0-n1"},
         {"end": 1, "node": -1, "loss": 16_384, "frames": 0}),
        ({"action": "loose", "link": "n0-n1", "loss": 0.25},
         {"end": 1, "node": -1, "loss": 8192, "frames": 0}),
        ({"action": "lose", "link": "n0-n1"}, {"end": 1, "node": -1, "loss": 0, "frames": 1}),
        ({"action": "lose", "link": "n0-n1", "frames": 7},
         {"end": 1, "node": -1, "loss": 0, "frames": 7}),
        ({"action": "kill", "node": 3}, {"end": -1, "node": 3, "loss": 0, "frames": 0}),
        ({"action": "revive", "node": 0}, {"end": -1, "node": 0, "loss": 0, "frames": 0}),
    ],
)  # fmt: skip
def test_an_event_is_planned(table, is_to):
    made = planned(event=[{"at_s": 1.5, "action": "kill", "node": 0}, {"at_s": 1.25, **table}])
    one, other = made.faults
    assert (one.at_us, one.index, other.at_us, other.index) == (1_250_000, 1, 1_500_000, 0)
    assert ACTIONS[one.action] == table["action"]
    found = {"end": one.end, "node": one.node, "loss": one.loss_q15, "frames": one.frames}
    peer = made.graph.peer[is_to["end"]]
    assert found in (is_to, is_to | {"end": peer if is_to["end"] >= 0 else -1})


def test_what_links_are_like():
    links = {"loss": 0.5, "latency_us": [7, 9], "wire_us": 11, "queue_frames": 3}
    made = planned(links=links, drift_ppm=17, start_us=23)
    assert (made.loss_q15, made.latency_us, made.wire_us) == (16_384, (7, 9), 11)
    assert (made.queue_frames, made.drift_ppm, made.start_us) == (3, 17, 23)
    assert made.duration_us == 2_000_000
    assert planned(links={"latency_us": [9, 9]}).latency_us == (9, 9)


def inputs(made):
    return [(one.at_us, one.node, one.kind) for one in made.inputs]


def test_inputs_are_for_all_nodes_or_one_and_in_order_of_time():
    made = planned(input=[{"at_s": 1.0, "kind": 3}, {"at_s": 0.4, "every_s": 0.8, "node": 2}])
    all_of_them = [(1_000_000, node, 3) for node in range(4)]
    assert inputs(made) == [(400_000, 2, 1), *all_of_them, (1_200_000, 2, 1)]


def test_more_than_a_million_inputs_are_refused():
    often = {"every_s": 2e-6, "node": 0}
    with pytest.raises(ScenarioError, match="more than 1,000,000 inputs"):
        planned(duration_s=2.0, input=[{"node": 1}, often])


@pytest.mark.parametrize(
    ("wrong", "says"),
    [
        ({"links": {"latency_us": [9, 8]}}, r"latency_us must be \[least, greatest\]"),
        ({"event": [{"at_s": 0, "action": "cut"}]}, 'cut needs a link; add link = "n0-n1"'),
        ({"event": [{"at_s": 0, "action": "kill"}]}, "kill needs a node; add node = 0"),
        ({"event": [{"at_s": 0, "action": "cut", "link": "n0-n1", "node": 1}]}, "has no node"),
        ({"event": [{"at_s": 0, "action": "cut", "node": 9}]}, "cut needs a link"),
        ({"event": [{"at_s": 0, "action": "kill", "link": "n0-n1", "node": 1}]}, "has no link"),
        ({"event": [{"at_s": 0, "action": "cut", "link": "n0-n2"}]}, 'no cable "n0-n2"'),
        ({"event": [{"at_s": 0, "action": "cut", "link": "n0-n1-n2"}]}, "no cable"),
        ({"event": [{"at_s": 0, "action": "kill", "node": 4}]}, "there is no node 4"),
        ({"input": [{"node": 4}]}, "there is no node 4; they are 0 to 3"),
        ({"cables": ["a-b", "a.9-b"]}, r"port"),
    ],
)
def test_what_cannot_be_is_refused(wrong, says):
    with pytest.raises(ScenarioError, match=says):
        planned(**wrong)


def test_an_error_of_a_cable_is_at_its_place():
    with pytest.raises(ScenarioError) as told:
        planned(cables=["a.E-b.W", "b-c", "a.E-c.W"])
    assert told.value.key == "cables.2"
