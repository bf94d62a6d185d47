"""Words, spans, points and drawings that papers are made of, by hand."""

from math import inf, nan
from types import SimpleNamespace as Of

import numpy as np
import pytest

from innervate.papers import drawing, jobs
from innervate.papers.errors import PapersError
from innervate.papers.experiment import Measured, Point, Span, about, columns, reading, verdict
from innervate.papers.store import Store
from innervate.papers.words import sentences, spans
from innervate.plot import style


@pytest.mark.parametrize(("numbers", "text"), [
    ([], ""), ([3], "3"), ([3, 4], "3-4"), ([2, 4, 5, 6, 9], "2,4-6,9"), ([1, 3], "1,3"),
])  # fmt: skip
def test_runs_of_numbers_are_joined(numbers, text):
    assert spans(numbers) == text


def test_sentences_go_over_lines():
    assert sentences("E1: one\n two.\nno\nE23: three: four\n") == {
        "E1": "one two. no", "E23": "three: four",
    }  # fmt: skip


def test_both_ends_of_a_span_belong_to_it():
    span = about(4.0)
    assert (span.low, span.high) == (3.0, 5.0)
    assert span.has(3.0, 5.0)
    assert not span.has(3.0, 5.01)
    assert not span.has(2.99)
    assert not span.has(nan)
    assert not span.has()
    assert span.share(np.array([2.9, 3.0, 5.0, 5.1, nan])) == 0.4
    assert Span(high=1.0).has(-inf, 1.0)
    assert Span(low=1.0).has(1.0, inf)


def test_a_verdict_says_what_it_rests_on():
    assert verdict(True) == "holds"
    assert verdict(True, "E1", "A2") == reading("E1", "A2") == "holds with reading E1, A2"
    assert verdict(False, "E1") == "does not hold"


def test_a_series_costs_as_much_as_its_seeds_and_is_kept_by_name():
    made = Point.each("what", 0.5, 4, lambda k, seed: k * seed, 10)
    assert (made.key, made.cost_s, made.work()) == ("what, seeds 1-4", 2.0, [10, 20, 30, 40])
    found = columns(lambda seed: {"a": seed, "b": None}, (), [1, 2])
    assert found == {"a": [1, 2], "b": [None, None]}
    got = Measured({"x": found}, True).floats(Point("x", print), "b")
    assert np.isnan(got).all()


def test_after_a_full_disk_lines_are_whole_again(tmp_path, full_disk):
    path = tmp_path / "results.jsonl"
    store = Store(path, "now")
    with full_disk(), pytest.raises(PapersError):
        store.put("a", 0)
    for key in "abc":
        store.put(key, (1,))
    assert [bool(line) for line in path.read_text().split("\n")] == [False, True, True, True, False]
    assert store.values == {"a": [1], "b": [1], "c": [1]}


def compared(monkeypatch, ours, its):
    """Which verdict and words two entries get, whose runs give these times by seed."""
    case = jobs.Case("case", "Case", None, range(len(ours)), ())
    pair = [jobs.Entry("job", name, "", print, print) for name in ("ours", "its")]
    values = {
        run.key: {} if value == "" else {"t": value}
        for entry, many in zip(pair, (ours, its), strict=True)
        for run, value in zip(jobs.runs(case, entry), many, strict=True)
    }
    job = Of(name="job", cases=lambda quick: [case])
    monkeypatch.setattr(jobs, "entries", lambda name: pair)
    found = jobs.Compared(job, Measured(values, True))
    return found.less({"": case}, "t", ("ours", "its"), jobs.Words("less", "why"))


def test_less_is_seed_by_seed(monkeypatch):
    """Where one has none of a number, the seed is left out; what never happens is the most."""
    found = compared(monkeypatch, [1.0] * 9, [2.0] * 9)
    assert (found.verdict, found.reason) == ("holds", "")
    assert found.measurement.endswith("less in 9 and more in 0 of 9")
    found = compared(monkeypatch, [1.0] * 9, [1.0] * 9)
    assert (found.verdict, found.reason) == ("does not hold", "why")
    found = compared(monkeypatch, ["", 1.0, 2.0, None, 5.0], [0.5, 2.0, 1.0, None, None])
    assert found.measurement.endswith("less in 2 and more in 1 of 4")


def axes():
    return style.panels(style.COLUMN_IN, 2.0)[1][0]


def test_shares_above_and_up_to():
    ax = axes()
    drawing.tail(ax, [1, 2, 3, 4])
    drawing.cumulated(ax, [1, 2, 3, 4])
    above, up_to = ax.lines
    assert above.get_ydata().tolist() == [100, 75, 50, 25]
    assert up_to.get_ydata().tolist() == [25, 50, 75, 100]


@pytest.mark.parametrize(("ends", "heights"), [
    ([(5.0, "a", "k")], [0.5]),
    ([(8.0, "b", "k"), (2.0, "a", "k")], [0.2, 0.8]),
    ([(5.0, "a", "k"), (5.2, "b", "k")], [0.46, 0.56]),
    ([(0.0, "a", "k"), (0.1, "b", "k")], [0.0, 0.1]),
    ([(10.0, "a", "k"), (9.9, "b", "k")], [0.9, 1.0]),
    ([(5.0, "a", "k"), (5.1, "b", "k"), (5.9, "c", "k")], [0.4333, 0.5333, 0.6333]),
])  # fmt: skip
def test_names_of_curves_keep_apart_and_inside(ends, heights):
    """A tenth of the axes' height apart, in the order of their curves."""
    ax = axes()
    ax.set_ylim(0, 10)
    drawing.end_labels(ax, ends, gap=0.1)
    assert [text.get_position()[1] for text in ax.texts] == pytest.approx(heights, abs=1e-3)
    names = [name for _, name, _ in sorted(ends)]
    assert [text.get_text() for text in ax.texts] == names
