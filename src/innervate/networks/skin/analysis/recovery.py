"""How a skin recovers from each of its scenario's events: detected, converged, routed."""

from typing import Any

import numpy as np

from innervate.networks.skin.analysis import rows
from innervate.networks.skin.analysis.summary_keys import Recovery, StartUp
from innervate.networks.skin.protocol.constants import NONE, PORTS
from innervate.scenario.actions.cables import ACTIONS, CUT, KILL, RESTART, RESTORE, REVIVE
from innervate.scenario.cables import Fault

NOBODY = -1


def recoveries(result: Any) -> list[Recovery]:
    """One entry per event of the scenario that happened, in order of time.

    What follows an event is looked for until the next later one; events of one moment share what
    came of it. For what the keys say see `Recovery`.
    """
    at = rows.marks(result)
    changes = rows.parent_changes(result)
    switches = changes.row[~changes.balancing]
    broken, unrouted = rows.broken_changes(result), rows.unrouted_steps(result)
    apart, joined = rows.apart_steps(result), rows.joined_steps(result)
    faults = {fault.index: fault for fault in result.plan.faults}
    found: list[Recovery] = []
    for place in np.flatnonzero(at.event != NOBODY).tolist():
        fault = faults[int(at.event[place])]
        window = _window(result, at, place)
        start = int(at.time_us[place])
        gone, gone_total = _cut_off(apart, window)
        there_before, there = (_at(joined, row, result.plan.graph.cells) for row in window)
        others = _routed(unrouted, window, start) if there else None
        found.append(
            {
                "at_s": start / 1e6,
                "action": ACTIONS[fault.action],
                "detected_ms": _since(start, _detected(result, fault, broken, window)),
                "converged_ms": _since(start, _last(result.rows["time"], switches, window)),
                "routed_ms": _since(start, None if gone_total else others),
                "others_ms": _since(start, others),
                "without_way": _at(unrouted, window[1], 0),
                "cut_cells": _cut_cells(result, at, place, fault),
                "cut_off": gone,
                "cut_off_total": gone_total,
                "joined_again": max(0, there - there_before),
            }
        )
    return found


def start_up(result: Any) -> StartUp:
    """The same for the beginning: `converged_ms` and `routed_ms` from switching on."""
    at = rows.marks(result)
    if len(at.row) == 0:  # it ran unobserved
        return {"converged_ms": None, "routed_ms": None}
    changes = rows.parent_changes(result)
    window = _window(result, at, 0)
    last = _last(result.rows["time"], changes.row[~changes.balancing], window)
    apart = _cut_off(rows.apart_steps(result), window)[1]
    routed = None if apart else _routed(rows.unrouted_steps(result), window, 0)
    return {"converged_ms": _since(0, last), "routed_ms": _since(0, routed)}


def _window(result: Any, at: rows.Marks, place: int) -> tuple[int, int]:
    """The rows after the first mark of a mark's moment and before that of a later moment."""
    first, after = (
        int(np.searchsorted(at.time_us, at.time_us[place], side)) for side in ("left", "right")
    )
    first = max(first, int(at.event[0] == NOBODY))  # the beginning is no event
    behind = int(at.row[after]) if after < len(at.row) else len(result.rows)
    return int(at.row[min(first, place)]) + 1, behind


def _at(steps: rows.Steps, row: int, otherwise: int) -> int:
    """What a step function is just before a row."""
    after = int(np.searchsorted(steps.row, row))
    return int(steps.cells[after - 1]) if after else otherwise


def _cut_off(steps: rows.Steps, window: tuple[int, int]) -> tuple[int, int]:
    """Cells cut off inside a window, and all that are so at its end."""
    first, behind = np.searchsorted(steps.row, window).tolist()
    return int(steps.fresh[first:behind].sum()), _at(steps, window[1], 0)


def _since(start_us: int, time_us: int | None) -> float | None:
    return None if time_us is None else (time_us - start_us) / 1e3


