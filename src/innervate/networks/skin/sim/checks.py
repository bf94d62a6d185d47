"""What is asserted of a route while a skin runs; ranges are checked for any network of cables."""

from innervate.networks.skin.invariants import is_worse
from innervate.networks.skin.protocol.constants import NONE, RULE_FEASIBLE
from innervate.networks.skin.sim.observer import BROKEN_FEASIBLE, next_hop


def check_route(world, cell):
    """After a change of route: fd strictly worse than the parent's [skin 6.2]."""
    run = world.run[0]
    if world.params[0].rule != RULE_FEASIBLE or run.broken != 0:
        return
    hop = next_hop(world, cell)
    if hop != NONE and hop < run.cells and not is_worse(world.cells[cell], world.cells[hop]):
        run.broken = BROKEN_FEASIBLE
        run.broken_node = cell
        run.broken_other = hop
