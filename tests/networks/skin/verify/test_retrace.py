"""A way back in whole states is one: each event leads to the next state, the last one breaks."""

from itertools import groupby, pairwise

import pytest

from innervate.networks.skin.verify import command, graphs, retrace
from innervate.networks.skin.verify.system import Budget, SkinModel, system_of
from innervate.verify.explore import explore, wander
from innervate.verify.twin import Twin


@pytest.mark.parametrize(("path", "short"), [
    ("", ""), ("a", "a"), ("abc", "abc"), ("aba", "a"), ("abac", "ac"), ("abcbd", "abd"),
    ("abcbab", "ab"), ("abbc", "abc"),
])  # fmt: skip
def test_a_path_comes_to_no_state_twice(path, short):
    assert retrace._without_rounds([*path]) == [*short]


RESTART = Budget(counts=3, loss=0, heal=0, false=0)
FOUND = [("pair", {}), ("triangle", {}), ("triangle", {"prompt": True}),
         ("triangle", {"updates": "triggered"}), ("ring", {"updates": "triggered"}),
         ("triangle", {"rule": "strict", "budget": RESTART})]  # fmt: skip


# Walks take longer ways: some steps of theirs take several events, some come by broken states.
WALKED = [("triangle", {"updates": "triggered"}, 1), ("triangle", {}, 4),
          ("ring", {"updates": "triggered", "prompt": True}, 6),
          ("triangle", {"updates": "triggered"}, 21)]  # fmt: skip


@pytest.mark.parametrize(("graph", "keys", "seed"), [*((*one, 0) for one in FOUND), *WALKED])
def test_whole_states_follow_each_other_and_are_reduced_to_what_was_found(graph, keys, seed):
    made = SkinModel(graphs.parse(graph), lean=True, **{"rule": "paper"} | keys)
    found = wander(made, 50, seed=seed, length=60) if seed else explore(made)
    whole = retrace.retrace(found)
    twin, lean = Twin(whole.model, system_of()), Twin(made, system_of())
    assert whole.path[0] == twin.image()
    assert (whole.broken, whole.model.lean) == (found.broken, False)
    for here, there in [*pairwise(whole.path), (whole.path[-1], None)]:
        twin.put(here)
        after = [(twin.image(), twin.world.found[0] or twin.system.check(twin.world))
                 for _ in twin.successors()]  # fmt: skip
        states = {state for state, code in after if not code}
        assert there in states if there else found.broken in {code for _, code in after}
    kept = [retrace.reduced(lean, row) for row in whole.path]
    assert [state for state, _ in groupby(kept)] == retrace._without_rounds(found.path)


@pytest.mark.parametrize("states", [0, 20])
def test_the_fair_schedule_is_played_from_what_a_search_found_that_was_to_end(states):
    model = SkinModel(graphs.parse("pc-1 1-2"), budget=Budget(ticks=2, faults=1), keep=True)
    case = command.run(model, command.Wanted(states=states, plain=True), lambda *_: False)
    assert case.tally.ended == ("limit" if states else "complete")
    assert (case.fair.ended, case.fair.of) == ("complete", case.tally.states)
    assert case.is_complete == (not states)
