"""The sizes that the documentation says are explored completely; `make full`."""

import pytest

from innervate.networks.skin.verify import fair, graphs
from innervate.networks.skin.verify.system import ANY, Budget, SkinModel
from innervate.verify import explore

GIB = 1 << 30
FAILURE_AND_LOSS = Budget(ticks=ANY, loss=1, cut=1, heal=0, false=0, restart=0, faults=2)
SMALL = [graph for cells in (1, 2, 3) for graph in graphs.all_graphs(cells)]
FOUR = list(graphs.all_graphs(4))
FEW = [graph for graph in FOUR if len(list(graph.links())) <= 7]
TICKS = pytest.mark.parametrize("ticks", [3, ANY], ids=["three ticks", "any ticks"])
BOTH = pytest.mark.parametrize("updates", ["periodic", "triggered"])

pytestmark = pytest.mark.slow


def fine(graph, rule, updates, budget=None, memory=4 * GIB, **keys):
    model = SkinModel(graph, rule, updates, budget or Budget(), **{"lean": True} | keys)
    found = explore.explore(model, memory=memory)
    assert (found.broken, found.tally.ended) == (0, "complete"), found.tally
    assert found.tally.left_out == 0 or not model.lean
    return found


def settles(found):
    calm = fair.check(found, memory=4 * GIB)
    assert (calm.ended, calm.starts, calm.left_out) == ("complete", calm.of, 0)


@pytest.mark.parametrize("rule", ["feasible", "strict"])
@BOTH
@pytest.mark.parametrize("graph", SMALL, ids=graphs.cables)
def test_up_to_three_cells(graph, updates, rule):
    # Under `strict` less can be forgotten: all at once would be tens of millions of states, and
    # where the three cells are a ring more than 12 GB with two beacons of the PC.
    is_large = rule == "strict" and updates == "triggered" and len(list(graph.links())) > 4
    is_ring = graphs.cables(graph).endswith("1-2 1-3 2-3")
    fewer = Budget(faults=1, counts=1 if is_ring else 2)
    fine(graph, rule, updates, fewer if is_large else None, memory=6 * GIB)


@BOTH
@TICKS
@pytest.mark.parametrize("graph", SMALL, ids=graphs.cables)
def test_up_to_three_cells_settle_from_every_state(graph, updates, ticks):
    settles(fine(graph, "feasible", updates, Budget(ticks=ticks), keep=True))


@BOTH
@pytest.mark.parametrize("graph", SMALL, ids=graphs.cables)
def test_up_to_three_cells_under_the_strict_rule_without_restarts(graph, updates):
    fine(graph, "strict", updates, Budget(ticks=ANY, restart=0))


@BOTH
@pytest.mark.parametrize("graph", FOUR, ids=graphs.cables)
def test_four_cells_with_a_failure_and_a_loss(graph, updates):
    settles(fine(graph, "feasible", updates, FAILURE_AND_LOSS, memory=9 * GIB, keep=True))


@BOTH
@pytest.mark.parametrize("graph", FEW, ids=graphs.cables)
def test_four_cells_under_the_strict_rule(graph, updates):
    fine(graph, "strict", updates, FAILURE_AND_LOSS)


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


def test_a_million_successors_a_second():
    best = max(explore.explore(SkinModel(graphs.parse("triangle"))).tally.per_s for _ in range(3))
    assert best > 1e6
