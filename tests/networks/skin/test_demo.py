"""What the demo tells of a skin's cut cable, and of calls and samples, from values set by hand."""

from types import SimpleNamespace as Of

import pytest

from innervate.networks.skin import demo, run, show, tables
from innervate.networks.skin.protocol.constants import TICK
from innervate.sim.status import ON_FRAME, ON_INPUT, ON_START, ON_TIMER

CUT = {"cut_cells": 0, "converged_ms": None, "detected_ms": None, "cut_off": 0,
       "others_ms": None, "cut_off_total": 0, "routed_ms": None}  # fmt: skip
NOTICED = ("+3 ms", "the cell at the cable has noticed")
LOST = ("at once", "7 of 40 cells have lost their way to the PC")
GONE = ("at once", "2 of 40 cells are cut off: no cable joins them any more")
SHARED = "the cells share both cables again; none lost its way meanwhile"


@pytest.mark.parametrize(("recovery", "steps"), [
    ({}, []), ({"cut_cells": 7, "detected_ms": 3.0}, [LOST, NOTICED]),
    ({"cut_off": 2, "detected_ms": 3.0, "others_ms": 2.0, "cut_off_total": 2},
     [GONE, ("+2 ms", "every other cell has a way again"), NOTICED]),
    ({"others_ms": 12.0, "detected_ms": 3.0},
     [NOTICED, ("+12.0 ms", "every cell has a way again")]),
    ({"converged_ms": 5.0, "routed_ms": 0}, [("+5 ms", SHARED)]),
    ({"converged_ms": 5.0, "routed_ms": 1.0}, []), ({"routed_ms": 0}, []),
    ({"converged_ms": 5.0, "routed_ms": 0, "others_ms": 4.0},
     [("+4 ms", "every cell has a way again")]),
])  # fmt: skip
def test_what_followed_a_cut_is_told_in_order_of_time(recovery, steps):
    assert demo._steps(CUT | recovery, 40) == steps


def test_a_demo_tells_of_every_event_and_how_it_stands(monkeypatch):
    monkeypatch.setattr(demo, "fault_words", lambda graph, fault: f"{fault} is cut")
    monkeypatch.setattr(show, "state_lines", lambda summary: ["No forwarding loop."])
    recovery = CUT | {"at_s": 0.5, "cut_cells": 7}
    summary = {"recoveries": [recovery, CUT | {"at_s": 1.25}], "duration_s": 2.0, "wall_s": 0.126}
    plan = Of(graph=Of(cells=40, interfaces=2), params={"beacon_us": 2500}, faults=["it", "that"])
    assert demo.lines(Of(skin=summary, plan=plan)) == [
        "40 cells, 2 cables to the PC, 2.5 ms between a cell's beacons", "",
        "0.500 s   it is cut", "   at once   7 of 40 cells have lost their way to the PC", "",
        "1.250 s   that is cut", "", "No forwarding loop.", "",
        "2 s were simulated in 0.13 s.",
    ]  # fmt: skip


@pytest.mark.parametrize(("handler", "node", "port", "said"), [
    (ON_START, 1, 0, "c1: switched on"), (ON_START, 1, 1, "c1: restarted"),
    (ON_FRAME, 1, 2, "c1: frame on port E"), (ON_FRAME, 9, 2, "c9: frame on port 2"),
    (ON_TIMER, 1, TICK, "c1: beacon period"),
    (ON_TIMER, 1, 1 - TICK, "c1: beacon that had to wait"),
    (ON_INPUT, 1, 0, "c1: sample of its sensors"),
])  # fmt: skip
def test_a_call_is_said_in_words(handler, node, port, said, monkeypatch):
    monkeypatch.setattr(run, "PORT_NAMES", "NWES")
    plan = Of(graph=Of(sink=9, label=lambda number: f"c{number}"))
    assert run.call_words(plan, {"node": node, "handler": handler, "port": port}) == said


@pytest.mark.parametrize(("period_us", "count"), [(0, 0), (100, 44), (101, 40), (1001, 4)])
def test_every_cell_takes_a_sample_at_once_and_then_each_period(period_us, count):
    plan = Of(data_period_us=period_us, graph=Of(cells=4), duration_us=1000)
    assert run.samples(plan) == count


@pytest.mark.parametrize(("cells", "asked", "is_kept"), [
    (0, None, False), (1, None, True), (500_000, None, True), (500_001, None, False),
    (500_001, True, True), (1, False, False),
])  # fmt: skip
def test_samples_are_kept_unless_there_are_very_many(cells, asked, is_kept, monkeypatch):
    seen = []
    monkeypatch.setattr(run.simulator, "simulate", lambda plan, **keys: seen.append(keys))
    monkeypatch.setattr(run.frames, "check_conserved", lambda result: seen.append("checked"))
    plan = Of(data_period_us=1000, graph=Of(cells=cells), duration_us=1000)
    run.simulate(plan, plain=True, checks=False, received=asked, progress=None)
    assert seen == [{"plain": True, "checks": False, "deliveries": is_kept, "progress": None}]
    run.simulate(plan, plain=True, checks=True, received=asked, progress=None)
    assert seen[2:] == ["checked"]


@pytest.mark.parametrize("kept", [True, False])
def test_samples_that_were_not_kept_have_no_table(kept):
    assert run.tables_of(None) == tables.TABLES
    found = run.written_of(Of(has_deliveries=kept))
    assert set(tables.TABLES) - set(found) == (set() if kept else {tables.RECEIVED})
