"""Why a loop stopped, and which of a protocol's five functions was called."""

# Why the loop stopped.
DONE = 0
POOL_FULL = 1
ROWS_FULL = 2
BROKEN = 3
BUDGET = 4
ON_START = 0
ON_FRAME = 1
ON_TIMER = 2
ON_INPUT = 3
COLD = 0
MEMORY_LOST = 1
