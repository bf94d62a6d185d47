"""How much a node of managed flooding keeps."""

SEEN = 64  # packets that a node remembers
PLACES = 8  # packets that wait to be passed on
OWN = 4  # own packets that wait for an acknowledgement
BODY = 8  # numbers that a user says: 16 bytes
