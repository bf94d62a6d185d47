"""A network as a capture, or its nodes, tell of it."""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass, field
from statistics import median
from typing import Any

DELAYS_MAX = 4096  # kept of a way


@dataclass
class Way:
    """One direction of a link."""

    got: int = 0  # frames that came in
    lost: int = 0  # frames that noise took
    # Of frames that came in, from their start.
    delays_us: deque[float] = field(default_factory=lambda: deque(maxlen=DELAYS_MAX))
    # Of the same, bytes.
    sizes: deque[int] = field(default_factory=lambda: deque(maxlen=DELAYS_MAX))

    @property
    def quality(self) -> float:
        """Share of frames that came in, 0 to 1."""
        return self.got / max(1, self.got + self.lost)


@dataclass
class Measured:
    """A network as a capture has it."""

    kind: str  # of network
    # By sender and receiver, nodes or ends of cables.
    ways: dict[tuple[Any, Any], Way] = field(default_factory=dict)
    seconds: float = 0.0  # from the first packet to the last
    packets: int = 0  # read
    cut: set[str] = field(default_factory=set)  # ends whose cable was cut for some time
    notes: list[str] = field(default_factory=list)  # what to know besides

    def way(self, a: Any, b: Any) -> Way:
        """The way from a to b; a new one if it was not seen before."""
        return self.ways.setdefault((a, b), Way())

    def delay_us(self) -> tuple[float, float, float]:
        """Least, median and greatest of the ways' median delays; 0 unknown."""
        found = [median(way.delays_us) for way in self.ways.values() if way.delays_us]
        return (min(found), median(found), max(found)) if found else (0.0, 0.0, 0.0)
