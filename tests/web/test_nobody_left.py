"""Where no cell is left that could have a way, a page does not speak of a recovery."""

import pytest

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
