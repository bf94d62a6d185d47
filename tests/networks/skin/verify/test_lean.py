"""What the search leaves out changes nothing: compared with the search that leaves nothing out."""

import pytest

from innervate.networks.skin.verify import command, fair, graphs, mutants, reduction
from innervate.networks.skin.verify.system import Budget, SkinModel
from innervate.networks.skin.verify.world import BROKEN_LOOP
from innervate.verify import explore
from tests.networks.skin.verify.cover import Cover

ONE = Budget(ticks=1, counts=1, faults=1)


def model(graph, updates, **keys):
    return SkinModel(graphs.parse(graph), updates=updates, **{"budget": ONE} | keys)


# No "false": a port that is deaf for good is like one that nothing reaches, but no row says so.
LOST = Budget(ticks=2, counts=2, false=0, faults=1)
MODELS = {
    "two in a line": model("pc-1 1-2", "triggered", budget=Budget(ticks=2, counts=2, faults=1)),
    "pair": model("pair", "triggered", budget=Budget(ticks=1, counts=2, faults=1)),
    "pair, kept": model("pair", "triggered", keep=True),
    "a PC that restarts twice": model(
        "pc-1", "triggered", budget=Budget(restart=2, faults=2), keep=True
    ),
    "strict, without restarts": model(
        "pair", "triggered", rule="strict", budget=Budget(1, 1, restart=0, faults=1)
    ),
    "strict, periodic": model(
        "pair", "periodic", rule="strict", budget=Budget(ticks=2, restart=0, faults=2)
    ),
    "strict": model("pc-1 1-2", "triggered", rule="strict", budget=Budget(ticks=2, faults=1)),
    "periodic": model("triangle", "periodic", budget=Budget(ticks=2, faults=1)),
    "periodic, kept": model("line", "periodic", budget=Budget(ticks=1, faults=2), keep=True),
    "forgetting": model("pc-1 1-2", "triggered", budget=Budget(ticks=3, faults=1), hold=2),
    "every order": model("pc-1 1-2", "periodic", budget=LOST, merge=False),
}


@pytest.mark.parametrize("name", MODELS)
def test_every_state_is_covered(name):
    cover = Cover(MODELS[name])
    whole, lean = cover.whole_result.tally, cover.lean_result.tally
    assert whole.ended == lean.ended == "complete"
    assert 50 < lean.states < whole.states
    assert cover.missing() == []
    assert cover.is_faithful()


@pytest.mark.slow
@pytest.mark.parametrize(
    ("graph", "updates", "keys"),
    [
        ("triangle", "triggered", {}),
        ("line", "triggered", {"budget": Budget(faults=0)}),
        ("star", "triggered", {"budget": Budget(ticks=1, faults=2), "rule": "strict"}),
        ("pair", "triggered", {"budget": Budget(ticks=2, faults=1)}),
        ("triangle", "periodic", {"budget": Budget(faults=1)}),
        ("pair", "periodic", {"budget": Budget(), "keep": True}),
        ("line", "periodic", {"budget": LOST, "merge": False}),
    ],
)
def test_every_state_of_larger_networks_is_covered(graph, updates, keys):
    cover = Cover(model(graph, updates, **keys))
    assert cover.whole_result.tally.states > 3_000
    assert cover.missing() == []
    assert cover.is_faithful()


@pytest.mark.parametrize("wrong", ["is_dead_route", "is_gone", "same_frame"])
def test_forgetting_too_much_is_noticed(monkeypatch, wrong):
    made = model("pair", "periodic", budget=Budget(ticks=1, counts=2, faults=1), keep=True)
    if wrong == "is_dead_route":
        made = made.changed(keep=False)
    monkeypatch.setattr(reduction, wrong, lambda *_: True)
    cover = Cover(made, plain=True)
    assert cover.missing() or not cover.is_faithful()


