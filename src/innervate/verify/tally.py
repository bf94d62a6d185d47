"""How far a search is."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(slots=True)
class Tally:
    """How far a search is, or came.

    Attributes:
        states: different states found.
        expanded: states whose successors are all known.
        generated: successors generated and looked up.
        left_out: successors not followed because more was in flight than there is room for.
        depth: events from the start to the latest state; all states less deep are expanded.
        wall_s: seconds of searching, compiling and loading not included.
        ended: "complete", "broken", "memory" (the bound was reached), "limit" (of states),
            "walked" (random walks; `states` counts these then) or "interrupted".
    """

    states: int = 0
    expanded: int = 0
    generated: int = 0
    left_out: int = 0
    depth: int = 0
    wall_s: float = 0.0
    ended: str = "interrupted"

    @property
    def per_s(self) -> float:
        """Successors generated and looked up per second."""
        return self.generated / self.wall_s if self.wall_s > 0 else 0.0
