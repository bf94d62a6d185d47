"""Words of `world.counters` that a skin has besides those of its cables (see `cables/wires.py`)."""

from innervate.sim.cables.wires import OTHER_BLOCK, OWN, OWN_TOO

COMMAND_BLOCK = OTHER_BLOCK

# Samples that cells gave up.
NO_ROUTE = OWN
LOOPED = OWN + 1
EARLY = OWN + 4  # of NO_ROUTE: by cells that have not had a route yet, as far as is watched

# Commands: dropped because they were here before, given up after too many hops, given to the PC;
# who got them: see orders.py.
AGAIN = OWN + 2
TOO_FAR = OWN + 3
GIVEN = OWN + 5
ADDRESSED = OWN_TOO
REACHED = OWN_TOO + 1
REPEATED = OWN_TOO + 2
STRAY = OWN_TOO + 3
MISSED = OWN_TOO + 4
