"""Whom messages to all did not reach."""

from bisect import bisect_left, bisect_right
from typing import Any

import numpy as np

from innervate.analysis.ways import Flags, Numbers
from innervate.networks.mesh.analysis.paths import Ground
from innervate.networks.mesh.protocol.constants import DATA
from innervate.scenario.actions.field import KILL, RESTART, REVIVE


def missed(
    result: Any, at: Numbers, node: Numbers, those: Numbers, of: Numbers, window_us: int
) -> Flags:
    """Per broadcast, whether somebody missed it who was on for `window_us` after its offer.

    `at` and `node` say when and to whom each message of the run was offered, `those` which of them
    are broadcasts, in order, and `of` which message each delivery is of.
    """
    if not len(those):
        return np.zeros(0, np.bool_)
    plan = result.plan
    there, which = _there(plan, at[those].tolist(), window_us)
    there = there[which]
    there[np.arange(len(those)), node[those]] = False
    who = result.delivered["node"][result.delivered["kind"] == DATA]
    mine = np.isin(of, those)
    there[np.searchsorted(those, of[mine]), who[mine]] = False
    return np.asarray(there.any(axis=1))


def _there(plan: Any, times: list[int], window_us: int) -> tuple[Flags, Numbers]:
    """(who is on for a whole window: some sets of nodes, per time which of these it is)."""
    ground = Ground(plan)
    switched = [fault for fault in plan.faults if fault.action in (KILL, REVIVE, RESTART)]
    moments = [fault.at_us for fault in switched]
    sets: dict[tuple[int, int, int], int] = {}
    found: list[Flags] = []
    which: list[int] = []
    for time in times:
        since, until = bisect_left(moments, time), bisect_right(moments, time + window_us)
        key = bisect_right(ground.times, time), since, until
        if key not in sets:
            sets[key] = len(found)
            on = np.array(ground.on_at(time), np.bool_)
            on[[fault.node for fault in switched[since:until]]] = False
            found.append(on)
        which.append(sets[key])
    return np.array(found), np.array(which, np.int64)
