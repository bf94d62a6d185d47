from types import SimpleNamespace

import numpy as np
import pytest

from innervate.networks.skin.analysis.load import balance_factor, interface_of, port_loads
from innervate.sim.cables.world import ALIVE, DEAD
from innervate.topology import from_patches

W, E, UP, DOWN, NONE = 0, 1, 2, 3, -1


def result_of(graph, parents, down=(), off=()):
    epoch = np.zeros(len(graph.peer), np.int32)
    epoch[list(down)] = 1
    cells = [SimpleNamespace(parent=port) for port in parents]
    alive = [DEAD if cell in off else ALIVE for cell in range(graph.cells + 1)]
    world = SimpleNamespace(cells=cells, epoch=epoch, alive=alive)
    return SimpleNamespace(plan=SimpleNamespace(graph=graph), world=world)


@pytest.fixture
def grid():
    """0 1 2 over 3 4 5; pc.0 on 0's W, pc.1 on 5's E."""
    graph = from_patches([(3, 2, "Z")])
    graph.add_interface(0, "W")
    graph.add_interface(5, "E")
    return graph


def test_hand_graph(grid):
    result = result_of(grid, [W, W, DOWN, UP, E, E])
    assert interface_of(result).tolist() == [0, 0, 1, 0, 1, 1]
    assert port_loads(result) == [3, 3]
    assert balance_factor(port_loads(result)) == 1.0


def test_all_through_one_port(grid):
    result = result_of(grid, [W, W, W, W, W, W], down=[grid.peer[-1], len(grid.peer) - 1])
    assert interface_of(result).tolist() == [0, 0, 0, -1, -1, -1]
    assert port_loads(result) == [3, 0]
    assert balance_factor([3, 0]) == 0.5


def test_rings_and_cut_cables_lead_nowhere(grid):
    ring = result_of(grid, [E, DOWN, W, UP, W, UP])
    assert interface_of(ring).tolist() == [-1] * 6
    cut = result_of(grid, [W, W, W, UP, W, E], down=[4 * 1 + W, 4 * 0 + E])
    assert interface_of(cut).tolist() == [0, -1, -1, 0, 0, 1]


def test_long_chain():
    cells = 1000
    graph = from_patches([(cells, 1, "Z")])
    graph.add_interface(0, "W")
    assert port_loads(result_of(graph, [W] * cells)) == [cells]


def test_who_has_not_started_or_is_dead_has_no_route_whatever_its_record_says(grid):
    assert port_loads(result_of(grid, [0] * 6, off=range(6))) == [0, 0]
    assert interface_of(result_of(grid, [W] * 6, off=[1])).tolist() == [0, -1, -1, -1, -1, -1]


def test_nobody_has_a_route(grid):
    result = result_of(grid, [NONE] * 6)
    assert port_loads(result) == [0, 0]
    assert balance_factor([0, 0]) is None


@pytest.mark.parametrize(
    ("loads", "factor"), [([5, 5, 5], 1.0), ([4, 0, 0], 1 / 3), ([3, 1], 0.8), ([68, 68, 69], None)]
)
def test_balance_factor(loads, factor):
    if factor is None:
        factor = sum(loads) ** 2 / (3 * sum(n * n for n in loads))
        assert factor > 0.999
    assert balance_factor(loads) == pytest.approx(factor)


def test_counts_every_cell_once(go):
    result = go("setup-3", seconds=0.5)
    assert sum(port_loads(result)) == 35
