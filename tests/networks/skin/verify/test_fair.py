"""Liveness: routes become shortest in time once faults have ended, and the check can fail."""

from dataclasses import replace

import pytest

from innervate.networks.skin.verify import cases, fair, graphs, mutants
from innervate.networks.skin.verify.system import ANY, Budget, SkinModel
from innervate.verify import explore

FAULTY = Budget(ticks=2, counts=2, faults=2)


def model(graph, **keys):
    return SkinModel(graphs.parse(graph), keep=True, **{"budget": FAULTY} | keys)


# States that are not settled after each round. One state can lead to several: they may become more.
LEFT = {
    ("pc-1 1-2", "periodic"): [183, 38, 15, 1, 0],
    ("pc-1 1-2", "triggered"): [4, 0],
    ("pair", "periodic"): [266, 86, 35, 18, 10, 12, 6, 2, 2, 0],
    ("pair", "triggered"): [7, 4, 4, 0],
}


@pytest.mark.parametrize(("graph", "updates"), LEFT)
def test_every_state_settles(graph, updates):
    budget = FAULTY if updates == "periodic" else Budget(ticks=1, counts=2, faults=1)
    result = explore.explore(model(graph, updates=updates, budget=budget))
    assert result.tally.ended == "complete"
    found = fair.check(result)
    assert (found.ended, found.starts, found.left_out) == ("complete", result.tally.states, 0)
    assert 0 < found.rounds <= found.bound
    assert found.left == LEFT[graph, updates]


def test_plain_and_compiled_agree():
    made = model("pc-1 1-2", budget=Budget(ticks=2, counts=1, faults=1))
    one, other = (fair.check(explore.explore(made, plain=p), plain=p) for p in (False, True))
    for name in ("rounds", "left", "played", "calm", "ended", "starts"):
        assert getattr(one, name) == getattr(other, name), name


def test_a_sample_says_that_it_is_one():
    result = explore.explore(model("pair"))
    found = fair.check(result, starts=50)
    assert found.starts == 50 < found.of == result.tally.states


def test_a_network_that_never_settles_is_found():
    lost = next(m for m in mutants.MUTANTS if m.name == "the PC says that it is a hop away")
    catch = mutants.hunt(lost)
    assert "no shortest routes after" in catch.by


def test_too_small_a_bound_is_broken(monkeypatch):
    monkeypatch.setattr(fair, "bound_of", lambda _: 1)
    found = fair.check(explore.explore(model("pair")))
    assert found.ended == "broken"
    assert len(found.path) == 4  # the state, a beacon lost, before the first round, after it


@pytest.mark.parametrize("ticks", [2, ANY])
def test_what_a_reduced_search_finds_stands_if_the_whole_one_agrees_or_says_less(
    monkeypatch, ticks
):
    monkeypatch.setattr(fair, "bound_of", lambda _: 1)
    made = model("pc-1 1-2", lean=True, budget=Budget(ticks=ticks, faults=1))
    case = cases.run(made, cases.Wanted(), lambda *_: False)
    assert case.fair.ended == "broken"
    assert case.is_broken


def test_a_beacon_that_was_lost_at_last_is_not_delivered_by_the_fair_schedule():
    budget = Budget(ticks=2, loss=1, cut=1, heal=0, false=0, restart=0, faults=2)
    made = model("pc-1 1-2", budget=budget, symmetric=False, capacity=3)
    merged, apart = (
        fair.check(explore.explore(made.changed(merge=flag))) for flag in (True, False)
    )
    assert merged.left == apart.left
    unlost = made.changed(budget=replace(budget, loss=0))
    assert fair.check(explore.explore(unlost)).left[0] < merged.left[0]
