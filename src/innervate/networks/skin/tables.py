"""The tables of a skin's run (see trace/tables.py)."""

from innervate.trace.tables import TIME, Column, Table

_CELL = Column("cell", "Int32", "cell", "who")

ROUTES = Table("routes", "a cell changed its parent port (a restart forgets it without a row)", (
    TIME, _CELL,
    Column("old", "Int8", "port", "parent port before; -1 none"),
    Column("new", "Int8", "port", "parent port after; -1 none"),
    Column("balancing", "Boolean", "", "only to balance the load"),
))  # fmt: skip
LINKS = Table("links", "a cell found a port broken, or working again", (
    TIME, _CELL,
    Column("port", "Int8", "port", "which of its ports"),
    Column("to", "Int32", "cell", "the cell on the other side; the number of cells = the PC"),
    Column("broken", "Boolean", "", "true broken, false works again"),
))  # fmt: skip
OUTAGES = Table("outages", "the number of cells without a route, or of cells cut off, changed", (
    TIME,
    Column("unrouted", "Int32", "cells", "cells connected to the PC without a route, from now on"),
    Column("cut_off", "Int32", "cells", "cells on that no cable joins with the PC, from now on"),
))  # fmt: skip
LOOPS = Table("loops", "a forwarding loop stood", (
    Column("opened_us", "Int64", "us", "when it closed into a ring"),
    Column("closed_us", "Int64", "us", "when it fell apart; null = stood at the end"),
    Column("cell", "Int32", "cell", "one of its cells"),
    Column("length", "Int32", "cells", "cells in it"),
))  # fmt: skip
RECEIVED = Table("received", "the PC received a tactile sample", (
    TIME,
    Column("interface", "Int16", "port", "interface port it came in on", "port"),
    Column("cell", "Int32", "cell", "who measured it"),
    Column("seq", "Int16", "number", "counts the cell's samples, 0..255"),
    Column("hops", "Int16", "hops", "cells that forwarded it"),
    Column("latency_us", "Int64", "us", "since it was measured", "latency"),
    Column("proximity", "Int32", "raw", "nearness of an object, 0 far"),
    Column("force_0", "Int32", "mN", "first force sensor"),
    Column("force_1", "Int32", "mN", "second force sensor"),
    Column("force_2", "Int32", "mN", "third force sensor"),
    Column("temperature", "Int16", "0.5 degC", "from 20 degC"),
    Column("accel_x", "Int16", "raw", "acceleration along x"),
    Column("accel_y", "Int16", "raw", "acceleration along y"),
    Column("accel_z", "Int16", "raw", "acceleration along z"),
), topic="/samples")  # fmt: skip
TABLES = (ROUTES, LINKS, OUTAGES, LOOPS, RECEIVED)
