"""Whom a recovery counts as cut off, and that there is none where nobody is left to recover."""

import pytest

from innervate.web.messages import Cut
from tests.networks.skin.runs import patch
from tests.web.runs import few_points, go_to, simulated

__all__ = ["few_points"]
pytestmark = pytest.mark.usefixtures("few_points")
ROOT = {"row": 0, "column": 0}


@pytest.mark.parametrize(
    ("columns", "hurt", "mend", "apart"),
    [
        (4, {"action": "cut", "interface": 0}, {"action": "restore", "interface": 0}, 4),
        (4, {"action": "kill", "cell": ROOT}, {"action": "revive", "cell": ROOT}, 3),
        (1, {"action": "kill", "cell": ROOT}, {"action": "revive", "cell": ROOT}, 0),
    ],
)
def test_a_skin_of_which_no_cell_is_left_has_not_recovered_until_some_are_back(
    columns, hurt, mend, apart
):
    events = [{"at_s": 0.4, **hurt}, {"at_s": 0.7, **mend}]
    line = patch(columns, 1, (0, 0), event=events, duration_s=1.0)
    made = simulated(line, speed=0)
    for t_s in (0.400001, 0.6999):
        go_to(made, t_s)
        shown = made.fields()["recovery"]
        assert (shown["recovered_ms"], shown["nobody"], shown["apart"]) == (None, True, apart)
        assert made.fields()["headline"]["level"] == "down"
    made.run_to_end()
    shown = made.fields()["recovery"]
    assert not shown["nobody"]
    assert 300 <= shown["recovered_ms"] < 500  # it took somebody to mend it
    assert made.fields()["unconnected"] == 0


def test_a_cable_that_was_out_too_shortly_to_be_noticed_leaves_nobody_without_a_way():
    """All cells are cut off for 2 ms: their ports and parents stay as they are."""
    events = [{"at_s": 0.4, "action": "cut", "interface": 0},
              {"at_s": 0.402, "action": "restore", "interface": 0}]  # fmt: skip
    made = simulated(patch(3, 1, (0, 0), event=events, duration_s=0.6), speed=0)
    made.run_to_end()
    shown = made.fields()["recovery"]
    assert shown["detected_ms"] is None
    assert (shown["recovered_ms"], shown["nobody"], shown["apart"]) == (2.0, False, 3)


def test_who_is_left_has_recovered_though_most_are_cut_off():
    kill = {"at_s": 0.4, "action": "kill", "cell": {"row": 0, "column": 1}}
    made = simulated(patch(4, 1, (0, 0), event=[kill], duration_s=0.6), speed=0)
    made.run_to_end()
    shown = made.fields()["recovery"]
    assert (shown["recovered_ms"], shown["nobody"], shown["apart"]) == (0.0, False, 2)


def shown_after(made, t_s):
    """Of that time: how many the newest recovery has cut off, how many are so, the headline."""
    go_to(made, t_s)
    shown = made.fields()
    return shown["recovery"]["apart"], shown["apart"], shown["headline"]["text"]


def cut(at_s, cell):
    return {"at_s": at_s, "action": "cut", "cell": {"row": 0, "column": cell}, "port": "E"}


def test_a_second_cut_counts_its_own_cells_and_the_headline_all():
    events = [cut(0.4, 2), cut(0.6, 1)]
    made = simulated(patch(5, 1, (0, 0), event=events, duration_s=1.2), speed=0)
    first = shown_after(made, 0.5)
    assert first[:2] == (2, 2)
    assert first[2].startswith("2 of 5 cells")
    second = shown_after(made, 0.7)
    assert second[:2] == (1, 3)
    assert second[2].startswith("3 of 5 cells")
    assert shown_after(made, 0.5) == first, "also when one goes back"
    made._change(Cut(cable(made, 0)))
    assert shown_after(made, 0.501)[:2] == (2, 4), "by hand, too"


def cable(made, cell):
    """The link between a cell of a line and the next one."""
    ends = [{link["a"], link["b"]} for link in made.scene()["links"]]
    return made.scene()["links"][ends.index({cell, cell + 1})]["id"]


def test_a_second_cut_counts_its_own_nodes_of_a_mesh():
    chain = {
        "kind": "mesh", "duration_s": 12.0, "gateway": 0, "radio": {"reach_m": 22},
        "node": [{"name": f"n{i}", "x_m": 20.0 * i, "y_m": 0} for i in range(5)],
        "event": [{"at_s": 6.0, "action": "cut", "link": ["n2", "n3"]},
                  {"at_s": 8.0, "action": "cut", "link": ["n1", "n2"]},
                  {"at_s": 8.0, "action": "cut", "link": ["n0", "n1"]}],
    }  # fmt: skip
    made = simulated(chain, speed=0)
    first = shown_after(made, 7.0)
    assert first[:2] == (2, 2)
    assert first[2].startswith("2 of 5 nodes are cut off")
    second = shown_after(made, 9.0)
    assert second[:2] == (2, 4), "both cuts of that moment, and none of the first"
    assert second[2].startswith("4 of 5 nodes are cut off")
    assert made.fields()["recovery"]["cause"] == "link n1 - n2 cut, and 1 more"
