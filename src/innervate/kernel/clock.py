"""The wall clock, for how long a run took; simulated time never comes from it."""

import time


def wall_s() -> float:
    """Seconds of a clock that only moves forward."""
    return time.perf_counter()
