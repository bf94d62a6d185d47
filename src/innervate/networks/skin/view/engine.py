"""A skin that can be touched while it is watched."""

from __future__ import annotations

from typing import Any

from innervate.networks.skin.sim import simulate
from innervate.networks.skin.view.touching import Finger
from innervate.web.engine import Engine, Mark

CELLS_MAX = 20_000


class SkinEngine(Engine):
    """A skin under way, and a finger on it."""

    finger: Finger | None = None  # once a hand has touched the skin

    def touch(self, cell: int | None) -> None:
        """Touch a cell from now on, or none."""
        if self.finger is None:
            self.finger = Finger(self.plan)
        self.finger.move(self.earliest_us, cell)
        self.running.world = self.finger.into(self.world)

    def back_to(self, mark: Mark) -> None:
        """Go back to a moment that was remembered; what was touched later is touched again."""
        super().back_to(mark)
        if self.finger is not None:
            self.running.world = self.finger.into(self.world)


def unwatchable(plan: Any) -> str:
    """Why a skin cannot be watched; "" if it can."""
    if plan.graph.cells > CELLS_MAX:
        return f"{plan.graph.cells:,} cells are too many to be drawn; at most {CELLS_MAX:,}"
    if plan.script:
        return "its [script] replaces the clock; use: innervate run"
    return ""


def simulation(plan: Any) -> simulate.SkinSimulation:
    """The skin as it is watched: with all samples that the PC receives."""
    return simulate.simulation(plan, deliveries=plan.data_period_us > 0)
