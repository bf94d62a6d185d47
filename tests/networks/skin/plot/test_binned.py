"""Cells of a large skin in squares."""

from types import SimpleNamespace

import numpy as np
import pytest

from innervate.networks.skin.plot import binned
from innervate.networks.skin.plot.binned import SQUARES, Grid
from innervate.plot import svg


def test_squares_cover_the_sheet_without_its_margin():
    pitch, margin, cells = 3.0, 20.0, 2 * SQUARES
    points = margin + pitch * np.array([[i, j] for i in (0, cells - 1) for j in (0, 1)])
    width = 2 * margin + pitch * (cells - 1)
    sheet = SimpleNamespace(points=points, margin=margin, pitch=pitch, width=width, height=40.0)
    grid = Grid(sheet)
    assert grid.size == 2 * pitch
    assert (grid.columns, grid.squares) == (SQUARES, SQUARES)
    assert grid.place.tolist() == [0, 0, SQUARES - 1, SQUARES - 1]
    assert grid.cells[[0, 1, -1]].tolist() == [2, 0, 2]


def test_the_mean_of_a_square_is_over_those_that_have_a_value():
    grid = Grid(SimpleNamespace(points=np.array([[0.0, 0], [1, 0], [8, 0], [18, 0]]), margin=0.0,
                                pitch=6.0, width=18.0, height=6.0))  # fmt: skip
    assert grid.cells.tolist() == [2, 1, 0, 1]
    values = np.array([5.0, np.nan, np.nan, 7.0])
    mean, came = grid.mean(values, ~np.isnan(values))
    assert (mean.tolist(), came.tolist()) == ([5, 0, 0, 7], [1, 0, 0, 1])


@pytest.mark.parametrize(("most", "tips"), [(3, 2), (2, 2), (1, 1)])
def test_squares_that_lack_something_are_crossed_and_have_tips_up_to_a_most(
    parse, monkeypatch, most, tips
):
    monkeypatch.setattr(binned, "TIPS_MAX", most)
    grid = Grid(SimpleNamespace(points=np.array([[0.0, 0], [8, 0], [18, 0]]), margin=0.0,
                                pitch=6.0, width=18.0, height=6.0))  # fmt: skip
    assert grid.place.tolist() == [0, 1, 3]
    drawing = svg.Drawing(20, 20, "squares")
    lacking = np.array([True, False, True, True])
    grid.draw(drawing, ["a"] * 4, list("wxyz"), lacking)
    made = list(parse(drawing).iter())
    assert [node.text for node in made if node.tag.endswith("title")][-tips:] == ["w", "z"][:tips]
    paths = {node.get("class"): node.get("d") for node in made if node.tag.endswith("path")}
    assert paths["lack"].count("M") == 4  # two crosses


def test_shades_of_ways_are_crossed_where_some_cell_has_none(monkeypatch):
    drawn = []
    monkeypatch.setattr(Grid, "draw", lambda *given: drawn.append(given[2:]))
    monkeypatch.setattr(binned, "hops_of", lambda *_: np.array([2, 4, 0, 0]))
    sheet = SimpleNamespace(
        points=np.array([[0.0, 0], [1, 0], [2, 0], [18, 0]]),
        margin=0.0,
        pitch=6.0,
        width=18.0,
        height=6.0,
        graph=SimpleNamespace(sink=4),
    )
    moment = SimpleNamespace(server=np.array([0, 1, -1, -1]))
    binned.route_map(sheet, moment, "ways")
    ((kinds, tips, lacking),) = drawn
    assert tips[0] == "3 cells, 3.0 hops on average, 1 without a way to the PC"
    assert kinds[-1] == "none"
    assert lacking.tolist() == [True, False, False, True]
