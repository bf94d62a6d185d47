"""Cells of a large skin in squares."""

from types import SimpleNamespace

import numpy as np

from innervate.networks.skin.plot.binned import SQUARES, Grid


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
