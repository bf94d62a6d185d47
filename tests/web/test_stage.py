"""When the stage shows the next state, by the clock alone."""

import pytest

from innervate.web.stage import STATES_PER_S, next_due

STEP_S = 1 / STATES_PER_S


@pytest.mark.parametrize(("late_s", "after_s"), [
    (0.0, STEP_S), (0.5 * STEP_S, STEP_S), (2.0 * STEP_S, STEP_S), (3.0 * STEP_S, 2.0 * STEP_S),
    (1.0, 1.0 - STEP_S), (-STEP_S, STEP_S),
])  # fmt: skip
def test_who_is_late_once_may_be_early_once(late_s, after_s):
    due = 100.0
    assert next_due(due, due + late_s) == pytest.approx(due + after_s)


def test_over_time_there_are_no_more_than_so_many():
    due = shown = 0.0
    for _ in range(300):
        shown = max(due, shown + 0.001)  # shown as soon as it is due
        due = next_due(due, shown)
    assert due == pytest.approx(300 * STEP_S)
