"""A simulation as pages see it: its fields, its way back, its recovery."""

import time

import numpy as np
import pytest

from innervate import scenario
from innervate.networks.skin.view.scene import places
from innervate.running import run
from innervate.web import messages
from innervate.web.errors import Refused, WatchError
from innervate.web.history import LOG, SERIES, TIMELINE
from innervate.web.simulated import Simulated
from innervate.web.snapshot import DeltaEncoder, Part, Snapshot
from tests.networks.skin.runs import patch
from tests.web.runs import KINDS, MESH, RADIO, SKIN, few_points, go_to, items, simulated, texts

__all__ = ["few_points"]

ROLES = {"cell", "sink", "port", "node", "gateway", "standby", "robot", "post", "monitor",
         "station"}  # fmt: skip
NODE_FIELDS = ("node_up", "parent", "port", "depth", "load", "touch", "alarm", "outside")


@pytest.mark.parametrize("kind", KINDS)
def test_scene_and_state_fit_together(kind):
    made = simulated(KINDS[kind])
    go_to(made, 0.8)
    scene, state = made.scene(), made.fields()
    ids = [node["id"] for node in scene["nodes"]]
    assert ids == list(range(len(ids)))
    assert {node["role"] for node in scene["nodes"]} <= ROLES
    assert len({(node["x"], node["y"]) for node in scene["nodes"]}) == len(ids)
    assert all({link["a"], link["b"]} <= set(ids) for link in scene["links"])
    for name in NODE_FIELDS:
        assert len(state.get(name, ids)) == len(ids), name
    assert len(state.get("link_up", scene["links"])) == len(scene["links"])
    assert set(state["node_up"].tolist()) <= {0, 1}
    assert scene["kind"] == kind
    assert scene["source"] == "simulation"
    assert state["t_s"] == pytest.approx(0.8)
    names = {series["id"] for series in scene["series"]}
    assert all(set(item.what) == names for item in items(made, SERIES))


@pytest.mark.usefixtures("few_points")
def test_cells_show_whose_tree_they_are_in():
    made = simulated(SKIN)
    go_to(made, 0.5)
    state, scene = made.fields(), made.scene()
    joined = {frozenset((link["a"], link["b"])) for link in scene["links"]}
    for cell in range(30):
        node, hops = cell, 0
        while node < 30:
            up = state["parent"][node]
            assert frozenset((node, int(up))) in joined
            node, hops = up, hops + 1
        assert state["port"][cell] == node - 30
        assert state["depth"][cell] == hops
    assert state["unconnected"] == 0
    assert 0 < state["load"].max() <= 1


def line_of(cells):
    """Half a second of a row of cells, the PC at its first."""
    made = simulated({**SKIN, "patch": [{"columns": cells, "rows": 1}],
                      "interface": [{"row": 0, "column": 0, "port": "W"}]})  # fmt: skip
    go_to(made, 0.5)
    return made


@pytest.mark.usefixtures("few_points")
def test_a_cell_that_is_off_and_those_behind_it_have_no_way():
    made = line_of(5)
    made.carry_out(messages.Kill(2))
    state = made.fields()
    assert state["node_up"].tolist() == [1, 1, 0, 1, 1, 1]
    assert state["link_up"].tolist() == [1, 1, 0, 0, 1]
    assert state["port"].tolist() == [0, 0, -1, -1, -1, 0]
    assert state["unconnected"] == 2
    made.carry_out(messages.Revive(2))
    go_to(made, 1.0)
    assert made.fields()["unconnected"] == 0


def test_frames_on_their_way_only_where_they_can_be_seen():
    made = simulated(SKIN, speed=0.02)
    go_to(made, 0.5)
    frames = made.fields()["flights"]
    joined = {frozenset((link["a"], link["b"])) for link in made.scene()["links"]}
    assert frames
    assert all(frozenset((frame["a"], frame["b"])) in joined for frame in frames)
    assert all(0 <= frame["p"] <= 1 for frame in frames)
    assert {frame["kind"] for frame in frames} <= {"beacon", "data"}
    made.carry_out(messages.Speed(1.0))
    assert made.fields()["flights"] == []


def test_a_long_run_of_which_nobody_sees_the_points_has_no_more_of_them_than_plots_show():
    made = simulated({**SKIN, "duration_s": 300.0}, speed=1.0)
    made.run_to_end()
    points = made.history.after(SERIES, 0, made.history.newest, 10_000)
    assert 500 <= len(points) <= 501
    made.back_to(0)
    go_to(made, 0.2)
    assert made.fields()["t_s"] == 0.2


