"""What an exploration found, as a scenario that a run plays to the same end."""

import random
import tomllib
from bdb import BdbQuit
from pathlib import Path

import pytest

import innervate
from innervate import scenario as scenarios
from innervate.cli import main
from innervate.cli.options import VerifyOptions
from innervate.live.deployment import Deployment
from innervate.network import NetworkError, use
from innervate.running import simulating
from innervate.scenario import ScenarioError
from innervate.verify import declared, scripts
from innervate.verify.cases import Story
from innervate.verify.graphs import graph_of
from innervate.verify.states import Budget
from innervate.web.engine import WatchError, engine_of
from tests.own import alone, made, own

__all__ = ["alone", "own"]  # fixtures


def story_of(network, **wanted):
    asked = VerifyOptions(**{"graph": "pair", "states": 2_000, **wanted})
    (one,) = declared.explorations(network, asked)
    return one(lambda *_: False).story


def test_a_story_is_written_and_run_to_what_it_says(own, capsys):
    """Two nodes call different news version 1; if all news are the same, nothing breaks."""
    name = str(own.folder)
    assert main(["verify", name, "--graph", "pair", "--budget", "input=2", "--out", "found"]) == 1
    story = capsys.readouterr().out
    title = "two nodes have different values of one version"
    assert f"So: {title}" in story
    assert "gossip-counterexample-1.toml (innervate run plays it), .txt" in story
    file = "found/gossip-counterexample-1.toml"
    assert main(["run", file]) == 2
    last = "n1 is given 1 (value 9) by its user: version 0 to 1, value 0 to 9."
    assert capsys.readouterr().err == (
        f"innervate: invariant broken in step 2 of 2 of its script: {title}. {last}\n"
    )
    assert main(["check", file]) == 0
    assert "  script     2 steps in place of the clock\n" in capsys.readouterr().out
    own.change("protocol.py", "node.value = item.value", "node.value = 7")
    assert main(["run", file]) == 0
    assert "ok: nothing broke in 2 steps of its script." in capsys.readouterr().out


def test_a_script_of_one_step_is_told_as_one(own, capsys):
    """As the commands say it; the counterexample above, of which one step breaks nothing."""
    name = str(own.folder)
    assert main(["verify", name, "--graph", "pair", "--budget", "input=2", "--out", "found"]) == 1
    path = Path("found/gossip-counterexample-1.toml")
    *lines, _second, end, last = path.read_text().split("\n")
    path.write_text("\n".join([*lines, end, last]))
    assert main(["check", str(path)]) == 0
    assert "  script     1 step in place of the clock\n" in capsys.readouterr().out
    assert main(["run", str(path)]) == 0
    assert "ok: nothing broke in 1 step of its script." in capsys.readouterr().out


def net_of(network, graph):
    of = network.fields
    return declared.net_of(network, graph_of(graph),
                           {**of.DEFAULTS, **getattr(of, "EXPLORED", {})})  # fmt: skip


WALKED = {"babel": "ring", "flooding": "line", "rpl": "line", "cables": "line", "channel": "pair",
          "channel of three": "line", "field": "pair", "csma": "ring"}  # fmt: skip


@pytest.mark.parametrize("which", WALKED)
def test_any_order_of_events_is_played_as_it_was_explored(which, alone):
    """Frames that come, are lost, wait, find no room; timers, draws, restarts, inputs."""
    medium = {"csma": "field", "channel of three": "channel"}.get(which, which)
    network = innervate.network.networks().get(which)
    if network is None:
        network = use(made(alone / "own", medium, "csma" if which == "csma" else "").folder)
    chance = random.Random(5)
    for length in (0, 1, 40, 80):
        net = net_of(network, WALKED[which])
        begun = chance.choice(list(net.begins(Budget(3, 2, 4))))
        state, events = begun.state, [begun.words] if net.draws.made else []
        for _ in range(length):
            step = chance.choice([one for one in net.steps(state)
                                  if not net.broken_of_all(one.state)])  # fmt: skip
            state = step.state
            events.append(step.words)
        text = scripts.scenario_of(network, net, Story("", events=events))
        run = innervate.run(tomllib.loads(text))
        kept = getattr(run.result.world, "cells" if network.medium == "cables" else "stations")
        names = [name for name, *_ in network.fields.STATE]
        for node, at in zip(kept, state.nodes, strict=True):
            assert tuple(tuple(value) if isinstance(value := getattr(node, name), list) else value
                         for name in names) == at.values  # fmt: skip
        if length == 0:
            assert run.result.handled == len(state.nodes)  # each was switched on, once
        counts = run.result.counts
        assert counts.in_flight == sum(map(len, state.ways)) >= 0
        assert counts.offered == sum("by its user" in event for event in events)
        assert sum(counts.lost_by.values()) == sum(
            any(how in event for how in ("lost", "does not hear", "given up")) for event in events
        )


