"""Moments of events on a report's charts: those of one moment together, and only the first."""

from types import SimpleNamespace as Of

import numpy as np

from innervate.networks.skin.plot.digest import MARKS_MAX, Digest
from innervate.plot.charts import Mark
from innervate.scenario.actions.cables import CUT, KILL


def marked(*events):
    """Marks of (us, action), on the chart of the whole run."""
    incidents = [Of(at_us=at_us, fault=Of(action=action)) for at_us, action in events]
    history = Of(steps=lambda: (np.zeros(1, np.int64), np.zeros(1, np.int64)))
    made = Of(
        incidents=incidents, history=history, result=Of(ended_us=9), _received=lambda *_: None
    )
    return Digest.overview(made)[0].marks


def test_events_of_one_moment_have_one_mark():
    second = 1_000_000
    assert marked((second, CUT), (2 * second, KILL)) == [Mark(1.0, "cut"), Mark(2.0, "kill")]
    together = [(second, CUT)] * 12
    assert marked(*together, (3 * second, CUT)) == [Mark(1.0, "12 events"), Mark(3.0, "cut")]


def test_no_more_than_there_is_room_for():
    assert len(marked(*((at, CUT) for at in range(MARKS_MAX + 1)))) == MARKS_MAX