def _last(times: rows.Numbers, places: rows.Numbers, window: tuple[int, int]) -> int | None:
    """Time of the last of these rows inside the window."""
    after = int(np.searchsorted(places, window[1]))
    if after == 0 or places[after - 1] < window[0]:
        return None
    return int(times[places[after - 1]])


def _routed(steps: rows.Steps, window: tuple[int, int], start: int) -> int | None:
    """When the last cell had a route for good; `start` if none ever lacked one."""
    first, behind = np.searchsorted(steps.row, window).tolist()
    if first == behind:
        return start if first == 0 or steps.cells[first - 1] == 0 else None
    # A step stands only where the number changed: a last one to 0 ended the outage.
    return None if steps.cells[behind - 1] > 0 else int(steps.time_us[behind - 1])


def ends_of(result: Any, fault: Fault) -> list[int]:
    """All ends of the cables an event happens to."""
    graph = result.plan.graph
    ends = [fault.end] if fault.end >= 0 else list(graph.ends_of(fault.node))
    return [end for own in ends if graph.peer[own] >= 0 for end in (own, graph.peer[own])]


def _detected(
    result: Any, fault: Fault, broken: rows.BrokenChanges, window: tuple[int, int]
) -> int | None:
    first, behind = np.searchsorted(broken.row, window).tolist()
    if first == behind:
        return None
    here = np.isin(broken.end[first:behind], ends_of(result, fault))
    hits = np.flatnonzero(here & (broken.broken[first:behind] == 1))
    return int(broken.time_us[first + int(hits[0])]) if len(hits) else None


def _cut_cells(result: Any, at: rows.Marks, place: int, fault: Fault) -> int:
    """Cells whose chain of parents used the link, or went through the node."""
    if fault.action in (RESTORE, REVIVE):
        return 0
    if fault.action == CUT or fault.node == result.plan.graph.sink:
        return int(at.cut_off[place])
    parent = parents_before(result, place)
    return int(np.count_nonzero(users(result.plan.graph, parent, fault)))


def parents_before(result: Any, place: int) -> rows.Numbers:
    """Parent port of every cell just before mark `place` (see rows.marks); -1 none."""
    at, changes = rows.marks(result), rows.parent_changes(result)
    cells = result.plan.graph.cells
    stopped = {fault.index: fault.node for fault in result.plan.faults
               if fault.action in (KILL, RESTART) and fault.node < cells}  # fmt: skip
    marks = zip(at.row[:place].tolist(), at.event[:place].tolist(), strict=True)
    lost = {stopped[event]: row for row, event in marks if event in stopped}
    behind = int(np.searchsorted(changes.row, at.row[place]))
    return rows.parents(changes, cells, behind, lost)


def next_hops(graph: Any, parent: rows.Numbers) -> rows.Numbers:
    """The node on every cell's parent port; -1 without a parent."""
    peer = np.frombuffer(graph.peer, np.int32)
    cells = len(parent)
    hop = peer[PORTS * np.arange(cells) + np.maximum(parent, 0)].astype(np.int64)
    hop = np.where(hop >= 0, np.minimum(hop // PORTS, cells), NOBODY)
    return np.where(parent == NONE, NOBODY, hop)


def users(graph: Any, parent: rows.Numbers, fault: Fault) -> Any:
    """True for every cell whose chain of parents uses the event's cable or node."""
    cells = len(parent)
    hop = next_hops(graph, parent)
    uses = np.zeros(cells + 2, np.bool_)  # the PC, and nobody (index -1)
    if fault.node >= 0:
        uses[fault.node] = hop[fault.node] != NOBODY
        uses[:cells] |= hop == fault.node
    else:
        for end in (fault.end, graph.peer[fault.end]):
            cell, port = divmod(end, PORTS)
            if cell < cells and parent[cell] == port:
                uses[cell] = True
    jump = np.concatenate([hop, [cells, cells + 1]])
    jump[jump < 0] = cells + 1
    for _ in range(max(1, cells.bit_length())):
        uses |= uses[jump]
        jump = jump[jump]
    return uses[:cells]
