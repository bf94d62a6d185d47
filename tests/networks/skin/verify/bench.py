"""What tests of the explorer share."""

from innervate.networks.skin.verify import check as skin_check


def parents_of(model, rows):
    """The set of (parent port or -1 of every cell) over all states of a search."""
    lay = model.layout()
    world = model.world(plain=True)
    data = bytes(memoryview(rows).cast("B"))
    found = set()
    nodes = model.graph.node_of
    for start in range(0, len(data), lay.width):
        world.work[:] = data[start : start + lay.width]
        ports = [skin_check.parent_port(world, c) for c in range(model.graph.cells)]
        found.add(
            tuple(
                -1 if port < 0 else nodes(model.graph.peer[4 * c + port])
                for c, port in enumerate(ports)
            )
        )
    return found
