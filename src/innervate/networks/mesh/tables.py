"""The tables of a mesh run (see tables.py)."""

from innervate.trace.tables import TIME, Column, Table, reports

_NODE = Column("node", "Int16", "node", "who")
_FLAGS = Column("flags", "Int16", "flags", "of its header: 2 end to end, 4 flood, 128 retry, ...")
_KIND = Column("kind", "Int8", "type", "8 data, 10 alarm; the others: protocol/constants.py")
_ORIGIN = Column("origin", "Int16", "node", "who made it")
_SEQ = Column("seq", "Int32", "number", "of its origin")

MESSAGES = Table("messages", "a message was offered to a node", (
    Column("offered_us", "Int64", "us", "when it was handed down"),
    _NODE,
    Column("dest", "Int16", "node", "recipient; 255 all, 254 the monitor"),
    Column("flow", "Int16", "flow", "which flow of the scenario"),
    Column("seq", "Int32", "number", "of its packet; null = none was made"),
    Column("delivered_us", "Int64", "us", "first delivery to its recipient; null = never"),
    Column("hops", "Int16", "hops", "transmissions on its way; null = not delivered"),
    Column("state", "Int8", "state",
           "0 delivered, 1 in flight at the end, 2 lost, 3 refused, 4 sender switched off"),
))  # fmt: skip
CROSSINGS = Table("crossings", "a robot left the fence", (
    Column("robot", "Int16", "node", "who"),
    Column("crossed_us", "Int64", "us", "when it truly did"),
    Column("back_us", "Int64", "us", "when it came back; the run's end if it did not"),
    Column("raised_us", "Int64", "us", "when the alarm was raised; null = nobody noticed"),
    Column("raised_by", "Int16", "node", "by the robot or by a witness of its beacon"),
    Column("accepted_us", "Int64", "us", "when the monitor had it; null = never"),
    Column("flooded", "Boolean", "", "the copy that came first was flooded, not routed"),
    Column("hops", "Int16", "hops", "transmissions on its way"),
    Column("warned_us", "Int64", "us", "when the monitor was told it was about to cross"),
    Column("overrun_m", "Float64", "m",
           "greatest distance outside until the monitor knew, else until it was back"),
), topic="/alarms")  # fmt: skip
DELIVERIES = Table("deliveries", "a node gave something to its user", (
    TIME, _NODE, _KIND, _FLAGS, _ORIGIN, _SEQ,
    Column("hops", "Int16", "hops", "transmissions on its way", "path_len"),
    Column("looped", "Boolean", "", "a node was twice on its way"),
), rows="delivered")  # fmt: skip
SENT = Table("transmissions", "a node sent something", (
    Column("start_us", "Int64", "us", "first moment on the air", "time"),
    Column("end_us", "Int64", "us", "last moment on the air", "end"),
    _NODE, _KIND, _FLAGS,
    Column("link_dst", "Int16", "node", "for whom; 255 all"),
    _ORIGIN,
    Column("dest", "Int16", "node", "at last for whom"),
    _SEQ,
    Column("path_len", "Int8", "nodes", "that had transmitted it, this one included"),
    Column("bytes", "Int16", "bytes", "without those of the PHY"),
    Column("receivers", "Int16", "nodes", "how many received it, others than meant too"),
), rows="sent")  # fmt: skip
ROUNDS = Table("rounds", "a gateway knew the links after a discovery round", (
    TIME, _NODE,
    Column("round", "Int32", "round", "which"),
    Column("links", "Int32", "links", "that it knows"),
    Column("good", "Int32", "links", "that are good in both directions at the start"),
    Column("both", "Int32", "links", "that it knows and that are good"),
), rows="rounds")  # fmt: skip
REPORTS = reports(_NODE)
TABLES = (MESSAGES, CROSSINGS, DELIVERIES, SENT, ROUNDS, REPORTS)