@pytest.mark.parametrize(("name", "does", "steps", "title"), [
    ("on_timer(node, params, now, timer, out)", "node.version = 0", 2, declared.STUCK),
    ("on_start(node, params, now, cause, out)", "node.value = 1", 1,
     "a node without news has a value"),
])  # fmt: skip
def test_what_is_still_and_what_breaks_at_the_start_is_played_too(own, name, does, steps, title):
    own.rewrite(name.partition("(")[0], f'def {name}:\n    """Nothing more."""\n    {does}')
    story = story_of(use(own.folder), budget="loss=0,restart=0,input=0")
    assert (story.title, len(story.events)) == (title, steps)
    with pytest.raises(NetworkError, match=f"in step {steps} of {steps} of its script: {title}"):
        innervate.run(tomllib.loads(story.scenario))


def test_a_step_that_cannot_be_is_told_with_its_line_and_what_can(own):
    text = story_of(use(own.folder), budget="input=2").scenario
    tables = tomllib.loads(text)
    for step, said in [
        ("n2 is given 1 (value 9) by its user", '.* cannot happen here; what can: "n1 gets a '
         'frame from n0 W", "A frame from n0 W is lost", .* and 8 more$'),
        ("n1 is given 1 (value 9) by its user, n1 draws 1 out of 2",
         '.* is now "n1 is given 1 .value 9. by its user"$'),
    ]:  # fmt: skip
        tables["script"]["steps"][1] = step
        with pytest.raises(ScenarioError, match=f"^script.steps.1: {said}"):
            innervate.run(tables)
    lines = text.splitlines()
    place = lines.index('  "n1 is given 1 (value 9) by its user",')
    (own.folder / "x.toml").write_text(text.replace("n1 is", "n2 is"))
    with pytest.raises(ScenarioError) as found:
        innervate.run(own.folder / "x.toml")
    assert found.value.line == place + 1


def test_what_needs_a_clock_refuses_a_script(own):
    text = story_of(use(own.folder), budget="input=2").scenario
    plan = scenarios.plan(scenarios.loads(text))
    said = r"its \[script\] replaces the clock"
    for needs in (
        lambda: simulating.simulate(plan, tap=object()), lambda: next(simulating.trail(plan, 9)),
        lambda: Deployment(plan),
    ):  # fmt: skip
        with pytest.raises(ScenarioError, match=f"{said}; only innervate run and sweep play it$"):
            needs()
    with pytest.raises(WatchError, match=f"{said}; use: innervate run$"):
        engine_of(plan)


@pytest.mark.parametrize(("keys", "said"), [
    ({"event": [{"at_s": 0.1, "action": "kill", "node": 0}]}, r"leave the \[\[event\]\]s out"),
    ({"input": [{"node": 0}]}, r"leave the \[\[input\]\]s out"),
    ({"nodes": 3}, "script.graph has 2 nodes, and nodes is 3"),
    ({"script": {"steps": [], "graph": "n0-"}}, "script.graph: "),
    ({"script": {"steps": []}}, "script.graph has 0 nodes, and nodes is 2"),
])  # fmt: skip
def test_a_script_has_its_nodes_and_all_that_happens(keys, said):
    good = {"kind": "flooding", "nodes": 2, "script": {"steps": [], "graph": "n0-n1"}}
    assert innervate.run(good).summary["headline"]["level"] == "ok"
    with pytest.raises(ScenarioError, match=said):
        innervate.run(good | keys)


def test_a_protocol_that_prints_is_called_for_what_happens_alone(own, capsys):
    (own.folder / "x.toml").write_text(story_of(use(own.folder), budget="input=2").scenario)
    said = '    print("given", node.number, item.value)\n'
    own.change("protocol.py", "    node.value = item.value", f"{said}    node.value = item.value")
    assert main(["run", str(own.folder / "x.toml"), "--plain"]) == 2
    assert capsys.readouterr().out == "given 0 7\ngiven 1 9\n"


def test_who_leaves_the_debugger_in_a_script_has_interrupted_it(own, monkeypatch):
    network = use(own.folder)
    text = story_of(network, budget="input=2").scenario

    def left(*_):
        raise BdbQuit

    monkeypatch.setattr(network.protocol, "on_input", left)
    with pytest.raises(KeyboardInterrupt):
        innervate.run(tomllib.loads(text), plain=True)
