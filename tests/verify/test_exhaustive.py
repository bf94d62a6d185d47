"""The sizes that the documentation says are explored completely; `make full`."""

import pytest

from innervate.verify import explore, fair, graphs
from innervate.verify.skin_system import Budget, SkinModel

GIB = 1 << 30
FAILURE_AND_LOSS = Budget(loss=1, cut=1, heal=0, false=0, restart=0, faults=2)
SMALL = [graph for cells in (1, 2, 3) for graph in graphs.all_graphs(cells)]

pytestmark = pytest.mark.slow


def fine(graph, rule, updates, budget=None, **keys):
    model = SkinModel(graph, rule, updates, budget or Budget(), **{"lean": True} | keys)
    found = explore.explore(model, memory=4 * GIB)
    assert (found.broken, found.tally.ended) == (0, "complete"), found.tally
    assert found.tally.left_out == 0 or not model.lean
    return found


@pytest.mark.parametrize("rule", ["feasible", "strict"])
@pytest.mark.parametrize("graph", SMALL, ids=graphs.cables)
@pytest.mark.parametrize("updates", ["periodic", "triggered"])
def test_up_to_three_cells(graph, rule, updates):
    # Under `strict` less can be forgotten: all at once would be tens of millions of states.
    is_large = rule == "strict" and updates == "triggered" and len(list(graph.links())) > 4
    fine(graph, rule, updates, Budget(faults=1) if is_large else None)


CABLES = [("feasible", n) for n in range(4, 11)] + [("strict", n) for n in range(4, 8)]


@pytest.mark.parametrize(("rule", "count"), CABLES)
def test_four_cells_with_a_failure_and_a_loss(rule, count):
    for graph in graphs.all_graphs(4):
        if len(list(graph.links())) == count:
            fine(graph, rule, "periodic", FAILURE_AND_LOSS)


@pytest.mark.parametrize("rule", ["feasible", "strict"])
@pytest.mark.parametrize(
    ("graph", "updates", "budget"),
    [
        ("pair", "periodic", None),
        ("pc-1 1-2", "triggered", None),
        ("triangle", "periodic", None),
        ("triangle", "triggered", Budget(2, 1, faults=1)),
    ],
)
def test_nothing_is_broken_where_nothing_is_left_out_either(graph, updates, budget, rule):
    fine(graphs.parse(graph), rule, updates, budget, lean=False)


@pytest.mark.parametrize("graph", ["line", "triangle"])
def test_three_cells_settle_from_every_state(graph):
    states = fine(graphs.parse(graph), "feasible", "periodic", Budget(faults=1), keep=True)
    found = fair.check(states)
    assert (found.ended, found.starts, found.left_out) == ("complete", found.of, 0)


def test_a_million_successors_a_second():
    best = max(explore.explore(SkinModel(graphs.parse("triangle"))).tally.per_s for _ in range(3))
    assert best > 1e6
