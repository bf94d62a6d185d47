"""Cells that no cable joins with the PC any more are told from those that have a way again."""

import pytest

from innervate import scenario
from innervate.analysis.headline import DEGRADED, DOWN, NO_DATA, OK
from innervate.networks.skin.analysis.headline import SkinFacts, skin_headline
from innervate.networks.skin.analysis.summary import summarize
from innervate.networks.skin.sim.simulate import simulate
from tests.networks.skin.runs import patch

CUT_0 = {"at_s": 0.5, "action": "cut", "interface": 0}
CUT_1 = {"at_s": 0.5, "action": "cut", "interface": 1}
FOURTH = {"row": 0, "column": 3}


def summary(*events, columns=8, rows=1, roots=((0, 0),), **keys):
    tables = patch(columns, rows, *roots, event=list(events), **({"duration_s": 1.0} | keys))
    return summarize(simulate(scenario.plan(scenario.from_dict(tables))))


def test_the_only_interface_is_cut():
    found = summary(CUT_0, columns=4, rows=4)
    (recovery,) = found["recoveries"]
    assert (recovery["routed_ms"], recovery["others_ms"]) == (None, None)
    assert (recovery["cut_off"], recovery["cut_off_total"]) == (16, 16)
    assert found["cut_off"]["cells"] == found["cut_off"]["most"] == 16
    assert found["cut_off"]["since_s"] == 0.5
    assert found["headline"] == {
        "level": DOWN,
        "text": "All 16 cells are cut off since 0.500 s: no cable joins them with the PC any more.",
    }


def test_one_of_two_interfaces_is_cut_and_nobody_is_cut_off():
    found = summary(CUT_0, columns=4, rows=4, roots=((0, 0), (3, 3)))
    (recovery,) = found["recoveries"]
    assert recovery["routed_ms"] == recovery["others_ms"] > 0
    assert (recovery["cut_off"], recovery["without_way"]) == (0, 0)
    assert found["cut_off"] == {"cells": 0, "labels": [], "since_s": None, "most": 0}
    assert found["headline"] == {"level": OK, "text": "Every cell has a way to the PC."}


def test_a_cable_whose_loss_isolates_a_part_of_a_line():
    found = summary({"at_s": 0.5, "action": "cut", "cell": FOURTH | {"port": "E"}})
    (recovery,) = found["recoveries"]
    assert recovery["routed_ms"] is None
    assert recovery["others_ms"] == 0.0  # those before the cable kept theirs
    assert found["cut_off"]["labels"] == [f"p0 r0 c{column}" for column in range(4, 8)]
    assert found["headline"]["level"] == DEGRADED
    assert found["headline"]["text"].startswith("4 of 8 cells are cut off since 0.500 s")
    assert found["headline"]["text"].endswith("every other cell has a way to the PC.")


def test_a_dead_cell_isolates_those_behind_it():
    found = summary({"at_s": 0.5, "action": "kill", "cell": FOURTH})
    (recovery,) = found["recoveries"]
    assert recovery["routed_ms"] is None
    assert recovery["cut_off"] == 4  # itself is off, not cut off
    assert found["switched_off"] == {"cells": 1, "labels": ["p0 r0 c3"]}
    assert "1 of 8 cells (p0 r0 c3) is switched off" in found["headline"]["text"]


def test_a_dead_cell_that_isolates_nobody():
    found = summary({"at_s": 0.5, "action": "kill", "cell": {"row": 0, "column": 7}})
    (recovery,) = found["recoveries"]
    assert (recovery["cut_off"], recovery["routed_ms"]) == (0, 0.0)
    assert found["headline"]["level"] == DEGRADED


def test_events_of_one_moment_share_what_came_of_it():
    found = summary(CUT_0, CUT_1, columns=4, rows=4, roots=((0, 0), (3, 3)))
    assert [one["cut_off"] for one in found["recoveries"]] == [16, 16]
    assert [one["routed_ms"] for one in found["recoveries"]] == [None, None]
    assert found["headline"]["level"] == DOWN


