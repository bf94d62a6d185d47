"""Random integers for the slotted level: the same plain and compiled, and on any machine.

L'Ecuyer's combined generator (Efficient and portable combined random number generators, CACM 31,
1988): two multiplicative generators whose products fit 64 bits, period 2.3e18.
"""

from innervate.sim.tables import uniform

FIRST = 2147483563
SECOND = 2147483399
RANGE = FIRST - 1
UNIT = 1 << 30  # probabilities are whole numbers of 1 / UNIT
MEAN_MAX = 1 << 42
COARSE = 1 << 11


def generator(seed, name):
    """State of a generator for the stream `name`: two words, both >= 1."""
    return uniform(seed, f"slotted/{name}", 2, UNIT) + 1


def step(state):
    """The next integer, 0 <= result < RANGE."""
    state[0] = state[0] * 40014 % FIRST
    state[1] = state[1] * 40692 % SECOND
    return (state[0] - state[1]) % RANGE


def draw(state, n):
    """A uniform integer 0 <= result < n, for 1 <= n <= UNIT."""
    return step(state) * n // RANGE


def shuffle(state, items, count):
    """Put the first `count` items into a random order, all orders alike."""
    for i in range(count - 1, 0, -1):
        j = draw(state, i + 1)
        kept = items[i]
        items[i] = items[j]
        items[j] = kept


def exponential(state, mean):
    """An exponential interval in whole ticks, by comparisons alone (von Neumann 1951).

    For 1 <= mean <= MEAN_MAX ticks, in steps of about a millionth of the mean.
    """
    whole = 0
    while True:
        first = step(state)
        last = first
        falling = 1
        while True:
            following = step(state)
            if following >= last:
                break
            last = following
            falling += 1
        if falling % 2 == 1:
            return mean * whole + mean * (first // COARSE) // (RANGE // COARSE)
        whole += 1


def choose(state, table):
    """Index drawn with the cumulative probabilities of `table`, in 1 / UNIT."""
    at = draw(state, UNIT)
    k = 0
    while k < len(table) - 1 and at >= table[k]:
        k += 1
    return k