@pytest.mark.parametrize(
    "event", [("cut", {"interface": 0}), ("kill", {"cell": {"row": 1, "column": 2}})]
)
@pytest.mark.usefixtures("few_points")
def test_the_recovery_is_that_of_the_batch_run(event):
    action, target = event
    batch = run({**SKIN, "event": [{"at_s": 0.5, "action": action, **target}]})
    recovery = batch.summary["recoveries"][0]
    made = simulated(SKIN)
    go_to(made, 0.5)
    links = made.scene()["links"]
    command = messages.Kill(8)
    if action == "cut":
        command = messages.Cut(next(link["id"] for link in links if link["b"] == 30))
    made.carry_out(command)
    assert made.fields()["since_cut_s"] == pytest.approx(1e-6)
    made.run_to_end()
    shown = made.fields()["recovery"]
    assert recovery["routed_ms"] > 0
    assert (shown["at_s"], shown["detected_ms"], shown["recovered_ms"]) == (
        0.5, recovery["detected_ms"], recovery["routed_ms"],
    )  # fmt: skip
    assert made.fields()["since_cut_s"] == pytest.approx(0.5)


@pytest.mark.parametrize("column", [2, 5])
@pytest.mark.usefixtures("few_points")
def test_the_log_does_not_say_that_all_have_a_way_while_cells_are_cut_off(column):
    kill = {"at_s": 0.5, "action": "kill", "cell": {"row": 0, "column": column}}
    made = simulated(patch(6, 1, (0, 0), event=[kill], duration_s=0.7), speed=0)
    made.run_to_end()
    told = texts(made)
    assert not [text for text in told if text.startswith("all cells have a way again")]
    assert made.fields()["recovery"]["apart"] == 5 - column


@pytest.mark.usefixtures("few_points")
def test_what_disturbs_nobody_is_over_at_once():
    made = simulated(SKIN)
    go_to(made, 0.5)
    state = made.fields()
    used = {frozenset((cell, int(up))) for cell, up in enumerate(state["parent"])}
    free = next(link["id"] for link in made.scene()["links"]
                if frozenset((link["a"], link["b"])) not in used)  # fmt: skip
    made.carry_out(messages.Cut(free))
    assert made.fields()["recovery"]["recovered_ms"] == 0.0


@pytest.mark.usefixtures("few_points")
def test_a_mesh_finds_other_ways():
    made = simulated(MESH)
    go_to(made, 4.0)
    state = made.fields()
    assert state["unconnected"] == 0
    relay = int(np.bincount(state["parent"][state["parent"] > 0]).argmax())
    made.carry_out(messages.Kill(relay))
    # Packets are passed on another way by whoever finds out that it is dead: nobody lacks a way.
    assert made.fields()["recovery"]["recovered_ms"] == 0.0
    assert made.fields()["unconnected"] == 0
    made.run_to_end()
    shown = made.fields()["recovery"]
    assert shown["detected_ms"] > 0
    assert any("does not answer" in text for text in texts(made))
    assert relay not in made.fields()["parent"]
    event = {"at_s": 4.0, "action": "kill", "node": relay}
    assert run({**MESH, "event": [event]}).summary["delivery_ratio"] == 1.0


@pytest.mark.usefixtures("few_points")
def test_who_is_behind_a_dead_node_of_a_mesh_is_cut_off_until_it_is_back():
    line = {**MESH, "flow": [], "radio": {"profile": "250k"}, "duration_s": 40.0,
            "link": [{"a": "g", "b": "x"}, {"a": "x", "b": "y"}, {"a": "y", "b": "z"}]}  # fmt: skip
    del line["nodes"]
    made = simulated(line)
    go_to(made, 4.0)
    made.carry_out(messages.Kill(1))
    state = made.fields()
    assert (state["unconnected"], state["apart"]) == (2, 2)
    assert state["recovery"]["recovered_ms"] is None  # there is nothing that it could do
    assert state["recovery"]["apart"] == 2
    assert state["recovery"]["nobody"]
    made.carry_out(messages.Revive(1))
    made.run_to_end()
    assert (made.fields()["unconnected"], made.fields()["apart"]) == (0, 0)
    shown = made.fields()["recovery"]
    assert shown["recovered_ms"] > 0
    assert not shown["nobody"]


