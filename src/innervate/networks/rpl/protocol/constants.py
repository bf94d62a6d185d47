"""Numbers that the files of RPL share."""

NONE = -1
NOBODY = 255

INFINITE = 65535  # INFINITE_RANK [RFC 6550, 17]
# Where sequence counters begin: who restarts is taken for newer than who has gone round [7.2].
INITIAL = 240
WINDOW = 16  # SEQUENCE_WINDOW
ETX_ONE = 128  # an ETX of 1 [RFC 6719, 3.5]
ETX_MOST = 4096

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
