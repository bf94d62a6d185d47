"""What must hold of a skin's state: no closed ring, feasible distances in order.

A state is the row of bytes `world.work` (see world.py).
"""

from innervate.networks.skin.invariants import is_worse
from innervate.networks.skin.protocol.constants import INFINITY, NONE, PORTS
from innervate.networks.skin.verify import row as rows
from innervate.networks.skin.verify import world as w


def parent_port(world, c):
    """A cell's parent port, or NONE."""
    for p in range(PORTS):
        slot = world.port_at[PORTS * c + p]
        if slot >= 0 and world.work[slot + w.SAYS] & rows.IS_PARENT:
            return p
    return NONE


def next_hop(world, c):
    """The node a cell's data goes to over a live cable; the PC is node `cells`; NONE."""
    p = parent_port(world, c)
    if p == NONE:
        return NONE
    way = world.out_way[PORTS * c + p]
    if not rows.is_up(world, way // 2):
        return NONE
    return min(world.way_end[way] // PORTS, world.at[w.CELLS])


def check(world):
    """What is broken in the row, or FINE [skin 6]."""
    cells = world.at[w.CELLS]
    for c in range(cells):
        hop = next_hop(world, c)
        if hop == NONE or hop == cells:
            continue
        if world.at[w.FEASIBLE]:
            rows.load_cell(world, c, 0)
            rows.load_cell(world, hop, 1)
            if not is_worse(world.cells[0], world.cells[1]):
                return w.BROKEN_ORDER
        steps = 0
        while hop != NONE and hop != cells and steps < cells:
            hop = next_hop(world, hop)
            steps = steps + 1
        if steps == cells:
            return w.BROKEN_LOOP
    return w.FINE


def measure_depths(world):
    """Hops of every cell to the PC over live cables into world.depth; INFINITY without a way."""
    cells = world.at[w.CELLS]
    for c in range(cells):
        world.depth[c] = INFINITY
    world.depth[cells] = 0
    for _ in range(cells):
        for way in range(world.at[w.DIRECTIONS]):
            if rows.is_up(world, way // 2):
                here = min(world.way_end[way] // PORTS, cells)
                there = min(world.way_end[way ^ 1] // PORTS, cells)
                if world.depth[there] + 1 < world.depth[here]:
                    world.depth[here] = world.depth[there] + 1


def is_settled(world):
    """1 if every cell that cables connect to the PC has a shortest route, and knows how far all its
    neighbours are: without faults it stays so.
    """
    measure_depths(world)
    for c in range(world.at[w.CELLS]):
        if world.depth[c] < INFINITY and not is_cell_settled(world, c):
            return False
    return True


def is_cell_settled(world, c):
    """1 if a cell has a shortest route and knows how far its neighbours are."""
    p = parent_port(world, c)
    if p == NONE or next_hop(world, c) == NONE:
        return False
    if world.work[world.port_at[PORTS * c + p] + w.DIST] + 1 != world.depth[c]:
        return False
    for q in range(PORTS):
        way = world.in_way[PORTS * c + q]
        if way != NONE and rows.is_up(world, way // 2):
            there = min(world.way_end[way ^ 1] // PORTS, world.at[w.CELLS])
            if world.work[world.port_at[PORTS * c + q] + w.DIST] != world.depth[there]:
                return False
    return True
