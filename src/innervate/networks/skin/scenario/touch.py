"""A touch that moves over the skin, sampled to whole numbers before the run."""

from __future__ import annotations

from array import array
from dataclasses import dataclass

from innervate.networks.skin.scenario.model import TouchTable
from innervate.topology import Graph
from innervate.topology.layout import cell_places

STEP_US = 2000
SAMPLES_MAX = 50_000


@dataclass(frozen=True, slots=True)
class Touch:
    """Where the touch is: sample i holds from i * step_us on."""

    step_us: int  # time between samples, us
    # Centre of the touch in the graph's layout, um.
    x_um: array[int]
    y_um: array[int]
    radius_um: int  # radius within which cells feel it, um
    force_mn: int  # force at its centre, mN


def sample(table: TouchTable, graph: Graph, duration_s: float) -> Touch:
    """The touch of a scenario; without a path it crosses the skin along its longer side.

    Before the first point of the path and after the last the touch stays there.
    """
    path = list(table.path) or _across(graph, duration_s)
    duration_us = round(duration_s * 1e6)
    step_us = max(STEP_US, -(-duration_us // SAMPLES_MAX))
    x_um, y_um = array("i"), array("i")
    leg = 0
    for i in range(duration_us // step_us + 1):
        now = i * step_us / 1e6
        while leg < len(path) - 1 and path[leg + 1][0] <= now:
            leg += 1
        (t0, x, y), after = path[leg], path[min(leg + 1, len(path) - 1)]
        part = min(max((now - t0) / (after[0] - t0), 0.0), 1.0) if after[0] > t0 else 0.0
        x_um.append(round(1000 * (x + part * (after[1] - x))))
        y_um.append(round(1000 * (y + part * (after[2] - y))))
    return Touch(
        step_us, x_um, y_um, max(1, round(1000 * table.radius_mm)), round(1000 * table.force_n)
    )


def _across(graph: Graph, duration_s: float) -> list[tuple[float, float, float]]:
    points = cell_places(graph)
    wide = max(x for x, _ in points)
    high = max(y for _, y in points)
    if wide >= high:
        return [(0.0, 0.0, high / 2), (duration_s, wide, high / 2)]
    return [(0.0, wide / 2, 0.0), (duration_s, wide / 2, high)]
