"""Figures of a sweep, from columns that are written here."""

import numpy as np
import pytest

from innervate.plot import sweeps
from innervate.plot.sweeps import Shown, draw, label

COLUMNS = {
    "k": [3, 1, 3, 1, 3, 2],
    "rule": ["b", "b", "a", "a", "b", "a"],
    "x_ms": [2.0, 4.0, None, 6.0, 4.0, None],
    "z": [1.0, 2.0, 3.0, None, 5.0, 6.0],
}


def axes(*shown, over=None):
    return draw(COLUMNS, Shown(*shown), over).axes[0]


def test_means_stand_over_their_settings():
    """One line for each value, named in the order they come; what has no value is left out."""
    b, a = axes("k", "x_ms", "rule", over={}).lines
    assert (b.get_label(), a.get_label()) == ("b", "a")
    assert (b.get_xdata().tolist(), b.get_ydata().tolist()) == ([1, 3], [4.0, 3.0])
    assert (a.get_xdata().tolist(), a.get_ydata().tolist()) == ([1], [6.0])
    (every,) = axes("k", "x_ms", over={}).lines
    assert (every.get_xdata().tolist(), every.get_ydata().tolist()) == ([1, 3], [5.0, 3.0])


def test_what_means_are_over_is_told():
    told = axes("k", "x_ms", over={"rule": 2, "m": 3}).get_xlabel()
    assert (
        " ".join(told.split()) == "k means over 2 values of rule, 3 values of m, all varied alike"
    )
    assert axes("k", "x_ms", over={}).get_xlabel() == "k"


def test_every_run_is_a_dot():
    b, a = axes("x_ms", "z", "rule").lines
    assert list(zip(b.get_xdata(), b.get_ydata(), strict=True)) == [
        (2.0, 1.0), (4.0, 2.0), (4.0, 5.0),
    ]  # fmt: skip
    assert len(a.get_xdata()) == 0


@pytest.mark.parametrize(("most", "written"), [(6, 6), (5, 0)])
def test_squares_have_their_number_as_far_as_it_can_be_read(most, written, monkeypatch):
    monkeypatch.setattr(sweeps, "WRITTEN_MAX", most)
    shown = axes("k", "x_ms", "rule", "heat")
    texts = [text.get_text() for text in shown.texts]
    assert texts == ["4", "none", "3", "6", "none", "none"][:written]
    assert [text.get_text() for text in shown.get_xticklabels()] == ["1", "2", "3"]
    assert [text.get_text() for text in shown.get_yticklabels()] == ["b", "a"]
    means = np.ma.filled(shown.images[0].get_array(), np.nan)
    assert np.array_equal(means, [[4, np.nan, 3], [6, np.nan, np.nan]], equal_nan=True)
    dark = [text.get_text() for text in shown.texts if text.get_color() == "#ffffff"]
    assert dark == (["6"] if written else [])


@pytest.mark.parametrize(("name", "words"), [
    ("recoveries.routed_ms", "recoveries routed (ms)"), ("a_us", "a (us)"), ("b_s", "b (s)"),
    ("rate_hz", "rate (Hz)"), ("dates", "dates"), ("in_slots", "in (slots)"),
])  # fmt: skip
def test_a_column_in_words(name, words):
    assert label(name) == words


def test_so_many_lines_are_drawn():
    columns = {"x": list(range(12)), "y": [1.0] * 12, "by": list(range(12))}
    for over in ({}, None):
        assert len(draw(columns, Shown("x", "y", "by"), over).axes[0].lines) == sweeps.LINES_MAX


def test_numbers_stand_at_themselves_and_words_one_after_another():
    assert sweeps._scale([3, 1.5, 3, None, 2]) == ([1.5, 2, 3], {1.5: 1.5, 2: 2.0, 3: 3.0})
    assert sweeps._scale(["b", "a", "b"]) == (["b", "a"], {"b": 0.0, "a": 1.0})
    assert sweeps._scale([True, False]) == ([False, True], {False: 0.0, True: 1.0})
