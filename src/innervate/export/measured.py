"""A network as a capture, or its nodes, tell of it."""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass, field
from statistics import median
from typing import Any

DELAYS_MAX = 4096  # kept of a way


@dataclass
class Way:
    """One direction of a link.

    Attributes:
        got: frames that came in.
        lost: frames that noise took.
        delays_us: of frames that came in, from their start.
        sizes: of the same, bytes.
    """

    got: int = 0
    lost: int = 0
    delays_us: deque[float] = field(default_factory=lambda: deque(maxlen=DELAYS_MAX))
    sizes: deque[int] = field(default_factory=lambda: deque(maxlen=DELAYS_MAX))

    @property
    def quality(self) -> float:
        """Share of frames that came in, 0 to 1."""
        return self.got / max(1, self.got + self.lost)


@dataclass
class Measured:
    """A network as a capture has it.

    Attributes:
        kind: of network.
        ways: by sender and receiver, nodes or ends of cables.
        seconds: from the first packet to the last.
        packets: read.
        cut: ends whose cable was cut for some time.
        notes: what to know besides.
    """

    kind: str
    ways: dict[tuple[Any, Any], Way] = field(default_factory=dict)
    seconds: float = 0.0
    packets: int = 0
    cut: set[str] = field(default_factory=set)
    notes: list[str] = field(default_factory=list)

    def way(self, a: Any, b: Any) -> Way:
        """The way from a to b; a new one if it was not seen before."""
        return self.ways.setdefault((a, b), Way())

    def delay_us(self) -> tuple[float, float, float]:
        """Least, median and greatest of the ways' median delays; 0 unknown."""
        found = [median(way.delays_us) for way in self.ways.values() if way.delays_us]
        return (min(found), median(found), max(found)) if found else (0.0, 0.0, 0.0)
