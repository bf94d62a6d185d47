import dataclasses
import time

import numpy as np
import pytest

from innervate import scenario
from innervate.networks.skin.analysis.recovery import recoveries, start_up
from innervate.networks.skin.protocol.constants import REPORT_BALANCE, REPORT_BROKEN, REPORT_PARENT
from innervate.networks.skin.sim.observer import CUT_OFF, UNROUTED
from innervate.scenario.actions.cables import KILL, LOOSE
from innervate.sim.cables.simulation import Result
from innervate.sim.cables.world import ROW
from innervate.sim.tables import row_dtype

# A line of three: pc.0 - 0 - 1 - 2 - pc.1; end = 4 * cell + port, W 0, E 1.
BEGIN = [(0, -1, CUT_OFF, -1, 0), (0, -1, UNROUTED, 3, 0)]
SETTLED = [
    (5_000, 0, REPORT_PARENT, -1, 0),
    (5_000, 2, REPORT_PARENT, -1, 1),
    (6_000, 1, REPORT_PARENT, -1, 1),
    (6_000, 1, UNROUTED, 0, 0),
]


def recorded(line, rows, events=None):
    """A result that holds just these rows."""
    changes = {} if events is None else {"event": events}
    plan = scenario.plan(line(3, **changes))
    table = np.array(rows, row_dtype(ROW))
    fields = dict.fromkeys(field.name for field in dataclasses.fields(Result))
    return Result(**fields | {"plan": plan, "rows": table})


def test_by_hand(line):
    rows = [
        *BEGIN,
        *SETTLED,
        (1_000_000, -1, CUT_OFF, 0, 2),
        (1_000_000, -1, UNROUTED, 2, 0),
        (1_020_000, 1, REPORT_BROKEN, 0, 1),  # some other cable
        (1_030_000, 2, REPORT_BROKEN, 1, 0),  # this cable, but works
        (1_031_000, 2, REPORT_BROKEN, 1, 1),  # this cable
        (1_031_000, 2, REPORT_PARENT, 1, -1),
        (1_040_000, 1, REPORT_PARENT, 1, 0),
        (1_040_000, 1, UNROUTED, 1, 0),
        (1_050_500, 2, REPORT_PARENT, -1, 0),
        (1_050_500, 2, UNROUTED, 0, 0),
        (1_900_000, 1, REPORT_BALANCE, 0, 1),  # does not count
    ]
    assert recoveries(recorded(line, rows)) == [
        {
            "at_s": 1.0,
            "action": "cut",
            "detected_ms": 31.0,
            "converged_ms": 50.5,
            "routed_ms": 50.5,
            "others_ms": 50.5,
            "without_way": 0,
            "cut_cells": 2,
            "cut_off": 0,
            "cut_off_total": 0,
            "joined_again": 0,
        }
    ]
    assert start_up(recorded(line, rows)) == {"converged_ms": 6.0, "routed_ms": 6.0}


def test_nothing_happened(line):
    rows = [*BEGIN, *SETTLED, (1_000_000, -1, CUT_OFF, 0, 0)]
    (found,) = recoveries(recorded(line, rows))
    assert found["detected_ms"] is None
    assert found["converged_ms"] is None
    assert found["routed_ms"] == 0.0


def test_never_routed_again(line):
    rows = [*BEGIN, *SETTLED, (1_000_000, -1, CUT_OFF, 0, 2), (1_000_000, -1, UNROUTED, 2, 0)]
    assert recoveries(recorded(line, rows))[0]["routed_ms"] is None


def test_each_event_looks_as_far_as_the_next(line):
    events = [
        {"at_s": 1.0, "action": "cut", "interface": 1},
        {"at_s": 1.02, "action": "restore", "interface": 1},
    ]
    rows = [
        *BEGIN,
        *SETTLED,
        (1_000_000, -1, CUT_OFF, 0, 2),
        (1_000_000, -1, UNROUTED, 2, 0),
        (1_010_000, 1, REPORT_PARENT, 1, 0),
        (1_010_000, 1, UNROUTED, 1, 0),
        (1_020_000, -1, CUT_OFF, 1, 0),
        (1_020_000, -1, UNROUTED, 0, 0),
        (1_035_000, 2, REPORT_BROKEN, 1, 1),
    ]
    first, second = recoveries(recorded(line, rows, events))
    assert (first["detected_ms"], first["converged_ms"], first["routed_ms"]) == (None, 10.0, None)
    assert (second["detected_ms"], second["converged_ms"]) == (15.0, None)
    assert second["routed_ms"] == 0.0


