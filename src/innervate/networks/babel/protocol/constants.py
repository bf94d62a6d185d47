"""Names and numbers that all parts of Babel share."""

PORTS = 4
NONE = -1
INFINITY = 65535
HELLO = 1
UPDATE = 2
ROUTE_REQUEST = 3
SEQNO_REQUEST = 4
DATA = 5
IHU = 6
ACK_REQUEST = 7
ACK = 8
TICK = 0  # our Hellos
LOOK = 1  # something may have expired
SOON = 2  # a triggered update
TENTH_MS = 100
SAID_MAX = 65535 * TENTH_MS  # us: most until the next update that a frame can say
WANTED_MAX = 16_000_000  # us: most between two requests
HOPS_MAX = 64
TRIES = 3
REPORT_ROUTE = 1  # a port of the route selected from now on, b its neighbour; -1 none
REPORT_DROP = 2  # data without a route, or that went too far
REPORT_LINK = 3  # a port, b 1 up, 0 down
