"""Random choices from a generator that fits a small integer: multiply-with-carry below 2^30.

A state object that draws has the fields rng, choice and asked. The explorer and replays set
`choice` to the value the next draw shall return; `asked` tells them out of how many.
"""

FACTOR = 32730
LOW15 = 32767
FIXED_POINT = FACTOR * 32768 - 1
GENERATE = -1


def seeded(seed):
    """A usable generator state from any integer >= 0: never 0 and never the fixed point.

    States near each other draw alike at first: drivers must mix what they pass (a hash of root
    seed, purpose and node), never count nodes or seeds from 0.
    """
    x = seed % FIXED_POINT
    if x == 0:
        x = 1
    return x


def step(x):
    """The generator's next state from x, 1 .. 2^30 - 1: a lag-1 multiply with carry."""
    return FACTOR * (x & LOW15) + (x >> 15)


def draw(state, n):
    """A uniform integer 0 <= result < n, for 1 <= n < 2^30."""
    if state.choice != GENERATE:
        state.asked = n
        result = state.choice
        if result >= n:
            result = n - 1
        return result
    x = step(state.rng)
    if n <= LOW15:
        state.rng = x
        return ((x & LOW15) * n) >> 15
    high = x & LOW15
    x = step(x)
    state.rng = x
    return ((high << 15) | (x & LOW15)) % n
