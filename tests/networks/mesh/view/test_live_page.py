"""Robots, alarms and names of running nodes on the page, by what the nodes say."""

from types import SimpleNamespace

import numpy as np
import pytest

from innervate import scenario
from innervate.networks.mesh.view import live
from innervate.networks.mesh.view.live import MeshLiveView, MeshMap, MeshState
from innervate.web.live import Live
from innervate.web.live_poll import Poller
from innervate.web.live_scene import FILE

YARD = """
kind = "mesh"
name = "yard"
radio = { reach_m = 60 }
[[node]]
name = "mast"
x_m = 0
y_m = 0
[[node]]
name = "rover"
x_m = 20
y_m = 20
[[robot]]
node = "rover"
waypoints = [[20, 20], [50, 20]]
speed_mps = 1.0
[fence]
polygon = [[10, 5], [40, 5], [40, 35], [10, 35]]
"""


def node(number, **more):
    return {"kind": "mesh", "role": "node", "number": number, "gateway": 0, "paths": [],
            "onward": [0] if number else [], "counters": {}, "neighbours": [], **more}  # fmt: skip


def alarm(kind, number, ago_s, robot=1):
    return {"kind": kind, "robot": robot, "reporter": robot, "number": number, "ago_s": ago_s}


def robot(at_cm, fence):
    return node(1, robot={"at_cm": at_cm, "fence": fence})


@pytest.mark.parametrize(
    ("fence", "alarms", "outside", "raised"),
    [
        ("inside", [], 0, 0),
        ("about to cross", [alarm("predict", 1, 0.1)], 0, 1),
        ("outside", [alarm("predict", 1, 3.0), alarm("cross", 2, 2.0)], 1, 1),
        ("inside", [alarm("clear", 3, 1.0), alarm("cross", 2, 2.0)], 0, 0),
        ("outside", [alarm("clear", 3, 9.0), alarm("cross", 4, 2.0)], 1, 1),
        ("outside", [], 1, 0),  # nobody learned of it
    ],
)
def test_a_robot_that_is_out_and_its_newest_alarm_are_shown(fence, alarms, outside, raised):
    told = {0: node(0, role="gateway", alarms=alarms), 1: robot([0, 0], fence)}
    shown = MeshState(MeshMap(told), told).fields()
    assert (shown["outside"], shown["alarm"]) == ([0, outside], [0, raised])


def test_the_alarm_of_a_robot_that_is_silent_stays():
    told = {0: node(0, role="gateway", alarms=[alarm("lost", 7, 1.0)]), 1: robot(None, "inside")}
    where = MeshMap(told)
    del told[1]
    assert MeshState(where, told).fields()["alarm"] == [0, 1]


def test_who_was_put_out_has_no_way_though_nobody_has_noticed_yet():
    def near(who):
        return [{"node": who, "quality": None, "suspect": False, "ports": []}]

    keys = {"identity": {"serial": 2, "list": 1, "revoked": []}}
    told = {0: node(0, role="gateway", neighbours=near(1)), 1: node(1, neighbours=near(0))}
    told[1]["keys"] = keys
    assert MeshState(MeshMap(told), told).headline().level == "ok"
    keys["identity"]["revoked"] = [2]
    found = MeshState(MeshMap(told), told).headline()
    assert (found.level, found.nodes) == ("down", (1,))
    assert found.text == "1 of 2 nodes was put out: its identity is revoked."
    told[0]["role"] = "node"
    state = MeshState(MeshMap(told), told)
    assert (state.unconnected, state.lacking, state.left) == (2, 1, 1), "it could not have a way"
    assert state.apart == 0
    told[0] |= {"role": "gateway", "keys": keys}
    state = MeshState(MeshMap(told), told)
    assert state.unconnected == 2, "a gateway that is put out leads nobody, and has no way either"
    assert state.without_words() == "2 that are put out"
    assert state.fields()["apart"] == 0
    where = MeshMap(told)
    del told[1]
    assert MeshState(where, told).unconnected == 1, "who is silent does not count"


