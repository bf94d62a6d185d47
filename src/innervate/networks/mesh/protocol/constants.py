"""Words of the mesh: packets, flags, inputs, timers, reports [mesh 2]."""

# Types of packets.
REQUEST = 1  # discovery request, broadcast
RESPONSE = 2  # discovery response, climbs the parents to the gateway
TABLE = 3  # part of a routing table, source-routed
TABLE_ACK = 4  # ROUTE_ACK: climbs the parents
ACTIVATE = 5  # ROUTE_ACTIVATE, flooded (two-phase activation only)
DATA = 8
E2E_ACK = 9
ALARM = 10  # FENCE_ALARM
POSITION = 11  # POS_BEACON: one hop, or routed to the monitor
GRAPH = 12  # part of the graph, flooded
AGAIN = 13  # in DELIVER alone: an ORDERED message that came before, and is not acknowledged
ACK = 16  # of a hop: a frame without the common header

# Flags.
ACK_WANTED = 1
END_TO_END = 2
FLOOD = 4
ORDERED = 4  # of a message to one recipient: its payload begins with the seq of the one before it
SOURCE_ROUTE = 8  # the payload begins with the rest of the route: its length, then its nodes
DETOURED = 16  # graph forwarding: the payload ends with the failed nodes, then their number
PRIORITY = 32
FIRST = 64  # first packet since its origin switched on
WEAK = 64  # of a RESPONSE: it came over a link that is too faint to rely on
PARITY = 128  # turns over with every end-to-end retry

# Addresses.
ALL = 0xFF
MONITOR = 0xFE  # the monitor; where none is configured, the gateway
NOBODY = 255
IDS = 254

TTL = 48  # a search goes back over what it has gone; else the path bounds it
PATH_MAX = 24
HEADER_BYTES = 11
CRC_BYTES = 2
ACK_BYTES = 9
ACK_MORE_BYTES = 3  # for every packet after the first: whose, and its number
MTU = 127  # bytes of a frame, where a node is not told of more ...
MTU_MAX = 1200  # ... as one on IP links may be
DATA_MAX = 90  # most payload of a message at MTU 127; 27 at 64, 1163 at 1200
BODY = 114  # room for a payload in a record at MTU 127: without header and CRC

# Inputs; item.kind is not looked at.
MESSAGE = 1  # item: send_message (see mesh_fields.ITEM)
SENT = 2  # the layer below: the frame with item.handle has left; item.ok 0 = it could not
SAMPLE = 3  # robots: position and speed, item.x .. item.vy
HANDED_UP = 4  # the user has ORDERED message item.handle of item.dest: its origin may know

# Timers.
TX = 0  # a queued frame is due
ACK_WAIT = 1  # a hop did not acknowledge
ROUND = 2  # the next step of a discovery round
TICK = 3  # every tick_us: sweeps, beacons, watches
RETRY = 4  # an end-to-end timeout
JOBS = 5  # gateway: a table was not acknowledged
TIMERS = 6

# Flags of SEND that the mesh sets (see outbox.py): URGENT = without carrier sense, at once.

# What forwarding relies on (params.mode).
TABLES = 0
WHOLE_GRAPH = 1
TABLE_FREE = 2

# params.failover, where mode is TABLES.
RANDOM = 0
LOUDEST = 1
ALTERNATE = 2
SEARCH = 3

# params.discovery.
TREE = 1
EACH = 2
LIST = 3

# What a gateway knows of a node's table.
CURRENT = 0
TO_SEND = 1
UNDER_WAY = 2
GIVEN_UP = 3
PARTS_MAX = 15  # of a table, or of the graph

# Kinds of alarms.
PREDICT = 0
CROSS = 1
LOST = 2
CLEAR = 3

# Reports: (code, a, b).
REPORT_ACCEPTED = 1  # message handle a goes out as packet seq b
REPORT_HOP = 2  # message handle a was acknowledged by its first hop
REPORT_ARRIVED = 3  # message handle a was acknowledged end to end
REPORT_EXPIRED = 4  # message handle a: given up for reason b
REPORT_FULL = 5  # message handle a was refused for reason b: NO_ROUTE or NO_ROOM
REPORT_DROPPED = 6  # packet (origin a, seq b) is given up here
REPORT_SUSPECT = 7  # neighbour a does not answer; 1 = it was next in the table
REPORT_ROUND = 8  # gateway: round a of epoch b begins
REPORT_GRAPH = 9  # gateway: a links known after the round; b = 1: other links than before
REPORT_TABLE = 10  # our table (or graph) is whole: version a, epoch b
REPORT_TABLES = 11  # gateway: all tables of version a are acknowledged; b = nodes without
REPORT_GATEWAY = 12  # we follow gateway a of epoch b from now on
REPORT_ALARM = 13  # alarm raised: kind a, for robot b
REPORT_MARGIN = 14  # alarm raised: margin a cm
REPORT_UNKEYED = 15  # a message of unknown type a was dropped
REPORT_SILENCED = 16  # a flood instance b of alarm seq a goes out

# Reasons of REPORT_EXPIRED and REPORT_FULL.
NO_ROUTE = 1  # nobody to send it to, or too long
NO_ACK = 2
PUT_OUT = 3  # an alarm needed its place
NO_ROOM = 4  # too many wait already

# Ranks in the queue.
ALARMS = 0
CONTROL = 1
MESSAGES = 2
OWN = 3  # messages begun here: what others began has been on its way for longer
