"""What is the matter for a while is said once in a while, not as often as it happens."""

from collections.abc import Callable

from innervate.live.machine import machine

PERIOD_S = 60.0


class Notices:
    """Says what is the matter when it begins, then once in each period, then that it is over.

    Args:
        say: is given each line.
        period_s: the least time between two lines on the same matter.
        clock: seconds, monotonic.
    """

    def __init__(
        self,
        say: Callable[[str], None],
        period_s: float = PERIOD_S,
        clock: Callable[[], float] = lambda: machine().monotonic_ns() / 1e9,
    ) -> None:
        self._say = say
        self._period_s = period_s
        self._clock = clock
        self._said: dict[str, float] = {}
        self._open: set[str] = set()

    def tell(self, matter: str, text: str) -> None:
        """Something is the matter, still or anew."""
        now = self._clock()
        if matter not in self._said or now - self._said[matter] >= self._period_s:
            self._said[matter] = now
            self._open.add(matter)
            self._say(text)

    def over(self, matter: str, text: str) -> None:
        """It is no more; said if it was said that it was."""
        if matter in self._open:
            self._open.discard(matter)
            self._say(text)
