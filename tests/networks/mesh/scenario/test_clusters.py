"""[clusters]: more nodes than a mesh has addresses for, each cluster a mesh of its own."""

import pytest

from innervate import scenario
from innervate.networks.mesh.analysis.summary import summarize
from innervate.networks.mesh.plot.words import opening
from innervate.networks.mesh.protocol.constants import ALL, MONITOR
from innervate.networks.mesh.scenario.clusters import Cluster
from innervate.networks.mesh.scenario.measured_template import measured
from innervate.networks.mesh.scenario.words import describe
from innervate.networks.mesh.sim.simulate import simulate
from innervate.scenario import ScenarioError

LINE = """\
kind = "mesh"
schema = 1
nodes = 30
duration_s = 20.0
{more}
[placement]
layout = "line"
[clusters]
gateways = {gateways}
run = {run}
[radio]
profile = "ideal"
"""


def load(text, folder=""):
    return scenario.loads(text, folder=str(folder))


def line(run, more="", gateways="[2, 15, 29]", tables=""):
    return scenario.plan(load(LINE.format(run=run, more=more, gateways=gateways) + tables))


def names(first, last):
    return [f"n{i}" for i in range(first, last + 1)]


def test_each_has_the_nodes_that_are_nearest_to_its_gateway() -> None:
    first, second, third = (line(run) for run in (1, 2, 3))
    assert first.names == names(0, 8)
    assert second.names == names(9, 22)
    assert third.names == names(23, 29)
    assert [one.ranks.index(0) for one in (first, second, third)] == [2, 6, 6]
    assert second.cluster == Cluster(2, (9, 14, 7), ("n2", "n15", "n29"))
    assert second.cluster.words == "cluster 2 of 3"
    assert (first.nodes, first.params["nodes"], first.capacity) == (9, 9, 32)


def test_who_is_in_a_cluster_hears_whom_as_in_the_whole() -> None:
    whole = scenario.plan(load(LINE.format(run=1, more="", gateways="1")))
    part = line(2)
    assert (whole.nodes, whole.cluster.sizes) == (30, (30,))
    for i in range(14):
        for j in range(14):
            there, here = (i + 9) * 30 + j + 9, i * 14 + j
            assert part.radio.rssi_cdb[here] == whole.radio.rssi_cdb[there]
            assert part.radio.prob_q15[here] == whole.radio.prob_q15[there]
    assert part.positions_cm == whole.positions_cm[9:23]
    assert part.good == [(a - 9, b - 9) for a, b in whole.good if a >= 9 and b <= 22]


def test_gateways_that_are_only_counted_stand_amidst_the_others() -> None:
    made = line(1, gateways="3")
    assert sorted(made.cluster.gateways) == ["n14", "n24", "n4"]
    assert sorted(made.cluster.sizes) == [9, 10, 11]
    assert made.names[made.ranks.index(0)] == made.cluster.gateways[0]


def test_a_number_in_the_file_is_that_of_the_whole_network() -> None:
    tables = '[[flow]]\nfrom = 20\nto = "n10"\nstart_s = 5\n'
    (offer,) = line(2, tables=tables).offers
    assert (offer.node, offer.dest) == (11, 1)


FLOWS = """
[[flow]]
from = "n1"
to = "n20"
start_s = 5
[[flow]]
from = "n25"
to = "n26"
start_s = 6
[[flow]]
from = "n15"
to = "n0"
start_s = 7
[[flow]]
from = "all"
to = "n0"
start_s = 8
[[flow]]
from = "n28"
to = "all"
start_s = 9
"""


@pytest.mark.parametrize(
    ("run", "wanted"),
    [
        # To a node elsewhere: to the gateway. From elsewhere: from the gateway.
        (1, [(0, 1, 2), (2, 2, 0), *((3, node, 0) for node in range(1, 9))]),
        # A gateway's own messages to other clusters do not go by its mesh.
        (2, [(0, 6, 11), *((3, node, 6) for node in range(14) if node != 6)]),
        (3, [(1, 2, 3), *((3, node, 6) for node in range(6)), (4, 5, ALL)]),
    ],
)
def test_what_is_elsewhere_is_behind_the_gateway(run, wanted) -> None:
    made = line(run, tables=FLOWS)
    assert [(one.flow, one.node, one.dest) for one in made.offers] == wanted
    told = describe(made).splitlines()
    assert not [one for one in told if "sends nothing" in one]
    flows = len({flow for flow, _, _ in wanted})
    assert f"  messages   {len(wanted)} in {flows} flows" in told


