"""SimPy's bare rate: processes that do nothing but wait for their next timeout."""

from math import log
from time import perf_counter

MEAN = 4000.0
STEPS = 4096
# Exponential waits, drawn before the clock runs, as in heap_loop.c.
WAITS = [-MEAN * log((i + 0.5) / STEPS) for i in range(STEPS)]
STRIDE = 1597  # odd: visits all of WAITS
CHUNK_EVENTS = 20_000


def measure(processes=204, seconds=1.0):
    """Timeouts per second with this many processes; None without SimPy."""
    try:
        import simpy
    except ImportError:
        return None
    env = simpy.Environment()
    events = 0

    def wait(at):
        nonlocal events
        while True:
            yield env.timeout(WAITS[at])
            events += 1
            at = (at + STRIDE) & (STEPS - 1)

    for i in range(processes):
        env.process(wait(i & (STEPS - 1)))
    env.run(until=MEAN)  # started, and past many a first wait
    chunk = MEAN * CHUNK_EVENTS / processes
    events, start, end = 0, perf_counter(), 0.0
    while end - start < seconds:
        env.run(until=env.now + chunk)
        end = perf_counter()
    return {
        "processes": processes,
        "events_per_s": events / (end - start),
        "version": simpy.__version__,
    }


if __name__ == "__main__":
    for processes in (204, 10_000):
        print(measure(processes))
