"""A finger on a simulated skin: the scenario's touch, led by hand.

A scenario's touch is a path, sampled to steps before the run. A hand moves what is left of it, from
the next step on, and what it did is written as a path again that gives the same samples.
"""

from typing import Any

import numpy as np

from innervate.networks.skin.scenario.model import TouchTable
from innervate.networks.skin.scenario.touch import sample
from innervate.networks.skin.sim.build import Touch, places_um
from innervate.topology.layout import cell_places

AWAY_MM = -1_000_000.0  # where nobody feels it
RADIUS_MM = 25.0  # of a finger, where the scenario has no touch: a cell and its neighbours

Numbers = np.ndarray[Any, np.dtype[np.int64]]


class Finger:
    """The touch of a plan, whose cells send data, and what a hand made of it.

    Attributes:
        x_um, y_um: where the touch is, per step.
    """

    def __init__(self, plan: Any) -> None:
        self._graph = plan.graph
        table = plan.scenario.model.touch
        if table is None:
            table = TouchTable(path=[(0.0, AWAY_MM, 0.0)], radius_mm=RADIUS_MM)
        self._table = table
        made = plan.touch or sample(table, plan.graph, plan.scenario.duration_s)
        self._step_us = made.step_us
        self._span = np.array((made.radius_um, made.force_mn, made.step_us), np.int64)
        self.x_um: Numbers = np.array(made.x_um, np.int64)
        self.y_um: Numbers = np.array(made.y_um, np.int64)

    def move(self, at_us: int, cell: int | None) -> None:
        """Put the finger on a cell from the next step on, or (None) take it away."""
        x_mm, y_mm = (AWAY_MM, 0.0) if cell is None else cell_places(self._graph)[cell]
        first = -(-at_us // self._step_us)
        self.x_um[first:], self.y_um[first:] = round(1000 * x_mm), round(1000 * y_mm)

    def into(self, world: Any) -> Any:
        """The world with this touch."""
        return world._replace(
            carrier=Touch(
                x=self.x_um.copy(),
                y=self.y_um.copy(),
                span=self._span.copy(),
                place=np.array(places_um(self._graph), np.int64),
            )
        )

    def table(self) -> dict[str, Any]:
        """The [touch] table that gives the same samples."""
        x, y = self.x_um, self.y_um
        moves = (np.diff(x) != 0) | (np.diff(y) != 0)
        # Between two points a path is straight: both ends of every stay have to be there.
        kept = np.flatnonzero(np.append(moves, True) | np.insert(moves, 0, True)).tolist()
        path = [[i * self._step_us / 1e6, int(x[i]) / 1000, int(y[i]) / 1000] for i in kept]
        return {"path": path, "radius_mm": self._table.radius_mm, "force_n": self._table.force_n}