def test_a_flow_that_begins_after_the_end_is_still_said() -> None:
    text = '[[flow]]\nfrom = "all"\nto = "gateway"\n'
    whole = LINE.format(run=1, more="", gateways="2") + text
    assert "sends nothing" not in describe(scenario.plan(load(whole)))
    short = scenario.plan(load(whole.replace("duration_s = 20.0", "duration_s = 2.0")))
    assert "flow.0 sends nothing" in describe(short)


EVENTS = """
[[event]]
at_s = 1
action = "kill"
node = 20
[[event]]
at_s = 2
action = "revive"
node = "n3"
[[event]]
at_s = 3
action = "cut"
link = ["n8", "n9"]
[[event]]
at_s = 4
action = "cut"
link = ["n10", "n11"]
[[event]]
at_s = 5
action = "kill"
node = "gateway"
[[event]]
at_s = 6
action = "kill"
random = 2
"""


def test_events_happen_where_their_nodes_are() -> None:
    first, second = line(1, tables=EVENTS), line(2, tables=EVENTS)
    assert [(one.index, one.node) for one in first.faults[:2]] == [(1, 3), (4, 2)]
    assert [(one.index, one.node, one.other) for one in second.faults[:3]] == [
        (0, 11, 0), (3, 1, 2), (4, 6, 0),
    ]  # fmt: skip
    assert (sum(first.absent), first.absent[3], sum(second.absent)) == (1, 1, 0)
    assert [len(one.faults) for one in (first, second)] == [4, 5], "2 at random in each cluster"


def test_robots_standbys_and_the_monitor_are_in_their_clusters() -> None:
    more = 'standby = ["n12", "n4", "n20"]\nmonitor = "n21"'
    tables = "reach_m = 25\n" + "\n".join(
        f'[[robot]]\nnode = "n{i}"\nwaypoints = [[{x}, 0]]' for i, x in ((1, 10), (14, 141))
    )
    first, second = (line(run, more, tables=tables) for run in (1, 2))
    assert [one.robots.index(1) for one in (first, second)] == [1, 5]
    assert [len(one.walks) for one in (first, second)] == [1, 1]
    assert [first.ranks.index(1), max(first.ranks)] == [4, 1]
    assert [second.ranks.index(1), second.ranks.index(2)] == [3, 11]
    assert (first.params["monitor"], second.params["monitor"]) == (MONITOR, 12)
    assert second.params["standby"] == 1
    assert line(3, more).params["standby"] == 0, "none of them is there"


def test_a_robot_that_no_good_link_reaches_is_with_whom_it_hears_best() -> None:
    text = LINE.format(run=2, more="", gateways="[2, 15]").replace('"ideal"', '"250k"')
    text += "reach_m = 16\n[[robot]]\nnode = 29\nwaypoints = [[30, 24]]\n"
    first, second = (load(text.replace("run = 2", f"run = {run}")) for run in (1, 2))
    assert "n29" in scenario.plan(first).names
    assert "n29" not in scenario.plan(second).names


def refused(text: str) -> str:
    """What is said of a scenario that cannot be."""
    with pytest.raises(ScenarioError) as error:
        scenario.plan(load(text))
    return str(error.value)


@pytest.mark.parametrize(("gateways", "said"), [
    ("0", "clusters.gateways must be 1 to 64 of them, not 0"),
    ("65", "clusters.gateways must be 1 to 64 of them, not 65"),
    ("[]", "clusters.gateways must be 1 to 64 of them, not 0"),
    ("31", "clusters.gateways = 31, but there are 30 nodes"),
    ('[2, 15, "n2"]', "clusters.gateways names n2 twice; leave one out"),
    ('[2, "n30"]', 'clusters.gateways.1: there is no node "n30"'),
    ("[2, 30]", "there is no node 30; they are numbered 0 to 29"),
])  # fmt: skip
def test_gateways_that_cannot_be_are_told(gateways, said) -> None:
    assert said in refused(LINE.format(run=1, more="", gateways=gateways))


