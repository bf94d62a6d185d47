"""Liveness: routes become shortest in time once faults have ended, and the check can fail."""

from dataclasses import replace
from itertools import permutations, product

import pytest

from innervate.networks.skin.verify import calm, command, fair, graphs, mutants
from innervate.networks.skin.verify import world as w
from innervate.networks.skin.verify.system import ANY, Budget, SkinModel, system_of
from innervate.verify import explore
from innervate.verify.twin import Twin

FAULTY = Budget(ticks=2, counts=2, faults=2)


def model(graph, **keys):
    return SkinModel(graphs.parse(graph), keep=True, **{"budget": FAULTY} | keys)


def ways(world):
    """Once for each way in which draws can turn out, by recursion over what was asked before."""
    todo = [()]
    while todo:
        given = todo.pop()
        calm.draw_first(world)
        world.draws[1 : 1 + len(given)] = list(given)
        yield given
        made, asked = world.draws[0], world.draws[1 + w.DRAWS :]
        for place in range(len(given), made):
            zeros = (0,) * (place - len(given))
            todo += [(*given, *zeros, value) for value in range(1, asked[place])]


def rounds_by_hand(result, most=9):
    """States left after each round: stepped one by one, told apart as bytes in a set."""
    twin = Twin(result.model.changed(keep=True), system_of())
    world, system, width = twin.world, twin.system, twin.lay.width
    world.at[w.FAIR] = 1
    rows = bytes(memoryview(result.rows).cast("B"))
    states, left = set(), []
    for row in range(0, len(rows), width):
        for _ in ways(world):
            twin.put(rows[row : row + width])
            calm.forget_budgets(world)
            assert system.settle(world)
            states.add(twin.image())
    orders = list(permutations(range(result.model.graph.nodes)))
    while states and len(left) < most:
        after = set()
        for state, order in product(states, orders):
            for _ in ways(world):
                twin.put(state)
                for node in order:
                    assert system.turn(world, node)
                if not system.is_settled(world):
                    after.add(twin.image())
        states = after
        left.append(len(states))
    return left


CASES = list(product(("pc-1 1-2", "pair"), ("periodic", "triggered")))


@pytest.mark.parametrize(("graph", "updates"), CASES)
def test_every_state_settles(graph, updates):
    budget = FAULTY if updates == "periodic" else Budget(ticks=1, counts=2, faults=1)
    result = explore.explore(model(graph, updates=updates, budget=budget))
    assert result.tally.ended == "complete"
    found = fair.check(result)
    assert (found.ended, found.starts, found.left_out) == ("complete", result.tally.states, 0)
    assert 0 < found.rounds == len(found.left) <= found.bound
    assert found.left[-1] == 0 < min(found.left[:-1])
    if (graph, updates) == CASES[1]:
        assert found.left == rounds_by_hand(result)


def test_plain_and_compiled_agree():
    made = model("pc-1 1-2", budget=Budget(ticks=2, counts=1, faults=1))
    one, other = (fair.check(explore.explore(made, plain=p), plain=p) for p in (False, True))
    for name in ("rounds", "left", "played", "calm", "ended", "starts"):
        assert getattr(one, name) == getattr(other, name), name


def test_a_sample_says_that_it_is_one():
    result = explore.explore(model("pair"))
    found = fair.check(result, starts=50)
    assert found.starts == 50 < found.of == result.tally.states


def test_a_network_that_never_settles_is_found(monkeypatch):
    monkeypatch.setattr(mutants, "models", lambda lean: [model("pc-1")])
    lost = next(m for m in mutants.MUTANTS if m.name == "the PC says that it is a hop away")
    catch = mutants.hunt(lost)
    assert catch.by == "routes are not shortest after 9 fair rounds"


def test_frames_that_set_off_more_without_end_are_told_as_such(monkeypatch):
    """Not as routes that are not shortest in time: there is no round in which they could be."""
    monkeypatch.setattr(mutants, "models", lambda lean: [model("pc-1", updates="triggered")])
    again = mutants.Mutant("the timer for news is never over",
                           "        cell.soon = 0\n        if is_news",
                           "        cell.soon = 1\n        if is_news")  # fmt: skip
    catch = mutants.hunt(again)
    assert catch.by == "what is under way sets off more without end, after 0 fair rounds"


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
    case = command.run(made, command.Wanted(), lambda *_: False)
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
