"""Invariants asserted while a skin runs: ranges and fd; loops are the observer's."""

from innervate.networks.skin.invariants import is_worse
from innervate.networks.skin.protocol.constants import NONE, RULE_FEASIBLE
from innervate.networks.skin.sim.observer import BROKEN_FEASIBLE, BROKEN_RANGE, next_hop


def check_cell(world, cell):
    """After a handler of `cell`: every word in its declared range [skin 6]."""
    watch = world.watch
    words = watch.words[cell]
    wrong = 0
    for i in range(len(watch.low)):
        value = words[i]
        wrong |= (value < watch.low[i]) | (value > watch.high[i])
    if wrong and world.run[0].broken == 0:
        world.run[0].broken = BROKEN_RANGE
        world.run[0].broken_node = cell


def check_route(world, cell):
    """After a change of route: fd strictly worse than the parent's [skin 6.2]."""
    run = world.run[0]
    if run.rule != RULE_FEASIBLE or run.broken != 0:
        return
    hop = next_hop(world, cell)
    if hop != NONE and hop < run.cells and not is_worse(world.cells[cell], world.cells[hop]):
        run.broken = BROKEN_FEASIBLE
        run.broken_node = cell
        run.broken_other = hop