@pytest.mark.usefixtures("few_points")
def test_the_recovery_of_a_mesh_does_not_depend_on_the_pace():
    found = set()
    for pieces in (1, 40):
        made = simulated(MESH)
        go_to(made, 4.0)
        made.carry_out(messages.Kill(int(made.fields()["parent"].max())))
        for piece in range(pieces):
            go_to(made, 4.0 + 8.0 * (piece + 1) / pieces)
        found.add(made.fields()["recovery"]["recovered_ms"])
    assert len(found) == 1
    assert None not in found


def test_stations_send_listen_and_wait():
    made = simulated(RADIO)
    seen = set()
    for t_s in np.arange(0.0, 0.6, 0.002):
        go_to(made, float(t_s))
        seen |= set(made.fields()["radio"]["now"])
    assert {1, 2, 4} <= seen <= {0, 1, 2, 3, 4}
    boxes = [item.what for item in items(made, TIMELINE)]
    assert all(box["from_s"] < box["to_s"] for box in boxes)
    assert {"frame", "collision"} <= {box["kind"] for box in boxes}


def test_the_timeline_is_what_was_sent():
    made = simulated(RADIO)
    made.run_to_end()
    done = run(RADIO)
    boxes = [item.what for item in items(made, TIMELINE)]
    shown = {
        (box["station"], round(1e6 * box["from_s"]), round(1e6 * box["to_s"])) for box in boxes
    }
    sent = {(int(row["node"]), int(row["time"]), int(row["end"])) for row in done.result.sent}
    assert len(boxes) == len(shown)
    assert shown <= sent
    assert all(end > done.result.ended_us for _, _, end in sent - shown)
    found = sum(text.startswith("collision of") for text in texts(made))
    assert found == min(done.summary["collisions"], 8) > 0


@pytest.mark.usefixtures("few_points")
def test_received_touch_is_shown():
    made = simulated(SKIN, touch={"path": [[0.0, 0.0, 0.0]], "radius_mm": 30.0})
    go_to(made, 0.9)
    touch = made.fields()["touch"]
    assert touch[0] == touch.max() > 50
    assert touch[29] == 0


@pytest.mark.parametrize("setup", ["setup-1", "setup-8", "joined", "icub-forearm", "loop-five"])
def test_interface_ports_lie_beside_the_skin(setup):
    graph = scenario.plan(scenario.load(setup)).graph
    where = places(graph)
    assert len(where) == graph.cells + graph.interfaces
    apart = np.hypot(*(where[:, None] - where[None]).transpose(2, 0, 1))
    np.fill_diagonal(apart, 9)
    assert apart[graph.cells :].min() > 0.4


def test_without_data_nothing_is_felt():
    made = simulated(SKIN, data={"rate_hz": 0})
    assert "touch" not in made.scene()["can"]
    with pytest.raises(Refused):
        made.carry_out(messages.Touch(3, 255))


@pytest.mark.usefixtures("few_points")
def test_healing_leaves_the_number_of_the_cut():
    made = simulated(SKIN)
    go_to(made, 0.5)
    link = next(link["id"] for link in made.scene()["links"] if link["b"] == 30)
    made.carry_out(messages.Cut(link))
    go_to(made, 0.7)
    was = made.fields()["recovery"]
    assert was["recovered_ms"] > 0
    made.carry_out(messages.Heal(link))
    made.carry_out(messages.Kill(12))
    assert made.fields()["recovery"]["at_s"] > was["at_s"]
    go_to(made, 0.8)
    was = made.fields()["recovery"]
    made.carry_out(messages.Revive(12))
    made.run_to_end()
    assert made.fields()["recovery"] == was
    assert made.fields()["since_cut_s"] == pytest.approx(0.3, abs=1e-5)


@pytest.mark.usefixtures("few_points")
def test_a_cell_alone_has_recovered_when_it_is_back():
    """A cut that nothing can get over, until it is healed."""
    made = line_of(3)
    made.carry_out(messages.Kill(1))
    made.carry_out(messages.Revive(1))
    made.run_to_end()
    assert made.fields()["recovery"]["cause"] == "cell p0 r0 c1 switched off"
    assert made.fields()["recovery"]["apart"] == 1  # for good, had it not been let back
    assert made.fields()["unconnected"] == 0


