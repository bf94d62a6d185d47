"""When a point has been repeated often enough: its confidence interval is narrow.

Decided on the first 1, 2, 3, ... batches of repeats in order of repeat, never on what happened to
be ready first, so that it is the same on any number of processes.
"""

import math
import re
from collections.abc import Sequence
from dataclasses import dataclass

from innervate.analysis.intervals import mean_interval
from innervate.sweeping.errors import SweepError

_RULE = re.compile(r"\s*([\w.-]+)\.ci\s*=\s*([0-9.eE+-]+)\s*(%?)\s*")


@dataclass(frozen=True, slots=True)
class Until:
    """A point is finished when the mean of a measure is known well enough."""

    measure: str  # a column of the results
    half: float  # greatest half width of its 95 % interval, in the measure's unit or as a share
    relative: bool  # `half` is a share of the mean

    def __str__(self) -> str:
        value = f"{100 * self.half:g}%" if self.relative else f"{self.half:g}"
        return f"{self.measure}.ci={value}"

    def met(self, values: Sequence[float]) -> bool:
        """Whether these values, of the first repeats in order, are enough."""
        if len(values) < 2:
            return False
        found = mean_interval(values)
        return (found.high - found.low) / 2 <= self._bound(found.value)

    def needed(self, values: Sequence[float]) -> int:
        """About how many values it will take; 0 if that cannot be said."""
        if len(values) < 2:
            return 0
        found = mean_interval(values)
        bound, half = self._bound(found.value), (found.high - found.low) / 2
        return math.ceil(len(values) * min((half / bound) ** 2, 1e6)) if bound > 0 else 0

    def _bound(self, mean: float) -> float:
        return self.half * abs(mean) if self.relative else self.half


def parse(text: str) -> Until:
    """The rule of an `--until` text: "recoveries.routed_ms.ci=5%", "throughput.ci=0.01"."""
    match = _RULE.fullmatch(text)
    try:
        half = float(match[2]) if match else math.nan
    except ValueError:
        half = math.nan
    if match is None or not math.isfinite(half) or half <= 0:
        raise SweepError(
            f"--until {text[:80]}: write it as MEASURE.ci=5% or MEASURE.ci=0.5, "
            "like recoveries.routed_ms.ci=5%"
        )
    return Until(match[1], half / 100 if match[3] else half, bool(match[3]))
