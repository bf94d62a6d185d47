"""The tables of a radio run (see tables.py)."""

from innervate.trace.tables import Column, Table, reports

_STATION = Column("station", "Int16", "station", "who", "node")

PACKETS = Table(
    "packets",
    "a station took a packet for delivered",
    (
        _STATION,
        Column("handle", "Int32", "number", "which of its packets, modulo 2^16"),
        Column("offered_us", "Int64", "us", "when it was offered", "offered"),
        Column("ended_us", "Int64", "us", "end of the frame that carried it", "end"),
        Column("known_us", "Int64", "us", "when its sender took it for delivered", "time"),
        Column("slots", "Int16", "slots", "its length"),
        Column("tries", "Int32", "frames", "how often it was sent"),
        Column("receivers", "Int16", "stations", "how many received it; 0 = lost silently"),
        Column("listeners", "Int16", "stations", "how many were switched on within reach"),
    ),
    rows="packets",
)
SENT = Table(
    "transmissions",
    "a station sent something",
    (
        Column("start_us", "Int64", "us", "first moment on the air", "time"),
        Column("end_us", "Int64", "us", "last moment on the air", "end"),
        _STATION,
        Column("kind", "Int8", "type", "1 CR-R or pulse, 2 data, 3 open, 4 report"),
        Column("slots", "Int16", "slots", "its length"),
        Column("position", "Int16", "position", "practical mode: its sender's place", "pos"),
        Column("next", "Int16", "position", "practical mode: whose turn follows"),
        Column("handle", "Int32", "number", "first packet in it"),
        Column("packets", "Int8", "packets", "how many are in it", "count"),
    ),
    rows="sent",
)
REPORTS = reports(_STATION)
TABLES = (PACKETS, SENT, REPORTS)