@pytest.mark.usefixtures("few_points")
def test_who_was_doubted_before_a_fault_did_not_notice_it():
    made = simulated(MESH)
    go_to(made, 4.0)
    made.carry_out(messages.Kill(3))
    fault = made.view.memory.fault
    for after_us, noticed in ((-3_000, None), (2_000, 2.0)):
        made.view._suspect(fault.at_us + after_us, 5, 3)
        assert made.fields()["recovery"]["detected_ms"] == noticed


def test_what_is_too_large_is_not_drawn():
    with pytest.raises(WatchError, match="too many"):
        simulated(SKIN, patch=[{"columns": 1000, "rows": 21}], protocol={"max_depth": 254},
                  data={"rate_hz": 0},
                  interface=[{"row": 0, "column": 50 * i} for i in range(20)])  # fmt: skip


def test_a_thousand_cells_cost_little():
    made = simulated(SKIN, 0.02, patch=[{"columns": 40, "rows": 25}], interface=[
        {"row": 0, "column": 10}, {"row": 24, "column": 30}])  # fmt: skip
    go_to(made, 0.2)
    scene, before, sizes = Part({"type": "scene"}), None, []
    encoder = DeltaEncoder(made.history)
    began = time.thread_time()
    for _ in range(30):
        made.carry_out(messages.Step())
        before = Snapshot(scene, made.fields(), made.history.newest, before)
        sizes.append(sum(len(message) for message in encoder.messages(before)))
    assert (time.thread_time() - began) / 30 < 0.02  # of 0.033 s; measured 0.002
    assert sum(sizes) / 30 < 100_000


@pytest.mark.usefixtures("few_points")
def test_what_the_scenario_does_is_told_in_its_place():
    events = [
        {"at_s": 4.0, "action": "kill", "node": 5},
        {"at_s": 6.0, "action": "revive", "node": 5},
    ]
    made = simulated(MESH, event=events)
    made.run_to_end()
    times = [item.what["t_s"] for item in items(made, LOG)]
    assert times == sorted(times)
    assert "node n5 switched off" in texts(made)
    by_hand = simulated(MESH)
    go_to(by_hand, 4.0)
    by_hand.carry_out(messages.Kill(5))
    by_hand.run_to_end()
    shown = [each.fields()["recovery"] for each in (made, by_hand)]
    assert shown[0] == shown[1]


@pytest.mark.usefixtures("few_points")
def test_a_node_at_the_edge_of_a_mesh_is_missed_by_nobody():
    leaf = {**MESH, "nodes": None, "radio": {"profile": "250k"},
            "link": [{"a": "g", "b": "x"}, {"a": "x", "b": "y"}], "flow": [],
            "event": [{"at_s": 5.0, "action": "kill", "node": "y"}]}  # fmt: skip
    made = simulated({key: value for key, value in leaf.items() if value is not None})
    made.run_to_end()
    assert made.fields()["recovery"]["recovered_ms"] == 0.0


@pytest.mark.usefixtures("few_points")
def test_without_a_gateway_nobody_has_a_way_until_the_standby_leads():
    made = simulated(MESH, standby=[1], duration_s=30.0)
    go_to(made, 4.0)
    made.carry_out(messages.Kill(0))
    assert made.fields()["recovery"]["recovered_ms"] is None
    assert made.fields()["unconnected"] == 11
    assert not any(made.fields()["leads"])
    made.run_to_end()
    assert np.flatnonzero(made.fields()["leads"]).tolist() == [1]
    assert 500 < made.fields()["recovery"]["recovered_ms"] < 6_000
    assert "n1 leads as gateway" in texts(made)


def test_metres_are_measured_only_where_nodes_are_where_they_are():
    assert simulated(MESH).scene()["metres"]
    pairs = {**MESH, "flow": [], "radio": {"profile": "250k"}, "link": [{"a": "g", "b": "x"}]}
    del pairs["nodes"]
    assert not simulated(pairs).scene()["metres"]


def test_on_a_channel_that_all_share_nothing_can_be_cut():
    made = Simulated(scenario.plan(scenario.load("mesh-team")))
    assert "cut" not in made.scene()["can"]
    with pytest.raises(Refused):
        made.carry_out(messages.Cut(0))


def test_no_channel_carries_more_than_it_can():
    made = simulated(RADIO)
    made.run_to_end()
    shares = [item.what["throughput"] for item in items(made, SERIES)]
    assert 60 < max(shares) <= 100
    done = run(RADIO)
    assert sum(shares) / len(shares) == pytest.approx(100 * done.summary["throughput"], abs=8)
