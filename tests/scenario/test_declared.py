"""Scenarios of networks that declare no keys of their own: what is the same on every medium."""

import pytest
from msgspec import to_builtins

from innervate import scenario as scenarios
from innervate.network import Network, networks
from innervate.scenario.errors import ScenarioError
from tests.own import alone, made, refused

__all__ = ["alone"]


@pytest.fixture(params=["cables", "channel", "field"])
def own(request, alone):
    return made(alone / "own", request.param)


def loaded(own, **changes):
    return scenarios.load(own.scenario, overrides={"duration_s": 2, **changes}.items())


@pytest.mark.parametrize("table", ["input", "event"])
def test_what_would_never_happen_is_refused(own, table):
    last = to_builtins(getattr(loaded(own).model, table)[-1])
    assert scenarios.plan(loaded(own, **{table: [{**last, "at_s": 1.999999}]}))
    with pytest.raises(ScenarioError, match=rf"{table}\.0\.at_s = 2 is the end of the run"):
        loaded(own, **{table: [{**last, "at_s": 2}]})
    with pytest.raises(ScenarioError, match=rf"{table}\.0\.at_s = 3 is outside the run"):
        loaded(own, **{table: [{**last, "at_s": 3}]})


@pytest.mark.parametrize("wrong", ["x", 1.5, True, [1, "x"], {"a": 1}])
def test_values_of_a_protocol_and_its_frames_are_whole_numbers(own, wrong):
    with pytest.raises(ScenarioError, match=r"protocol\.b must be a whole number, not"):
        loaded(own, protocol={"a": 3, "b": wrong})
    with pytest.raises(ScenarioError, match=r"input\.0\.item\.value must be a whole number, not"):
        loaded(own, input=[{"item": {"made_at": 1, "value": wrong}}])
    with pytest.raises(ScenarioError, match=r"protocol\.a must be a whole number, not"):
        loaded(own, protocol={"a": [3]})


def test_inputs_are_repeated_up_to_the_end_and_not_at_it(own):
    given = {"at_s": 0.5, "every_s": 0.5, "node": 1, "item": {}}
    plan = scenarios.plan(loaded(own, input=[given], event=[]))
    assert [one.at_us for one in plan.inputs] == [500_000, 1_000_000, 1_500_000]
    plan = scenarios.plan(loaded(own, input=[{**given, "every_s": 0}], event=[]))
    assert [one.at_us for one in plan.inputs] == [500_000]


def test_the_node_that_an_input_is_for_is_there(own):
    with pytest.raises(ScenarioError, match="there is no node 500; they are 0 to"):
        loaded(own, input=[{"node": 500}])
    with pytest.raises(ScenarioError, match='input has no "valeu"; did you mean "value"'):
        loaded(own, input=[{"item": {"valeu": 1}}])


def test_events_that_are_the_networks_own_are_told_among_the_others(own, capsys):
    own.change("network.py", '    protocol="protocol",', '    protocol="protocol",\n'
               '    happenings="more:HAPPENINGS",')  # fmt: skip
    (own.folder / "more.py").write_text(
        '"""More."""\n\nHAPPENINGS = {"warm": lambda node, value: (1, {"value": value})}\n'
    )
    event = [{"at_s": 1.5, "action": "kill", "node": 0},
             {"at_s": 1.0, "action": "warm", "node": 1, "value": 9},
             {"at_s": 0.5, "action": "kill", "node": 1}]  # fmt: skip
    plan = scenarios.plan(loaded(own, event=event))
    who = "n{}" if hasattr(plan, "graph") else "node {}"
    lines = networks()["own"].describe(plan).splitlines()
    first = next(k for k, line in enumerate(lines) if line.startswith("  event "))
    assert lines[first : first + 3] == [
        f"  event      at 0.5 s kill {who.format(1)}",
        f"             at 1 s warm {who.format(1)}, value 9",
        f"             at 1.5 s kill {who.format(0)}",
    ]


