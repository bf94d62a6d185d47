"""What the explorer has to find in the published rule, and must not find in the others."""

import tomllib
from pathlib import Path

import pytest

from innervate import scenario
from innervate.networks.skin.plot import counterexample
from innervate.networks.skin.sim.simulate import simulate
from innervate.networks.skin.verify import graphs, retrace, story
from innervate.networks.skin.verify.system import ANY, Budget, SkinModel, system_of
from innervate.networks.skin.verify.world import BROKEN_LOOP
from innervate.sim.driver import InvariantBroken
from innervate.verify import explore
from innervate.verify.twin import Twin

# Every frame arrives before anything else happens, or is lost where the budget says so: these are
# the smallest histories that [skin E25] prints.
LOSSLESS = Budget(loss=0, cut=1, heal=0, false=0, restart=0, faults=1)
LOST = Budget(ticks=2, counts=1, loss=1, cut=2, heal=0, false=0, restart=0, faults=3)
KNOWN = {
    "four nodes, nothing lost": ("triangle", LOSSLESS, 3),
    "five nodes, nothing lost": ("ring", LOSSLESS, 4),
    "three nodes, a beacon lost": ("pair", LOST, 2),
}


def model(name, rule, **keys):
    graph, budget, _ = KNOWN[name]
    return SkinModel(graphs.parse(graph), rule, "periodic", budget, prompt=True, **keys)


@pytest.mark.parametrize("name", KNOWN)
def test_the_paper_rule_closes_the_known_loops(name):
    result = explore.explore(model(name, "paper"))
    assert result.broken == BROKEN_LOOP
    assert result.path[0] == Twin(result.model, system_of()).image()
    told = story.tell(result)
    assert len(told.ring) == KNOWN[name][2]
    assert len(told.sentences) == len(told.steps) == len(told.scenes) == len(result.path)
    assert told.lines()[-1].startswith("So: closed loop n1 -> ")
    lost = [text for text in told.sentences if text.startswith("lost")]
    assert len(lost) == ("lost" in name and "nothing" not in name)


@pytest.mark.parametrize("rule", ["strict", "feasible"])
@pytest.mark.parametrize("name", KNOWN)
def test_the_other_rules_do_not(name, rule):
    # Of the five nodes twice as many states as it takes to find the published rule's loop.
    result = explore.explore(model(name, rule), states=150_000)
    assert result.broken == 0
    assert result.tally.ended == ("limit" if "five" in name else "complete")


def test_a_loss_is_needed_where_the_story_has_one():
    graph = KNOWN["three nodes, a beacon lost"][0]
    calm = Budget(ticks=2, counts=1, loss=0, cut=2, heal=0, false=0, restart=0, faults=2)
    made = SkinModel(graphs.parse(graph), "paper", "periodic", calm, prompt=True)
    assert explore.explore(made).broken == 0
    # ... or a frame that is still on its way.
    late = SkinModel(graphs.parse(graph), "paper", "periodic", calm)
    assert explore.explore(late).broken == BROKEN_LOOP


@pytest.mark.parametrize(
    ("graph", "keys"),
    [
        ("triangle", {"prompt": True}),
        ("triangle", {}),
        ("ring", {"budget": LOSSLESS}),
        ("pair", {}),
        ("triangle", {"updates": "triggered"}),
    ],
)
def test_a_counterexample_is_a_scenario_that_closes_the_same_loop(graph, keys):
    result = explore.explore(SkinModel(graphs.parse(graph), **{"rule": "paper"} | keys))
    assert result.broken
    check_played(story.tell(result))


@pytest.mark.parametrize(
    ("graph", "keys"),
    [
        ("triangle", {"prompt": True}),
        ("triangle", {"updates": "triggered"}),
        ("ring", {"updates": "triggered"}),
    ],
)
def test_what_a_reduced_search_finds_is_told_of_whole_states(graph, keys):
    made = SkinModel(graphs.parse(graph), lean=True, **{"rule": "paper"} | keys)
    found = explore.explore(made)
    whole = retrace.retrace(found)
    assert not whole.model.lean
    assert len(whole.path) == len(found.path)
    check_played(story.tell(whole))


@pytest.mark.parametrize("lean", [False, True])
def test_the_strict_rule_closes_a_loop_when_a_restarted_pc_counts_from_anew(lean):
    budget = Budget(counts=3, loss=0, heal=0, false=0)
    made = SkinModel(graphs.parse("triangle"), "strict", "periodic", budget, lean=lean)
    found = explore.explore(made)
    assert found.broken == BROKEN_LOOP
    told = story.tell(retrace.retrace(found) if lean else found)
    assert len(told.sentences) == 11
    assert "The PC has listened for a period." in told.sentences
    with pytest.raises(InvariantBroken, match="forwarding loop"):
        simulate(scenario.plan(scenario.loads(told.scenario)))


def test_the_documented_story_of_a_restarted_pc_is_as_long_as_documented():
    made = SkinModel(graphs.parse("triangle"), "strict", "periodic", Budget(counts=3))
    told = story.tell(explore.explore(made))
    assert len(told.sentences) == 10
    page = (Path(__file__).parents[4] / "docs" / "verify.md").read_text(encoding="utf-8")
    assert "leads through itself:\nten events on the triangle." in page


def test_a_beacon_that_is_late_by_more_than_fd_hold_closes_a_loop():
    made = SkinModel(graphs.parse("pair"), budget=Budget(ticks=11), lean=True)
    told = story.tell(retrace.retrace(explore.explore(made)))
    assert told.title == "closed loop n1 -> n2 -> n1"
    assert "forgotten after 9 periods" in told.scenario


# Seeds whose first loop is soon retraced.
@pytest.mark.parametrize(("ticks", "seed"), [(20, 2), (ANY, 3)], ids=["20 ticks", "any ticks"])
def test_what_a_reduced_walk_finds_is_told_of_whole_states(ticks, seed):
    budget = Budget(ticks=ticks, counts=8, faults=4)
    made = SkinModel(graphs.parse("triangle"), "paper", "triggered", budget, lean=True)
    found = explore.wander(made, 200_000, seed=seed)
    check_played(story.tell(retrace.retrace(found)))


def check_played(told):
    """The scenario of a story ends with its loop."""
    assert tomllib.loads(told.scenario)["script"]["keepalive"] is True
    plan = scenario.plan(scenario.loads(told.scenario))
    played = simulate(plan)
    cells = played.world.cells
    ends = [4 * c + state.parent for c, state in enumerate(cells)]
    label = plan.graph.label
    hops = {
        label(c): label(plan.graph.node_of(plan.graph.peer[end]))
        for c, end in enumerate(ends)
        if cells[c].parent >= 0
    }
    names = [told.graph.label(node) for node in told.ring]
    assert names
    for here, there in zip(names, [*names[1:], names[0]], strict=True):
        assert hops[here] == there


def test_a_story_is_drawn_with_its_ring():
    told = story.tell(explore.explore(model("four nodes, nothing lost", "paper")))
    text = counterexample.draw(told).render()
    assert text.count('class="ring"') == 3 * 3  # a line and two barbs each
    assert "closed loop" in text
    for number, sentence in enumerate(told.sentences, 1):
        assert f"{number}. {sentence[:20]}" in text


def test_stories_are_as_short_as_they_can_be():
    made = SkinModel(graphs.parse("triangle"), "paper", "periodic", Budget(faults=1))
    shortest = len(explore.explore(made).path)
    walked = explore.wander(made, 20_000)
    assert walked.broken
    assert len(walked.path) >= shortest
