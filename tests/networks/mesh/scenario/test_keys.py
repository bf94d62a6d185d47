"""Mesh scenarios: what is refused, and with which sentence."""

from pathlib import Path
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from innervate.scenario import ScenarioError, from_dict, json_schema, load, loads, plan

SMALL = """\
kind = "mesh"
nodes = 12

[radio]
mean_degree = 6

[fence]
polygon = [[20, 20], [80, 20], [80, 80], [20, 80]]
holes = [[[40, 40], [50, 40], [50, 50]]]

[[robot]]
node = 3
waypoints = [[50, 70], [50, 90]]

[[flow]]
from = 5
to = "monitor"

[[event]]
at_s = 10.0
action = "kill"
node = "n2"
"""

SQUARE = "[[20, 20], [80, 20], [80, 80], [20, 80]]"
HOLE = "[[[40, 40], [50, 40], [50, 50]]]"
MISTAKES = {
    "nodes = 12": [
        ("nodes = 0", "2: nodes must be 1 to 254, not 0"),
        ("nodes = 255", "2: 255 nodes are too many: an address is one byte"),
        ("nodes = 255", "in the table-free mode (protocol.tables = false) too"),
        ("", " there is no network; add nodes = 30, [[node]]s or an [import]"),
        ('nodes = 12\nimport.file = "x"', "3: a mesh is made of one of them: nodes or"),
        ("nodes = 12\ngateway = 12", "3: gateway: there is no node 12"),
        ('nodes = 12\ngateway = "n12"', '3: gateway: there is no node "n12"; did you'),
        ('nodes = 12\nmonitor = "me"', '3: monitor: there is no node "me"; there are n0'),
        ("nodes = 12\nstandby = [0]", "3: standby.0: n0 is the gateway; name another"),
        ("nodes = 12\nstandby = [4, 4]", "3: standby.1: n4 is a standby already"),
        ('nodes = 12\nprotocol.failover = "grpah"', 'did you mean "graph"?'),
    ],
    "mean_degree = 6": [
        ("mean_degree = 12", "5: radio.mean_degree = 12, but there are 11 others"),
        ("mean_degree = 1", "the network falls into"),
        ("tx_dbm = -60", "raise radio.tx_dbm"),
        ("reach_m = 1", "raise radio.reach_m"),
        ("reach_m = 9\ntx_dbm = 3", "6: radio.reach_m and radio.tx_dbm both set"),
        ('mac = "csma-cd-r"', '5: radio.mac = "csma-cd-r" needs all nodes to hear'),
        ('mac = "csma-cd-d1"', "hears others while it sends, as on a cable; radios"),
        ('mac = "aloha"', '5: radio.mac must be "csma", "none"'),
        ('profile = "ideal"\nmac = "csma"', "6: radio.mac = \"csma\" has nothing"),
    ],
    SQUARE: [
        ("[[20, 20], [80, 80], [80, 20], [20, 80]]", "8: fence.polygon crosses itself: edge 0"),
        ("[[0, 0], [80, 0], [40, 80], [40, 0], [0, 80]]", "8: fence.polygon touches itself"),
        ("[[0, 0], [90, 0], [90, 90], [90, 5]]", "8: fence.polygon touches itself: edges"),
        ("[[20, 20], [20, 20], [80, 80], [20, 80]]", "8: fence.polygon has corner 0 twice in"),
        ("[[20, 20], [80, 20]]", "8: fence.polygon must have 3 corners or more, not 2"),
        ("[[20, 20]]", "8: fence.polygon must have 3 corners or more, not 1"),
        ("[[20, 20, 3]]", "8: fence.polygon.0 must be a point [x, y] in metres"),
        ("[[0, 0], [30000, 0], [30000, 90], [0, 90]]", "8: the fence and its robots spread"),
        (f"[{', '.join(f'[{i}, {i * i}]' for i in range(49))}]", "52 corners, more than 48"),
    ],
    HOLE: [
        ("[[[70, 70], [90, 70], [90, 90]]]", "9: fence.holes.0 is not wholly inside"),
        ("[[[20, 30], [30, 30], [30, 40]]]", "9: fence.holes.0 is not wholly inside"),
        (f"[{HOLE[1:-1]}, [[45, 42], [60, 42], [60, 60]]]", "9: fence.holes.0 and 1 overlap"),
        (f"{HOLE}\nunit_cm = 2", "10: fence.unit_cm must be a unit of 1, 10 or 100 cm"),
    ],
    "node = 3": [
        ("node = 12", "12: robot.0.node: there is no node 12; they are numbered 0 to 11"),
    ],
    "waypoints": [
        ("random = true\nwaypoints", "14: robot.0 is random and has waypoints"),
        ("area = [0, 0, 9, 9]\nwaypoints", "13: robot.0.area goes with random = true"),
    ],
    "from = 5": [
        ("from = 12", "16: flow.0.from: there is no node 12"),
        ('from = "monitor"', '16: flow.0.from must be a node, "all", "random"'),
        ("from = 0", "15: flow.0 goes from n0 to n0; name two nodes"),
        ("from = 5\npairs = 2", '17: flow.0.pairs goes with from = "random"'),
        ('from = "random"\npairs = 12', "but only 11 nodes can be drawn"),
        ("from = 5\nbytes = 1164", "17: flow.0.bytes must be"),
        ("from = 5\nevery_s = 1\nrate_hz = 1", "18: flow.0.every_s and rate_hz say the"),
        ("from = 5\nevery_s = 0.0001\nstart_s = 0", "more than 500,000 messages"),
    ],
    "at_s = 10.0": [
        ("at_s = 60.0", "20: event.0.at_s = 60 is the end of the run, so it would"),
        ("at_s = 61.0", "20: event.0.at_s = 61 is outside the run"),
        ("at_s = [9, 8]", "20: event.0.at_s must be [from, to], not [9, 8]"),
    ],
    '"kill"': [
        ('"cut"', '22: event.0: "cut" takes link = ["n1", "n2"] or random = 1, not node'),
    ],
    'node = "n2"': [
        ('node = "n22"', '22: event.0.node: there is no node "n22"'),
        ("random = 10", "22: event.0.random = 10, but there are 9 nodes that are alive"),
        ("", '19: event.0 ("kill") needs one target: node = 3 or random = 1'),
        ("random = 1\nlink = [1, 2]", '"kill") needs one target'),
        ('node = "n2"\nnoise_dbm = 1', '23: event.0.noise_dbm goes with "jam"'),
    ],
}  # fmt: skip