def test_nobody_is_cut_off_for_no_time_between_two_events_of_one_moment():
    back = {"at_s": 0.5, "action": "restore", "interface": 0}
    found = summary(CUT_0, back, columns=4, rows=4)
    assert [one["cut_off"] for one in found["recoveries"]] == [0, 0]
    assert found["cut_off"]["most"] == 0
    assert found["headline"]["level"] == OK
    again = [{**event, "at_s": 0.7} for event in (back, CUT_0)]
    found = summary(CUT_0, *again, columns=4, rows=4)
    assert [one["cut_off"] for one in found["recoveries"]] == [16, 0, 0]
    assert found["cut_off"]["since_s"] == 0.5


def test_of_cells_that_were_cut_off_one_after_the_other_only_the_first_is_since_then():
    first = {"at_s": 0.5, "action": "cut", "cell": FOURTH | {"port": "E"}}
    found = summary(first, {**CUT_0, "at_s": 0.7})
    assert found["headline"]["text"].startswith("All 8 cells are cut off, the first since 0.500 s:")


def test_a_cable_that_is_cut_twice_is_put_back_once():
    twice = [CUT_0, {**CUT_0, "at_s": 0.6}, {"at_s": 0.7, "action": "restore", "interface": 0}]
    found = summary(*twice, columns=4, rows=4)
    assert found["recoveries"][-1]["joined_again"] == 16
    assert found["cut_off"]["cells"] == 0


def test_a_later_event_does_not_hide_who_is_cut_off_already():
    later = {"at_s": 0.7, "action": "cut", "cell": {"row": 0, "column": 5, "port": "E"}}
    found = summary({"at_s": 0.5, "action": "cut", "cell": FOURTH | {"port": "E"}}, later)
    second = found["recoveries"][1]
    assert (second["cut_off"], second["cut_off_total"]) == (0, 4)
    assert (second["routed_ms"], second["others_ms"]) == (None, 0.0)
    assert found["cut_off"]["since_s"] == 0.5


@pytest.mark.parametrize(
    ("harm", "repair", "isolated"),
    [
        (CUT_0, {"action": "restore", "interface": 0}, 8),
        ({"at_s": 0.5, "action": "kill", "cell": FOURTH}, {"action": "revive", "cell": FOURTH}, 4),
    ],
)
def test_what_is_repaired_joins_again(harm, repair, isolated):
    found = summary(harm, {"at_s": 0.7, **repair})
    first, second = found["recoveries"]
    assert first["cut_off"] == isolated
    assert (second["cut_off_total"], second["without_way"]) == (0, 0)
    assert second["joined_again"] >= isolated
    assert second["routed_ms"] > 0
    assert (found["cut_off"]["cells"], found["cut_off"]["most"]) == (0, isolated)
    assert found["headline"]["level"] == DEGRADED
    assert "cut off from the PC for a time; every cell has a way" in found["headline"]["text"]


def test_cells_that_never_got_a_way_are_said():
    found = summary(protocol={"beacon_hz": 1})
    assert found["start_up"]["routed_ms"] is None
    assert found["without_way"]["never"] == 8
    assert found["headline"] == {"level": DOWN, "text": "No cell ever got a way to the PC."}


def test_samples_lost_on_the_way_are_said_and_those_before_the_first_way_are_not():
    quiet = summary(columns=4, rows=4, data={"rate_hz": 100})
    assert quiet["lost_at_start"] == quiet["data"]["lost"] > 0
    kept = "Every cell has a way to the PC, and no sample was lost after the start."
    assert quiet["headline"]["text"] == kept
    torn = summary(CUT_0, columns=4, rows=4, roots=((0, 0), (3, 3)), data={"rate_hz": 100})
    lost = torn["data"]["lost"] - torn["lost_at_start"]
    assert torn["headline"]["level"] == DEGRADED
    assert torn["headline"]["text"].startswith(f"{lost} of ")


def test_the_observer_agrees_with_a_search_along_the_cables():
    events = [{"at_s": 0.3 + 0.01 * i, "action": "cut", "random": "link"} for i in range(14)]
    events += [{"at_s": 0.5, "action": "kill", "random": "cell"}]
    tables = patch(4, 4, (0, 0), event=events, duration_s=0.7, seed=2)
    result = simulate(scenario.plan(scenario.from_dict(tables)))
    graph, epoch = result.plan.graph, result.world.epoch
    found, front = {graph.sink}, [graph.sink]
    while front:
        for end in graph.ends_of(front.pop()):
            other = graph.peer[end]
            if other >= 0 and not epoch[end] & 1 and graph.node_of(other) not in found:
                found.add(graph.node_of(other))
                front.append(graph.node_of(other))
    off = {fault.node for fault in result.plan.faults if fault.node >= 0}
    apart = [graph.label(c) for c in range(graph.cells) if c not in found and c not in off]
    assert summarize(result)["cut_off"]["labels"] == apart
    assert len(apart) > 2


