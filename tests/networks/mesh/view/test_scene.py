"""A mesh as pages show it: of one that has links and no places."""

from types import SimpleNamespace as Of

import numpy as np

from innervate.networks.mesh.view.scene import Field
from innervate.sim.field.states import ALIVE
from innervate.web.field_view import UP
from tests.web.runs import plan_of

LINKED = {
    "kind": "mesh", "duration_s": 60.0, "nodes": 3, "gateway": 0, "monitor": 2,
    "link": [{"a": 0, "b": 1, "quality": [0.9, 0.8]}, {"a": 1, "b": 2, "quality": [0.75, 0.95]}],
}  # fmt: skip


def test_a_link_is_as_good_as_its_worse_way_and_neighbours_lie_beside_each_other():
    scene = Field(plan_of(LINKED)).scene()
    assert [(link["a"], link["b"], link["quality"]) for link in scene["links"]] == [
        (0, 1, 0.8), (1, 2, 0.75)]  # fmt: skip
    a, b, c = (np.array([node["x"], node["y"]]) for node in scene["nodes"])
    assert np.hypot(*(c - a)) > np.hypot(*(b - a)) > 0
    assert (scene["metres"], scene["fence"]) == (False, None)


def test_without_alarms_nobody_is_their_monitor():
    assert [node["role"] for node in Field(plan_of(LINKED)).scene()["nodes"]] == [
        "gateway", "node", "node"]  # fmt: skip


def test_a_link_between_nodes_that_stay_is_up_however_weak():
    plan = plan_of(LINKED)
    radios = np.zeros(3, [("state", np.int64)])
    radios["state"] = ALIVE
    world = Of(radios=radios, cut=np.zeros(9), rssi=np.full(9, -20_000))
    assert Field(plan).link_up(world).tolist() == [UP, UP]


def test_of_a_cluster_a_page_says_which_it_is():
    made = {"kind": "mesh", "duration_s": 60.0, "nodes": 300, "placement": {"side_m": 300},
            "clusters": {"gateways": 3, "run": 2}}  # fmt: skip
    assert Field(plan_of(made)).scene()["part"] == "cluster 2 of 3, 300 nodes in all"
    assert "part" not in Field(plan_of(LINKED)).scene()
