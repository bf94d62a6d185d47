"""Any order of a cell's ports comes of those that are proved to change nothing."""

from itertools import permutations

from innervate.networks.skin.protocol.constants import PORTS
from innervate.networks.skin.prove.mirror import ORDERS


def test_all_orders_of_four_ports_come_of_the_two():
    found = edge = {tuple(range(PORTS))}
    while edge:
        edge = {tuple(order[p] for p in one) for one in edge for order in ORDERS.values()} - found
        found = found | edge
    assert found == set(permutations(range(PORTS)))
