"""Rows that every kind of run keeps in its loop's tables."""


def record_row(world, time, node, code, a, b):
    """A row of what nodes report."""
    run = world.run[0]
    if run.row_limit > 0:
        row = world.rows[run.rows]
        run.rows += 1
        row.time = time
        row.node = node
        row.code = code
        row.a = a
        row.b = b


def record_step(world, node, time, handler, port):
    """A row of the trail of all handler calls."""
    run = world.run[0]
    if run.trail_limit > 0:
        row = world.trail[run.trail]
        run.trail += 1
        row.time = time
        row.node = node
        row.handler = handler
        row.port = port
        row.fingerprint = run.fingerprint