@pytest.mark.parametrize(("updates", "faults"), [("periodic", 2), ("triggered", 1)])
def test_compiled_and_plain_leave_out_the_same(updates, faults):
    made = model("pair", updates, budget=Budget(ticks=2, faults=faults), lean=True)
    one, other = (explore.explore(made, plain=plain) for plain in (False, True))
    assert one.tally.states > 500
    for number in ("states", "expanded", "generated", "depth", "ended", "left_out"):
        assert getattr(one.tally, number) == getattr(other.tally, number), number
    assert bytes(memoryview(one.rows).cast("B")) == bytes(memoryview(other.rows).cast("B"))


@pytest.mark.parametrize("updates", ["periodic", "triggered"])
@pytest.mark.parametrize("graph", ["triangle", "pair"])
def test_the_loops_of_the_paper_rule_are_found_all_the_same(graph, updates):
    made = model(graph, updates, rule="paper", budget=Budget(faults=2))
    whole, lean = (explore.explore(made.changed(lean=flag)) for flag in (False, True))
    assert lean.broken == whole.broken == BROKEN_LOOP
    assert len(lean.path) == len(whole.path)
    assert lean.tally.states < whole.tally.states


def test_a_story_is_told_of_whole_states():
    made = model("triangle", "triggered", rule="paper", budget=Budget(faults=2), lean=True)
    case = command.run(made, command.Wanted(), lambda *_: False)
    assert case.is_broken
    assert case.story.lines()[-1].startswith("So: closed loop n")
    assert "[script]" in case.story.scenario


@pytest.mark.parametrize(
    ("graph", "updates"), [("pair", "periodic"), ("pc-1 1-2", "triggered"), ("pc-1", "triggered")]
)
def test_liveness_holds_from_the_states_that_are_kept(graph, updates):
    made = model(graph, updates, budget=Budget(ticks=2, counts=2, faults=2), keep=True)
    results = [explore.explore(made.changed(lean=flag)) for flag in (False, True)]
    whole, lean = map(fair.check, results)
    assert whole.ended == lean.ended == "complete"
    assert whole.rounds == lean.rounds
    assert lean.starts < whole.starts


@pytest.mark.parametrize(
    "made",
    [
        model("pc-1", "triggered", budget=Budget(ticks=2, counts=1, faults=1), keep=True),
        model("pc-1 1-2", "triggered", keep=True),
        model("pc-1 1-2", "periodic", keep=True, hold=4, budget=Budget(1, 1, faults=2)),
        model("pair", "periodic", budget=Budget(ticks=1, counts=2, faults=1), keep=True),
    ],
    ids=["a cell", "two in a line", "two that forget soon", "pair"],
)
def test_what_follows_without_faults_is_the_same(made):
    cover = Cover(made.changed(symmetric=False))
    order = list(range(made.graph.nodes))
    assert cover.is_followed(order)
    assert cover.is_followed(order[::-1])


@pytest.mark.parametrize("graph", ["pc-1 1-2", "pair"])
@pytest.mark.parametrize("updates", ["periodic", "triggered"])
def test_as_many_ticks_as_it_takes_cover_any_number(graph, updates):
    made = model(graph, updates, budget=Budget(ticks=2, counts=1, faults=1))
    cover = Cover(made, any_ticks=True)
    assert cover.lean_result.tally.ended == "complete"
    assert cover.missing() == []


@pytest.mark.slow
@pytest.mark.parametrize("graph", ["pair", "triangle"])
def test_liveness_holds_in_larger_networks_that_forget_soon(graph):
    budget = Budget(ticks=1, faults=1)
    made = model(graph, "triggered", budget=budget, keep=True, hold=4, capacity=4)
    results = [explore.explore(made.changed(lean=flag)) for flag in (False, True)]
    whole, lean = map(fair.check, results)
    assert whole.ended == lean.ended == "complete"
    assert whole.rounds == lean.rounds
    assert 50 * lean.starts < whole.starts


@pytest.mark.slow
@pytest.mark.parametrize("mutant", mutants.MUTANTS, ids=lambda mutant: mutant.name)
def test_every_mutant_is_caught_by_the_reduced_search(mutant):
    assert mutants.hunt(mutant, starts=40, lean=True).by
