import dataclasses
import time

import numpy as np
import pytest

from innervate import scenario
from innervate.networks.skin.analysis.recovery import recoveries, start_up
from innervate.networks.skin.protocol.constants import REPORT_BALANCE, REPORT_BROKEN, REPORT_PARENT
from innervate.networks.skin.sim.observer import APART, CUT_OFF, JOINED, UNROUTED
from innervate.scenario.actions.cables import KILL, LOOSE
from innervate.sim.cables.simulation import Result
from innervate.sim.tables import ROW, row_dtype

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


def test_who_is_cut_off_from_the_beginning_on_never_had_a_way(line):
    rows = [(0, -1, CUT_OFF, -1, 0), (0, -1, UNROUTED, 3, 0), (0, -1, CUT_OFF, 0, 3),
            (0, -1, APART, 3, 3), (0, -1, JOINED, 0, 0), (0, -1, UNROUTED, 0, 0)]  # fmt: skip
    events = [{"at_s": 0.0, "action": "cut", "interface": 0}]
    result = recorded(line, rows, events)
    assert start_up(result) == {"converged_ms": None, "routed_ms": None}


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


CELL_1 = {"row": 0, "column": 1}
LATE = {"at_s": 1.5, "action": "loose", "interface": 1, "loss": 0.5}


@pytest.mark.parametrize(
    ("before", "parents", "cells"),
    [
        ({"action": "kill", "cell": CELL_1}, [], 1),
        ({"action": "restart", "cell": CELL_1}, [], 1),  # its memory went: it has no parent
        ({"action": "restart", "cell": CELL_1}, [1], 2),  # until it takes one again
        ({"action": "restart", "cell": CELL_1}, [0], 1),
        ({"action": "restart", "cell": CELL_1}, [0, 1], 2),
        ({"action": "restart", "cell": {"row": 0, "column": 2}}, [], 0),  # 1 goes through 2
        ({"action": "restart", "pc": True}, [], 2),  # that is no parent's memory
        ({"action": "lose", "cell": CELL_1 | {"port": "E"}, "frames": 3}, [], 2),
        ({"action": "loose", "cell": CELL_1 | {"port": "E"}, "loss": 0.1}, [], 2),
    ],
)
def test_who_uses_a_cable_is_who_has_a_way_over_it_just_before(line, before, parents, cells):
    rows = [*BEGIN, *SETTLED, (1_000_000, 1, CUT_OFF, 0, 0)]
    rows += [(1_200_000 + k, 1, REPORT_PARENT, -1, port) for k, port in enumerate(parents)]
    rows += [(1_500_000, -1, CUT_OFF, 1, 0), (1_600_000, 1, REPORT_PARENT, 1, 0)]
    found = recoveries(recorded(line, rows, [{"at_s": 1.0, **before}, LATE]))
    assert found[1]["cut_cells"] == cells


@pytest.mark.parametrize(
    ("action", "keys", "cells"),
    [("cut", {"interface": 1}, 7), ("restore", {"interface": 1}, 0),
     ("revive", {"cell": CELL_1}, 0), ("restart", {"pc": True}, 7),
     ("restart", {"cell": CELL_1}, 1), ("lose", {"interface": 1, "frames": 1}, 2)],
)  # fmt: skip
def test_what_a_mark_says_counts_where_it_is_of_that_cable(line, action, keys, cells):
    rows = [*BEGIN, *SETTLED, (1_000_000, -1, CUT_OFF, 0, 7)]
    (found,) = recoveries(recorded(line, rows, [{"at_s": 1.0, "action": action, **keys}]))
    assert (found["action"], found["cut_cells"]) == (action, cells)


def test_cells_cut_off_and_joined_again_are_told_by_event(line):
    events = [{"at_s": 1.0, "action": "cut", "interface": 1},
              {"at_s": 1.2, "action": "cut", "interface": 0},
              {"at_s": 1.2, "action": "restart", "pc": True},
              {"at_s": 1.4, "action": "restore", "interface": 0}]  # fmt: skip
    rows = [
        *BEGIN, (0, -1, JOINED, 3, 0), *SETTLED,
        (1_000_000, -1, CUT_OFF, 0, 0),
        (1_200_000, -1, CUT_OFF, 1, 3), (1_200_000, -1, APART, 3, 3), (1_200_000, -1, JOINED, 0, 0),
        (1_200_000, -1, CUT_OFF, 2, 0),
        (1_400_000, -1, CUT_OFF, 3, 0), (1_400_000, -1, APART, 0, 0), (1_400_000, -1, JOINED, 3, 0),
        (1_400_000, -1, UNROUTED, 2, 0), (1_430_000, 1, UNROUTED, 0, 0),
    ]  # fmt: skip
    names = ("cut_off", "cut_off_total", "joined_again", "routed_ms", "others_ms", "without_way")
    found = [tuple(one[name] for name in names) for one in recoveries(recorded(line, rows, events))]
    assert found == [
        (0, 0, 0, 0.0, 0.0, 0), (3, 3, 0, None, None, 0), (3, 3, 0, None, None, 0),
        (0, 0, 3, 30.0, 30.0, 0)]  # fmt: skip


def test_who_never_got_a_way_is_counted(line):
    rows = [*BEGIN, (0, -1, JOINED, 3, 0), (1_000_000, -1, CUT_OFF, 0, 0),
            (1_100_000, 1, UNROUTED, 1, 0)]  # fmt: skip
    (found,) = recoveries(recorded(line, rows))
    assert (found["without_way"], found["routed_ms"]) == (1, None)
    assert start_up(recorded(line, rows)) == {"converged_ms": None, "routed_ms": None}
    assert start_up(recorded(line, [])) == {"converged_ms": None, "routed_ms": None}


@pytest.mark.parametrize("end", [(2, 1), (1, 1), (2, 0), (0, 0)])
def test_who_finds_a_cell_dead_is_a_neighbour_or_itself(line, end):
    events = [{"at_s": 1.0, "action": "kill", "cell": CELL_1}]
    cell, port = end
    rows = [*BEGIN, *SETTLED, (1_000_000, 1, CUT_OFF, 0, 0),
            (1_010_000, cell, REPORT_BROKEN, port, 1)]  # fmt: skip
    hit = end in {(1, 1), (2, 0)}
    assert recoveries(recorded(line, rows, events))[0]["detected_ms"] == (10.0 if hit else None)


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
