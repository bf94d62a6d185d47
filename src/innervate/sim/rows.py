"""Rows that every kind of run keeps in its loop's tables."""


def record_row(world, time, node, code, a, b):
    """A row of what nodes report."""
    run = world.run[0]
    if run.row_limit > 0:
        row = world.rows[run.rows]
        run.rows += 1
        row.time, row.node, row.code, row.a, row.b = time, node, code, a, b


def record_step(world, node, time, handler, port):
    """A row of the trail of all handler calls."""
    run = world.run[0]
    if run.trail_limit > 0:
        row = world.trail[run.trail]
        run.trail += 1
        row.time, row.node, row.handler = time, node, handler
        row.port, row.fingerprint = port, run.fingerprint


def record_delivery(world, time, node, port, kind, latency):
    """A row of what a node's user got; how long it took, us, -1 = nobody knows."""
    run = world.run[0]
    if run.delivery_limit > 0:
        row = world.deliveries[run.deliveries]
        run.deliveries += 1
        row.time, row.node, row.port, row.kind, row.latency = time, node, port, kind, latency