LINKS = """\
kind = "mesh"
[[link]]
a = "x"
b = "y"
quality = [0.9, 0.7]
[[link]]
a = "y"
b = "z"
"""
WRONG_LINKS = {
    'a = "y"': [
        ('a = "q"', "the network falls into 2 parts: no good links lead to q, z; add the"),
    ],
    'b = "z"': [
        ('b = "x"', "6: link.1 joins y and x a second time; leave one out"),
        ('b = "y"', "6: link.1 joins y with itself"),
        ('b = "all"', '8: link.1.b must be a node by number or name, not "all"'),
    ],
    "[0.9, 0.7]": [
        ("1.5", "5: link.0.quality must be 0 to 1, not 1.5"),
        ("[0, 1]", "no good links lead to x; add"),
    ],
    'kind = "mesh"': [
        ('kind = "mesh"\nnodes = 3',
         '4: link.0.a: there is no node "x"; there are n0, n1, n2'),
        ('kind = "mesh"\n[[node]]\nname = "x"',
         '6: link.0.b: there is no node "y"; there are x'),
        ('kind = "mesh"\n[[node]]\nname = "x"\n[[node]]\nname = "x"',
         '4: there are two nodes "x"; rename one'),
        ('kind = "mesh"\nradio.tx_dbm = 3', "2: radio.tx_dbm has no effect on links"),
        ('kind = "mesh"\n[[robot]]\nnode = "x"\nrandom = true',
         "2: robot x has no position; give it waypoints, or random = true with an area"),
    ],
}  # fmt: skip


