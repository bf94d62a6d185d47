"""States of a node in a field, and of a place for a frame under way."""

# States of a node.
OFF = 0
ALIVE = 1
DEAD = 2
# States of a place for a frame under way.
FREE = 0
HELD = 1  # waits for the channel
COMMITTED = 2  # the radio turns round
ON_AIR = 3
VOID = 4  # its sender died; free as soon as its event in the queue is due
