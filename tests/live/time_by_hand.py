"""Live nodes under simulated time: an hour of waiting takes as long as what is done in it."""

import asyncio
import selectors
import types
from unittest import mock

from innervate.live import engine


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


def run(coroutine):
    """Run a coroutine and the live nodes in it under simulated time; what it returns."""
    loop = SimulatedLoop()
    clock = types.SimpleNamespace(monotonic_ns=lambda: round(loop.time() * 1e9))
    patched = mock.patch.object(engine, "time", clock)
    with patched, asyncio.Runner(loop_factory=lambda: loop) as runner:
        return runner.run(coroutine)
