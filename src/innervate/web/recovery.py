"""How a network gets over what was done to it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any


@dataclass(slots=True)
class Recovery:
    """How the network gets over the newest fault, as in a run's summary.

    Attributes:
        cause: in words.
        at_us: when.
        detected_ms: the first who noticed, from there.
        recovered_ms: everybody has a way again since then; None = not yet. Who is cut off, so that
            nothing leads to it whatever anybody does, does not count.
        apart: how many were cut off at worst.
        nobody: nobody is left who could have a way: all are off, silent or cut off. Then nothing
            has recovered, and nothing can before somebody comes back.
        closed: something else was done since everybody had: this does not change any more.
    """

    cause: str
    at_us: int
    detected_ms: float | None = None
    recovered_ms: float | None = None
    apart: int = 0
    nobody: bool = False
    closed: bool = False

    def close(self) -> None:
        """Something that takes nothing away is done to the network."""
        self.closed = self.recovered_ms is not None

    def cut_off(self, nodes: int) -> None:
        """So many are cut off now."""
        self.apart = max(self.apart, nodes)

    def shown(self) -> dict[str, Any]:
        """The recovery as pages get it, times in ms."""
        return {
            "cause": self.cause,
            "at_s": self.at_us / 1e6,
            "detected_ms": self.detected_ms,
            "recovered_ms": self.recovered_ms,
            "apart": self.apart,
            "nobody": self.nobody,
        }
