"""Numbers that the files of RPL share; sizes as in protocol.fields."""

NODES = 254
NEIGHBOURS = 24
QUEUE = 6  # packets
BODY = 8  # numbers of a message, 16 bytes
TARGETS = 4  # of a DAO in storing mode
NEAR = 4  # hops of a short source route, without the first
ROUTE = 16  # of a long one
NONE = -1
NOBODY = 255

INFINITE = 65535  # INFINITE_RANK [RFC 6550, 17]
# Where sequence counters begin: who restarts is taken for newer than who has gone round [7.2].
INITIAL = 240
WINDOW = 16  # SEQUENCE_WINDOW
ETX_ONE = 128  # an ETX of 1 [RFC 6719, 3.5]
ETX_MOST = 4096

# Kinds of frame.
DIO = 1
DIS = 2
DAO = 3  # storing mode: to a parent
ACK = 4  # of a hop
DATA = 5  # without a source route, and with a short or a long one: so many more
DAO_ACK = 8  # likewise
DAO_UP = 11  # non-storing mode: to the root
ROUTE_ERROR = 12  # non-storing mode: a source route is broken, to the root

# Timers.
TRICKLE = 0
ACK_WAIT = 1
DAO_DELAY = 2
TICK = 3

# What is under way.
IDLE = 0
A_DIO = 1
A_DIS = 2
A_DAO = 3
A_PACKET = 4

# Reports.
REPORT_NO_ROUTE = 1  # a packet for a was dropped: no way, after b other ones
REPORT_FULL = 2  # a packet for a found no place
REPORT_LOOP = 3  # a packet for a was dropped: the second inconsistency of ranks
REPORT_DETACHED = 4  # no parent any more; the rank was a
REPORT_PARENT = 5  # a is the preferred parent now; the rank is b
REPORT_VERSION = 6  # a member of DODAG version a
REPORT_HOPS = 7  # a packet for a was dropped: its hop limit
