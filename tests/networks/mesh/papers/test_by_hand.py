"""What figures of the mesh count, of nodes and runs that are written here."""

from types import SimpleNamespace as Of

import pytest

from innervate.networks.mesh.papers import uplinks
from innervate.networks.mesh.protocol.neighbours import FREE, UNHEARD


def node(depth, first, *heard):
    """A node and whom it heard: (who, depth, RSSI)."""
    near, depths, loud = ([one[i] for one in heard] for i in range(3))
    return Of(depth=depth, parent=first, neighbour=near, round_depth=depths, round_rssi=loud)


GATEWAY = node(0, FREE)


def counted(*nodes, good=()):
    plan = Of(nodes=1 + len(nodes), good=good, params={"min_rssi": -90})
    run = Of(plan=plan, world=Of(nodes=[GATEWAY, *nodes]))
    return uplinks.measure(Of(run=lambda seed: run), 1)


@pytest.mark.parametrize(("heard", "best"), [
    ([(5, 1, -80), (6, 0, -85)], 6), ([(5, 0, -80), (6, 0, -79)], 6),  # nearest, loudest
    ([(5, 0, -91), (6, 1, -90)], 6), ([(5, 0, -91)], 5),  # faint ones if there is no other
    ([(5, 0, -80), (6, 0, -80)], 5), ([(5, 2, -50), (6, 1, -89)], 6),  # not as far as itself
    ([(FREE, 0, -50), (6, 1, -89)], 6), ([(5, UNHEARD, -50), (6, 1, -89)], 6),
    ([(5, 2, -50)], None), ([], None),
])  # fmt: skip
def test_the_best_of_those_nearer_to_the_gateway(heard, best):
    nodes = [node(2, 9, *heard)]
    assert uplinks._best([GATEWAY, *nodes], 1, -90) == best
    assert uplinks._best([GATEWAY, node(UNHEARD, 9, *heard)], 1, -90) is None


def test_whom_a_node_heard_first_is_counted_against_the_best():
    both, other, neither, deaf = (
        node(1, 0, (0, 0, -60)), node(2, 1, (1, 1, -80), (5, 1, -70)), node(2, 1, (1, 1, -80)),
        node(UNHEARD, FREE),
    )  # fmt: skip
    assert counted(both, other, neither, deaf, good=[(0, 1), (2, 5), (4, 0)]) == {
        "nodes": 3, "other": 1, "first": 1, "best": 2,
    }  # fmt: skip
    assert counted(both, other, neither, good=[(1, 2)])["first"] == 1
    assert counted(both, other, neither, good=[(2, 1), (3, 1)])["first"] == 2
