"""Shares of messages over time, by hand."""

from types import SimpleNamespace

import numpy as np

from innervate.networks.mesh.plot import charts


def test_each_message_counts_in_the_part_of_the_run_in_which_it_was_offered(monkeypatch):
    states = [charts.sent.DELIVERED] * 4 + [charts.sent.LOST] * 4
    found = SimpleNamespace(offered_us=10 + np.arange(8), state=np.array(states))
    monkeypatch.setattr(charts.sent, "messages", lambda _: found)
    monkeypatch.setattr(charts.sent, "counted", lambda same: same)
    drawn = charts.over_time(SimpleNamespace(plan=SimpleNamespace(faults=[])))
    assert (drawn.values.tolist(), drawn.times.tolist()) == ([100.0, 0.0], [10e-6, 14e-6])
    assert (drawn.x.low, drawn.x.high) == (10e-6, 18e-6)
