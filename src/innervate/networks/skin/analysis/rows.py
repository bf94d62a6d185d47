"""Raw rows of a run as plain arrays: parents, cells without a route, cells cut off, loops, ports.

All functions take a `sim.simulate.Result`; times are in us of true time.
"""

from typing import Any, NamedTuple

import numpy as np

from innervate.analysis.ways import Numbers as Numbers
from innervate.networks.skin.protocol.constants import (
    PORTS,
    REPORT_BALANCE,
    REPORT_BROKEN,
    REPORT_PARENT,
)
from innervate.networks.skin.sim import observer

NEVER = -1


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
    rows = result.rows
    code = rows["code"]
    at = np.flatnonzero((code == REPORT_PARENT) | (code == REPORT_BALANCE))
    part = rows[at]
    return ParentChanges(
        at, part["time"], part["node"], part["a"], part["b"], part["code"] == REPORT_BALANCE
    )


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
    at, part = _coded(result, REPORT_BROKEN)
    return BrokenChanges(at, part["time"], PORTS * part["node"] + part["a"], part["b"])


def marks(result: Any) -> Marks:
    """The beginning and the scenario's events."""
    at, part = _coded(result, observer.CUT_OFF)
    return Marks(at, part["time"], part["a"], part["b"])


def loop_episodes(result: Any) -> LoopEpisodes:
    """All forwarding loops: a ring of parents over live cables."""
    rows = result.rows
    code = rows["code"]
    at = np.flatnonzero((code == observer.LOOP_OPEN) | (code == observer.LOOP_CLOSED))
    part = rows[at]
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


def _coded(result: Any, code: int) -> tuple[Numbers, Any]:
    at = np.flatnonzero(result.rows["code"] == code)
    return at, result.rows[at]