@pytest.mark.parametrize(
    ("whole", "old", "new", "message"),
    [
        (whole, old, *mistake)
        for whole, wrong in ((SMALL, MISTAKES), (LINKS, WRONG_LINKS))
        for old, mistakes in wrong.items()
        for mistake in mistakes
    ],
)
def test_mistakes(whole: str, old: str, new: str, message: str) -> None:
    assert old in whole
    with pytest.raises(ScenarioError) as found:
        plan(loads(whole.replace(old, new, 1), path="x.toml"))
    text = str(found.value)
    assert message in text
    assert text.startswith("x.toml:")
    assert "\n" not in text


def test_a_cut_where_no_link_is() -> None:
    text = "[[link]]\na = 'a'\nb = 'b'\n[[link]]\na = 'b'\nb = 'c'\n[[event]]\nat_s = 1\n"
    cut = "action = 'cut'\nlink = ['a', 'c']\n"
    with pytest.raises(
        ScenarioError, match=r"x.toml:\d+: event.0: there is no link a - c; name one"
    ):
        plan(loads(f"kind = 'mesh'\n{text}{cut}", path="x.toml"))


def test_imports_that_leave_nothing_together(tmp_path: Path) -> None:
    (tmp_path / "parts.txt").write_text("a b 0.9 0.9\nc d 0.9 0.9\n")
    parts = 'kind = "mesh"\n[import]\nfile = "parts.txt"\nlargest_component = false\n'
    (tmp_path / "x.toml").write_text(parts)
    with pytest.raises(ScenarioError, match=r"2 parts: .* set import.largest_component = true"):
        plan(load(tmp_path / "x.toml"))
    wrong = 'kind = "mesh"\n[import]\nfile = "freifunk/leipzig"\ntypes = ["wofi"]\n'
    with pytest.raises(ScenarioError, match=r"no link is of type wofi; there is .*wifi"):
        plan(loads(wrong))


@pytest.mark.parametrize(
    ("more", "remedy"),
    [
        ("placement.layout = 'line'\nplacement.spacing_m = 20\nradio.reach_m = 10", "reach_m"),
        ("placement.side_m = 900\nradio.mean_degree = 0.1", "mean_degree"),
        ("placement.side_m = 900\nradio.tx_dbm = -60", "tx_dbm"),
    ],
)
def test_places_that_no_draw_connects(more: str, remedy: str) -> None:
    said = rf"falls into \d parts: no good links lead to .*n2; raise radio\.{remedy}$"
    with pytest.raises(ScenarioError, match=said):
        plan(loads(f"kind = 'mesh'\nnodes = 3\n{more}\n"))


def test_the_whole_extent_can_be_used() -> None:
    corners = "[[0, 0], [{0}, 0], [{0}, 90], [0, 90]]"
    robot = "[[robot]]\nnode = 0\nwaypoints = [[1, 1], [2, 2]]\n"
    text = f"kind = 'mesh'\nnodes = 1\n{robot}[fence]\nunit_cm = 100\npolygon = {corners}\n"
    assert max(plan(loads(text.format(23_000))).params["px"]) == 23_000
    with pytest.raises(ScenarioError, match="the fence and its robots spread"):
        plan(loads(text.format(23_001)))


def test_a_node_without_a_place() -> None:
    with pytest.raises(ScenarioError, match=r"node\.1 has half a place"):
        from_dict({"kind": "mesh", "node": [{"x_m": 1, "y_m": 1}, {"x_m": 1}]})
    with pytest.raises(ScenarioError, match=r"node\.0 has no place; give it x_m and y_m"):
        from_dict({"kind": "mesh", "node": [{"name": "a"}]})


def test_a_message_that_does_not_fit_a_frame() -> None:
    with pytest.raises(ScenarioError, match="at an MTU of 64 it is at most 27"):
        plan(loads(SMALL, ["flow.0.bytes=28", "radio.profile=38k4"]))


def test_a_graph_that_does_not_fit_its_frames() -> None:
    with pytest.raises(ScenarioError, match="hold 85 nodes at an MTU of 64, not 86"):
        plan(loads('kind="mesh"\nnodes=86\nprotocol.failover="graph"\nprotocol.mtu=64'))


RANGES = ("suspect_s", "listen_s", "period_s", "dead_s", "forget_s", "ack_us", "copies", "jitter_s",
          "table_window", "table_tries", "e2e_s", "beacon_s", "transmissions")  # fmt: skip


