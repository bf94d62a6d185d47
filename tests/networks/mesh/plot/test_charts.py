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


def test_few_messages_are_not_divided_into_parts(monkeypatch):
    for count, said in ((1, "100 % of 1 message."), (7, "100 % of 7 messages.")):
        states = np.full(count, charts.sent.DELIVERED)
        found = SimpleNamespace(offered_us=np.arange(count), state=states)
        monkeypatch.setattr(charts.sent, "messages", lambda _, found=found: found)
        monkeypatch.setattr(charts.sent, "counted", lambda same: same)
        assert charts.over_time(SimpleNamespace(plan=SimpleNamespace(faults=[]))).text == said


def test_moments_of_a_run_are_marked_in_seconds_the_first_few_of_them(monkeypatch):
    """Of several events at one moment it is said how many there are."""
    monkeypatch.setattr(charts, "fault_words", lambda plan, fault: fault.words)
    faults = [SimpleNamespace(at_us=at, words=words) for at, words in (
        (999_999, "early"), (1_000_000, "a"), (1_500_000, "b"), (1_500_000, "c"), (2_000_000, "d"),
        (3_000_000, "e"), (3_000_001, "late"), (2_500_000, "f"))]  # fmt: skip
    marks = charts._marks(SimpleNamespace(faults=faults), charts.Axis(1.0, 3.0))
    assert marks == [charts.Mark(1.0, "a"), charts.Mark(1.5, "2 events"), charts.Mark(2.0, "d"),
                     charts.Mark(3.0, "e")]  # fmt: skip
