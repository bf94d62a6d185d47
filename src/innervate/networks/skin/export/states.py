"""A skin as it was, step by step, read out of a run's tables."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np

from innervate.analysis.ways import NOWHERE, follow
from innervate.networks.skin.analysis.recovery import next_hops
from innervate.topology.layout import cell_places

TOUCH_WINDOW_US = 100_000

Point = tuple[float, float, float]


class States:
    """A skin as it was; its tables are read once, in order of time.

    Attributes:
        parent: per cell the port of its parent, -1 none.
        hop: per cell the node that its parent's port leads to, -1 none; the PC is behind the last.
        hops: per cell hops to the PC, -1 without a chain of parents that leads there.
        unrouted: how many cells that cables reached had no route, by the run's own account.
        cut_off: how many cells were on, but joined with the PC by no cable.
        force: per cell the mean force, mN, that the PC received last.
        proximity: the same of its proximity.
        heard: per cell when that was, us.
        places: per cell its place, m.
    """

    def __init__(self, plan: Any, tables: Mapping[str, Any], step_us: int) -> None:
        """Args: plan and tables (polars frames by name) of a run; the time between two states."""
        self.plan, self.graph, self.step_us = plan, plan.graph, step_us
        cells = self.graph.cells
        self.parent = [-1] * cells
        self.unrouted = self.cut_off = 0
        self.force, self.proximity = [0] * cells, [0] * cells
        self.heard = [-TOUCH_WINDOW_US - 1] * cells
        self.hop: list[int] = []
        self.hops: list[int] = []
        self.places = places_m(self.graph)
        self.routes = iter(tables["routes"].select("time_us", "cell", "new").iter_rows())
        some = ("time_us", "unrouted", "cut_off")
        self.outages = iter(tables["outages"].select(*some).iter_rows())
        self.samples: Iterator[tuple[int, ...]] = iter(())
        if "received" in tables:
            forces = ("force_0", "force_1", "force_2")
            some = tables["received"].select("time_us", "cell", "proximity", *forces)
            self.samples = iter(some.iter_rows())

    def snapshots(self) -> Iterator[tuple[int, States]]:
        """Itself as it was every step, and at the end."""
        ways: Any = (
            (self.routes, self._route),
            (self.outages, self._outage),
            (self.samples, self._feel),
        )
        waiting = [next(rows, None) for rows, _ in ways]
        at = 0
        while at < self.plan.duration_us:
            at = min(at + self.step_us, self.plan.duration_us)
            for i, (rows, take) in enumerate(ways):
                row = waiting[i]
                while row is not None and row[0] < at:
                    take(*row)
                    row = next(rows, None)
                waiting[i] = row
            self._follow()
            yield at, self

    def _route(self, _time: int, cell: int, new: int) -> None:
        self.parent[cell] = new

    def _outage(self, _time: int, unrouted: int, cut_off: int) -> None:
        self.unrouted, self.cut_off = unrouted, cut_off

    def _feel(self, time: int, cell: int, proximity: int, *forces: int) -> None:
        self.heard[cell], self.proximity[cell] = time, proximity
        self.force[cell] = round(sum(forces) / 3)

    def _follow(self) -> None:
        hop = next_hops(self.graph, np.array(self.parent, np.int64))
        _, far = follow(hop, hop == self.graph.sink)
        self.hop, self.hops = hop.tolist(), np.where(far == NOWHERE, NOWHERE, far + 1).tolist()

    def known(self, at: int) -> list[bool]:
        """Per cell whether the PC heard of it lately."""
        return [at - heard <= TOUCH_WINDOW_US for heard in self.heard]


def places_m(graph: Any) -> list[Point]:
    """Where the cells of a graph lie, m: on a body, or in a plane."""
    if not graph.positions:
        return [(x / 1000, -y / 1000, 0.0) for x, y in cell_places(graph)]
    flat = [value / 1000 for value in graph.positions]
    return [(flat[i], flat[i + 1], flat[i + 2]) for i in range(0, len(flat), 3)]
