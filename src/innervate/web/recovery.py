"""How a network gets over what was done to it."""

from dataclasses import dataclass
from typing import Any


@dataclass(slots=True)
class Recovery:
    """How the network gets over the newest fault, as in a run's summary."""

    cause: str  # in words, of the first thing of that moment
    at_us: int  # when
    detected_ms: float | None = None  # the first who noticed, from there
    # Everybody has a way again since then; None = not yet. Who is cut off, so that nothing leads to
    # it whatever anybody does, does not count.
    recovered_ms: float | None = None
    apart: int = 0  # how many were cut off at worst, besides those who were before
    # Nobody is left who could have a way: all are off, silent or cut off. Then nothing has
    # recovered, and nothing can before somebody comes back.
    nobody: bool = False
    # Something else was done since everybody had: this does not change any more.
    closed: bool = False
    more: int = 0  # so many other things were taken away at the same moment
    before: int = 0  # so many were cut off already, and have been since

    def close(self) -> None:
        """Something that takes nothing away is done to the network."""
        self.closed = self.recovered_ms is not None

    def cut_off(self, nodes: int) -> None:
        """So many are cut off now."""
        self.before = min(self.before, nodes)
        self.apart = max(self.apart, nodes - self.before)

    def shown(self) -> dict[str, Any]:
        """The recovery as pages get it, times in ms."""
        return {
            "cause": f"{self.cause}, and {self.more} more" if self.more else self.cause,
            "at_s": self.at_us / 1e6,
            "detected_ms": self.detected_ms,
            "recovered_ms": self.recovered_ms,
            "apart": self.apart,
            "nobody": self.nobody,
        }