def test_every_alarm_is_told_once_and_old_ones_with_their_age():
    view, names = MeshLiveView(), ["n0", "n1"].__getitem__
    told = {0: node(0, alarms=[alarm("cross", 2, 2.0), alarm("predict", 1, 61.0)]), 1: node(1)}
    assert view.news(told, names) == [
        ("alarm at n0: robot n1 is about to cross the fence, 61 s ago", "bad"),
        ("alarm at n0: robot n1 has crossed the fence", "bad"),
    ]
    assert view.news(told, names) == []
    told[0]["alarms"] += [alarm("clear", 3, 0.2), alarm("lost", 4, 0.1, robot=9)]
    assert view.news(told, names) == [
        ("alarm at n0: robot n1 is inside again", "good"),
        ("alarm at n0: robot n9 is lost", "bad"),
    ]


def test_a_robot_is_drawn_where_it_says_it_is_and_nodes_bear_the_scenarios_names(
    tmp_path, monkeypatch
):
    """The fence's origin is its corner at (10, 5) m; the robot is 32 m east, 20 m north of it."""
    (tmp_path / FILE).write_text(scenario.dump(scenario.loads(YARD)))
    told = {0: node(0, role="gateway"), 1: robot([3200, 2000], "outside")}
    assert scenario.plan(scenario.loads(YARD)).origin_cm == (1000, 500)
    monkeypatch.setattr(Poller, "ask_all", lambda self, request: dict(told))
    source = Live([tmp_path / "n0.sock", tmp_path / "n1.sock"])
    scene = source.scene()
    assert [(one["also"], one["role"]) for one in scene["nodes"]] == [
        ("mast", "gateway"), ("rover", "robot"),
    ]  # fmt: skip
    assert [(one["x"], one["y"]) for one in scene["nodes"]] == [(0, 0), (20, -20)]
    assert source.fields()["position"] == [[0, 0], [42, -25]]
    told[1] = robot(None, "inside")  # started anew, it has not been told yet where it is
    source._poll()
    assert "position" not in source.fields()


def test_robots_are_where_they_say_from_the_corner_of_the_fence_with_y_down():
    known = SimpleNamespace(origin_m=(10.0, 40.0))
    told = {0: node(0), 1: robot([250, 104], "inside"), 2: robot(None, "inside")}
    assert MeshLiveView().moved(told, known) == {1: (12.5, 38.96)}


def hears(*nodes):
    return [{"node": node, "ports": [node + 4, node + 5]} for node in nodes]


def test_links_are_between_those_who_hear_each_other_by_their_paths():
    told = {5: node(0, role="gateway", neighbours=hears(1, 9, 0)), 6: node(1, neighbours=hears(2)),
            8: node(2, neighbours=hears(1))}  # fmt: skip
    where = MeshMap(told)
    found = {(link.a.node, link.b.node): (link.paths_a, link.paths_b) for link in where.links}
    assert found == {(5, 6): ((5, 6), ()), (6, 8): ((6, 7), (5, 6))}


def ways(told, lost=()):
    """What is found of a map of all, of whom some do not answer."""
    return MeshState(MeshMap(told), {at: one for at, one in told.items() if at not in lost})


CHAIN = {0: node(0, role="gateway", neighbours=hears(1)), 1: node(1, neighbours=hears(0, 2)),
         2: node(2, neighbours=hears(1), onward=[1]),
         3: node(3, neighbours=[], onward=[1])}  # fmt: skip


def test_who_reaches_its_gateway_who_is_astray_and_who_is_cut_off():
    state = ways(CHAIN)
    assert state.look() == (1, 0, 2)  # n3 hears nobody
    shown = state.more()
    assert (shown["parent"].tolist(), shown["depth"].tolist()) == ([-1, 0, 1, 1], [0, 1, 2, -1])
    assert shown["apart"] == 1
    assert ways(CHAIN, lost=[1]).look() == (2, 0, 0)  # who is off has no way to lose
    assert ways(CHAIN, lost=[3]).look() == (0, 0, 2)
    standby = {**CHAIN, 1: node(1, role="standby", neighbours=hears(0, 2))}
    assert ways(standby).look() == (1, 0, 2)