def test_the_observer_may_leave_out_the_first_step(line):
    # A cell that restarts loses its route without a row; the step back to 0 tells.
    rows = [
        *BEGIN,
        *SETTLED,
        (1_000_000, 2, CUT_OFF, 0, 0),
        (1_004_000, 2, REPORT_PARENT, -1, 1),
        (1_004_000, 2, UNROUTED, 0, 0),
    ]
    events = [{"at_s": 1.0, "action": "restart", "cell": {"row": 0, "column": 2}}]
    assert recoveries(recorded(line, rows, events))[0]["routed_ms"] == 4.0


@pytest.mark.parametrize(
    ("event", "cells"),
    [
        ({"action": "loose", "interface": 1, "loss": 0.5}, 2),
        ({"action": "loose", "cell": {"row": 0, "column": 1, "port": "W"}, "loss": 0.5}, 0),
        ({"action": "loose", "cell": {"row": 0, "column": 1, "port": "E"}, "loss": 0.5}, 1),
        ({"action": "kill", "cell": {"row": 0, "column": 2}}, 2),
        ({"action": "kill", "cell": {"row": 0, "column": 1}}, 1),
        ({"action": "restart", "pc": True}, 0),
    ],
)
def test_cells_that_used_a_cable_or_a_cell(line, event, cells):
    rows = [*BEGIN, *SETTLED, (1_000_000, -1, CUT_OFF, 0, 0)]
    found = recoveries(recorded(line, rows, [{"at_s": 1.0, **event}]))
    assert found[0]["cut_cells"] == cells


def test_a_dead_cell_uses_nothing_any_more(line):
    events = [
        {"at_s": 1.0, "action": "kill", "cell": {"row": 0, "column": 1}},
        {"at_s": 1.5, "action": "loose", "interface": 1, "loss": 0.5},
    ]
    rows = [*BEGIN, *SETTLED, (1_000_000, 1, CUT_OFF, 0, 1), (1_500_000, -1, CUT_OFF, 1, 0)]
    result = recorded(line, rows, events)
    assert [fault.action for fault in result.plan.faults] == [KILL, LOOSE]
    assert [found["cut_cells"] for found in recoveries(result)] == [1, 1]


@pytest.mark.parametrize("seed", range(1, 6))
def test_line_of_free_running_cells(line, go, seed):
    """E21: on a line without drift, convergence - detection = (d - 1) T, after k +- 1 T."""
    result = go(line(9, seed=seed, timing={"drift_ppm": 0, "hop_latency_us": [1, 1]}))
    (found,) = recoveries(result)
    depth = found["cut_cells"]
    assert depth in (4, 5)
    assert 20 < found["detected_ms"] < 40
    assert found["converged_ms"] - found["detected_ms"] == pytest.approx(10 * (depth - 1), abs=0.1)
    assert found["routed_ms"] == found["converged_ms"]


def test_line_in_lock_step(line, go):
    """E20: k + 2 (d - 1) periods."""
    timing = {"lock_step": True, "hop_latency_us": [1, 1]}
    event = [{"at_s": 0.9999, "action": "cut", "interface": 1}]
    (found,) = recoveries(go(line(9, timing=timing, event=event)))
    periods = 3 + 2 * (found["cut_cells"] - 1)
    assert found["converged_ms"] == pytest.approx(10 * periods, abs=1.0)


def test_fast_enough(go):
    result = go("demo")
    best = 1.0
    for _ in range(5):
        started = time.perf_counter()
        recoveries(result)
        best = min(best, time.perf_counter() - started)
    assert best < 0.010
