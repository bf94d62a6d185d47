"""Figures of a sweep, from columns that are written here."""

import numpy as np
import pytest
from matplotlib.colors import to_rgb

from innervate.plot import sweeps
from innervate.plot.sweeps import Shown, draw
from innervate.plot.words import label

COLUMNS = {
    "k": [3, 1, 3, 1, 3, 2],
    "rule": ["b", "b", "a", "a", "b", "a"],
    "x_ms": [2.0, 4.0, None, 6.0, 4.0, None],
    "z": [1.0, 2.0, 3.0, None, 5.0, 6.0],
}


def axes(*shown, over=None):
    return draw(COLUMNS, Shown(*shown), over).axes[0]


def test_means_stand_over_their_settings():
    """A line for each value, named in the order they come; broken where runs have no value."""
    b, a = axes("k", "x_ms", "rule", over={}).lines
    assert (b.get_label(), a.get_label()) == ("b", "a")
    assert (b.get_xdata().tolist(), b.get_ydata().tolist()) == ([1, 3], [4.0, 3.0])
    assert (a.get_xdata().tolist(), a.get_ydata().tolist()) == ([1], [6.0])
    (every,) = axes("k", "x_ms", over={}).lines
    assert every.get_xdata().tolist() == [1, 2, 3]
    assert str(every.get_ydata().tolist()) == "[5.0, nan, 3.0]"


def test_what_means_are_over_is_told():
    told = axes("k", "x_ms", over={"rule": 2, "m": 3}).get_xlabel()
    assert (
        " ".join(told.split()) == "k means over 2 values of rule, 3 values of m, all varied alike"
    )
    assert axes("k", "x_ms", over={}).get_xlabel() == "k"


def test_means_by_how_often_points_were_run_are_told():
    columns = COLUMNS | {"point": [0, 0, 1, 1, 2, 2]}
    for last, told in ((2, "all varied alike"), (1, "by how often each of them was run")):
        columns["point"][-1] = last
        drawn = draw(columns, Shown("k", "x_ms"), {"rule": 2}).axes[0]
        assert told in " ".join(drawn.get_xlabel().split())


@pytest.mark.parametrize("over", [{}, None])
@pytest.mark.parametrize("values", [(0, 0, 0), (0, None, 0), (0, 9, 0), (0, -9, 0)])
def test_where_all_is_0_the_scale_goes_up(values, over):
    (ax,) = draw({"k": [1, 1, 2], "lost": values}, Shown("k", "lost"), over).axes
    assert (ax.get_ylim() == (-0.05, 1)) == (not any(values))


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


def luminance(colour):
    linear = [c / 12.92 if c <= 0.04045 else ((c + 0.055) / 1.055) ** 2.4 for c in colour]
    return np.dot(linear, (0.2126, 0.7152, 0.0722))


def test_the_number_in_a_square_can_be_read_whatever_its_shade():
    """Contrast by WCAG 2 of each number with its square, as drawn, from the least to the most."""
    columns = {"x": list(range(60)), "y": [float(i) for i in range(60)], "by": [1] * 60}
    shown = draw(columns, Shown("x", "y", "by", "heat"), {}).axes[0]
    (image,) = shown.images
    assert len(shown.texts) == 60
    for text in shown.texts:
        ground = luminance(image.to_rgba(float(text.get_text()))[:3])
        ink = luminance(to_rgb(text.get_color()))
        assert (max(ink, ground) + 0.05) / (min(ink, ground) + 0.05) >= 4.5, text.get_text()


@pytest.mark.parametrize(("name", "words"), [
    ("recoveries.routed_ms", "recoveries routed (ms)"), ("a_us", "a (us)"), ("b_s", "b (s)"),
    ("rate_hz", "rate (Hz)"), ("dates", "dates"), ("in_slots", "in (slots)"),
])  # fmt: skip
def test_a_column_in_words(name, words):
    assert label(name) == words


def test_so_many_lines_are_drawn():
    columns = {"x": list(range(12)), "y": [1.0] * 12, "by": list(range(12))}
    for over in ({}, None):
        (ax,) = draw(columns, Shown("x", "y", "by"), over).axes
        assert len(ax.lines) == sweeps.LINES_MAX
        assert "the first 8 of 12 values of by" in ax.get_xlabel()
        looks = {(line.get_color(), line.get_marker()) for line in ax.lines}
        assert len(looks) == sweeps.LINES_MAX


def test_names_stand_beside_lines_and_not_over_each_other():
    long = [f"csma-cd-{'x' * 30}-{i}" for i in range(6)]
    columns = {"x": long, "y": [1.0] * 6, "by": list(range(6)), "on": [True, False] * 3}
    made = draw(columns, Shown("x", "y", "by", title="word " * 20), {})
    (ax,) = made.axes
    made.get_layout_engine().execute(made)
    to_draw = made.canvas.get_renderer()
    assert ax.get_legend().get_window_extent(to_draw).x0 > ax.get_window_extent(to_draw).x1
    assert ax.get_title(loc="left").count("\n") == 2
    names = [text for text in ax.get_xticklabels() if text.get_text()]
    assert [text.get_text() for text in names] == [f"csma-cd-xx...xxxxxxxxx-{i}" for i in range(6)]
    assert {text.get_rotation() for text in names} == {35}
    assert axes_names(draw(columns, Shown("on", "y"), {})) == ["false", "true"]


CROWDED = {  # lines that leave no room between them, as examples/team-size.toml draws
    "csma-cd-r": (0.712, 0.712, 0.712, 0.712), "csma-cd-d2": (0.557, 0.544, 0.514, 0.412),
    "dcf": (0.178, 0.275, 0.323, 0.35), "tdma": (0.712, 0.712, 0.712, 0.712),
}  # fmt: skip
ROOMY = {"csma-cd-r": (0.7, 0.7, 0.7, 0.7), "dcf": (0.1, 0.1, 0.1, 0.1)}


@pytest.mark.parametrize(("lines", "beside"), [(CROWDED, True), (ROOMY, False)])
def test_names_of_a_few_lines_stand_inside_where_they_cover_none(lines, beside):
    columns = {
        "stations": [2, 5, 10, 20] * len(lines),
        "throughput": [value for values in lines.values() for value in values],
        "protocol.mac": [mac for mac in lines for _ in range(4)],
    }
    made = draw(columns, Shown("stations", "throughput", "protocol.mac"), {})
    made.draw_without_rendering()
    (ax,) = made.axes
    box = ax.get_legend().get_window_extent()
    assert (box.x0 > ax.get_window_extent().x1) == beside
    paths = [line.get_transform().transform_path(line.get_path()) for line in ax.lines]
    assert not any(path.intersects_bbox(box, filled=False) for path in paths)


def axes_names(made):
    return [text.get_text() for text in made.axes[0].get_xticklabels()]


def test_a_heat_map_names_as_many_of_its_squares_as_there_is_room_for():
    columns = {"x": list(range(40)), "y": [1.0] * 40, "by": [1] * 40}
    names = axes_names(draw(columns, Shown("x", "y", "by", "heat"), {}))
    assert names == [str(3 * i) for i in range(14)]


def test_numbers_stand_at_themselves_and_words_one_after_another():
    assert sweeps._scale([3, 1.5, 3, None, 2]) == ([1.5, 2, 3], {1.5: 1.5, 2: 2.0, 3: 3.0})
    assert sweeps._scale(["b", "a", "b"]) == (["b", "a"], {"b": 0.0, "a": 1.0})
    assert sweeps._scale([True, False]) == ([False, True], {False: 0.0, True: 1.0})