@pytest.mark.parametrize("key", RANGES)
def test_protocol_keys_know_their_range(key: str) -> None:
    with pytest.raises(ScenarioError, match=f"protocol.{key} must be"):
        loads(SMALL, [f"protocol.{key}=-1"])


def test_periods_that_cannot_be_counted() -> None:
    with pytest.raises(ScenarioError, match=r"protocol\.period_s is out of range; it can be at mo"):
        plan(loads(SMALL, ["protocol.period_s=60000", "protocol.beacon_s=0.1"]))
    with pytest.raises(
        ScenarioError, match=r"protocol\.collect_s must be more than listen_s, 0\.3"
    ):
        plan(loads(SMALL, ["protocol.collect_s=0.2"]))
    with pytest.raises(ScenarioError, match=r"protocol\.period_max_s is below period_s"):
        plan(loads(SMALL, ["protocol.period_s=60", "protocol.period_max_s=30"]))


def test_the_schema_knows_the_mesh() -> None:
    parts = json_schema()["$defs"]
    assert {"MeshScenario", "FenceTable", "FlowTable", "RobotTable"} <= set(parts)
    assert {"from", "to", "every_s"} <= set(parts["FlowTable"]["properties"])
    assert "import" in parts["MeshScenario"]["properties"]


words = st.one_of(
    st.none(), st.booleans(), st.integers(-3, 300), st.integers(), st.floats(), st.text(max_size=6),
    st.lists(st.integers(-2, 200), max_size=3),
    st.lists(st.tuples(st.integers(-9, 99), st.integers(-9, 99)), max_size=5),
    st.sampled_from(["random", "all", "gateway", "monitor", "n3", "graph", "38k4", "ip", "ideal",
                     "grid", "line", "kill", "cut", "jam", "dcf", "freifunk/leipzig"]),
)  # fmt: skip
KEYS = (
    "nodes", "gateway", "standby", "monitor", "duration_s", "seed", "placement.layout",
    "placement.side_m", "placement.spacing_m", "placement.columns", "import.file", "import.topohub",
    "import.min_tq", "radio.profile", "radio.mac", "radio.mean_degree", "radio.reach_m",
    "radio.tx_dbm", "radio.exponent", "radio.shadowing_db", "radio.sense_db", "protocol.failover",
    "protocol.tables", "protocol.mtu", "protocol.beacon_s", "protocol.period_s", "fence.polygon",
    "fence.holes", "fence.unit_cm", "fence.clear_m", "fence.sample_hz", "robot.0.node",
    "robot.0.waypoints", "robot.0.random", "robot.0.area", "robot.0.speed_mps", "robot.1.node",
    "flow.0.from", "flow.0.to", "flow.0.pairs", "flow.0.every_s", "flow.0.rate_hz", "flow.0.count",
    "flow.0.start_s", "flow.0.jitter_s", "event.0.at_s", "event.0.action", "event.0.node",
    "event.0.link", "event.0.random", "event.0.noise_dbm", "link.0.a", "link.0.b",
    "link.0.quality", "node.0.x_m", "node.0.y_m", "node.0.name",
)  # fmt: skip


@pytest.mark.parametrize(("nodes", "said"), [
    (1, "there are no others; leave it out"), (2, "there is 1 other; make it smaller"),
    (3, "there are 2 others; make it smaller"),
])  # fmt: skip
def test_a_degree_that_nodes_cannot_have_is_refused_with_what_helps(nodes: int, said: str) -> None:
    text = f'kind = "mesh"\nnodes = {nodes}\n[radio]\nmean_degree = 8\n'
    with pytest.raises(ScenarioError, match=f"but {said}"):
        plan(loads(text))


@settings(max_examples=250, deadline=None)
@given(st.lists(st.tuples(st.sampled_from(KEYS), words), max_size=5))
def test_any_value_of_any_key_is_a_scenario_or_one_line(pairs: list[tuple[str, Any]]) -> None:
    line = "fine"
    try:
        made = loads(SMALL, pairs)
        if made.duration_s < 1000:
            plan(made)
    except ScenarioError as error:
        line = str(error)
    assert line.isprintable()
