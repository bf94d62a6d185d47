"""Live nodes under simulated time: an hour of waiting takes as long as what is done in it."""

import asyncio
import selectors
from functools import wraps

from innervate.live.machine import Machine, on


class _Selector(selectors.DefaultSelector):
    """Looks for what is ready now; where nothing is, time moves on by what would be waited."""

    passed = 0.0

    def select(self, timeout=None):
        ready = super().select(0)
        if not ready:
            assert timeout is not None, "nothing is left that could happen"
            self.passed += max(0.0, timeout)
        return ready


class SimulatedLoop(asyncio.SelectorEventLoop):
    """asyncio's loop with a clock of its own; what is under way in sockets takes no time."""

    def __init__(self):
        self._passing = _Selector()
        super().__init__(self._passing)

    def time(self):
        return 1000.0 + self._passing.passed


class Clocked(Machine):
    """A machine as this one, but for its clock that never jumps and the start that it is in."""

    def __init__(self, loop):
        self.loop, self.boots = loop, 1

    def boot(self):
        return f"boot {self.boots}"

    def monotonic_ns(self):
        return round(self.loop.time() * 1e9)


def run(coroutine):
    """Run a coroutine and the live nodes in it under simulated time; what it returns."""
    loop = SimulatedLoop()
    with on(Clocked(loop)), asyncio.Runner(loop_factory=lambda: loop) as runner:
        return runner.run(coroutine)


def timed(test):
    """A test that is a coroutine, run under simulated time."""

    @wraps(test)
    def run_it(*args, **kwargs):
        run(test(*args, **kwargs))

    return run_it