EVENTS = {
    "cables": [("cut", {"link": "n1-n0"}), ("restore", {"link": "n1.E-n2.W"}),
               ("kill", {"node": 3}), ("loose", {"link": "n2-n3", "loss": 0.25}),
               ("lose", {"link": "n2-n3", "frames": 7}), ("revive", {"node": 3}),
               ("restart", {"node": 2})],
    "channel": [("kill", {"node": 3}), ("revive", {"node": 3}), ("join", {"node": 1})],
    "field": [("kill", {"node": 3}), ("cut", {"node": 0, "other": 1}),
              ("jam", {"node": 2, "noise_dbm": -71.5}), ("restart", {"node": 3})],
}  # fmt: skip


def test_what_was_done_is_written_as_events_that_do_the_same(own):
    kind = loaded(own).model.kind
    network = networks()[kind]
    events = [{"at_s": 0.1 * place, "action": word, **more}
              for place, (word, more) in enumerate(EVENTS[network.medium])]  # fmt: skip
    plan = scenarios.plan(loaded(own, event=events))
    written = [{"at_s": fault.at_us / 1e6, **network.event(plan, fault)} for fault in plan.faults]
    assert scenarios.plan(loaded(own, event=written)).faults == plan.faults


def test_of_two_cables_between_the_same_nodes_either_is_cut_by_its_ends(alone):
    own = made(alone / "own")
    kind = loaded(own).model.kind
    network = networks()[kind]
    cables = ["n0.E-n1.W", "n0.up-n1.down", "n1.E-n2.W"]
    events = [{"at_s": 0.1, "action": "cut", "link": name} for name in (*cables, "n1.down-n0.up")]
    plan = scenarios.plan(loaded(own, cables=cables, event=events, input=[]))
    named = [network.event(plan, fault)["link"] for fault in plan.faults]
    assert named == [*cables, cables[1]]
    with pytest.raises(ScenarioError, match=r"there is no cable .n0\.W-n1\.E."):
        loaded(own, cables=cables, event=[{**events[0], "link": "n0.W-n1.E"}], input=[])


def test_events_of_keys_of_its_own_are_written_by_nobody_else():
    own = {"model": "scenario:Mine"}
    assert Network("mine", "mine", medium="channel").writes_events
    assert not Network("mine", "mine", medium="field", **own).writes_events
    assert Network("mine", "mine", **own, event="scenario:event").writes_events


@pytest.mark.parametrize(("medium", "old", "new", "says"), [
    ("channel", "nodes = 6", "nodes = 3", "own/own.toml:21: there is no node 3; they are 0 to 2"),
    ("channel", 'action = "kill"', 'action = "cut"',
     'action must be join, kill or revive, not "cut"'),
    ("channel", "wait_us = 10_000", "wait_us = 0", "wait_us must be 1 to 1000000 us, not 0"),
    ("channel", "value = 7", "valeu = 7", 'did you mean "value"'),
    ("field", "nodes = 16", "nodes = 4", "own/own.toml:23: there is no node 15; they are 0 to 3"),
    ("field", 'action = "kill"', 'action = "cut"',
     "own.toml:26: cut needs the other node; add other"),
    ("field", 'action = "kill"', 'action = "hide"',
     "action must be kill, revive, cut, restore, jam"),
    ("field", "hops = 7", "hops = 0", "own/own.toml:12: hops must be 1 to 15 hops, not 0"),
    ("field", "value = 7", "valeu = 7", 'did you mean "value"'),
    ("field", 'layout = "grid"', "positions_m = [[0, 0]]", "positions_m has 1 places for 16 nodes"),
    ("field", 'layout = "grid"', 'link = [{ nodes = [1, 1] }]', "node 1 is named twice"),
    ("field", "reach_m = 30", "exponent_min = 9", "air.exponent_min is above exponent_max"),
])  # fmt: skip
def test_mistakes_are_one_line(alone, capsys, medium, old, new, says):
    network = made(alone / "own", medium)
    network.change("own.toml", old, new)
    assert says in refused(network, capsys)
