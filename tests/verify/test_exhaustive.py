"""The sizes that the documentation says are explored completely; `make full`."""

import pytest

from innervate.verify import explore, fair, graphs
from innervate.verify.skin_system import Budget, SkinModel

GIB = 1 << 30
FAILURE_AND_LOSS = Budget(loss=1, cut=1, heal=0, false=0, restart=0, faults=2)
COMPLETE = "pc-1 pc-2 pc-3 1-2 1-3 2-3"
SMALL = [graph for cells in (1, 2, 3) for graph in graphs.all_graphs(cells)]

pytestmark = pytest.mark.slow


def fine(model, memory=4 * GIB):
    tally_of = explore.explore(model, memory=memory)
    assert (tally_of.broken, tally_of.tally.ended) == (0, "complete"), tally_of.tally
    return tally_of


@pytest.mark.parametrize("rule", ["feasible", "strict"])
@pytest.mark.parametrize("graph", SMALL, ids=graphs.cables)
def test_up_to_three_cells_with_periodic_updates(graph, rule):
    # All at once would be some 10 million states in the complete graph.
    budget = Budget(faults=1) if graphs.cables(graph) == COMPLETE else Budget()
    fine(SkinModel(graph, rule, "periodic", budget))


@pytest.mark.parametrize("rule", ["feasible", "strict"])
@pytest.mark.parametrize("graph", [g for g in SMALL if g.cells < 3], ids=graphs.cables)
def test_up_to_two_cells_with_triggered_updates(graph, rule):
    fine(SkinModel(graph, rule, "triggered"))


@pytest.mark.parametrize("budget", [Budget(2, 1, faults=1), Budget(1, 2, faults=1)])
def test_triangle_with_triggered_updates(budget):
    fine(SkinModel(graphs.parse("triangle"), "feasible", "triggered", budget))


@pytest.mark.parametrize("graph", ["line", "star"])
def test_three_cells_with_triggered_updates_and_one_fault(graph):
    fine(SkinModel(graphs.parse(graph), "feasible", "triggered", Budget(faults=1)))


@pytest.mark.parametrize("rule", ["feasible", "strict"])
def test_four_cells_with_a_failure_and_a_loss(rule):
    for graph in graphs.all_graphs(4):
        if len(list(graph.links())) <= 6:
            fine(SkinModel(graph, rule, "periodic", FAILURE_AND_LOSS))


def test_triangle_settles_from_every_state():
    model = SkinModel(graphs.parse("triangle"), budget=Budget(faults=1), keep=True)
    found = fair.check(fine(model))
    assert (found.ended, found.starts, found.left_out) == ("complete", found.of, 0)


def test_a_million_successors_a_second():
    best = max(explore.explore(SkinModel(graphs.parse("triangle"))).tally.per_s for _ in range(3))
    assert best > 1e6