def test_what_nodes_say_of_their_ways(monkeypatch):
    monkeypatch.setattr(live, "ways", lambda *given: given)
    told = {**CHAIN, 1: node(1, role="standby", neighbours=hears(0, 2), gives_back=False),
            2: node(2, neighbours=hears(1), onward=[1, 0])}  # fmt: skip
    state = MeshState.__new__(MeshState)
    state.map, state.told = MeshMap(told), {at: told[at] for at in (0, 1, 2)}
    carries = np.eye(4, dtype=np.bool_)  # links that carry frames
    state.live = lambda: carries
    known, links, on, off, leads = state._find_ways()
    assert (links == carries).all()
    assert (on.tolist(), off.tolist()) == ([True] * 3 + [False], [False] * 3 + [True])
    assert leads.tolist() == [True, False, False, False]
    assert known.gateway.tolist() == [0, 0, 0, -1]
    assert known.named.tolist() == [[-1, -1], [0, -1], [1, 0], [-1, -1]]
    assert known.neighbours.astype(int).tolist() == [
        [0, 1, 0, 0], [1, 0, 1, 0], [0, 1, 0, 0], [0, 0, 0, 0]]  # fmt: skip
    assert not known.goes_back  # of one alone it is known that it does not
    del told[1]["gives_back"]
    assert state._find_ways()[0].goes_back


@pytest.mark.parametrize(("said", "shown"), [
    ({}, "node"), ({"robot": {}}, "robot"), ({"robot": {}, "role": "gateway"}, "gateway"),
    ({"role": "standby"}, "standby"),
])  # fmt: skip
def test_a_robot_is_shown_as_one_unless_it_is_more(said, shown):
    assert MeshLiveView().role(node(1) | said) == shown


def test_an_alarm_of_another_witness_is_told_too():
    one = alarm("cross", 2, 1.0)
    told = {0: node(0, role="gateway", alarms=[one, one, one | {"reporter": 4}])}
    assert [text for text, _ in MeshLiveView().news(told, lambda i: f"n{i}")] == [
        "alarm at n0: robot n1 has crossed the fence",
        "alarm at n0: robot n1 has crossed the fence, says n4",
    ]


def test_nodes_are_drawn_where_their_scenario_has_them_and_bear_its_names():
    plan = scenario.plan(scenario.loads(YARD.replace('name = "rover"', 'name = "n1"').replace(
        'node = "rover"', 'node = "n1"')))  # fmt: skip
    drawn = MeshLiveView().drawn(plan)
    assert drawn.labels == {"n0": "mast"}
    assert drawn.origin_m == (10.0, -5.0)
    assert drawn.places == {"n0": (0, 0), "n1": (20, -20)}


def judged(told, lost=()):
    found = ways(told, lost).headline()
    return found.level, found.text


def test_a_node_alone_on_its_machine_has_its_way_by_those_on_others():
    """On a robot one node runs: its gateway, and who relays to it, are elsewhere."""
    told = {0: node(3, neighbours=hears(2), onward=[2])}
    assert judged(told) == (
        "ok",
        "The only node has a way to the gateway; nodes 0, 2 do not run here, and what is said of "
        "them is believed.",
    )
    shown = ways(told).more()
    assert (shown["parent"].tolist(), shown["depth"].tolist(), shown["way"].tolist()) == (
        [-1], [-1], [0],
    )  # fmt: skip
    told[0]["neighbours"][0]["suspect"] = True
    assert judged(told)[0] == "down"
    assert judged({0: node(3, neighbours=[], onward=[], gateway=None)}) == (
        "no data", "No node leads as gateway yet.",
    )  # fmt: skip


def path(port, **more):
    return {"name": f"udp {port}", "own": "", "port": port, "up": True, "broken": False, **more}


