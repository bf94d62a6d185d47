"""Percentiles of what a run measured: linear between neighbours, as those of sweeps are.

Two kinds are others, as docs/sweeps.md says: of networks without a summary of their own, and where
networks are compared in a field, they are the nearest value that was measured; a skin's are counted
in classes (sim/delays.py), and are the least value that so many do not exceed.
"""

from typing import Any

import numpy as np

from innervate.analysis.summary_common import Percentiles


def percentiles(values: Any, shares: tuple[int, ...], nearest: bool = False) -> list[float | None]:
    """The values that so many of a hundred do not exceed; None where there are no values."""
    if len(values) == 0:
        return [None] * len(shares)
    found = np.percentile(np.asarray(values), shares, method="nearest" if nearest else "linear")
    return [float(value) for value in found]


def usual(values: Any, scale: float = 1.0, nearest: bool = False) -> Percentiles:
    """Median, 99th percentile and maximum, as `percentiles` has them, times `scale`."""
    found = percentiles(np.asarray(values, np.float64), (50, 99, 100), nearest)
    p50, p99, most = (None if value is None else scale * value for value in found)
    return {"p50": p50, "p99": p99, "max": most}