@pytest.mark.parametrize(("old", "new", "said"), [
    ("run = 1", "run = 4", "clusters.run = 4, but there are 3 clusters; make it smaller"),
    ("nodes = 30", "nodes = 30\ngateway = 3", "clusters.gateways says who leads; leave gateway"),
    ("nodes = 30", "nodes = 2001", "2001 nodes are too many: clusters have at most 2000"),
    ("nodes = 30", "nodes = 300", "cluster of n29 would have 277 nodes, and it may have 254; add"),
])  # fmt: skip
def test_what_cannot_be_is_said(old, new, said) -> None:
    text = LINE.format(run=1, more="", gateways="[2, 15, 29]")
    assert said in refused(text.replace(old, new))


def test_254_nodes_are_a_cluster() -> None:
    text = LINE.format(run=1, more="", gateways="[0, 507]")
    assert scenario.plan(load(text.replace("nodes = 30", "nodes = 508"))).cluster.sizes == (
        254,
        254,
    )
    with pytest.raises(ScenarioError, match="the cluster of n507 would have 255 nodes"):
        scenario.plan(load(text.replace("nodes = 30", "nodes = 509")))


def test_what_is_more_than_a_cluster_may_have_goes_to_the_next() -> None:
    few = line(1, gateways="[4, 20]\nnodes_max = 16")
    assert line(1, gateways="[4, 20]").cluster.sizes == (13, 17)
    assert few.cluster.sizes == (14, 16)
    with pytest.raises(ScenarioError, match="n20 would have 17 nodes, and it may have 14; add a"):
        line(1, gateways="[4, 20]\nnodes_max = 14")


def test_without_clusters_they_are_what_is_proposed() -> None:
    with pytest.raises(ScenarioError, match=r"\[clusters\] makes several meshes of up to 2000"):
        load('kind = "mesh"\nschema = 1\nnodes = 255\n')
    with pytest.raises(ScenarioError, match="300 nodes are too many"):
        load('kind = "mesh"\nschema = 1\n[import]\nfile = "freifunk/ulm"\nnodes = 300\n')


def test_check_says_which_and_how_to_run_the_others() -> None:
    said = describe(line(2))
    assert "cluster 2 of 3; nodes of each gateway: n2 9, n15 14, n29 7" in said
    assert "clusters.run = 1 to 3" in said
    assert "--vary clusters.run=1..3 --paired clusters.run" in said
    assert "nodes      14, gateway n15" in said
    assert "--vary" not in describe(line(1, gateways="1"))


def test_a_run_says_which_cluster_it_is_of() -> None:
    tables = '[[flow]]\nfrom = "all"\nto = "gateway"\nstart_s = 15\n'
    result = simulate(line(2, tables=tables), plain=True)
    summary = summarize(result)
    members = [f"n{node}" for node in range(9, 23)]
    assert summary["cluster"] == {"number": 2, "of": 3, "nodes": 30, "members": members}
    assert [members[one["node"]] for one in summary["gateways"]] == ["n15"]
    assert (summary["nodes"], summary["delivery_ratio"]) == (14, 1.0)
    said = "x: cluster 2 of 3, 30 nodes in all; here 14 nodes, 13 good links"
    assert opening(summary | {"name": "x"}) == said
    assert "cluster" not in summarize(simulate(scenario.plan(load(SMALL)), plain=True))


SMALL = 'kind = "mesh"\nschema = 1\nnodes = 3\nduration_s = 1.0\n'


def test_a_large_network_as_it_was_measured_in_clusters(tmp_path) -> None:
    links = "".join(f"n{i} n{i + 1} 0.9\n" for i in range(299))
    (tmp_path / "long.txt").write_text(links)
    text, taken = measured("mine", "long.txt", {"gateways": 3}, str(tmp_path))
    assert taken == (
        "Taken: 300 of 300 nodes, in 3 clusters; links of 0.3 and better hold them together."
    )
    made = [scenario.plan(load(text.replace("run = 1", f"run = {run}"), tmp_path))
            for run in (1, 2, 3)]  # fmt: skip
    assert [one.nodes for one in made] == list(made[0].cluster.sizes)
    assert sum(one.nodes for one in made) == 300
    assert load(text, tmp_path).model.protocol.tables, "100 nodes are no crowd"
    assert measured("mine", "long.txt", {}, str(tmp_path))[1].endswith(
        "about the best connected one of 300, too many for a mesh: --gateways makes several."
    )
