"""How far a search is."""

from dataclasses import dataclass


@dataclass(slots=True)
class Tally:
    """How far a search is, or came."""

    states: int = 0  # different states found
    expanded: int = 0  # states whose successors are all known
    generated: int = 0  # successors generated and looked up
    left_out: int = 0  # successors not followed because more was in flight than there is room for
    depth: int = 0  # events from the start to the latest state; all states less deep are expanded
    wall_s: float = 0.0  # seconds of searching, compiling and loading not included
    # "complete", "broken", "memory" (the bound was reached), "limit" (of states), "walked"
    # (random walks; `states` counts these then) or "interrupted"
    ended: str = "interrupted"

    @property
    def per_s(self) -> float:
        """Successors generated and looked up per second."""
        return self.generated / self.wall_s if self.wall_s > 0 else 0.0
