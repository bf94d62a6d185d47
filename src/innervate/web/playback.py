"""How fast a simulated network's time goes: seconds of it per second of ours, held, or unpaced."""

import time
from collections.abc import Callable

from innervate.web.errors import Refused

SPEED_MIN, SPEED_MAX = 0.001, 1_000_000.0
LATE_S = 0.25  # a network that is too large for the speed runs as fast as it can


class Playback:
    """Says how far the network's time should be.

    Args:
        speed: SPEED_MIN .. SPEED_MAX; 0 = as fast as possible.
        clock: seconds, monotonic.
    """

    def __init__(self, speed: float = 1.0, clock: Callable[[], float] = time.monotonic) -> None:
        self._clock = clock
        self._since = clock()
        self._from_us = 0
        self.speed = 0.0
        self.paused = False
        self.set_speed(speed, 0)

    def set_speed(self, speed: float, now_us: int) -> None:
        """Another speed from now on; `now_us` is the network's time now, as below.

        Raises:
            Refused: out of range.
        """
        if speed != 0 and not SPEED_MIN <= speed <= SPEED_MAX:
            raise Refused(f"a speed is {SPEED_MIN:g} to {SPEED_MAX:g}, or 0: as fast as possible")
        self.speed = speed
        self.start_from(now_us)

    def hold(self, now_us: int) -> None:
        """Stop the network's time at `now_us`."""
        self.paused = True
        self.start_from(now_us)

    def go(self, now_us: int) -> None:
        """Let the network's time go on from `now_us`."""
        self.paused = False
        self.start_from(now_us)

    def start_from(self, now_us: int) -> None:
        """Measure from this moment on: it is `now_us` in the network."""
        self._since, self._from_us = self._clock(), now_us

    def due_us(self, end_us: int) -> int:
        """How far the network should be, at most its end."""
        if self.paused:
            return self._from_us
        if self.speed == 0:
            return end_us
        return min(end_us, self._from_us + int((self._clock() - self._since) * self.speed * 1e6))

    def note(self, now_us: int, due_us: int) -> None:
        """The network is at `now_us`: if it cannot keep up, the clock waits for it."""
        if self.speed and (due_us - now_us) / (self.speed * 1e6) > LATE_S:
            self.start_from(now_us)
