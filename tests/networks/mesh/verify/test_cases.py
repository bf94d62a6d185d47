"""What `innervate verify mesh` explores if nobody says, and how it is recorded."""

from types import SimpleNamespace as Of

import pytest

from innervate.networks.mesh.verify import command, fuzz
from innervate.networks.mesh.verify.command import MeshWanted
from innervate.networks.mesh.verify.model import MeshBudget, MeshModel, parse
from tests.networks.draws import Draw

LINE = ((0, 1), (1, 2))
SHORT = (("e2e_tries", 1), ("transmissions", 1))
QUICK = (("period_s", 2.0), ("period_max_s", 2.0), ("dead_s", 3.0), ("dead_step_s", 1.0))
ASKED = (("period_s", 6.0), ("period_max_s", 6.0), ("guard_s", 0.1))


def budget(deaths=0, revivals=0, acks=0):
    return MeshBudget(deaths, revivals, 0, acks, 0)


def test_each_promise_is_explored_with_as_much_as_may_fail():
    found = dict(command.models(MeshWanted(("search",), LINE)))
    assert found == {
        "a message": MeshModel(LINE, "search", ((2, 0),), -1, (), budget(1, 0, 1), SHORT),
        "an alarm": MeshModel(LINE, "search", (), 2, (), budget(), SHORT),
        "gateways": MeshModel(LINE, "search", (), -1, (2,), budget(1, 1), QUICK, beats=6),
        "gateways that are asked": MeshModel(
            LINE, "search", (), -1, (2,), budget(1), ASKED, beats=3
        ),
    }
    (random,) = command.models(MeshWanted(("random",)))
    assert random == ("two messages", MeshModel(
        parse("line"), "random", ((1, 0), (1, 0)), -1, (), budget(0, 0, 1), SHORT, reliable=False
    ))  # fmt: skip


def test_all_that_can_be_reached_is_explored_with_its_calm_futures_if_nobody_says():
    usual = MeshWanted()
    assert (usual.live, usual.states, usual.walks, usual.seed) == (True, 0, 0, 1)
    assert usual.failovers == ("search", "graph")


@pytest.mark.parametrize("story", [None, Of(title="loops", sentences=["it goes round"])])
def test_a_case_is_recorded_with_what_came_of_it(story):
    tally = Of(states=5, expanded=4, generated=9, depth=3, wall_s=1.23456, ended="complete")
    found = Of(model=MeshModel(LINE, budget=budget(1)), tally=tally, calls=7, fair=2, longest=6,
               nets=Of(locals=Of(states=[1, 2])), wide=[9, 256])  # fmt: skip
    assert command._record("a message", found, story) == {
        "name": "a message", "links": "0-1 1-2", "failover": "search",
        "budget": {"deaths": 1, "revivals": 0, "frames": 0, "acks": 0, "ticks": 0},
        "states": 5, "expanded": 4, "generated": 9, "calls": 7, "node_states": 2, "depth": 3,
        "wall_s": 1.235, "ended": "complete", "fair": 2, "longest": 6, "one_value": [9, 256],
        "broken": story and "loops", "story": story and ["it goes round"],
    }  # fmt: skip


def test_the_least_mesh_that_may_be_drawn():
    """Whatever is a matter of chance is so, as nothing is less likely."""
    assert fuzz.drawn(Draw(0, 0.0), 7) == {
        "kind": "mesh", "name": "random-7", "seed": 7, "nodes": 3, "gateway": 0, "standby": [],
        "duration_s": 15.0 * (5 if fuzz.PROFILES[0] == "38k4" else 1),
        "radio": {"profile": fuzz.PROFILES[0], "mean_degree": 2.0},
        "protocol": {
            "failover": fuzz.FAILOVERS[0], "discovery": "list", "retry": True, "reliable": True,
            "on_demand": True, "tables": True, "activation": True, "mtu": 64, "transmissions": 1,
        },
        "flow": [{"from": 0, "to": 1, "every_s": 0.05, "count": 1, "bytes": 1, "start_s": 0.0,
                  "priority": True}],
        "event": [],
        "fence": {"polygon": [[20, 20], [80, 20], [80, 80], [20, 80]]},
        "robot": [{"node": 2, "random": True, "speed_mps": 1}],
    }  # fmt: skip


def test_the_greatest_mesh_that_may_be_drawn():
    """Nothing that is a matter of chance is so."""
    action = fuzz.ACTIONS[-1]
    times = 5 if fuzz.PROFILES[-1] == "38k4" else 1
    end_s = 40.0 * times
    at = {"link": [22, 23]} if action in ("cut", "restore") else {"node": 23}
    found = fuzz.drawn(Draw(1, 0.95), 7)
    assert (found["nodes"], found["duration_s"], found["standby"]) == (24, end_s, [23, 22])
    assert found["radio"] == {"profile": fuzz.PROFILES[-1], "mean_degree": 9.0}
    assert found["protocol"] == {
        "failover": fuzz.FAILOVERS[-1], "discovery": "each", "retry": False, "reliable": False,
        "on_demand": False, "tables": False, "activation": False, "mtu": 127, "transmissions": 3,
    }  # fmt: skip
    flow = {"from": 23, "to": "all", "every_s": 2.0, "count": 60, "bytes": 27}
    assert found["flow"] == 4 * [flow | {"start_s": 0.8 * end_s, "priority": False}]
    assert found["event"] == 10 * [{"at_s": 0.95 * end_s, "action": action, **at}]
    assert not {"fence", "robot"} & found.keys()


@pytest.mark.parametrize(("share", "so"), [
    (0.19, {"activation", "retry", "reliable", "tables", "fence", "priority"}),
    (0.2, {"retry", "reliable", "tables", "fence"}), (0.3, {"retry", "reliable", "tables"}),
    (0.79, {"retry", "reliable", "tables"}), (0.8, {"reliable", "tables"}), (0.9, set()),
])  # fmt: skip
def test_how_likely_each_is(share, so):
    found = fuzz.drawn(Draw(0, share), 7)
    names = {name for name in ("activation", "retry", "reliable", "tables")
             if found["protocol"][name]}  # fmt: skip
    names |= {"fence"} & found.keys()
    names |= {"priority"} if found["flow"][0]["priority"] else set()
    tables = {"tables"} if fuzz.FAILOVERS[0] == "graph" else set()
    assert names == so | tables


def test_cables_are_cut_between_two_and_all_else_happens_to_one():
    for action in fuzz.ACTIONS:
        draw = Draw(0, 0.0)
        draw.choice = lambda _, one=action: one
        found = fuzz._event(draw, 9, 100.0)
        at = {"link": [0, 1]} if action in ("cut", "restore") else {"node": 0}
        assert found == {"at_s": 5.0, "action": action, **at}


def test_slow_radios_run_five_times_as_long():
    for profile in fuzz.PROFILES:
        draw = Draw(0, 0.5)
        draw.choice = lambda values, one=profile: one if one in values else values[0]
        assert fuzz.drawn(draw, 1)["duration_s"] == (75.0 if profile == "38k4" else 15.0)


def test_the_other_ends_of_a_flow_are_nodes_the_monitor_or_all():
    seen = []
    draw = Draw(1, 0.5)
    draw.choice = lambda values: seen.append(values) or values[0]
    fuzz._flow(draw, 9, 10.0)
    fuzz._flow(Draw(0, 0.5), 9, 10.0)
    draw.place = 0
    fuzz._flow(draw, 9, 10.0)
    assert [tuple(seen[at]) for at in (0, 3)] == [(7, 7, "monitor", "all"), (1, 1, 1, "all")]
