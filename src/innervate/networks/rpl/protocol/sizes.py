"""How much a node of RPL keeps, and how much a frame has room for."""

NODES = 254
NEIGHBOURS = 24
QUEUE = 6  # packets
BODY = 8  # numbers of a message, 16 bytes
TARGETS = 4  # of a DAO in storing mode
NEAR = 4  # hops of a short source route, without the first
ROUTE = 16  # of a long one
