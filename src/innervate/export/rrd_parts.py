"""What a recording for Rerun is made of, and its colours."""

from typing import Any, NamedTuple

import numpy as np

Rgb = tuple[int, int, int]
Log = tuple[int, str, int]  # us, text, level (see recording.py)

# Hues of Okabe and Ito, which stay apart for colour-blind readers; states have sizes as well.
PORTS: tuple[Rgb, ...] = (
    (0, 114, 178), (230, 159, 0), (0, 158, 115), (204, 121, 167), (86, 180, 233), (240, 228, 66),
    (160, 110, 70),
)  # fmt: skip
ALARM, INK, GREY, PALE = (213, 94, 0), (60, 66, 74), (150, 150, 150), (222, 224, 228)
# From little to much, as in the reports.
HEAT: tuple[Rgb, ...] = ((246, 243, 238), (251, 211, 156), (242, 162, 76), (210, 103, 22),
                         (120, 45, 0))  # fmt: skip


class Column(NamedTuple):
    """An entity over time: one value at each moment."""

    name: str  # its path
    times_us: list[int]  # of its rows
    content: Any  # columns of components, as Rerun has them


class Parts(NamedTuple):
    """All that is recorded of a run."""

    still: list[tuple[str, Any]]  # entities that stay as they are: (path, what)
    columns: list[Column]  # those that change
    log: list[Log]  # what happened
    views: list[tuple[str, list[str]]]  # (name, entities in it) of the views in space
    curves: list[str]  # entities that are plotted over time


def heat(shares: Any) -> Any:
    """Colours (n, 3) of shares from 0 to 1."""
    steps = np.linspace(0, 1, len(HEAT))
    bands = np.array(HEAT, np.float64).T
    mixed = [np.interp(shares, steps, band) for band in bands]
    return np.stack(mixed, axis=1).round().astype(np.uint8)
