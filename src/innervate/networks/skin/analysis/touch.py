"""The touch as the cells felt it and as the PC had it: a lost sample is a hole in the image."""

from typing import Any, NamedTuple

import numpy as np

from innervate.analysis.ways import Flags
from innervate.networks.skin.analysis.rows import NEVER, Numbers

WINDOW_S = 0.05


class Image(NamedTuple):
    """A touch: one number per cell."""

    force_mn: Numbers  # mean of the three force sensors, mN
    proximity: Numbers  # nearness of an object, raw, 0 far
    # how long the PC had had the sample; NEVER (-1) where it had none in the window, force
    # and proximity are 0 then
    age_us: Numbers

    @property
    def known(self) -> Flags:
        """True for every cell the PC had a sample of."""
        known: Flags = self.age_us != NEVER
        return known


def received_image(run: Any, time_s: float, window_s: float = WINDOW_S) -> Image:
    """What the PC knew at a time: of every cell the latest sample received in the window before.

    Args:
        run: a Run, or a simulation's Result, with its received samples kept.
        time_s: the moment.
        window_s: samples older than this count as lost.
    """
    result = getattr(run, "result", run)
    cells = result.plan.graph.cells
    rows = result.deliveries
    now, since = round(1e6 * time_s), round(1e6 * (time_s - window_s))
    first, behind = np.searchsorted(rows["time"], [since, now], side="right").tolist()
    part = rows[first:behind]
    force, proximity = np.zeros(cells, np.int64), np.zeros(cells, np.int64)
    age = np.full(cells, NEVER, np.int64)
    # Of several samples of one cell NumPy keeps the last.
    force[part["cell"]] = part["force"].mean(axis=1).round().astype(np.int64)
    proximity[part["cell"]] = part["proximity"]
    age[part["cell"]] = now - part["time"]
    return Image(force, proximity, age)