@pytest.mark.parametrize(
    ("facts", "level", "text"),
    [
        (SkinFacts(9), OK, "Every cell has a way to the PC."),
        (SkinFacts(9, sent=5, lost=5), DEGRADED,
         "5 of 5 samples were lost (100 %); every cell has a way to the PC."),
        (SkinFacts(9, seeking=(4, 2)), DEGRADED,
         "2 of 9 cells (2, 4) have no way to the PC, although cables join them with it; "
         "every other cell has a way to the PC."),
        (SkinFacts(9, seeking=(4, 2), never=(4,)), DEGRADED,
         "1 of 9 cells (4) never got a way to the PC; 1 of 9 cells (2) has no way to the PC, "
         "although cables join it with the PC; every other cell has a way to the PC."),
        (SkinFacts(2, cut_off=(0,), off=(1,)), DOWN,
         "1 of 2 cells (0) is cut off: no cable joins it with the PC any more; "
         "1 of 2 cells (1) is switched off."),
        (SkinFacts(3, pc_off=True, cut_off=(0, 1, 2)), DOWN,
         "The PC is switched off: no cell has a way to it."),
        (SkinFacts(3, pc_off=True, seeking=(0, 1)), DOWN,
         "The PC is switched off: no cell has a way to it."),
        (SkinFacts(9, cut_off=(4, 2, 8)), DEGRADED,
         "3 of 9 cells (2, 4, 8) are cut off: no cable joins them with the PC any more; "
         "every other cell has a way to the PC."),
        (SkinFacts(9, off=(4, 2, 8, 0)), DEGRADED,
         "4 of 9 cells are switched off; every other cell has a way to the PC."),
        (SkinFacts(9, sent=100_000, lost=1), DEGRADED,
         "1 of 100,000 samples was lost (0.001 %); every cell has a way to the PC."),
        (SkinFacts(9, sent=100_001, lost=1), DEGRADED,
         "1 of 100,001 samples was lost (less than 0.001 %); every cell has a way to the PC."),
        (SkinFacts(9, sent=7), OK, "Every cell has a way to the PC, and no sample was lost."),
        (SkinFacts(9, sent=7, lost=2, early=2), OK,
         "Every cell has a way to the PC, and no sample was lost after the start."),
        (SkinFacts(9, sent=7, lost=3, early=2), DEGRADED,
         "1 of 5 samples was lost (20 %); every cell has a way to the PC."),
        (SkinFacts(9, missed=1200), DEGRADED,
         "Commands did not reach cells that had a way, 1,200 times; every cell has a way to the "
         "PC."),
        (SkinFacts(9, cut_off_before=1), DEGRADED,
         "1 of 9 cells was cut off from the PC for a time; every cell has a way to the PC."),
        (SkinFacts(9, cut_off_before=9), DEGRADED,
         "All 9 cells were cut off from the PC for a time; every cell has a way to the PC."),
        (SkinFacts(9, cut_off=(4,), off=(2,), cut_off_before=9), DEGRADED,  # 4 still is
         "1 of 9 cells (4) is cut off: no cable joins it with the PC any more; 1 of 9 cells (2) "
         "is switched off; at the worst moment all 9 cells were cut off; every other cell has a "
         "way to the PC."),
        (SkinFacts(3, silent=(0, 1)), DEGRADED,
         "2 of 3 cells (0, 1) do not answer; the other cell has a way to the PC."),
        (SkinFacts(3, silent=(0, 1, 2)), NO_DATA, "No cell answers: nothing is known of the skin."),
        (SkinFacts(2, off=(0, 1)), DOWN, "Both cells are switched off."),
        (SkinFacts(1, cut_off=(0,)), DOWN,
         "The only cell is cut off: no cable joins it with the PC any more."),
        (None, NO_DATA, "Nobody watched who had a way to the PC."),
    ],
)  # fmt: skip
def test_headlines(facts, level, text):
    found = skin_headline(facts)
    assert (found.level, found.text) == (level, text)
    assert (level == OK) <= (found.nodes == ())