@pytest.mark.parametrize(("neighbours", "paths", "level"), [
    ([2], [path(0, broken=True), path(1)], "ok"),
    ([], [], "ok"),  # a network of one node
    ([], [path(0)], "down"),
    ([2], [path(0, broken=True), path(1, up=False)], "down"),  # whom it has not forgotten yet
])  # fmt: skip
def test_a_gateway_alone_on_its_machine_is_well_if_it_hears_somebody(neighbours, paths, level):
    told = {0: node(0, role="gateway", onward=[], neighbours=hears(*neighbours), paths=paths)}
    found = judged(told)
    assert found[0] == level
    assert level == "ok" or found[1] == "The only node leads, and hears nobody."


def chain_by(middle, **more):
    """Gateway 0, then 1, then `middle` elsewhere, and 3 behind it."""
    return {0: node(0, role="gateway", neighbours=hears(1)),
            1: node(1, neighbours=hears(0, middle)),
            2: node(3, neighbours=hears(middle), onward=[middle], **more)}  # fmt: skip


@pytest.mark.parametrize("gives_back", [True, False])
def test_a_node_elsewhere_hands_on_to_who_is_nearest_to_the_gateway(gives_back):
    told = chain_by(2, gives_back=gives_back)
    assert judged(told) == (
        "ok",
        "All 3 nodes have a way to the gateway; node 2 does not run here, and what is said of it "
        "is believed.",
    )
    shown = ways(told).more()
    assert (shown["parent"].tolist(), shown["depth"].tolist()) == ([-1, 0, -1], [0, 1, -1])
    told[1]["neighbours"][1]["suspect"] = True  # nobody here hears it but 3
    level, text = judged(told)
    assert (level, text.split(":")[0]) == (
        "degraded", "1 of 3 nodes is cut off from the gateway"
    )  # fmt: skip


def test_a_path_that_was_cut_here_leads_nowhere_else_either():
    told = chain_by(2)
    told[2]["paths"] = [{"port": port, "up": False} for port in (6, 7)]
    assert judged(told)[0] == "degraded"


def test_who_runs_here_and_is_silent_is_not_elsewhere():
    told = chain_by(2) | {3: node(2, neighbours=hears(1, 3), onward=[1])}
    assert judged(told)[1] == "All 4 nodes have a way to the gateway."
    level, text = judged(told, lost=[3])
    assert level == "degraded"
    assert text.startswith("1 of 4 nodes is cut off from the gateway")
    assert "run here" not in text
    del told[3]["number"]  # of a dead node whose number nobody knows the socket is left
    assert judged(told, lost=[3]) == (
        "degraded",
        "1 of 4 nodes is silent; node 2 does not run here, as far as is known, and what is said "
        "of it is believed.",
    )


def test_who_died_here_with_a_number_that_nobody_knows_takes_nobodys_gateway_away():
    """On a robot two nodes ran; the gateway runs elsewhere, and is heard."""
    told = {0: node(1, neighbours=hears(0), onward=[0]), 1: node(3)}
    del told[1]["number"]
    assert judged(told, lost=[1]) == (
        "degraded",
        "1 of 2 nodes is silent; node 0 does not run here, as far as is known, and what is said "
        "of it is believed.",
    )


def test_a_gateway_elsewhere_from_which_nothing_comes_leads_nobody_though_others_are_heard():
    """It died, and messages to it go on from node to node: all of these hear each other."""
    told = {0: node(1, neighbours=hears(2), onward=[0])}
    assert judged(told)[0] == "ok"  # who is heard is believed to find it
    told[0]["gateway_silent"] = True
    assert judged(told) == (
        "down",
        "Nothing comes from the gateway any more, and what is sent to it does not get through; "
        "nodes 0, 2 do not run here, and what is said of them is believed.",
    )
    told[1] = node(3, neighbours=hears(0), onward=[0])
    assert judged(told)[0] == "ok"  # another one here heard it just now


def test_a_gateway_elsewhere_beside_one_here_makes_two_parts():
    told = {0: node(0, role="gateway", neighbours=hears(1)), 1: node(1, neighbours=hears(0)),
            2: node(3, gateway=9, neighbours=hears(9), onward=[9])}  # fmt: skip
    level, text = judged(told)
    assert level == "degraded"
    assert text.startswith("2 nodes lead as gateways, each followed by a part of the network")
