"""Raw rows of a run as plain arrays: parents, cells without a route, cells cut off, loops, ports.

All functions take a `sim.simulate.Result`; times are in us of true time.
"""

from collections.abc import Mapping
from types import MappingProxyType
from typing import Any, NamedTuple

import numpy as np

from innervate.analysis.ways import Numbers as Numbers
from innervate.networks.skin.protocol import constants as const
from innervate.networks.skin.sim import observer

NEVER = -1
NOBODY: Mapping[int, int] = MappingProxyType({})


class ParentChanges(NamedTuple):
    """Every change of a parent port, in order of time."""

    row: Numbers  # place in the run's rows
    time_us: Numbers  # when
    cell: Numbers  # who
    # old, new: port before and after; -1 none
    old: Numbers
    new: Numbers
    # True where the cell changed only to balance the load
    balancing: np.ndarray[Any, np.dtype[np.bool_]]


class Steps(NamedTuple):
    """How many cells something is true of, from `time_us[i]` on (a step function)."""

    row: Numbers  # place in the run's rows
    time_us: Numbers  # when
    cells: Numbers  # how many from then on
    fresh: Numbers  # of those cut off, how many were not so before


class LoopEpisodes(NamedTuple):
    """Forwarding loops, in the order in which they closed into a ring."""

    cell: Numbers  # one cell of the ring
    opened_us: Numbers  # when the ring came to be
    closed_us: Numbers  # when it fell apart; NEVER (-1) if it stood at the end of the run
    length: Numbers  # cells in the ring


class BrokenChanges(NamedTuple):
    """Every moment at which a cell found a port broken (1) or working again (0)."""

    row: Numbers
    time_us: Numbers
    end: Numbers
    broken: Numbers


class Marks(NamedTuple):
    """The scenario's events as they happened; the first mark is the beginning (event -1)."""

    row: Numbers  # place of the mark in the run's rows: what stands behind it happened after it
    time_us: Numbers  # when
    event: Numbers  # index in the scenario file
    cut_off: Numbers  # cells that lost their working chain of parents at that moment


def parent_changes(result: Any) -> ParentChanges:
    """All changes of parent ports."""
    at, part = _coded(result, const.REPORT_PARENT, const.REPORT_BALANCE)
    balancing = part["code"] == const.REPORT_BALANCE
    return ParentChanges(at, part["time"], part["node"], part["a"], part["b"], balancing)


def parents(
    changes: ParentChanges, cells: int, behind: int, lost: Mapping[int, int] = NOBODY
) -> Numbers:
    """Parent port of every cell after the first changes, -1 none.

    A cell that `lost` its memory at a row has none that it took before.
    """
    # Of several values for one place NumPy keeps the last.
    parent = np.full(cells, const.NONE, np.int64)
    parent[changes.cell[:behind]] = changes.new[:behind]
    changed = np.full(cells, NEVER, np.int64)
    changed[changes.cell[:behind]] = changes.row[:behind]
    for cell, row in lost.items():
        if changed[cell] < row:
            parent[cell] = const.NONE
    return parent


def unrouted_steps(result: Any) -> Steps:
    """How many cells that are physically connected to the PC had no route, over time."""
    return _steps(result, observer.UNROUTED)


def apart_steps(result: Any) -> Steps:
    """How many cells were cut off: on, and no live cable joined them with the PC, any way."""
    return _steps(result, observer.APART)


def joined_steps(result: Any) -> Steps:
    """How many cells live cables joined with the PC, over time."""
    return _steps(result, observer.JOINED)


def _steps(result: Any, code: int) -> Steps:
    at, part = _coded(result, code)
    return Steps(at, part["time"], part["a"], part["b"])


def values_at(steps: Steps, at: Numbers) -> Numbers:
    """What a step function is after each of these rows; 0 before its first step."""
    after = np.searchsorted(steps.row, at, "right")
    return np.append(steps.cells, 0)[after - 1]


def broken_changes(result: Any) -> BrokenChanges:
    """Ports found broken, and working again."""
    at, part = _coded(result, const.REPORT_BROKEN)
    return BrokenChanges(at, part["time"], const.PORTS * part["node"] + part["a"], part["b"])


def marks(result: Any) -> Marks:
    """The beginning and the scenario's events."""
    at, part = _coded(result, observer.CUT_OFF)
    return Marks(at, part["time"], part["a"], part["b"])


def loop_episodes(result: Any) -> LoopEpisodes:
    """All forwarding loops: a ring of parents over live cables."""
    _, part = _coded(result, observer.LOOP_OPEN, observer.LOOP_CLOSED)
    # The rows of one ring's cell alternate: opened, closed, opened ...
    order = np.argsort(part["node"], kind="stable")
    node, time = part["node"][order], part["time"][order]
    opened = part["code"][order] == observer.LOOP_OPEN
    closed_us = np.full(len(order), NEVER, np.int64)
    follows = (node[1:] == node[:-1]) & opened[:-1] & ~opened[1:]
    closed_us[:-1][follows] = time[1:][follows]
    where = np.flatnonzero(opened)
    where = where[np.argsort(order[where], kind="stable")]
    return LoopEpisodes(node[where], time[where], closed_us[where], part["a"][order][where])


def _coded(result: Any, *codes: int) -> tuple[Numbers, Any]:
    at = np.flatnonzero(np.isin(result.rows["code"], codes))
    return at, result.rows[at]
